"""The way of a bundle into a draft, and of the draft to the public, which is a step of its own.

Which draft a bundle goes to is kept beside it (`<bundle>.drafts.json`: addresses and identifiers,
no token) as soon as there is one, so that an upload that was broken off goes on in the same draft.
"""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, TypeAdapter, ValidationError

from api.deposit.archives.archive import Archive, Metadata, Record
from api.deposit.archives.metadata import Description, description
from api.deposit.archives.server import ArchiveError
from api.deposit.package import NAME, pack
from api.deposit.verification import verify
from files.atomic import replace_file, temporary_directory_beside

#: Files that are also sent by themselves, to be read or searched without the zip.
APART = (
    *("README.md", "sun-sensor-atlas.sqlite"),
    *("bibliography/studies.bib", "bibliography/studies.ris"),
)
#: How often a file whose checksum came back wrong is sent.
_TRIES = 3

State = Literal["sent", "there already", "removed"]


@dataclass(frozen=True)
class Bundle:
    """A private copy of a bundle as it was verified: files to send by name, MD5, metadata."""

    files: dict[str, Path]
    md5: dict[str, str]
    description: Description


@dataclass(frozen=True)
class UploadResult:
    """The draft, what happened to each file, and files in it that are not of the bundle."""

    draft: Record
    files: dict[str, State]
    remaining_files: tuple[str, ...]


@contextmanager
def verified(directory: Path, undone: str) -> Iterator[Bundle]:
    """Copy a bundle, verify the copy and pack it; it is there for as long as the block.

    Raises
    ------
    ArchiveError
        Where anything in the bundle does not hold, or its CITATION.cff lacks authors or the
        repository.
    CitationError
        Where the authors in its CITATION.cff cannot be read.
    """
    directory = Path(os.path.abspath(directory))  # noqa: PTH100 - a link stays one
    with temporary_directory_beside(directory) as private:
        copy = private / directory.name
        try:
            shutil.copytree(directory, copy, symlinks=True)
            wrong = verify(copy)
        except (OSError, ValueError) as error:
            said = str(error).replace(str(private), str(directory.parent))
            raise ArchiveError(f"{said}; {undone}") from error
        wrong += [(name, "missing") for name in APART if not (copy / name).is_file()]
        if wrong:
            raise ArchiveError(f"{directory}: {wrong[0][0]}: {wrong[0][1]}; {undone}")
        about = description(copy)
        if about.unfilled:
            raise ArchiveError(
                f"CITATION.cff of the bundle is not filled in: {'; '.join(about.unfilled)}. Fill "
                f"in the project's own, build and upload again; {undone}"
            )
        top = f"{NAME}-{about.version}"
        packed = private / f"{top}.zip"
        pack(copy, packed, top, date.fromisoformat(about.released))
        files = {packed.name: packed, **{Path(name).name: copy / name for name in APART}}
        yield Bundle(files, {name: _md5(path) for name, path in files.items()}, about)


def upload(
    archive: Archive,
    directory: Path,
    *,
    version_of: str | None = None,
    draft: str | None = None,
    tell: Callable[[str, State], None] = lambda _name, _state: None,
) -> UploadResult:
    """Bring a bundle into a draft; nothing becomes public.

    Parameters
    ----------
    archive : to send to
    directory : the bundle
    version_of : published record to make the next version of; a new record by default
    draft : to go on with, where it is not the remembered one
    tell : called after each file

    Raises
    ------
    ArchiveError
        Where anything does not go as it should; what has been sent stays in the draft.
    CitationError
        As `verified`.
    """
    with verified(directory, "nothing was sent") as bundle:
        document = bundle.description.draft
        opened, of = _open(archive, directory, version_of, draft, document)
        archive.describe(opened.id, document)
        there = archive.files(opened.id)
        done: dict[str, State] = {}
        for name in bundle.files:
            held = name in there and there[name].md5 == bundle.md5[name]
            if not held:
                _send(archive, opened.id, name, bundle)
            done[name] = "there already" if held else "sent"
            tell(name, done[name])
        foreign = tuple(sorted(there.keys() - bundle.files.keys()))
        if of is None:
            return UploadResult(opened, done, foreign)
        for name in foreign:  # of the version before, under a name that this one does not have
            archive.delete(opened.id, name)
            done[name] = "removed"
            tell(name, "removed")
        return UploadResult(opened, done, ())


def publish(archive: Archive, identifier: str, directory: Path) -> Record:
    """Make a draft public that has the files and the authors of a bundle.

    Raises
    ------
    ArchiveError
        Where the bundle does not hold, authors or files of the draft are not those of the bundle,
        or the archive does not do as asked.
    CitationError
        As `verified`.
    """
    undone = "nothing was published"
    with verified(directory, undone) as bundle:
        draft = archive.draft(identifier)
        if draft is None:
            public = archive.published(identifier)
            said = "is published already" if public else "is no unpublished draft of this archive"
            raise ArchiveError(f"{identifier} {said}; {undone}")
        authors = Metadata.model_validate(bundle.description.draft["metadata"]).authors
        if draft.metadata.authors != authors:
            raise ArchiveError(
                f"the authors of draft {identifier} are {draft.metadata.authors}, expected those "
                f"of the bundle, {authors}. Upload again; {undone}"
            )
        held = {name: entry.md5 for name, entry in archive.files(identifier).items()}
        if differing := sorted(dict(held.items() ^ bundle.md5.items())):
            raise ArchiveError(
                f"draft {identifier} is not the bundle in {directory}: {', '.join(differing)} "
                "missing, foreign or of other bytes. Upload again, or take foreign files out; "
                f"{undone}"
            )
        return archive.publish(identifier)


def _send(archive: Archive, draft: str, name: str, bundle: Bundle) -> None:
    found = None
    for _ in range(_TRIES):
        found = archive.send(draft, name, bundle.files[name], bundle.md5[name])
        if found == bundle.md5[name]:
            return
    raise ArchiveError(
        f"{name}: sent {_TRIES} times, the archive has MD5 {found or 'none'}, here it is "
        f"{bundle.md5[name]}; run the command again later, and do not publish"
    )


class _Remembered(BaseModel):
    draft: str
    version_of: str | None


_MEMORY = TypeAdapter(dict[str, _Remembered])


def _open(
    archive: Archive,
    directory: Path,
    version_of: str | None,
    draft: str | None,
    document: dict[str, object],
) -> tuple[Record, str | None]:
    """Find or open the draft; return it, and the record that it is the next version of."""
    path = directory.with_name(f"{directory.name}.drafts.json")
    try:
        memory = _MEMORY.validate_json(path.read_bytes()) if path.exists() else {}
    except ValidationError as error:
        raise ArchiveError(
            f"{path}: does not say which draft the bundle goes to; delete it, and name the draft "
            "with --draft if there is one"
        ) from error
    known = memory.get(where := f"{archive.server.address} records")
    found = None
    if draft is not None:
        if (found := archive.draft(draft)) is None:
            raise ArchiveError(f"{archive.server.address} has no unpublished draft {draft}")
        version_of = known.version_of if known and known.draft == draft else None
    elif known is not None and version_of in (None, known.version_of):
        if (found := archive.draft(known.draft)) is not None:
            version_of = known.version_of
        elif version_of is None and archive.published(known.draft):
            raise ArchiveError(
                f"{known.draft} is published; `sunatlas deposit upload --new-version "
                f"{known.draft}` opens its next version"
            )
        # Else it was deleted by hand, or published since: a draft of its own is wanted.
    if found is None:
        found = archive.new_version(version_of) if version_of else archive.create(document)
    memory[where] = _Remembered(draft=found.id, version_of=version_of)
    replace_file(path, _MEMORY.dump_json(memory, indent=2).decode() + "\n")
    return found, version_of


def _md5(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.md5(usedforsecurity=False)).hexdigest()

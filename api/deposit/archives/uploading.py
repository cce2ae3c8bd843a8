"""The way of a bundle into a draft: opened or gone on with, each file sent once, nothing public.

Which draft a bundle goes to is kept beside it (`<bundle>.drafts.json`: addresses and identifiers,
no token) as soon as there is one, so that an upload that was broken off goes on in the same draft.
"""

from __future__ import annotations

import hashlib
import json
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from api.deposit.archives.contract import Archive, ArchiveError, Draft, NoDraftError
from api.deposit.archives.metadata import description
from api.deposit.package import DESCRIPTOR
from api.deposit.verification import verify
from benchmark.datasets.checksums import contents, sha256
from survey_data.whole_files import replace_file

#: Files that are also sent by themselves, to be read or searched without the zip.
APART = ("README.md", "sun-sensor-atlas.sqlite", "studies.bib", "studies.ris")
#: How often a file whose checksum came back wrong is sent.
_TRIES = 3

State = Literal["sent", "there already", "removed"]
Tell = Callable[[str, State], None]


class BundleError(ArchiveError):
    """What is to be uploaded is no whole bundle."""


class ChecksumError(ArchiveError):
    """The archive holds other bytes than were sent, time and again."""


@dataclass(frozen=True)
class Uploaded:
    """What an upload did.

    Attributes
    ----------
    draft : it went to
    files : what happened to each file
    left : files of the draft that are not of the bundle and were there before
    """

    draft: Draft
    files: Mapping[str, State]
    left: tuple[str, ...]


def parts(directory: Path) -> dict[str, Path]:
    """Return the files that an archive is sent of a bundle, by name.

    Raises
    ------
    BundleError
        Where the zip is missing, or is not that of the directory.
    """
    packed = directory.with_name(f"{directory.name}.zip")
    if not packed.is_file():
        raise BundleError(
            f"{packed}: missing; build the bundle again with `sunatlas deposit build`"
        )
    try:
        with zipfile.ZipFile(packed) as archive:
            inside = {name.partition("/")[2]: _digest(archive, name) for name in archive.namelist()}
    except (zipfile.BadZipFile, OSError, EOFError) as error:
        raise BundleError(f"{packed}: no whole zip ({error})") from error
    if inside != {name: sha256(directory / name) for name in contents(directory)}:
        raise BundleError(f"{packed}: not the zip of {directory}; build the bundle again")
    package = json.loads((directory / DESCRIPTOR).read_text("utf-8"))
    apart = {Path(name).name: directory / name for name in contents(directory)}
    return {
        f"{package['name']}-{package['version']}.zip": packed,
        **{name: apart[name] for name in APART},
    }


def _digest(archive: zipfile.ZipFile, name: str) -> str:
    with archive.open(name) as file:
        digest = hashlib.sha256()
        while chunk := file.read(1 << 20):
            digest.update(chunk)
    return digest.hexdigest()


def md5_of(path: Path) -> str:
    """Return the MD5 of a file in hexadecimal: the checksum that both interfaces tell."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, lambda: hashlib.md5(usedforsecurity=False)).hexdigest()


def upload(
    archive: Archive,
    server: str,
    directory: Path,
    *,
    version_of: str | None = None,
    draft: str | None = None,
    tell: Tell = lambda _name, _state: None,
) -> Uploaded:
    """Bring a bundle into a draft; nothing becomes public.

    Parameters
    ----------
    archive : to send to
    server : its address, by which the draft is remembered
    directory : the bundle, its zip beside it
    version_of : published record to make the next version of; a new record by default
    draft : to go on with, where it is not the remembered one
    tell : called after each file

    Raises
    ------
    ArchiveError
        Where anything does not go as it should; what has been sent stays in the draft.
    """
    if wrong := verify(directory):
        raise BundleError(f"{directory}: {wrong[0][0]}: {wrong[0][1]}; nothing was sent")
    sending = parts(directory)
    memory = Memory(directory, f"{server} {archive.name}")
    told = description(directory)
    opened, of, fresh = _open(archive, memory, version_of, draft, told)
    if not fresh:
        archive.describe(opened, told)
    there = archive.files(opened)
    done: dict[str, State] = {}
    for name, path in sending.items():
        done[name] = _settle(archive, opened, name, path, there)
        tell(name, done[name])
    foreign = sorted(there.keys() - sending.keys())
    if of is not None:
        # Of the version before, under names that this one does not have.
        for name in foreign:
            archive.delete(opened, there[name])
            done[name] = "removed"
            tell(name, "removed")
    return Uploaded(opened, done, () if of is not None else tuple(foreign))


def _settle(
    archive: Archive, draft: Draft, name: str, path: Path, there: Mapping[str, Any]
) -> State:
    wanted = md5_of(path)
    if name in there and there[name].md5 == wanted:
        return "there already"
    found = None
    for _ in range(_TRIES):
        found = archive.send(draft, name, path).md5
        if found == wanted:
            return "sent"
    raise ChecksumError(
        f"{name}: sent {_TRIES} times, the archive has MD5 {found or 'none'}, here it is {wanted}; "
        "run the command again later, and do not publish"
    )


def _open(
    archive: Archive, memory: Memory, version_of: str | None, draft: str | None, told: Any
) -> tuple[Draft, str | None, bool]:
    """Return the draft, the record it is a version of, and whether it has its description."""
    if draft is not None:
        if version_of is not None:
            raise ArchiveError("--draft goes on with a draft, --new-version opens one: give one")
        found, of = archive.draft(draft), None
        remembered = memory.recall()
        if remembered is not None and remembered[0] == found.id:
            of = remembered[1]
        memory.keep(found.id, of)
        return found, of, False
    remembered = memory.recall()
    if remembered is not None and version_of in (None, remembered[1]):
        identifier, of = remembered
        try:
            return archive.draft(identifier), of, False
        except NoDraftError:
            published = archive.published(identifier)
            if published is not None and version_of is None:
                raise ArchiveError(
                    f"{published.page} is published; `sunatlas deposit upload --new-version "
                    f"{identifier}` opens its next version"
                ) from None
            # Deleted by hand, or published since: a draft of its own is wanted.
    if version_of is None:
        opened, fresh = archive.create(told), True
    else:
        opened, fresh = archive.new_version(version_of), False
    memory.keep(opened.id, version_of)
    return opened, version_of, fresh


class Memory:
    """Which draft a bundle goes to, for each server and interface.

    Parameters
    ----------
    directory : of the bundle
    where : server and interface
    """

    def __init__(self, directory: Path, where: str) -> None:
        self.path = directory.with_name(f"{directory.name}.drafts.json")
        self._where = where

    def recall(self) -> tuple[str, str | None] | None:
        """Return the draft, and the record it is a new version of; None where there is none.

        Raises
        ------
        BundleError
            Where the file is none of ours.
        """
        entry = self._read().get(self._where)
        return None if entry is None else (entry["draft"], entry["version_of"])

    def keep(self, draft: str, version_of: str | None) -> None:
        """Remember a draft."""
        document = self._read() | {self._where: {"draft": draft, "version_of": version_of}}
        replace_file(self.path, json.dumps(document, indent=2, sort_keys=True) + "\n")

    def _read(self) -> dict[str, Any]:
        if not self.path.exists():
            return {}
        try:
            found = json.loads(self.path.read_text("utf-8"))
            for entry in found.values():
                if not isinstance(entry["draft"], str):
                    raise TypeError  # noqa: TRY301 - as the members that are not there
                if not isinstance(entry["version_of"], str | None):
                    raise TypeError  # noqa: TRY301
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise BundleError(
                f"{self.path}: does not say which draft the bundle goes to; delete it, and name "
                "the draft with --draft if there is one"
            ) from error
        return dict(found)

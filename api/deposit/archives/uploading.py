"""The way of a bundle into a draft: opened or gone on with, each file sent once, nothing public.

Which draft a bundle goes to is kept beside it (`<bundle>.drafts.json`: addresses and identifiers,
no token) as soon as there is one, so that an upload that was broken off goes on in the same draft.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from api.deposit.archives.archive import Archive
from api.deposit.archives.contract import (
    ArchiveError,
    Draft,
    NoDraftError,
    StoredFile,
)
from api.deposit.archives.metadata import Description
from api.deposit.archives.sealed import BundleError, SealedBundle, SealedFile, seal
from files.atomic import replace_file

#: How often a file whose checksum came back wrong is sent.
_TRIES = 3

State = Literal["sent", "there already", "removed"]
Tell = Callable[[str, State], None]


class ChecksumError(ArchiveError):
    """The archive holds other bytes than were sent, time and again."""


@dataclass(frozen=True)
class UploadResult:
    """What an upload did.

    Attributes
    ----------
    draft : it went to
    files : what happened to each file
    remaining_files : files of the draft that are not of the bundle and were there before
    """

    draft: Draft
    files: Mapping[str, State]
    remaining_files: tuple[str, ...]


@dataclass(frozen=True)
class OpenDraft:
    """A draft to send to.

    Attributes
    ----------
    draft : where files go
    version_of : record that it is the next version of, or None
    has_metadata : whether it has the bundle's description already
    """

    draft: Draft
    version_of: str | None
    has_metadata: bool


def upload(
    archive: Archive,
    server: str,
    directory: Path,
    *,
    version_of: str | None = None,
    draft: str | None = None,
    tell: Tell = lambda _name, _state: None,
) -> UploadResult:
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
    UnfilledError
        Where the bundle's CITATION.cff lacks authors or the repository; nothing was sent.
    ArchiveError
        Where anything does not go as it should; what has been sent stays in the draft.
    """
    memory = Memory(directory, f"{server} {archive.name}")
    with seal(directory) as bundle:
        bundle.description.require_filled("nothing was sent")
        opened = _open(archive, memory, version_of, draft, bundle.description)
        return _send(archive, bundle, opened, tell)


def _send(archive: Archive, bundle: SealedBundle, opened: OpenDraft, tell: Tell) -> UploadResult:
    """Send what the draft lacks."""
    draft = opened.draft
    if not opened.has_metadata:
        archive.describe(draft, bundle.description)
    there = archive.files(draft)
    done: dict[str, State] = {}
    for name, file in bundle.files.items():
        done[name] = _settle(archive, draft, name, file, there)
        tell(name, done[name])
    foreign = sorted(there.keys() - bundle.files.keys())
    if opened.version_of is not None:
        # Of the version before, under names that this one does not have.
        for name in foreign:
            archive.delete(draft, there[name])
            done[name] = "removed"
            tell(name, "removed")
    return UploadResult(draft, done, () if opened.version_of is not None else tuple(foreign))


def _settle(
    archive: Archive, draft: Draft, name: str, file: SealedFile, there: Mapping[str, StoredFile]
) -> State:
    if name in there and there[name].md5 == file.md5:
        return "there already"
    found = None
    for _ in range(_TRIES):
        found = archive.send(draft, name, file).md5
        if found == file.md5:
            return "sent"
    raise ChecksumError(
        f"{name}: sent {_TRIES} times, the archive has MD5 {found or 'none'}, here it is "
        f"{file.md5}; run the command again later, and do not publish"
    )


def _open(
    archive: Archive, memory: Memory, version_of: str | None, draft: str | None, record: Description
) -> OpenDraft:
    """Find or open the draft."""
    if draft is not None:
        if version_of is not None:
            raise ArchiveError("--draft goes on with a draft, --new-version opens one: give one")
        found, of = archive.draft(draft), None
        remembered = memory.recall()
        if remembered is not None and remembered[0] == found.id:
            of = remembered[1]
        memory.keep(found.id, of)
        return OpenDraft(found, of, has_metadata=False)
    remembered = memory.recall()
    if remembered is not None and version_of in (None, remembered[1]):
        identifier, of = remembered
        try:
            return OpenDraft(archive.draft(identifier), of, has_metadata=False)
        except NoDraftError:
            published = archive.published_record(identifier)
            if published is not None and version_of is None:
                raise ArchiveError(
                    f"{published.page} is published; `sunatlas deposit upload --new-version "
                    f"{identifier}` opens its next version"
                ) from None
            # Deleted by hand, or published since: a draft of its own is wanted.
    if version_of is None:
        opened, fresh = archive.create(record), True
    else:
        opened, fresh = archive.new_version(version_of), False
    memory.keep(opened.id, version_of)
    return OpenDraft(opened, version_of, fresh)


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

"""What every archive does: open a draft, take files and a description, publish.

Two interfaces of Zenodo keep this contract (`records`, `depositions`); whoever uploads knows
neither.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from api.deposit.archives.metadata import Description
from api.deposit.citation import Author

if TYPE_CHECKING:
    from api.deposit.archives.sealed import SealedFile


class ArchiveError(ValueError):
    """An archive refused, failed or cannot be understood; the message says what to do."""


class RefusedError(ArchiveError):
    """The archive answered that it will not.

    Attributes
    ----------
    status : of HTTP
    """

    def __init__(self, message: str, status: int) -> None:
        super().__init__(message)
        self.status = status


class NoDraftError(ArchiveError):
    """There is no draft of this name (any more)."""


class UnreachableError(ArchiveError):
    """No answer after every try."""


@dataclass(frozen=True)
class Draft:
    """A record that is not published yet.

    Attributes
    ----------
    id : by which it is published
    page : address at which a person sees it
    authors : that it names
    files_at : address that takes files, where the archive gives one
    """

    id: str
    page: str
    authors: tuple[Author, ...] = ()
    files_at: str = ""


@dataclass(frozen=True)
class StoredFile:
    """A file as the archive holds it.

    Attributes
    ----------
    id : by which it is deleted
    md5 : in hexadecimal; None where it is not whole
    """

    id: str
    md5: str | None


@dataclass(frozen=True)
class Published:
    """A record that is public.

    Attributes
    ----------
    id, page, doi : of this version; doi None where the archive tells none
    """

    id: str
    page: str
    doi: str | None


class Archive(Protocol):
    """One archive by one interface; every call may raise ArchiveError."""

    name: str

    def create(self, description: Description) -> Draft:
        """Open a draft of a new record."""
        ...

    def new_version(self, record: str) -> Draft:
        """Open a draft of the next version of a published record, with the files it has."""
        ...

    def draft(self, identifier: str) -> Draft:
        """Look at a draft; NoDraftError where there is none."""
        ...

    def published(self, identifier: str) -> Published | None:
        """Look at a published record; None where there is none."""
        ...

    def describe(self, draft: Draft, description: Description) -> None:
        """Give the draft this description instead of the one it has."""
        ...

    def files(self, draft: Draft) -> Mapping[str, StoredFile]:
        """List the files of a draft by name, halves among them."""
        ...

    def send(self, draft: Draft, name: str, file: SealedFile) -> StoredFile:
        """Send a file, in place of one of this name."""
        ...

    def delete(self, draft: Draft, file: StoredFile) -> None:
        """Take a file out of a draft."""
        ...

    def publish(self, draft: Draft) -> Published:
        """Make the draft public, for good."""
        ...


def wanting(found: Mapping[str, StoredFile], wanted: Mapping[str, str]) -> Sequence[str]:
    """Say how the files of a draft differ from `wanted`, MD5 by name; empty where they do not."""
    missing = [f"{name} is missing" for name in sorted(wanted.keys() - found.keys())]
    foreign = [f"{name} is not of the bundle" for name in sorted(found.keys() - wanted.keys())]
    other = [
        f"{name} is {'other bytes' if found[name].md5 else 'half there'}"
        for name in sorted(found.keys() & wanted.keys())
        if found[name].md5 != wanted[name]
    ]
    return [*missing, *foreign, *other]

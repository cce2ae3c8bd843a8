"""What calls of an archive give and raise: drafts, stored files, published records, errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from api.metadata.citation import Author


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
class PublishedRecord:
    """A record that is public.

    Attributes
    ----------
    id, page, doi : of this version; doi None where the archive tells none
    """

    id: str
    page: str
    doi: str | None


def file_differences(found: Mapping[str, StoredFile], wanted: Mapping[str, str]) -> Sequence[str]:
    """Say how the files of a draft differ from `wanted`, MD5 by name; empty where they do not."""
    missing = [f"{name} is missing" for name in sorted(wanted.keys() - found.keys())]
    foreign = [f"{name} is not of the bundle" for name in sorted(found.keys() - wanted.keys())]
    other = [
        f"{name} is {'other bytes' if found[name].md5 else 'half there'}"
        for name in sorted(found.keys() & wanted.keys())
        if found[name].md5 != wanted[name]
    ]
    return [*missing, *foreign, *other]

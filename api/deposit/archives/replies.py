"""Typed models of the archive's replies, for both interfaces.

More members than are read may be there; one that is missing or of another type is named
(`api.deposit.archives.responses`).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Annotated, Any, Literal, TypeVar
from urllib.parse import quote

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    RootModel,
    StringConstraints,
)

from api.deposit.archives.contract import PublishedRecord, RefusedError, StoredFile
from api.deposit.archives.responses import ReplyError, short
from api.metadata.citation import Author

_IDENTIFIER = re.compile(r"[A-Za-z0-9][A-Za-z0-9-]{0,63}")
#: What a terminal would act on, and letters that turn the direction of reading.
_CONTROL = re.compile(r"[\x00-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
_MD5 = re.compile(r"(?:md5:)?([0-9a-f]{32})")
#: Files of a record on Zenodo, and some more that another archive may allow.
_FILES = 1000

T = TypeVar("T")


def _as_text(value: Any) -> Any:
    """Return a number, as the legacy interface counts its depositions, as text."""
    counted = isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 10**18
    return str(value) if counted else value


def _plain(text: str) -> str:
    if _CONTROL.search(text):
        raise ValueError("expected no control characters")
    return text


def identifier(value: str) -> str:
    """Return the identifier of a record, which may stand in an address.

    Raises
    ------
    ReplyError
        For anything else.
    """
    if not _IDENTIFIER.fullmatch(value):
        raise ReplyError(
            f"{short(value)} is no identifier of a record: expected letters and digits, as in "
            "the record's address"
        )
    return value


Identifier = Annotated[str, BeforeValidator(_as_text), AfterValidator(identifier)]
Line = Annotated[str, StringConstraints(max_length=1000), AfterValidator(_plain)]


class Reply(BaseModel):
    """An answer."""

    model_config = ConfigDict(strict=True, frozen=True, extra="ignore")


class _Orcid(Reply):
    scheme: Line | None = None
    identifier: Line | None = None


class _Who(Reply):
    type: Line | None = None
    name: Line | None = None
    family_name: Line | None = None
    given_name: Line | None = None
    identifiers: list[_Orcid] | None = None


class _Creator(Reply):
    person_or_org: _Who | None = None

    @property
    def author(self) -> Author:
        """The person or organisation."""
        who = self.person_or_org or _Who()
        orcids = [i.identifier for i in who.identifiers or () if i.scheme == "orcid"]
        personal = who.type == "personal"
        return Author(
            family=(who.family_name or "") if personal else "",
            given=(who.given_name or "") if personal else "",
            name="" if personal else who.name or "",
            orcid=orcids[0] if orcids else None,
        )


class _Metadata(Reply):
    creators: list[_Creator] | None = None


class Pid(Reply):
    """A persistent identifier: reserved for a draft, or registered."""

    identifier: Line
    provider: Line | None = None
    client: Line | None = None


class Record(Reply):
    """A record or draft: what the records interface says of it."""

    id: Identifier
    is_published: bool | None = None
    metadata: _Metadata | None = None
    pids: dict[Line, Pid] | None = None

    @property
    def authors(self) -> tuple[Author, ...]:
        """The authors that it names."""
        creators = self.metadata.creators if self.metadata else None
        return tuple(creator.author for creator in creators or ())

    def published_record(self, address: str) -> PublishedRecord:
        """Return the record as one that is public on a server."""
        doi = (self.pids or {}).get("doi")
        return PublishedRecord(
            self.id, f"{address}/records/{self.id}", doi.identifier if doi else None
        )


class Entry(Reply):
    """A file of a draft: whole once its status is completed."""

    key: Line
    status: Line | None = None
    checksum: Line | None = None

    @property
    def is_complete(self) -> bool:
        """Whether it was committed."""
        return self.status == "completed"

    @property
    def stored_file(self) -> StoredFile:
        """The file as the archive holds it."""
        return StoredFile(self.key, md5(self.checksum) if self.is_complete else None)


class Entries(Reply):
    """A list of files: of a draft."""

    entries: Annotated[list[Entry], Field(max_length=_FILES)]


class _LegacyCreator(Reply):
    name: Line | None = None
    orcid: Line | None = None

    @property
    def author(self) -> Author:
        """The person, or the organisation where the name has no comma."""
        family, comma, given = (self.name or "").partition(", ")
        if comma:
            return Author(family, given, "", self.orcid)
        return Author(name=family, orcid=self.orcid)


class _LegacyMetadata(Reply):
    creators: list[_LegacyCreator] | None = None


class _Links(Reply):
    bucket: Line | None = None
    latest_draft: Line | None = None


class Deposition(Reply):
    """A deposition: what the legacy interface says of it."""

    id: Identifier
    submitted: bool | None = None
    doi: Line | None = None
    metadata: _LegacyMetadata | None = None
    links: _Links | None = None

    @property
    def authors(self) -> tuple[Author, ...]:
        """The authors that it names."""
        creators = self.metadata.creators if self.metadata else None
        return tuple(creator.author for creator in creators or ())

    def link(self, name: Literal["bucket", "latest_draft"]) -> str:
        """Return an address that it gives.

        Raises
        ------
        ReplyError
            Where it gives none.
        """
        found = getattr(self.links, name, None)
        if found is None:
            raise ReplyError(f"deposition {self.id} has no links.{name}, expected an address")
        return str(found)


class DepositionFile(Reply):
    """A file of a deposition: always whole."""

    id: Identifier
    filename: Line
    checksum: Line | None = None


class DepositionFiles(RootModel[Annotated[list[DepositionFile], Field(max_length=_FILES)]]):
    """A list of files: of a deposition."""

    model_config = ConfigDict(strict=True, frozen=True)


class BucketFile(Reply):
    """A file of a bucket: with its checksum."""

    checksum: Line | None = None


def by_name(files: list[tuple[str, StoredFile]]) -> dict[str, StoredFile]:
    """Return files by their names.

    Raises
    ------
    ReplyError
        Where two have the same.
    """
    found = dict(files)
    if len(found) < len(files):
        names = [name for name, _ in files]
        twice = next(name for name in names if names.count(name) > 1)
        raise ReplyError(f"the archive lists {twice} twice, expected one file of a name")
    return found


def about(asked: str, reply: T, record: str) -> T:
    """Return an answer about the record that was asked for.

    Raises
    ------
    ReplyError
        If `record` is another one.
    """
    if record != asked:
        raise ReplyError(f"the archive answered of record {record}, expected {asked}")
    return reply


def md5(value: str | None) -> str | None:
    """Return a checksum in hexadecimal, with or without its prefix; None where there is none."""
    found = _MD5.fullmatch(value or "")
    return found[1] if found else None


def segment(name: str) -> str:
    """Return a file's name as one segment of a path."""
    return quote(name, safe="")


def unless_missing(look: Callable[[], T]) -> T | None:
    """Look at something; None where the archive says that it is not there (404, 410)."""
    try:
        return look()
    except RefusedError as error:
        if error.status in {404, 410}:
            return None
        raise

"""Zenodo's legacy deposit interface (developers.zenodo.org).

Sequence: make a deposition; put each file into its bucket; describe; publish. Kept for archives and
tools that still speak it; `records` is the better one, since Zenodo refuses new versions of records
with files here at times.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from api.deposit.archives.contract import (
    ArchiveError,
    Draft,
    NoDraftError,
    Published,
    RefusedError,
    StoredFile,
)
from api.deposit.archives.metadata import Description, creators_of_legacy, legacy
from api.deposit.archives.replies import (
    content,
    entries,
    identifier,
    md5,
    member,
    segment,
    unless_missing,
)
from api.deposit.archives.transport import Transport

_ALL = "/api/deposit/depositions"


class DepositionsArchive:
    """An archive by its legacy interface."""

    name = "legacy"

    def __init__(self, transport: Transport) -> None:
        self._ask = transport.ask
        self._address = transport.server.address

    def create(self, description: Description) -> Draft:
        """Open a deposition; where the answer is lost, an empty one may be left over."""
        return self._draft(self._ask("POST", _ALL, json={"metadata": legacy(description)}))

    def new_version(self, record: str) -> Draft:
        """Open a draft of the next version, found where the answer's `latest_draft` points."""
        where = f"{_ALL}/{identifier(record)}/actions/newversion"
        try:
            reply = self._ask("POST", where)
        except RefusedError as error:
            if "remove all files" in str(error):
                raise ArchiveError(
                    f"{error}; a known fault of this interface: use --api records, or --draft with "
                    "the draft that is left over"
                ) from error
            raise
        return self._draft(self._ask("GET", member(reply, "links", "latest_draft")))

    def draft(self, identifier_: str) -> Draft:
        """Look at a draft; NoDraftError where there is none."""
        reply = self._deposition(identifier_)
        if reply is None or reply.get("submitted"):
            raise NoDraftError(f"{self._address} has no unpublished draft {identifier_}")
        return self._draft(reply)

    def published(self, identifier_: str) -> Published | None:
        """Look at a published record; None where there is none."""
        reply = self._deposition(identifier_)
        return self._published(reply) if reply and reply.get("submitted") else None

    def describe(self, draft: Draft, description: Description) -> None:
        """Give the draft this description instead of the one it has."""
        self._ask("PUT", f"{_ALL}/{draft.id}", json={"metadata": legacy(description)})

    def files(self, draft: Draft) -> Mapping[str, StoredFile]:
        """List the files of a draft by name; a bucket has none but whole ones."""
        listed = entries(self._ask("GET", f"{_ALL}/{draft.id}/files"), "files")
        return {
            member(entry, "filename"): StoredFile(
                identifier(member(entry, "id")), md5(entry.get("checksum"))
            )
            for entry in listed
        }

    def send(self, draft: Draft, name: str, path: Path) -> StoredFile:
        """Put a file into the bucket, over one of this name."""
        reply = self._ask("PUT", f"{draft.files_at}/{segment(name)}", content=content(path))
        # A bucket's answer names no file of the deposition: who deletes it asks for the list.
        return StoredFile("", md5(reply.get("checksum")))

    def delete(self, draft: Draft, file: StoredFile) -> None:
        """Take a file out of a draft; that it is gone already is as well."""
        where = f"{_ALL}/{draft.id}/files/{segment(file.id)}"
        unless_missing(lambda: self._ask("DELETE", where))

    def publish(self, draft: Draft) -> Published:
        """Make the draft public, for good."""

        def happened() -> Any:
            reply = self._deposition(draft.id)
            return reply if reply and reply.get("submitted") else None

        reply = self._ask("POST", f"{_ALL}/{draft.id}/actions/publish", happened=happened)
        return self._published(reply)

    def _deposition(self, identifier_: str) -> Any:
        where = f"{_ALL}/{identifier(identifier_)}"
        return unless_missing(lambda: self._ask("GET", where))

    def _draft(self, reply: Any) -> Draft:
        found = identifier(member(reply, "id"))
        return Draft(
            found,
            f"{self._address}/deposit/{found}",
            creators_of_legacy(reply.get("metadata")),
            str(member(reply, "links", "bucket")),
        )

    def _published(self, reply: Any) -> Published:
        found = identifier(member(reply, "id"))
        return Published(found, f"{self._address}/records/{found}", reply.get("doi"))

"""Zenodo's legacy deposit interface (developers.zenodo.org).

Sequence: make a deposition; put each file into its bucket; describe; publish. Kept for archives and
tools that still speak it; `records` is the better one, since Zenodo refuses new versions of records
with files here at times.
"""

from __future__ import annotations

from collections.abc import Mapping

from api.deposit.archives.contract import (
    ArchiveError,
    Draft,
    NoDraftError,
    PublishedRecord,
    RefusedError,
    StoredFile,
)
from api.deposit.archives.metadata import Description, legacy
from api.deposit.archives.replies import (
    BucketFile,
    Deposition,
    DepositionFiles,
    about,
    by_name,
    identifier,
    md5,
    segment,
    unless_missing,
)
from api.deposit.archives.sealed import SealedFile
from api.deposit.archives.transport import Transport

_ALL = "/api/deposit/depositions"


class DepositionsArchive:
    """An archive by its legacy interface."""

    name = "legacy"

    def __init__(self, transport: Transport) -> None:
        self._ask = transport.ask
        self._tell = transport.tell
        self._address = transport.server.address

    def create(self, description: Description) -> Draft:
        """Open a deposition; where the answer is lost, an empty one may be left over."""
        body = {"metadata": legacy(description)}
        return self._draft(self._ask("POST", _ALL, Deposition, json=body))

    def new_version(self, record: str) -> Draft:
        """Open a draft of the next version, found where the answer's `latest_draft` points."""
        where = f"{_ALL}/{identifier(record)}/actions/newversion"
        try:
            reply = self._ask("POST", where, Deposition)
        except RefusedError as error:
            if "remove all files" in str(error):
                raise ArchiveError(
                    f"{error}; a known fault of this interface: use --api records, or --draft with "
                    "the draft that is left over"
                ) from error
            raise
        return self._draft(self._ask("GET", reply.link("latest_draft"), Deposition))

    def draft(self, identifier_: str) -> Draft:
        """Look at a draft; NoDraftError where there is none."""
        reply = self._deposition(identifier_)
        if reply is None or reply.submitted:
            raise NoDraftError(f"{self._address} has no unpublished draft {identifier_}")
        return self._draft(reply)

    def published_record(self, identifier_: str) -> PublishedRecord | None:
        """Look at a published record; None where there is none."""
        reply = self._public(identifier_)
        return None if reply is None else self._published_record(reply)

    def describe(self, draft: Draft, description: Description) -> None:
        """Give the draft this description instead of the one it has."""
        self._tell("PUT", f"{_ALL}/{draft.id}", json={"metadata": legacy(description)})

    def files(self, draft: Draft) -> Mapping[str, StoredFile]:
        """List the files of a draft by name; a bucket has none but whole ones."""
        listed = self._ask("GET", f"{_ALL}/{draft.id}/files", DepositionFiles).root
        return by_name(
            [(file.filename, StoredFile(file.id, md5(file.checksum))) for file in listed]
        )

    def send(self, draft: Draft, name: str, file: SealedFile) -> StoredFile:
        """Put a file into the bucket, over one of this name."""
        where = f"{draft.files_at}/{segment(name)}"
        reply = self._ask("PUT", where, BucketFile, content=file.content)
        # A bucket's answer names no file of the deposition: who deletes it asks for the list.
        return StoredFile("", md5(reply.checksum))

    def delete(self, draft: Draft, file: StoredFile) -> None:
        """Take a file out of a draft; that it is gone already is as well."""
        where = f"{_ALL}/{draft.id}/files/{segment(file.id)}"
        unless_missing(lambda: self._tell("DELETE", where))

    def publish(self, draft: Draft) -> PublishedRecord:
        """Make the draft public, for good."""
        where = f"{_ALL}/{draft.id}/actions/publish"
        reply = self._ask("POST", where, Deposition, happened=lambda: self._public(draft.id))
        return self._published_record(about(draft.id, reply, reply.id))

    def _public(self, identifier_: str) -> Deposition | None:
        reply = self._deposition(identifier_)
        return reply if reply is not None and reply.submitted else None

    def _deposition(self, identifier_: str) -> Deposition | None:
        where = f"{_ALL}/{identifier(identifier_)}"
        reply = unless_missing(lambda: self._ask("GET", where, Deposition))
        return None if reply is None else about(identifier_, reply, reply.id)

    def _draft(self, reply: Deposition) -> Draft:
        page = f"{self._address}/deposit/{reply.id}"
        return Draft(reply.id, page, reply.authors, reply.link("bucket"))

    def _published_record(self, reply: Deposition) -> PublishedRecord:
        return PublishedRecord(reply.id, f"{self._address}/records/{reply.id}", reply.doi)

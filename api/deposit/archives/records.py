"""InvenioRDM's records interface, the one that Zenodo itself is made of.

Sequence (docs-invenio-rdm, `reference/rest_api_drafts_records.md`): make a draft; for each file
declare, send, commit; describe; publish. A next version starts without files and imports those of
the one before.
"""

from __future__ import annotations

from collections.abc import Mapping

from api.deposit.archives.contract import (
    Draft,
    NoDraftError,
    PublishedRecord,
    StoredFile,
)
from api.deposit.archives.metadata import Description, invenio
from api.deposit.archives.replies import (
    Entries,
    Entry,
    Record,
    about,
    by_name,
    identifier,
    segment,
    unless_missing,
)
from api.deposit.archives.sealed import SealedFile
from api.deposit.archives.transport import Transport


class RecordsArchive:
    """An archive by its records interface."""

    name = "records"

    def __init__(self, transport: Transport) -> None:
        self._ask = transport.ask
        self._tell = transport.tell
        self._address = transport.server.address

    def create(self, description: Description) -> Draft:
        """Open a draft of a new record; where the answer is lost, an empty one may be left over."""
        return self._draft(self._ask("POST", "/api/records", Record, json=invenio(description)))

    def new_version(self, record: str) -> Draft:
        """Open a draft of the next version; the server gives the one there is, where there is."""
        draft = self._draft(self._ask("POST", f"{_record(record)}/versions", Record))
        if not self.files(draft):
            self._ask(
                "POST",
                f"{_at(draft)}/actions/files-import",
                Entries,
                happened=lambda: self._entries(draft) if self.files(draft) else None,
            )
        return draft

    def draft(self, identifier_: str) -> Draft:
        """Look at a draft; NoDraftError where there is none."""
        where = f"{_record(identifier_)}/draft"
        reply = unless_missing(lambda: self._ask("GET", where, Record))
        # A published record that is being edited has a draft as well: not one for new files.
        if reply is None or reply.is_published:
            raise NoDraftError(f"{self._address} has no unpublished draft {identifier_}")
        return self._draft(about(identifier_, reply, reply.id))

    def published_record(self, identifier_: str) -> PublishedRecord | None:
        """Look at a published record; None where there is none."""
        reply = self._public(identifier_)
        return None if reply is None else reply.published_record(self._address)

    def describe(self, draft: Draft, description: Description) -> None:
        """Give the draft this description; identifiers reserved for it are kept."""
        pids = self._ask("GET", _at(draft), Record).pids or {}
        kept = {name: pid.model_dump(exclude_none=True) for name, pid in pids.items()}
        self._tell("PUT", _at(draft), json={**invenio(description), "pids": kept})

    def files(self, draft: Draft) -> Mapping[str, StoredFile]:
        """List the files of a draft by name; those not committed have no checksum."""
        return by_name([(entry.key, entry.stored_file) for entry in self._entries(draft).entries])

    def send(self, draft: Draft, name: str, file: SealedFile) -> StoredFile:
        """Declare, send and commit a file; one of this name, or half of one, makes way."""
        where = f"{_at(draft)}/files"
        if (there := self.files(draft).get(name)) is not None:
            self.delete(draft, there)

        def declared() -> Entries | None:
            return self._entries(draft) if name in self.files(draft) else None

        def committed() -> Entry | None:
            entry = self._ask("GET", f"{where}/{segment(name)}", Entry)
            return entry if entry.is_complete else None

        self._ask("POST", where, Entries, json=[{"key": name}], happened=declared)
        self._tell("PUT", f"{where}/{segment(name)}/content", content=file.content)
        commit = f"{where}/{segment(name)}/commit"
        return self._ask("POST", commit, Entry, happened=committed).stored_file

    def delete(self, draft: Draft, file: StoredFile) -> None:
        """Take a file out of a draft; that it is gone already is as well."""
        where = f"{_at(draft)}/files/{segment(file.id)}"
        unless_missing(lambda: self._tell("DELETE", where))

    def publish(self, draft: Draft) -> PublishedRecord:
        """Make the draft public, for good."""
        reply = self._ask(
            "POST",
            f"{_at(draft)}/actions/publish",
            Record,
            happened=lambda: self._public(draft.id),
        )
        return about(draft.id, reply, reply.id).published_record(self._address)

    def _public(self, identifier_: str) -> Record | None:
        found = unless_missing(lambda: self._ask("GET", _record(identifier_), Record))
        return None if found is None else about(identifier_, found, found.id)

    def _entries(self, draft: Draft) -> Entries:
        return self._ask("GET", f"{_at(draft)}/files", Entries)

    def _draft(self, reply: Record) -> Draft:
        return Draft(reply.id, f"{self._address}/uploads/{reply.id}", reply.authors)


def _record(identifier_: str) -> str:
    return f"/api/records/{identifier(identifier_)}"


def _at(draft: Draft) -> str:
    return f"/api/records/{draft.id}/draft"

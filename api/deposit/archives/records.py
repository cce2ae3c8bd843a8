"""InvenioRDM's records interface, the one that Zenodo itself is made of.

Sequence (docs-invenio-rdm, `reference/rest_api_drafts_records.md`): make a draft; for each file
declare, send, commit; describe; publish. A next version starts without files and imports those of
the one before.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from api.deposit.archives.contract import (
    Draft,
    NoDraftError,
    Published,
    StoredFile,
)
from api.deposit.archives.metadata import Description, creators_of_invenio, invenio
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


class RecordsArchive:
    """An archive by its records interface."""

    name = "records"

    def __init__(self, transport: Transport) -> None:
        self._ask = transport.ask
        self._address = transport.server.address

    def create(self, description: Description) -> Draft:
        """Open a draft of a new record; where the answer is lost, an empty one may be left over."""
        return self._draft(self._ask("POST", "/api/records", json=invenio(description)))

    def new_version(self, record: str) -> Draft:
        """Open a draft of the next version; the server gives the one there is, where there is."""
        reply = self._ask("POST", f"/api/records/{identifier(record)}/versions")
        draft = self._draft(reply)
        if not self.files(draft):
            self._ask(
                "POST",
                f"{self._at(draft)}/actions/files-import",
                happened=lambda: self.files(draft) or None,
            )
        return draft

    def draft(self, identifier_: str) -> Draft:
        """Look at a draft; NoDraftError where there is none."""
        where = f"/api/records/{identifier(identifier_)}/draft"
        reply = unless_missing(lambda: self._ask("GET", where))
        # A published record that is being edited has a draft as well: not one for new files.
        if reply is None or reply.get("is_published"):
            raise NoDraftError(f"{self._address} has no unpublished draft {identifier_}")
        return self._draft(reply)

    def published(self, identifier_: str) -> Published | None:
        """Look at a published record; None where there is none."""
        where = f"/api/records/{identifier(identifier_)}"
        reply = unless_missing(lambda: self._ask("GET", where))
        return None if reply is None else self._published(reply)

    def describe(self, draft: Draft, description: Description) -> None:
        """Give the draft this description; identifiers reserved for it are kept."""
        kept = self._ask("GET", self._at(draft)).get("pids") or {}
        self._ask("PUT", self._at(draft), json={**invenio(description), "pids": kept})

    def files(self, draft: Draft) -> Mapping[str, StoredFile]:
        """List the files of a draft by name; those not committed have no checksum."""
        listed = entries(member(self._ask("GET", f"{self._at(draft)}/files"), "entries"), "files")
        return {member(entry, "key"): _stored(entry) for entry in listed}

    def send(self, draft: Draft, name: str, path: Path) -> StoredFile:
        """Declare, send and commit a file; one of this name, or half of one, makes way."""
        where = f"{self._at(draft)}/files"
        if (there := self.files(draft).get(name)) is not None:
            self.delete(draft, there)

        def declared() -> Mapping[str, StoredFile] | None:
            return self.files(draft) if name in self.files(draft) else None

        def committed() -> Any:
            entry = self._ask("GET", f"{where}/{segment(name)}")
            return entry if entry.get("status") == "completed" else None

        self._ask("POST", where, json=[{"key": name}], happened=declared)
        self._ask("PUT", f"{where}/{segment(name)}/content", content=content(path))
        return _stored(self._ask("POST", f"{where}/{segment(name)}/commit", happened=committed))

    def delete(self, draft: Draft, file: StoredFile) -> None:
        """Take a file out of a draft; that it is gone already is as well."""
        where = f"{self._at(draft)}/files/{segment(file.id)}"
        unless_missing(lambda: self._ask("DELETE", where))

    def publish(self, draft: Draft) -> Published:
        """Make the draft public, for good."""
        reply = self._ask(
            "POST",
            f"{self._at(draft)}/actions/publish",
            happened=lambda: unless_missing(lambda: self._ask("GET", f"/api/records/{draft.id}")),
        )
        return self._published(reply)

    @staticmethod
    def _at(draft: Draft) -> str:
        return f"/api/records/{draft.id}/draft"

    def _draft(self, reply: Any) -> Draft:
        found = identifier(member(reply, "id"))
        authors = creators_of_invenio(reply.get("metadata"))
        return Draft(found, f"{self._address}/uploads/{found}", authors)

    def _published(self, reply: Any) -> Published:
        found = identifier(member(reply, "id"))
        doi = ((reply.get("pids") or {}).get("doi") or {}).get("identifier")
        return Published(found, f"{self._address}/records/{found}", doi)


def _stored(entry: Any) -> StoredFile:
    whole = entry.get("status") == "completed"
    return StoredFile(member(entry, "key"), md5(entry.get("checksum")) if whole else None)

"""What every archive does: open a draft, take files and a description, publish.

Two interfaces of Zenodo keep this contract (`records`, `depositions`); whoever uploads knows
neither.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from api.deposit.archives.contract import Draft, PublishedRecord, StoredFile
from api.deposit.archives.metadata import Description
from api.deposit.archives.sealed import SealedFile


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

    def published_record(self, identifier: str) -> PublishedRecord | None:
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

    def publish(self, draft: Draft) -> PublishedRecord:
        """Make the draft public, for good."""
        ...

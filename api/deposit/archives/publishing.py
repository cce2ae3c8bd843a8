"""The one step that cannot be taken back, and what is looked at before it is taken."""

from __future__ import annotations

from pathlib import Path

from api.deposit.archives.archive import Archive
from api.deposit.archives.contract import (
    ArchiveError,
    NoDraftError,
    PublishedRecord,
    file_differences,
)
from api.deposit.archives.sealed import SealedBundle, seal
from api.metadata.citation import author_problems


class NotReadyError(ArchiveError):
    """The draft may not become public; the message says why."""


def publish(archive: Archive, identifier: str, directory: Path) -> PublishedRecord:
    """Make a draft public whose authors are people and whose files are the bundle's.

    Authors are looked at in the bundle and in the draft, whose own become public.

    Parameters
    ----------
    archive : that holds the draft
    identifier : of the draft
    directory : the bundle, its zip beside it

    Raises
    ------
    UnfilledError
        Where the bundle's CITATION.cff lacks a field.
    NotReadyError
        Where the draft's authors are no people, or files are missing, foreign or other bytes.
    BundleError
        Where the bundle does not hold.
    ArchiveError
        Where the archive does not do as asked.
    """
    with seal(directory) as bundle:
        return _published(archive, identifier, directory, bundle)


def _published(
    archive: Archive, identifier: str, directory: Path, bundle: SealedBundle
) -> PublishedRecord:
    bundle.description.require_filled("nothing was published")
    try:
        draft = archive.draft(identifier)
    except NoDraftError:
        if (public := archive.published_record(identifier)) is not None:
            raise NotReadyError(f"{public.page} is published already") from None
        raise
    found = author_problems(draft.authors)
    if found:
        raise NotReadyError(
            f"the authors of draft {identifier} cannot be published: {'; '.join(found)}. Upload "
            "again; nothing was published"
        )
    sent = {name: file.md5 for name, file in bundle.files.items()}
    differing = file_differences(archive.files(draft), sent)
    if differing:
        raise NotReadyError(
            f"draft {identifier} is not the bundle in {directory}: {'; '.join(differing)}. Upload "
            "again, or take foreign files out; nothing was published"
        )
    return archive.publish(draft)

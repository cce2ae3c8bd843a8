"""Croissant metadata, link sets, the software's description, and the versions of what is known."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from api.metadata import served, signposting
from api.metadata.codemeta import codemeta
from api.metadata.croissant import croissant
from api.metadata.identity import identity
from api.schema.scores import WholeLeaderboardQuery
from api.service.datasets import dataset
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.service.leaderboard import leaderboard
from benchmark.results import samples


def dataset_croissant(known: Knowledge, name: str, base: str) -> Document:
    """Return a data set's files with SHA-256 and columns; `base` is the service's address."""
    file, table = served.table_of_data(dataset(known, name).table().encode(), name, base)
    files, tables = [file], [table]
    published = _samples(known, name)
    if published:
        found = served.files_of_samples(name, {k: make() for k, make in published.items()}, base)
        files = [*found, file]
        tables = [*served.tables_of_samples(*(one["name"] for one in found)), table]
    described = served.of_dataset(known.measurements.card(name), base)
    document = croissant(described, identity(), files, tables)
    landing = landing_of_dataset(known, name)
    return Document(document, links=signposting.headers(landing.links_of_metadata()))


def leaderboard_croissant(known: Knowledge, base: str) -> Document:
    """Return the table of the leaderboard with SHA-256 and columns."""
    who = identity()
    file, table = served.table_of_ranks(_ranks(known), base)
    document = croissant(served.of_record(who, base), who, [file], [table])
    landing = signposting.landing_of_record(who)
    return Document(document, links=signposting.headers(landing.links_of_metadata()))


@lru_cache(4)
def _ranks(known: Knowledge) -> bytes:
    """Return the CSV of the whole leaderboard, which takes most of a second to write."""
    ranked = leaderboard(known, WholeLeaderboardQuery.model_validate({"whole": True}))
    return ranked.table().encode()


def software() -> Document:
    """Return the description of the software (CodeMeta 3.0)."""
    landing = signposting.landing_of_atlas(identity())
    links = signposting.headers(landing.links_of_metadata())
    return Document(codemeta(identity().citation), links=links)


def landing_of_dataset(known: Knowledge, name: str) -> signposting.LandingPage:
    """Return the page of a data set, with the files that are published of it."""
    return signposting.landing_of_dataset(name, identity(), sampled=bool(_samples(known, name)))


def _samples(known: Knowledge, name: str) -> dict[str, Callable[[], bytes]]:
    """Return what reads the errors and directions of a data set; nothing where none are there."""
    if not samples.has_samples(name, known.measurements.directory):
        return {}
    return {
        "errors": lambda: known.measurements.file(samples.path_of(name)),
        "directions": lambda: known.measurements.file(samples.path_of(name, directions=True)),
    }


def health(known: Knowledge, version: str) -> dict[str, Any]:
    """Return the status of a service of a version, with versions of facts and record."""
    return {
        "status": "ok",
        "version": version,
        "studies": len(known.facts.studies),
        "datasets": len(known.measurements.presets),
        "scores": len(known.measurements.scores),
        "facts_sha256": known.facts_digest,
        "record_sha256": known.measurements.digest,
    }

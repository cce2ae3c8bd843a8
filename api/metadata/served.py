"""What the service has of each data set and of the leaderboard, as Croissant describes it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from api.metadata.croissant import (
    PARQUET,
    Column,
    DatasetDescription,
    Entity,
    file_object,
    record_set,
)
from api.metadata.errors import DIRECTIONS, ERRORS
from api.metadata.identity import Identity
from api.schema.datasets import Data
from api.schema.scores import LeaderboardRow
from api.schema.table import Model, described_columns
from benchmark.results import samples

CSV = ("text/csv",)
SUBJECTS = ("sun sensor", "calibration", "simulation", "benchmark")
#: What is measured on a data set, by the names of columns.
MEASURED: Mapping[str, str] = {
    field["name"]: field["description"]
    for field in (*ERRORS, *DIRECTIONS)
    if field["type"] == "number"
}


def of_dataset(card: Mapping[str, Any], base: str | None) -> DatasetDescription:
    """Return what a data set is.

    Parameters
    ----------
    card : of the data set
    base : address of the service, ending in a slash; None where there is none, as in a bundle
    """
    name = card["name"]
    return DatasetDescription(
        f"Sun Sensor Atlas: {name}",
        f"{card['description']} Simulated {card['observation']} of a {card['detector']} detector "
        f"behind a {card['mask']} mask, with the true directions of the Sun and errors of "
        "every pipeline.",
        f"{base}datasets/{name}" if base else None,
        f"{card['version']}.0.0",
        (*SUBJECTS, card["detector"], card["mask"], card["observation"]),
    )


def of_record(who: Identity, base: str | None) -> DatasetDescription:
    """Return what the leaderboard is; parameters as of `of_dataset`."""
    return DatasetDescription(
        f"{who.title}: leaderboard",
        "Errors of every pipeline of extractor, compensations and calibration model on simulated "
        "sun sensors, ranked within each data set and condition beside the Cramer-Rao bound.",
        f"{base}leaderboard" if base else None,
        who.version,
        (*SUBJECTS, "leaderboard", "Cramer-Rao bound"),
    )


def tables_of_samples(errors: str, directions: str) -> list[Entity]:
    """Return the tables of a data set's errors and directions, by the names of their files."""
    return [
        record_set(
            "errors",
            errors,
            "Error of a pipeline on a sample of the test split, under the nominal condition.",
            _columns(ERRORS),
            ("extractor", "model", "unit", "sample"),
        ),
        record_set(
            "directions",
            directions,
            "A sample of the test split: the true direction and the bound.",
            _columns(DIRECTIONS),
            ("sample",),
        ),
    ]


def files_of_samples(name: str, contents: Mapping[str, bytes], base: str) -> list[Entity]:
    """Return the files of a data set's errors and directions, as served.

    Parameters
    ----------
    name : of the data set
    contents : bytes by `errors` and `directions`
    base : address of the service, ending in a slash
    """
    said = {
        "errors": f"Errors sample by sample, condition {samples.CONDITION}.",
        "directions": "Directions of the test samples, and their bounds.",
    }
    return [
        file_object(
            f"{name}.{kind}.parquet",
            f"{base}v1/datasets/{name}/{kind}.parquet",
            PARQUET,
            said[kind],
            content,
        )
        for kind, content in contents.items()
    ]


def table_of_data(content: bytes, name: str, base: str) -> tuple[Entity, Entity]:
    """Return the CSV of a data set's hashes and bounds, as served; parameters as above."""
    file = file_object(
        f"{name}.csv",
        f"{base}v1/datasets/{name}?format=csv",
        CSV,
        "Hash of each split in each condition, and its Cramer-Rao bound.",
        content,
    )
    said = "A split of the data set in a condition."
    return file, record_set("splits", file["name"], said, _columns_of(Data), ("condition", "split"))


def table_of_ranks(content: bytes, base: str) -> tuple[Entity, Entity]:
    """Return the CSV of the leaderboard, as served.

    Parameters
    ----------
    content : its bytes
    base : address of the service, ending in a slash
    """
    file = file_object(
        "leaderboard.csv",
        f"{base}v1/leaderboard?format=csv&whole=true",
        CSV,
        "Every pipeline on every data set and condition, ranked.",
        content,
    )
    key = ("dataset", "condition", "extractor", "model")
    return file, record_set(
        "ranks",
        file["name"],
        "A pipeline on a data set in a condition.",
        _columns_of(LeaderboardRow),
        key,
    )


def _columns(fields: Sequence[Mapping[str, Any]]) -> list[Column]:
    return [(one["name"], one["type"], one["description"]) for one in fields]


def _columns_of(model: Model) -> list[Column]:
    return [(one.name, one.type, one.description) for one in described_columns(model).values()]

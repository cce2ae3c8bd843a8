"""The measured tables of the bundle: algorithms, data sets, scores and leaderboard, as CSV."""

from __future__ import annotations

import dataclasses
import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from api.cells import cell
from api.deposit import derived_tables
from api.metadata.fields import schema
from api.schema.algorithms import Algorithm
from api.schema.curves import Curve
from api.schema.deposited import (
    ClaimTrial,
    ClaimVerdict,
    ClauseVerdict,
    DepositedDataset,
    DepositedEdition,
    DepositedPoint,
    DepositedRule,
    DepositedSweep,
    IdentifiedStudy,
    Pin,
    PublicationCount,
    Resolution,
    SampleFile,
)
from api.schema.scores import LeaderboardRow, Score
from api.schema.table import Model
from benchmark.claims.ledger import ledger
from benchmark.leaderboard.board import build
from benchmark.learning_curves import record as curves
from benchmark.results.store import PUBLISHED_STUDIES, Store
from benchmark.sweeps import record as sweeps
from files.csv_writing import csv_text
from registry.catalogue import catalogue
from registry.taxonomy import taxonomy_rows

#: Columns of sweeps that stand in the bundle under another name or value.
_RENAMED = frozenset({"series", "sweep", "point", "unit"})
_PIPELINE = ("dataset", "condition", "extractor", "model")
_KEY = (*_PIPELINE, "unit")
_RANKED = (
    *("rank", "group", "tied", *_PIPELINE),
    *("own_error_deg", "own_se", "on_bench_deg", "on_bench_basis"),
    *("twin_of", "folded", "rms_deg", "low_deg", "high_deg", "unit_rms_deg"),
)


class NothingPublishedError(FileNotFoundError):
    """There are no published results to deposit."""


class DescriptorError(ValueError):
    """A file is no descriptor of a data package; the message names it."""


@dataclass(frozen=True)
class MeasuredTable:
    """A table with its description.

    Attributes
    ----------
    name : of the resource; the file is benchmark/<name>.csv
    title, description : for people
    text : the CSV, UTF-8, lines ended by a line feed
    schema : Table Schema v2
    """

    name: str
    title: str
    description: str
    text: str
    schema: Mapping[str, Any]


def measured_tables(published: Path) -> list[MeasuredTable]:
    """Make the measured tables from a directory of published results.

    Raises
    ------
    NothingPublishedError
        Where it holds no scores.
    ValueError
        Where a file cannot be read, or has a column nothing is known of.
    """
    store, beside = Store(published), Store(published.with_name(PUBLISHED_STUDIES.name))
    compared = store.rows(unit=None)
    if not compared:
        raise NothingPublishedError(
            f"{store.scores_directory} is missing or empty; run `sunatlas leaderboard update`"
        )
    scores = sorted(
        (*compared, *beside.rows(unit=None)), key=lambda row: [row[name] for name in _KEY]
    )
    pins = {**store.pins(), **beside.pins()}
    ranked = [
        {name: row[name] for name in _RANKED}
        for dataset in build(compared)["datasets"]
        for row in dataset["rows"]
    ]
    entries = ledger(published)
    return [
        _table("algorithms", Algorithm, [one.to_dict() for one in catalogue().implementations()]),
        _table("datasets", DepositedDataset, derived_tables.datasets()),
        _table("scores", Score, scores),
        _table("leaderboard", LeaderboardRow, ranked),
        _table("data", Pin, [dataclasses.asdict(pin) for _, pin in sorted(pins.items())]),
        *_of_experiments(published),
        _table("resolution", Resolution, derived_tables.resolution(scores)),
        _table("all_studies", IdentifiedStudy, derived_tables.all_studies()),
        _table("editions", DepositedEdition, derived_tables.edition_rows()),
        _table("verdicts", ClauseVerdict, derived_tables.verdicts()),
        _table("publications", PublicationCount, derived_tables.publication_counts()),
        _table("claim_verdicts", ClaimVerdict, derived_tables.claim_verdicts(entries)),
        _table("claim_rules", DepositedRule, derived_tables.claim_rules(entries)),
        _table("claim_trials", ClaimTrial, derived_tables.claim_trials(entries)),
    ]


def frames_table(rows: Sequence[Mapping[str, Any]]) -> MeasuredTable:
    """Make the table of the samples that go along, a row a file of arrays."""
    return _table("frames", SampleFile, rows)


def _of_experiments(published: Path) -> Iterator[MeasuredTable]:
    """Make the tables of sweeps and learning curves, where there are any."""
    if swept := sweeps.swept(published):
        # An empty cell is a missing value, which a key may not be: a refused series says so.
        rows = [
            {
                **{name: row[name] or "none" for name in ("series", "sweep", "point")},
                **{name: value for name, value in row.items() if name not in _RENAMED},
                "measured_in": row["unit"],
            }
            for row in swept
        ]
        yield _table("sweeps", DepositedSweep, rows)
    if rows := curves.published_curves(published):
        whole = [{name: row[name] for name in row if name != "points"} for row in rows]
        yield _table("curves", Curve, whole)
        points = [
            {**{name: row[name] for name in _PIPELINE}, **point}
            for row in rows
            for point in row["points"]
        ]
        yield _table("curve_points", DepositedPoint, points)


@cache
def _described() -> Mapping[str, Mapping[str, Any]]:
    return tomllib.loads(Path(__file__).with_name("tables.toml").read_text("utf-8"))


def _table(name: str, model: Model, rows: Sequence[Mapping[str, Any]]) -> MeasuredTable:
    """Make a table that tables.toml describes, of rows of a model."""
    said = _described()[name]
    columns = list(dict.fromkeys(column for row in rows for column in row))
    cells = ([cell(taxonomy_rows(name, row.get(name))) for name in columns] for row in rows)
    text = csv_text(columns, cells)
    described = schema(model, columns, primary=said["primary"], foreign=said.get("foreign"))
    return MeasuredTable(name, said["title"], said["description"], text, described)


def read_descriptor(path: Path) -> dict[str, Any]:
    """Read a datapackage.json; DescriptorError naming the file where it is none."""
    try:
        found = json.loads(path.read_text("utf-8"))
    except ValueError as error:
        raise DescriptorError(f"{path}: not JSON ({error})") from error
    if isinstance(found, dict) and isinstance(found.get("resources"), list):
        return found
    raise DescriptorError(f"{path}: expected an object with a list of resources")

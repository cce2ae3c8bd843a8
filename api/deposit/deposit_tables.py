"""The measured tables of the bundle: algorithms, data sets, scores and leaderboard, as CSV."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
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
from benchmark.claims.ledger import Entry, ledger
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
_DATASET = {"dataset": ("datasets", "name")}
_PARTS = {**_DATASET, "extractor": ("algorithms", "name"), "model": ("algorithms", "name")}
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

    NothingPublishedError where it holds no scores. ValueError where a file cannot be read, or has a
    column nothing is known of.
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
    return [
        _table(
            "algorithms",
            Algorithm,
            "Algorithms",
            "Every implementation of an extractor or a model.",
            [implementation.to_dict() for implementation in catalogue().implementations()],
            primary=("name",),
        ),
        _table(
            "datasets",
            DepositedDataset,
            "Data sets",
            "The simulated sensors that pipelines are scored on: the standard ones, and sensors of "
            "single studies, on which no others are scored.",
            derived_tables.datasets(),
            primary=("name",),
        ),
        _table(
            "scores",
            Score,
            "Scores",
            "One row a pipeline on a data set in a condition and a unit of the sensor; a pure "
            "function of code and data.",
            scores,
            primary=_KEY,
            foreign=_PARTS,
        ),
        _table(
            "leaderboard",
            LeaderboardRow,
            "Leaderboard",
            "Pipelines ranked in each data set and condition; numbers of every row stand in "
            "scores.",
            [
                {name: row[name] for name in _RANKED}
                for dataset in build(compared)["datasets"]
                for row in dataset["rows"]
            ],
            primary=_PIPELINE,
            foreign=_PARTS,
        ),
        _table(
            "data",
            Pin,
            "Generated data",
            "Hash of every generated split of every data set, and its Cramer-Rao bound.",
            [dataclasses.asdict(pin) for _, pin in sorted(pins.items())],
            primary=("dataset", "condition", "split"),
            foreign=_DATASET,
        ),
        *_of_experiments(published),
        *_of_facts(scores),
        *_of_claims(ledger(published)),
    ]


def frames_table(rows: Sequence[Mapping[str, Any]]) -> MeasuredTable:
    """Make the table of the samples that go along, a row a file of arrays."""
    return _table(
        "frames",
        SampleFile,
        "Samples in this bundle",
        "Which samples of the standard data sets lie in frames/: every split of the nominal "
        "condition, whole. The code makes those of other conditions and units.",
        rows,
        primary=("dataset", "condition", "split"),
        foreign=_DATASET,
    )


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
        yield _table(
            "sweeps",
            DepositedSweep,
            "Sweeps",
            "Error of every extractor on features in closed form, with the Cramer-Rao bound.",
            rows,
            primary=("series", "sweep", "point", "extractor"),
            foreign={"extractor": ("algorithms", "name")},
        )
    if rows := curves.published_curves(published):
        yield _table(
            "curves",
            Curve,
            "Learning curves",
            "How many calibration poses the leaders of each data set need to be within 10 % of "
            "their floor.",
            [{name: row[name] for name in row if name != "points"} for row in rows],
            primary=_PIPELINE,
            foreign=_PARTS,
        )
        yield _table(
            "curve_points",
            DepositedPoint,
            "Points of the learning curves",
            "Errors after so many calibration poses, over draws of poses and units of the sensor.",
            [
                {**{name: row[name] for name in _PIPELINE}, **point}
                for row in rows
                for point in row["points"]
            ],
            primary=(*_PIPELINE, "poses"),
            foreign=_PARTS,
        )


def _of_facts(scores: Sequence[Mapping[str, Any]]) -> list[MeasuredTable]:
    """Make the tables that follow from facts and plan, with the numbers of none."""
    return [
        _table(
            "resolution",
            Resolution,
            "Resolution of the studies",
            "Runs of each study, with grade: a row per pipeline, data set and condition. Basis of "
            "each part, and the rule that fills it where the study does not state it.",
            derived_tables.resolution(scores),
            primary=("study", "detector", "mask", *_PIPELINE),
            foreign={**_PARTS, "study": ("all_studies", "study")},
        ),
        _table(
            "all_studies",
            IdentifiedStudy,
            "Studies of both editions",
            "The survey's studies and those it does not map, distinguished by their edition.",
            derived_tables.all_studies(),
            primary=("study",),
            foreign={"edition": ("editions", "edition")},
        ),
        _table(
            "editions",
            DepositedEdition,
            "Editions of the studies",
            "The survey's studies, and those it does not map: each with the version to cite.",
            derived_tables.edition_rows(),
            primary=("edition",),
        ),
        _table(
            "verdicts",
            ClauseVerdict,
            "Verdicts of the findings",
            "Each clause of the survey's checkable statements, judged strictly by the tables, with "
            "the counts and the evidence that would turn it, and the verdict of the whole.",
            derived_tables.verdicts(),
            primary=("finding", "clause"),
            foreign={"finding": ("findings", "id")},
        ),
        _table(
            "publications",
            PublicationCount,
            "Publications per year and per venue",
            "Mapped studies of each year, and of each venue that is known.",
            derived_tables.publication_counts(),
            primary=("per", "year_or_venue"),
        ),
    ]


def _of_claims(entries: Sequence[Entry]) -> list[MeasuredTable]:
    """Make the tables of the survey's claims, as they came out."""
    claimed = {"claim": ("claims", "id")}
    return [
        _table(
            "claim_verdicts",
            ClaimVerdict,
            "Verdicts of the claims",
            "Each of the survey's statements about algorithms, put to the test.",
            derived_tables.claim_verdicts(entries),
            primary=("claim",),
            foreign=claimed,
        ),
        _table(
            "claim_rules",
            DepositedRule,
            "Rules of the claims",
            "Criteria of each claim, with the result of the trials.",
            derived_tables.claim_rules(entries),
            primary=("claim", "rule"),
            foreign=claimed,
        ),
        _table(
            "claim_trials",
            ClaimTrial,
            "Trials of the claims",
            "The statistic of every rule in every trial.",
            derived_tables.claim_trials(entries),
            primary=("claim", "rule", "trial"),
            foreign=claimed,
        ),
    ]


def _table(
    name: str,
    model: Model,
    title: str,
    description: str,
    rows: Sequence[Mapping[str, Any]],
    *,
    primary: Sequence[str],
    foreign: Mapping[str, tuple[str, str]] | None = None,
) -> MeasuredTable:
    columns = list(dict.fromkeys(column for row in rows for column in row))
    cells = ([cell(taxonomy_rows(name, row.get(name))) for name in columns] for row in rows)
    text = csv_text(columns, cells)
    described = schema(model, columns, primary=primary, foreign=foreign)
    return MeasuredTable(name, title, description, text, described)


def read_descriptor(path: Path) -> dict[str, Any]:
    """Read a datapackage.json; DescriptorError naming the file where it is none."""
    try:
        found = json.loads(path.read_text("utf-8"))
    except ValueError as error:
        raise DescriptorError(f"{path}: not JSON ({error})") from error
    if isinstance(found, dict) and isinstance(found.get("resources"), list):
        return found
    raise DescriptorError(f"{path}: expected an object with a list of resources")

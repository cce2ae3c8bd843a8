"""Headlines of mapped studies beside the same methods here: ``headlines.csv`` and the scores.

Accuracy stands beside accuracy, precision beside precision. Typed in the table are the published
number with what it is, the data set and pipeline that stand for the study's sensor, and the
sentence on how sensor and noise differ; our number is read in the scores.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from files.strict_csv import read_records

FILE = Path(__file__).parent / "headlines.csv"
COLUMNS = (
    *("study", "dataset", "extractor", "model"),
    *("published_deg", "kind", "statistic", "difference"),
)

Row = Mapping[str, Any]


class HeadlineError(ValueError):
    """The table is broken; the message names the line."""


@dataclass(frozen=True)
class Headline:
    """A number that a study is known for, and what stands for it here.

    Attributes
    ----------
    study
        Key of the mapped study, or the name of a work that is not mapped.
    dataset, extractor, model
        What stands for it; empty where nothing here does.
    published_deg
        The published number, degrees; None where there is none.
    kind
        ``accuracy`` or ``precision``.
    statistic
        What the number is: a key of `STATISTICS` of its kind.
    difference
        How sensor, noise and bench differ.
    """

    study: str
    dataset: str
    extractor: str
    model: str
    published_deg: float | None
    kind: str
    statistic: str
    difference: str


def _column(name: str) -> Callable[[Row], float | None]:
    return lambda row: row[name]


def _one_axis(row: Row) -> float | None:
    spread = row["repeatability_deg"]
    return None if spread is None else float(spread / math.sqrt(2.0))


#: What of a score is comparable with a published number, by kind and statistic. Precision is of one
#: axis, as studies state it; 99.7 % of the errors lie within what stands beside three sigma.
STATISTICS: Mapping[tuple[str, str], tuple[str, Callable[[Row], float | None]]] = MappingProxyType(
    {
        ("precision", "1 sigma"): ("one axis, 1 sigma", _one_axis),
        ("accuracy", "3 sigma"): ("99.7 % within", _column("p997_deg")),
        ("accuracy", "rms"): ("rms", _column("rms_deg")),
        ("accuracy", "mean"): ("median", _column("median_deg")),
        ("accuracy", "unspecified"): ("rms", _column("rms_deg")),
    }
)


@cache
def read_headlines(path: Path = FILE) -> tuple[Headline, ...]:
    """Return the headlines in the order of the table.

    Raises
    ------
    HeadlineError
        For a broken line, a number that is none, and a kind or statistic that is unknown.
    """
    records = read_records(path, list(COLUMNS))
    if records.problems:
        raise HeadlineError("; ".join(map(str, records.problems)))
    return tuple(_headline(path, line, cells) for line, cells in records.rows)


def _headline(path: Path, line: int, cells: list[str]) -> Headline:
    study, dataset, extractor, model, published, kind, statistic, difference = cells
    if (kind, statistic) not in STATISTICS:
        known = ", ".join(" ".join(pair) for pair in STATISTICS)
        raise HeadlineError(f"{path.name}, line {line}: {kind} {statistic} is none of {known}")
    try:
        number = float(published) if published else None
    except ValueError:
        number = math.nan
    if number is not None and not (math.isfinite(number) and number > 0):
        raise HeadlineError(f"{path.name}, line {line}: {published} is no number of degrees")
    if not difference:
        raise HeadlineError(f"{path.name}, line {line}: nothing says how sensor and noise differ")
    return Headline(study, dataset, extractor, model, number, kind, statistic, difference)


def headlines(
    rows: Iterable[Row], nominal: Mapping[str, str], known: Iterable[Headline] | None = None
) -> list[dict[str, Any]]:
    """Set each headline beside the score of what stands for it.

    Parameters
    ----------
    rows
        Score rows as `Store.rows` gives them.
    nominal
        The condition compared, by data set.
    known
        The headlines; those of the published table by default.

    Returns
    -------
    list of dict
        In the order of the table, with its columns and ``our_deg`` (None where nothing is
        measured), ``our_statistic``, ``ratio`` (ours over the published one), ``bound_deg`` and
        ``availability``. Our accuracy is the own error: that of a perfect bench.
    """
    scores = {
        (row["dataset"], row["extractor"], row["model"]): row
        for row in rows
        if row["unit"] == 0 and row["condition"] == nominal.get(row["dataset"])
    }
    return [
        _beside(one, scores.get((one.dataset, one.extractor, one.model)))
        for one in (read_headlines() if known is None else known)
    ]


def _beside(one: Headline, score: Row | None) -> dict[str, Any]:
    named, read = STATISTICS[one.kind, one.statistic]
    ours = None if score is None else read(score)
    return {
        **{name: getattr(one, name) for name in COLUMNS},
        "our_deg": ours,
        "our_statistic": named,
        "ratio": None if ours is None or one.published_deg is None else ours / one.published_deg,
        "bound_deg": None if score is None else score["bound_deg"],
        "availability": None if score is None else score["availability"],
    }

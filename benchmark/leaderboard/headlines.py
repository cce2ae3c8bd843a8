"""Accuracies and precisions that studies publish, beside the same statistic of their methods here.

The published number and its kind are facts of the survey; ours is that of what runs for the study,
under the condition that it is run for. ``headlines.csv`` says of some how sensor and noise differ.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

from registry.fidelity.runnable import RunnablePipeline
from registry.resolution import Resolution
from registry.studies import Study
from survey_data.reported import QUANTITIES, Quantity, ReportedAccuracy

FILE = Path(__file__).parent / "headlines.csv"

Row = Mapping[str, Any]
#: Data set, condition, extractor and model.
Place = tuple[str, str, str, str]


#: The statistic of our errors that is compared with a published accuracy, by the kind of that
#: accuracy; the RMS for any other kind.
_STATISTICS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "3sigma": ("99.7 % within", "p997_deg"),
        "p95": ("95 % within", "p95_deg"),
        "max": ("largest", "max_deg"),
        "mean": ("median", "median_deg"),
    }
)


@dataclass(frozen=True)
class Headline:
    """A number that a study publishes, beside ours.

    `place` is the score that stands beside it; None where nothing that runs for the study has one.
    `our_deg` is the same statistic of the own error on the standard unit, of a precision on one
    axis. `difference` says how sensor and noise differ; empty where nothing is said.
    """

    study: str
    published: ReportedAccuracy
    place: Place | None
    our_deg: float | None
    our_statistic: str
    availability: float | None
    difference: str

    @property
    def ratio(self) -> float | None:
        """Ours over the published one; None where nothing is measured."""
        if self.our_deg is None:
            return None
        if self.published.quantity == "precision":
            return self.our_deg / self.published.rms_deg
        return self.our_deg / self.published.value_deg

    @property
    def distance(self) -> float:
        """How far the two are apart, as the logarithm of a factor."""
        return math.inf if not self.ratio else abs(math.log(self.ratio))


@cache
def read_differences() -> Mapping[tuple[str, str], str]:
    """Return what is said of differences, by study and quantity."""
    with FILE.open(encoding="utf-8", newline="") as file:
        rows = csv.DictReader(file)
        return {(row["study"], row["quantity"]): row["difference"] for row in rows}


def headlines(
    scores: Mapping[Place, Row],
    studies: Iterable[Study],
    resolutions: Mapping[str, Resolution],
    differences: Mapping[tuple[str, str], str] | None = None,
) -> list[Headline]:
    """Set every published number beside ours, the farthest apart first.

    A study is compared by its most accurate pipeline among those with the best evidence.
    `scores` are rows of the standard unit by data set, condition, extractor and model;
    `resolutions` say what runs for each study, by key.
    """
    said = read_differences() if differences is None else differences
    found = [
        _beside(study, published, scores, resolutions[study.key].strongest_pipelines, said)
        for study in studies
        for quantity in QUANTITIES
        if (published := study.report(quantity)) is not None
    ]
    return sorted(found, key=lambda one: (-one.distance, one.study, one.published.quantity))


def _beside(
    study: Study,
    published: ReportedAccuracy,
    scores: Mapping[Place, Row],
    pipelines: Iterable[RunnablePipeline],
    said: Mapping[tuple[str, str], str],
) -> Headline:
    named, column, divisor = _statistic(published.quantity, published.statistic.kind)
    measured = [
        (row[column] / divisor, place, row["availability"])
        for place in map(_first_setting, pipelines)
        if (row := scores.get(place)) is not None and row[column] is not None
    ]
    ours, at, answered = min(measured, default=(None, None, None))
    difference = said.get((study.key, published.quantity), "")
    return Headline(study.key, published, at, ours, named, answered, difference)


def _statistic(quantity: Quantity, kind: str) -> tuple[str, str, float]:
    """Return what stands beside a number: its name, its column, and what that is divided by."""
    if quantity == "precision":
        return "one axis, 1 sigma", "repeatability_deg", math.sqrt(2.0)
    return *_STATISTICS.get(kind, ("rms", "rms_deg")), 1.0


def _first_setting(pipeline: RunnablePipeline) -> Place:
    at = pipeline.settings[0]
    return at.dataset, at.condition, pipeline.extractor, pipeline.model

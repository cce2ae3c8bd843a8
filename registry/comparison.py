"""Sentences where a calibration of the literature errs more than another on the same data."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from registry.answer import Answer, RankedArchitecture
from registry.taxonomy import NO_IMPLEMENTATION_STATED

LEAST_RATIO = 1.1
"""Smaller ratios of errors do not count as a contradiction."""

MOST = 2
"""Contradictions shown with an answer."""


@dataclass(frozen=True)
class Contradiction:
    """Two calibrations of an architecture on one data set, under one condition, over one field.

    ``first`` is the one that most studies used, or that the survey advises; ``other`` has the
    smallest own error there. Both are named as pipelines.
    """

    detector: str
    mask: str
    kind: Literal["studies", "advice"]
    dataset: str
    condition: str
    first: str
    first_own_error_deg: float
    other: str
    other_own_error_deg: float
    studies: int

    @property
    def ratio(self) -> float | None:
        """Error of the first over that of the other; None over zero."""
        other = self.other_own_error_deg
        return self.first_own_error_deg / other if other else None

    @property
    def sentence(self) -> str:
        """The comparison in words."""
        who = f"{self.studies} {'studies' if self.studies > 1 else 'study'} used"
        said = who if self.kind == "studies" else "The survey advises"
        times = "" if self.ratio is None else f", {self.ratio:.3g} times smaller"
        first, other = self.first_own_error_deg, self.other_own_error_deg
        return (
            f"{self.detector} + {self.mask}: {said} {self.first}, own error {first:.3g} deg; "
            f"{self.other} reaches {other:.3g} deg on the same data "
            f"({self.dataset}, {self.condition}){times}."
        )


def contradictions(answer: Answer) -> list[Contradiction]:
    """Return the first few contradictions of an answer, in the order of its architectures.

    By own errors: what methods make of the same readings.
    """
    found: list[Contradiction] = []
    for one in answer.architectures:
        if "measured" in one.meets:
            found += _of(answer, one)
        if len(found) >= MOST:
            break
    return found[:MOST]


def _of(answer: Answer, one: RankedArchitecture) -> Iterator[Contradiction]:
    question, table = answer.on_the_ground, answer.on_the_ground.table
    here = [place.architecture == one.place.architecture for place in table.places]
    rows = np.flatnonzero(question.measured & np.array(here)[table.row_place]).tolist()
    designs = {row: table.designs[int(table.row_design[row])] for row in rows}
    used = [row for row in rows if designs[row].users]
    advised = [row for row in rows if designs[row].advice]
    own = question.errors.own_error_deg
    for kind, among, key in (
        ("studies", used, lambda row: (-len(designs[row].users), own[row])),
        ("advice", advised, lambda row: (own[row],)),
    ):
        if not among:
            continue
        first = min(among, key=key)
        pipeline = table.rows[first]
        beside = [row for row in rows if table.rows[row].dataset == pipeline.dataset]
        best = min(beside, key=own.__getitem__)
        asked = question.requirements
        judged, least = (
            table.rows[row].judge(asked.hazards, asked.half_field_deg) for row in (first, best)
        )
        if judged.condition != least.condition or judged.field_deg != least.field_deg:
            continue
        if math.isinf(judged.error_deg) or judged.error_deg < LEAST_RATIO * least.error_deg:
            continue
        yield Contradiction(
            *one.place.architecture,
            kind,  # type: ignore[arg-type]  # one of the two above
            pipeline.dataset,
            judged.condition,
            pipeline_name(pipeline.extractor, pipeline.model),
            judged.error_deg,
            pipeline_name(table.rows[best].extractor, table.rows[best].model),
            least.error_deg,
            len(designs[first].users),
        )


def pipeline_name(extractor: str, model: str) -> str:
    """Return the name of a pipeline, such as ``bctm + optical + lut``."""
    return f"{extractor} + {model}"


def labels(extractor: str, stages: tuple[str, ...]) -> str:
    """Return the survey's labels of a calibration, such as ``BCTM + LSQ``; empty if it has none."""
    return " + ".join(one for one in (extractor, *stages) if one != NO_IMPLEMENTATION_STATED)


def calibration_name(
    extractor: str, stages: tuple[str, ...], measured: tuple[str, str] | None
) -> str:
    """Return the one name of a calibration: the measured pipeline, else the survey's labels."""
    if measured is not None:
        return pipeline_name(*measured)
    return f"{labels(extractor, stages) or 'no method stated'} (survey labels)"

"""Which sensor to build, and how to calibrate it: an answer in two levels.

Architectures (a detector behind a mask) that meet the requirements, and on each its calibrations:
an extractor, compensations, a model. Three kinds of evidence stay apart: what the survey's text
advises, what studies proposed, and what is measured here. Where they disagree, the answer says so.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from registry import studies as registered
from registry.designs import design_table
from registry.judging import Question
from registry.measured_pipelines import MeasuredPipeline, Measurements
from registry.ranking import SORTS, Sort
from registry.relaxation import BlockingConstraint, Relaxation
from registry.requirements import Requirements
from registry.studies import Facts
from registry.taxonomy import InvalidValueError, unknown_name

if TYPE_CHECKING:
    from registry.answer import Answer

__all__ = [
    "Architecture",
    "BlockingConstraint",
    "Calibration",
    "MeasuredPipeline",
    "Measurements",
    "Recommendation",
    "Relaxation",
    "Requirements",
    "recommend",
]

Member = Mapping[str, Any]


@dataclass(frozen=True)
class Calibration:
    """A calibration on an architecture, with its evidence, as in the HTTP answer.

    ``studies`` use its extractor, compensations and model; ``with_model`` counts those that use
    its compensations and model, ``support`` is their geometric mean with the studies of the
    architecture (`registry.ranking.support`). ``measured`` is its best measured pipeline that
    meets the requirements, ``other_datasets`` its best on each data set beside that one's.
    """

    rank: int
    extractor: str
    compensations: Sequence[str]
    model: str
    advised: Sequence[str]
    studies: Sequence[str]
    with_model: int
    support: float
    measured: Member | None
    other_datasets: Sequence[Member]
    basis: Mapping[str, str]


@dataclass(frozen=True)
class Architecture:
    """An architecture with its evidence, and its calibrations, best first, as in the HTTP answer.

    ``advice`` is the survey's for what is asked. ``best`` is the calibration with the smallest
    error. ``measures`` are the tasks' own, by which it is ranked
    (`registry.ranking.task_measures`). ``count`` calibrations meet the requirements,
    ``calibrations`` are the first of them.
    """

    rank: int
    detector: str
    mask: str
    tasks: Sequence[Member]
    advised: bool
    advice: Sequence[Member]
    studies: Sequence[str]
    best: Calibration
    pareto: bool
    contradiction: str | None
    measures: Sequence[Member]
    count: int
    calibrations: Sequence[Calibration]


@dataclass(frozen=True)
class Recommendation:
    """The answer to requirements.

    Attributes
    ----------
    requirements
        What was asked.
    architectures
        The first of those that meet them, best first.
    blocking_constraint
        Why nothing meets the requirements; None where something does.
    document
        All of the answer, as over HTTP (`api.schema.recommendations.Recommendations`).
    """

    requirements: Requirements
    architectures: tuple[Architecture, ...]
    blocking_constraint: BlockingConstraint | None
    document: Member

    @property
    def count(self) -> int:
        """How many architectures meet the requirements."""
        count: int = self.document["count"]
        return count

    @property
    def designs(self) -> int:
        """How many calibrations these have, all together."""
        designs: int = self.document["designs"]
        return designs

    @property
    def contradictions(self) -> tuple[str, ...]:
        """Where measurement contradicts the survey's advice."""
        return tuple(self.document["contradictions"])

    @property
    def regret(self) -> Member | None:
        """Error of the first calibration compared with the most accurate one measured."""
        regret: Member | None = self.document["regret"]
        return regret


def recommend(
    requirements: Requirements | Mapping[str, object] | None = None,
    measured: Measurements | Iterable[MeasuredPipeline] = (),
    *,
    sort: Sort = "advice",
    limit: int | None = None,
    calibrations: int | None = None,
    facts: Facts | None = None,
) -> Recommendation:
    """Rank the architectures that meet the requirements, and on each its calibrations.

    Parameters
    ----------
    requirements : Requirements or mapping, optional
        A mapping takes the names of `registry.requirements.PARAMETERS`; none asks nothing.
    measured : Measurements or iterable of Measured
        What was measured. Hand in `Measurements` where many questions are asked of the same.
    sort : {"advice", "support", "measured"}
        By which evidence first (`registry.ranking.ranked`).
    limit, calibrations : int, optional
        The most architectures to return, and calibrations of each; counts, nodes and links tell
        of all.
    facts : Facts, optional
        The survey's by default.

    Raises
    ------
    InvalidValueError
        For an unknown parameter or order, a value outside the taxonomy, an impossible limit.
    """
    for name, most in (("limit", limit), ("calibrations", calibrations)):
        if most is not None and most < 1:
            raise InvalidValueError(name, most, "a whole number of at least 1")
    from registry.answer_json import answer_json  # noqa: PLC0415 - NumPy

    found = answer(requirements, measured, sort=sort, facts=facts)
    document = json.loads(answer_json(found, limit, calibrations))
    return Recommendation(
        requirements=found.question.requirements,
        architectures=tuple(_architecture(**members) for members in document["architectures"]),
        blocking_constraint=found.blocking_constraint,
        document=document,
    )


def _architecture(*, best: Member, calibrations: Iterable[Member], **members: Any) -> Architecture:
    return Architecture(
        best=Calibration(**_frozen(best)),
        calibrations=tuple(Calibration(**_frozen(one)) for one in calibrations),
        **_frozen(members),
    )


def _frozen(members: Member) -> dict[str, Any]:
    return {name: tuple(v) if isinstance(v, list) else v for name, v in members.items()}


def answer(
    requirements: Requirements | Mapping[str, object] | None = None,
    measured: Measurements | Iterable[MeasuredPipeline] = (),
    *,
    sort: Sort = "advice",
    facts: Facts | None = None,
) -> Answer:
    """Find what meets the requirements, ranked; the parameters are those of `recommend`."""
    from registry.answer import Answer  # noqa: PLC0415 - NumPy

    if sort not in SORTS:
        raise unknown_name("sort", sort, SORTS)
    known = facts or registered.facts()
    if isinstance(requirements, Requirements):
        requirements.check(known.taxonomy, known.properties)
        asked = requirements
    else:
        asked = Requirements.parse(requirements or {}, known.taxonomy, known.properties)
    rows = measured if isinstance(measured, Measurements) else Measurements(measured)
    return Answer(Question(design_table(known, rows), asked), sort)

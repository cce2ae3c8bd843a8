"""Which sensor to build, and how to calibrate it: an answer in two levels.

Architectures (a detector behind a mask) that meet the requirements, and on each its calibrations:
an extractor, compensations, a model. Three kinds of evidence stay apart: what the survey's text
advises, what studies proposed, and what is measured here. Where they disagree, the answer says so.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from registry import studies as registered
from registry.contradiction import against_advice, against_literature, regret_words
from registry.designs import Kept, design_table
from registry.flows import LeftOut, Link, Node
from registry.judging import Question
from registry.measured import Measured, Measurements
from registry.paths import PathTable, StudyPath, path_table
from registry.ranking import SORTS, Regret, Sort, pareto, regret, support
from registry.relaxation import Blocked, Relaxation, explain
from registry.requirements import Requirements
from registry.studies import Facts
from registry.taxonomy import InvalidValueError, unknown_name

if TYPE_CHECKING:
    from registry.path_columns import Taken
    from registry.ranked_designs import RankedDesigns, RankedPlace

__all__ = [
    "Architecture",
    "Blocked",
    "Calibration",
    "Measured",
    "Measurements",
    "Recommendation",
    "Relaxation",
    "Requirements",
    "recommend",
]


@dataclass(frozen=True)
class Calibration:
    """A calibration on an architecture, with its evidence.

    ``studies`` extract features so and stand for the stages; ``with_model`` counts those that
    stand for the stages, ``backing`` is the support (`registry.ranking.support`). ``measured`` is
    its best measured pipeline that meets the requirements, ``others`` the data sets that it is
    measured on beside that one's.
    """

    rank: int
    extractor: str
    compensations: tuple[str, ...]
    model: str
    advised: tuple[str, ...]
    studies: tuple[str, ...]
    with_model: int
    backing: float
    measured: Mapping[str, object] | None
    others: tuple[Mapping[str, object], ...]
    basis: Mapping[str, str]

    def to_dict(self) -> dict[str, object]:
        """Return the calibration as in the HTTP answer."""
        return {
            "rank": self.rank,
            "extractor": self.extractor,
            "compensations": list(self.compensations),
            "model": self.model,
            "advised": list(self.advised),
            "studies": list(self.studies),
            "with_model": self.with_model,
            "support": round(self.backing, 4),
            "measured": self.measured,
            "other_datasets": list(self.others),
            "basis": dict(self.basis),
        }


@dataclass(frozen=True)
class Architecture:
    """An architecture with its evidence, and its calibrations, best first.

    ``tasks`` are those its studies had, or it is advised for: their number, and whether it is;
    ``advice`` is the survey's for what is asked. ``best`` errs least of all its calibrations.
    ``measures`` are the tasks' own, what it is ranked by (`registry.ranking.task_measures`).
    ``count`` calibrations meet the requirements, ``calibrations`` are the first of them.
    """

    rank: int
    detector: str
    mask: str
    tasks: Mapping[str, tuple[int, bool]]
    advice: tuple[Mapping[str, str], ...]
    studies: tuple[str, ...]
    best: Calibration
    pareto: bool
    contradiction: str | None
    measures: tuple[Mapping[str, object], ...]
    count: int
    calibrations: tuple[Calibration, ...]

    def to_dict(self) -> dict[str, object]:
        """Return the architecture as in the HTTP answer."""
        return {
            "rank": self.rank,
            "detector": self.detector,
            "mask": self.mask,
            "tasks": [
                {"task": task, "studies": n, "advised": advised}
                for task, (n, advised) in self.tasks.items()
            ],
            "advised": bool(self.advice),
            "advice": [dict(advice) for advice in self.advice],
            "studies": list(self.studies),
            "best": self.best.to_dict(),
            "pareto": self.pareto,
            "contradiction": self.contradiction,
            "measures": [dict(measure) for measure in self.measures],
            "count": self.count,
            "calibrations": [calibration.to_dict() for calibration in self.calibrations],
        }


@dataclass(frozen=True)
class Recommendation:
    """The answer to requirements.

    ``count`` architectures meet them; ``architectures`` are the first of them, best first.
    ``contradictions`` say where measurement contradicts the survey's advice, ``regret`` by how
    much the first calibration named errs more than the best one measured. ``untried`` maps a
    hazard asked for to the architectures that no data set tries it on; ``untimed`` counts the
    pipelines that a limit on latency cannot judge, not being timed on this machine. Paths, nodes
    and links show the studies behind the answer; ``left_out`` lists the studies on no path because
    a value is unknown, whatever is required. ``blocked`` explains an empty answer.
    """

    requirements: Requirements
    sort: Sort
    count: int
    designs: int
    architectures: tuple[Architecture, ...]
    contradictions: tuple[str, ...]
    regret: Mapping[str, object] | None
    untried: Mapping[str, tuple[tuple[str, str], ...]]
    untimed: int
    paths: tuple[StudyPath, ...]
    nodes: tuple[Node, ...]
    links: tuple[Link, ...]
    left_out: tuple[LeftOut, ...]
    blocked: Blocked | None

    def to_dict(self) -> dict[str, object]:
        """Return the recommendation as in the HTTP answer."""
        return {
            "requirements": self.requirements.to_dict(),
            "sort": self.sort,
            "count": self.count,
            "designs": self.designs,
            "architectures": [architecture.to_dict() for architecture in self.architectures],
            "contradictions": list(self.contradictions),
            "regret": self.regret,
            "untried": {
                hazard: [{"detector": d, "mask": m} for d, m in pairs]
                for hazard, pairs in self.untried.items()
            },
            "untimed": self.untimed,
            "paths": [path.to_dict() for path in self.paths],
            "nodes": [node.to_dict() for node in self.nodes],
            "links": [link.to_dict() for link in self.links],
            "left_out": [left.to_dict() for left in self.left_out],
            "blocked": None if self.blocked is None else self.blocked.to_dict(),
        }


def recommend(
    requirements: Requirements | Mapping[str, object] | None = None,
    measured: Measurements | Iterable[Measured] = (),
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
    found = answered(requirements, measured, sort=sort, facts=facts)
    return recommendation(found, limit, calibrations)


def recommendation(
    found: Answered, limit: int | None = None, calibrations: int | None = None
) -> Recommendation:
    """Return an answer as objects, with the first architectures and calibrations of each."""
    from registry.path_columns import unpacked  # noqa: PLC0415 - NumPy

    ranked, taken, asked = found.ranked, found.taken, found.question.asked
    paths = path_table(found.question.table.facts)
    lost = found.regret
    return Recommendation(
        requirements=asked,
        sort=ranked.sort,
        count=len(ranked.places),
        designs=ranked.count,
        architectures=tuple(
            _architecture(at, place, found, paths, calibrations)
            for at, place in enumerate(ranked.places[:limit])
        ),
        contradictions=found.contradictions,
        regret=None if lost is None else lost.to_dict(regret_words(lost)),
        untried=found.untried,
        untimed=found.untimed,
        paths=paths.study_paths(unpacked(taken.paths)),
        nodes=tuple(paths.node(*of) for of in unpacked(taken.nodes)),
        links=tuple(paths.link(*of) for of in unpacked(taken.links)),
        left_out=paths.left_out,
        blocked=found.blocked,
    )


@dataclass(frozen=True, eq=False)
class Answered:
    """What an answer is made of: `recommend` makes objects of it, the HTTP service bytes."""

    question: Question
    ranked: RankedDesigns
    taken: Taken

    @cached_property
    def contradictions(self) -> tuple[str, ...]:
        """Where an architecture that is not advised does better at a task than those advised."""
        tasks = self.question.asked.include.get("task", ())
        return against_advice(self.ranked.places, tasks)

    @cached_property
    def regret(self) -> Regret | None:
        """What the first calibration named errs beside the best one; None if none is measured."""
        return regret(self.ranked.places, self.ranked.first())

    @cached_property
    def pareto(self) -> frozenset[int]:
        """Positions of the architectures that none beats in both support and error."""
        return pareto(self.ranked.places)

    @cached_property
    def untried(self) -> dict[str, tuple[tuple[str, str], ...]]:
        """Architectures that no data set tries a hazard on, by the hazards asked for."""
        question = self.question
        return {hazard: question.columns.untried(hazard) for hazard in question.asked.survive}

    @cached_property
    def untimed(self) -> int:
        """How many measured pipelines a limit on latency cannot judge; 0 where none is asked."""
        if self.question.asked.max_latency_us is None:
            return 0
        return sum(row.latency_us is None for row in self.question.columns.rows)

    @cached_property
    def blocked(self) -> Blocked | None:
        """Why nothing meets the requirements, if nothing does."""
        places = self.ranked.places
        return None if places else explain(self.question.table, self.question.asked)

    def tasks(self, place: RankedPlace) -> dict[str, tuple[int, bool]]:
        """Return the tasks of an architecture: how many studies had them, whether advised."""
        advised = [a.value for a in place.place.advice if a.requirement == "task"]
        found = {
            task: ((bits & place.studies).bit_count(), task in advised)
            for task, bits in {**dict.fromkeys(advised, 0), **place.place.tasks}.items()
        }
        return {task: both for task, both in found.items() if any(both)}

    def others(self, kept: Kept) -> tuple[Measured, ...]:
        """Return the best pipeline of a design on each data set beside that of its best one."""
        if kept.row is None:
            return ()
        judged = self.question.judgements
        first = int(self.question.columns.first_row[kept.at])
        others: dict[str, tuple[float, Measured]] = {}
        for at, row in enumerate(kept.design.rows, first):
            if row.dataset != kept.row.dataset:
                error = judged.error_deg[at]
                known = others.get(row.dataset)
                if known is None or error < known[0]:
                    others[row.dataset] = error, row
        return tuple(row for _, row in others.values())


def answered(
    requirements: Requirements | Mapping[str, object] | None = None,
    measured: Measurements | Iterable[Measured] = (),
    *,
    sort: Sort = "advice",
    facts: Facts | None = None,
) -> Answered:
    """Find what meets the requirements, ranked; the parameters are those of `recommend`."""
    from registry.path_columns import path_columns  # noqa: PLC0415 - NumPy
    from registry.ranked_designs import RankedDesigns  # noqa: PLC0415 - NumPy

    if sort not in SORTS:
        raise unknown_name("sort", sort, SORTS)
    known = facts or registered.facts()
    if isinstance(requirements, Requirements):
        requirements.check(known.taxonomy, known.properties)
        asked = requirements
    else:
        asked = Requirements.parse(requirements or {}, known.taxonomy, known.properties)
    rows = measured if isinstance(measured, Measurements) else Measurements(measured)
    table = design_table(known, rows)
    question = Question(table, asked)
    ranked = RankedDesigns(question, question.meeting, sort)
    return Answered(question, ranked, path_columns(table).taken(ranked))


def _architecture(
    at: int, place: RankedPlace, found: Answered, paths: PathTable, most: int | None
) -> Architecture:
    detector, mask = place.place.architecture
    best = int((place.designs == place.best_at).argmax())
    return Architecture(
        rank=at + 1,
        detector=detector,
        mask=mask,
        tasks=found.tasks(place),
        advice=tuple(advice.to_dict() for advice in place.advice),
        studies=paths.studies(place.studies),
        best=_calibration(best, place.best, place, found, paths),
        pareto=at in found.pareto,
        contradiction=against_literature(place, place.usual),
        measures=tuple(measure.to_dict() for measure in place.measures),
        count=len(place.designs),
        calibrations=tuple(
            _calibration(i, found.question.kept(design), place, found, paths)
            for i, design in enumerate(place.designs[:most].tolist())
        ),
    )


def _calibration(
    at: int, kept: Kept, place: RankedPlace, found: Answered, paths: PathTable
) -> Calibration:
    design, asked = kept.design, found.question.asked
    partly = found.question.partly(place.number)
    return Calibration(
        rank=at + 1,
        extractor=design.extractor,
        compensations=design.stages[:-1],
        model=design.model,
        advised=tuple(advice.id for advice in design.advice),
        studies=paths.studies(place.taken(kept)),
        with_model=place.with_model(kept).bit_count(),
        backing=support(kept, place),
        measured=None if kept.row is None else kept.row.to_dict(asked, partly),
        others=tuple(row.to_dict(asked, partly) for row in found.others(kept)),
        basis=found.question.basis(place.place, measured=kept.row is not None),
    )

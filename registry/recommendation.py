"""Which sensor to build, and how to calibrate it: an answer in two levels.

Architectures (a detector behind a mask) that meet the requirements, and on each its calibrations:
an extractor, compensations, a model. Three kinds of evidence stay apart: what the survey's text
advises, what studies proposed, and what is measured here. Where they disagree, the answer says so.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from registry import studies as registered
from registry.contradiction import against_advice, against_literature, regret_words
from registry.designs import DesignTable, Kept, design_table
from registry.flows import LeftOut, Link, Node
from registry.judging import KeptPlace, Question
from registry.measured import Measured, Measurements, Partly
from registry.paths import PathTable, StudyPath, path_table
from registry.ranking import SORTS, Place, Sort, pareto, ranked, regret, support
from registry.relaxation import Blocked, Relaxation, explain
from registry.requirements import Requirements
from registry.studies import Facts
from registry.taxonomy import InvalidValueError, unknown_name

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
            "count": self.count,
            "calibrations": [calibration.to_dict() for calibration in self.calibrations],
        }


@dataclass(frozen=True)
class Recommendation:
    """The answer to requirements.

    ``count`` architectures meet them; ``architectures`` are the first of them, best first.
    ``contradictions`` say where measurement contradicts the survey's advice, ``regret`` by how
    much the first calibration named errs more than the best one measured. ``untried`` maps a
    hazard asked for to the architectures that no data set tries it on. Paths, nodes and links
    show the studies behind the answer; ``left_out`` lists the studies on no path for want of a
    value, whatever is required. ``blocked`` explains an empty answer.
    """

    requirements: Requirements
    sort: Sort
    count: int
    designs: int
    architectures: tuple[Architecture, ...]
    contradictions: tuple[str, ...]
    regret: Mapping[str, object] | None
    untried: Mapping[str, tuple[tuple[str, str], ...]]
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
    places = ranked(question.places(), sort)
    paths = path_table(known)
    taken = paths.taken(question, places)
    nodes, links = paths.narrowed(taken)
    beaten = pareto(places)
    lost = regret(places)
    return Recommendation(
        requirements=asked,
        sort=sort,
        count=len(places),
        designs=sum(len(designs) for _, designs in places),
        architectures=tuple(
            _architecture(at, place, question, paths, calibrations, pareto=at in beaten)
            for at, place in enumerate(places[:limit])
        ),
        contradictions=against_advice(places, asked.include.get("task", ())),
        regret=None
        if lost is None
        else {
            "first_deg": _or_none(lost.first),
            "best_deg": lost.best.error_deg,
            "ratio": lost.ratio,
            "sentence": regret_words(lost),
        },
        untried=_untried(table, asked),
        paths=paths.study_paths(taken),
        nodes=nodes,
        links=links,
        left_out=paths.left_out,
        blocked=None if places else explain(table, asked),
    )


def _or_none(kept: Kept) -> float | None:
    return None if kept.error_deg == float("inf") else kept.error_deg


def _architecture(
    at: int,
    found: Place,
    question: Question,
    paths: PathTable,
    most: int | None,
    *,
    pareto: bool,
) -> Architecture:
    place, designs = found
    best = designs.index(place.best)
    partly = question.partly(place.place)
    detector, mask = place.place.architecture
    advised = [a.value for a in place.place.advice if a.requirement == "task"]
    tasks = {
        task: ((bits & place.studies).bit_count(), task in advised)
        for task, bits in {**dict.fromkeys(advised, 0), **place.place.tasks}.items()
    }
    return Architecture(
        rank=at + 1,
        detector=detector,
        mask=mask,
        tasks={task: both for task, both in tasks.items() if any(both)},
        advice=tuple(advice.to_dict() for advice in place.advice),
        studies=paths.studies(place.studies),
        best=_calibration(best, designs[best], place, question, paths, partly=partly),
        pareto=pareto,
        contradiction=against_literature(place, designs),
        count=len(designs),
        calibrations=tuple(
            _calibration(i, kept, place, question, paths, partly=partly)
            for i, kept in enumerate(designs[:most])
        ),
    )


def _calibration(
    at: int,
    kept: Kept,
    place: KeptPlace,
    question: Question,
    paths: PathTable,
    *,
    partly: tuple[Partly[Measured], ...],
) -> Calibration:
    design, asked, judged = kept.design, question.asked, question.judged
    others: dict[str, Measured] = {}
    for row in design.rows:
        if kept.row is not None and row.dataset != kept.row.dataset:
            known = others.get(row.dataset)
            if known is None or judged[row].error_deg < judged[known].error_deg:
                others[row.dataset] = row
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
        others=tuple(row.to_dict(asked, partly) for row in others.values()),
        basis=question.basis(place.place, kept),
    )


def _untried(table: DesignTable, asked: Requirements) -> dict[str, tuple[tuple[str, str], ...]]:
    return {
        hazard: tuple(
            place.architecture
            for place in table.places
            if not any(row.tried(hazard) for design in place.designs for row in design.rows)
        )
        for hazard in asked.survive
    }

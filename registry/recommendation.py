"""Which sensor and which calibration: the paths studies took, ranked for given requirements.

Literature support and measured performance stay two columns. Rank goes by literature support,
ties by the measured error; the Pareto set says which paths nothing beats in both.

Support of a path is the geometric mean of three numbers of distinct studies: those with its task,
detector and mask (the architecture), those of them that also used its model, and those of them
that also used its extractor, the whole path. Each step counts alike, so a path that one study took
on a well-backed architecture stands above one that nobody came near, and an architecture whose
studies agree on model and extractor stands above one as large whose studies scatter.
"""

from __future__ import annotations

import operator
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from registry import studies as registered
from registry.flows import LeftOut, Link, Node
from registry.measured import Measured, Measurements
from registry.paths import Answer, PathTable, measured_number, path_table
from registry.relaxation import Blocked, Relaxation, explain
from registry.requirements import LIMITS, Requirements
from registry.studies import Facts
from registry.taxonomy import InvalidValueError

__all__ = [
    "Blocked",
    "Literature",
    "Measured",
    "Measurements",
    "Recommendation",
    "RecommendedPath",
    "Relaxation",
    "Requirements",
    "recommend",
]


@dataclass(frozen=True)
class Literature:
    """How the literature backs a path: numbers of distinct studies meeting the requirements."""

    studies: int  # the whole path
    with_model: int  # task, detector, mask, model
    architecture: int  # task, detector, mask

    @property
    def support(self) -> float:
        """The geometric mean of the three."""
        return float((self.studies * self.with_model * self.architecture) ** (1 / 3))

    def to_dict(self) -> dict[str, float]:
        """Return the counts and the support, rounded to 4 decimals."""
        return {
            "studies": self.studies,
            "with_model": self.with_model,
            "architecture": self.architecture,
            "support": round(self.support, 4),
        }


@dataclass(frozen=True)
class RecommendedPath:
    """One ranked path. ``basis`` says on what each numeric requirement was judged.

    ``measured`` is the most accurate measured row that meets the numeric requirements, None if
    the path has not been measured. ``pareto``: no other path has at least its support and at
    least its measured performance, and one of them better; an unmeasured path counts as worst.
    """

    rank: int
    task: str
    detector: str
    mask: str
    model: str
    extractor: str
    studies: tuple[str, ...]
    literature: Literature
    measured: Measured | None
    basis: Mapping[str, str] = field(hash=False)
    pareto: bool

    def to_dict(self) -> dict[str, object]:
        """Return the path as in the HTTP answer."""
        return {
            "rank": self.rank,
            "task": self.task,
            "detector": self.detector,
            "mask": self.mask,
            "model": self.model,
            "extractor": self.extractor,
            "studies": list(self.studies),
            "literature": self.literature.to_dict(),
            "measured": None if self.measured is None else self.measured.to_dict(),
            "basis": dict(self.basis),
            "pareto": self.pareto,
        }


@dataclass(frozen=True)
class Recommendation:
    """The answer to requirements.

    ``count`` paths meet them; ``paths`` are the first of them, best first. Nodes and links show
    all of them with the studies that took them. ``left_out`` lists the studies on no path for
    want of a value, whatever is required. ``blocked`` explains an empty answer.
    """

    requirements: Requirements
    count: int
    paths: tuple[RecommendedPath, ...]
    nodes: tuple[Node, ...]
    links: tuple[Link, ...]
    left_out: tuple[LeftOut, ...]
    blocked: Blocked | None

    def to_dict(self) -> dict[str, object]:
        """Return the recommendation as in the HTTP answer."""
        return {
            "requirements": self.requirements.to_dict(),
            "count": self.count,
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
    limit: int | None = None,
    facts: Facts | None = None,
) -> Recommendation:
    """Rank the paths task > detector > mask > model > extractor that meet the requirements.

    Parameters
    ----------
    requirements : Requirements or mapping, optional
        A mapping takes the names of `registry.requirements.PARAMETERS`; none asks nothing.
    measured : Measurements or iterable of Measured
        Scores, of one condition if they are to be compared. Hand in `Measurements` where many
        questions are asked of the same rows.
    limit : int, optional
        The most paths to return; `count`, nodes and links tell of all.
    facts : Facts, optional
        The survey's by default.

    Raises
    ------
    InvalidValueError
        For an unknown parameter, a value outside the taxonomy, an impossible limit.
    """
    if limit is not None and limit < 1:
        raise InvalidValueError("limit", limit, "a whole number of at least 1")
    table = path_table(facts or registered.facts())
    if isinstance(requirements, Requirements):
        requirements.check(table.taxonomy)
        asked = requirements
    else:
        asked = Requirements.parse(requirements or {}, table.taxonomy)
    rows = measured if isinstance(measured, Measurements) else Measurements(measured)
    answers = table.meeting(asked, rows)
    ranked = sorted(answers, key=_rank)
    best = _pareto(ranked, asked)
    nodes, links = _narrowed(table, answers)
    return Recommendation(
        requirements=asked,
        count=len(ranked),
        paths=tuple(
            _path(table, answer, rank, rank - 1 in best)
            for rank, answer in enumerate(ranked[:limit], start=1)
        ),
        nodes=nodes,
        links=links,
        left_out=table.left_out,
        blocked=None if ranked else explain(table, asked, rows),
    )


def _rank(answer: Answer) -> tuple[int, float, int]:
    error = float("inf")
    if answer.measured is not None:
        number = measured_number("max_error_deg", answer.measured)
        error = error if number is None else number
    return (-answer.backing, error, answer.path)


def _pareto(ranked: Sequence[Answer], requirements: Requirements) -> frozenset[int]:
    """Return the positions of the paths that none beats in support and the measured quantities.

    The quantities are those with a limit; the error if there is none.
    """
    quantities = [name for name in LIMITS if requirements.limit(name) is not None] or [
        "max_error_deg"
    ]
    costs = [_costs(answer, quantities) for answer in ranked]
    # In sorted order whatever beats a point stands before it; and if that is beaten itself, then
    # by something that beats the point too. So the front found so far is all there is to compare.
    front: list[tuple[float, ...]] = []
    for point in sorted(set(costs)):
        for other in front:
            if all(map(operator.le, other, point)):
                break
        else:
            front.append(point)
    best = set(front)
    return frozenset(at for at, point in enumerate(costs) if point in best)


def _costs(answer: Answer, quantities: Sequence[str]) -> tuple[float, ...]:
    """Return what is to be small: support negated, then each quantity, infinite if unmeasured."""
    costs = [float(-answer.backing)]
    for name in quantities:
        number = None if answer.measured is None else measured_number(name, answer.measured)
        if number is None:
            costs.append(float("inf"))
        else:
            costs.append(-number if name.startswith("min_") else number)
    return tuple(costs)


def _path(table: PathTable, answer: Answer, rank: int, pareto: bool) -> RecommendedPath:
    task, detector, mask, model, extractor = table.paths[answer.path]
    return RecommendedPath(
        rank=rank,
        task=task,
        detector=detector,
        mask=mask,
        model=model,
        extractor=extractor,
        studies=table.studies(answer.studies),
        literature=Literature(
            answer.studies.bit_count(),
            answer.with_model.bit_count(),
            answer.architecture.bit_count(),
        ),
        measured=answer.measured,
        basis=MappingProxyType(dict(answer.basis)),
        pareto=pareto,
    )


def _narrowed(
    table: PathTable, answers: Sequence[Answer]
) -> tuple[tuple[Node, ...], tuple[Link, ...]]:
    """Return nodes and links of the paths found, with the studies that took them."""
    node_bits = [0] * len(table.nodes)
    link_bits = [0] * len(table.links)
    for answer in answers:
        studies = answer.studies
        for at in table.nodes_on[answer.path]:
            node_bits[at] |= studies
        for at in table.links_on[answer.path]:
            link_bits[at] |= studies
    return (
        tuple(table.node(at, bits) for at, bits in enumerate(node_bits) if bits),
        tuple(table.link(at, bits) for at, bits in enumerate(link_bits) if bits),
    )

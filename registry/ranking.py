"""The order of an answer, what nothing beats, and what following the order costs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from registry.designs import Kept
from registry.judging import KeptPlace

Sort = Literal["advice", "support", "measured"]
SORTS: tuple[Sort, ...] = ("advice", "support", "measured")
"""What an answer is ordered by first; the first of them is the usual one."""


MOST_CREDIT = 2.0
"""Times by which advice and studies together make up for a larger error, at most."""

_HALF_STUDIES = 5.0


def support(kept: Kept, place: KeptPlace) -> float:
    """Return how the literature backs a calibration on an architecture.

    The geometric mean of three numbers of studies that meet the requirements: those of the
    architecture, those of them that stand for its stages, and those that extract features as it
    does too. Each step counts alike.
    """
    taken = place.taken(kept)
    if not taken:
        return 0.0
    counts = (place.studies, place.with_model(kept), taken)
    return float(math.prod(bits.bit_count() for bits in counts) ** (1 / 3))


def key_of(
    sort: Sort,
    advised: bool,
    backing: float,
    error: float,
    own: float | None = None,
    *,
    of_errors: bool = False,
) -> tuple[float, ...]:
    """Return what an architecture is ranked by, the best first.

    By advice: where kinds of errors are asked for (`of_errors`), what the survey advises for them;
    then what the survey advises or studies back and what is measured, then what has
    that evidence alone, then the rest; in each by the error or, where tasks are asked for, by
    their `own` measures (`registry.task_measures.joint_cost`). Evidence divides that by up to
    `MOST_CREDIT`: half of it (as a power) for advice, half for n studies in parts of n / (n + 5).
    So what stands first is at most so many times worse than the best of those with evidence. By
    support, or by what is measured: that first. What is not measured errs without limit.
    """
    if sort == "measured":
        return (error, not advised, -backing)
    if sort == "support":
        return (-backing, error, not advised)
    cost = error if own is None else own
    evident, measured = advised or backing > 0, math.isfinite(cost)
    tier = 0 if evident and measured else 1 if evident else 2
    credit = 0.5 * advised + 0.5 * backing / (backing + _HALF_STUDIES)
    unadvised = of_errors and not advised
    return (unadvised, tier, cost / MOST_CREDIT**credit, not advised, -backing)


def pareto(places: Sequence[KeptPlace]) -> frozenset[int]:
    """Return the positions of the architectures that none beats in both support and error."""
    costs = [(-place.backing, place.error_deg) for place in places]
    least = math.nan
    unbeaten: set[tuple[int, float]] = set()
    for cost in sorted(set(costs)):  # whoever beats one comes before it
        if not least <= cost[1]:
            unbeaten.add(cost)
            least = cost[1]
    return frozenset(at for at, cost in enumerate(costs) if cost in unbeaten)


@dataclass(frozen=True)
class Regret:
    """What the first calibration of an answer errs, beside the best measured one that meets all.

    ``ratio`` is the first's error over the best's: 1 where they are the same, None where the first
    is not measured.
    """

    first: Kept
    best: Kept

    @property
    def ratio(self) -> float | None:
        """How many times the error."""
        if not math.isfinite(self.first.error_deg):
            return None
        return self.first.error_deg / self.best.error_deg

    def to_dict(self, sentence: str) -> dict[str, object]:
        """Return the regret as in the HTTP answer, beside a sentence that says it."""
        first = self.first.error_deg
        return {
            "first_deg": None if math.isinf(first) else first,
            "best_deg": self.best.error_deg,
            "ratio": self.ratio,
            "sentence": sentence,
        }


def regret(places: Sequence[KeptPlace], first: Kept | None) -> Regret | None:
    """Return the regret of an answer; None where nothing in it is measured.

    ``first`` is the first calibration of the first of its architectures.
    """
    if first is None:
        return None
    best = min(places, key=lambda place: place.error_deg).best
    if not math.isfinite(best.error_deg):
        return None
    return Regret(first, first if first.error_deg == best.error_deg else best)

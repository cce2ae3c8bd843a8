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

Place = tuple[KeptPlace, tuple[Kept, ...]]
"""An architecture and its calibrations, best first."""


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


def ranked(places: Sequence[KeptPlace], sort: Sort) -> list[Place]:
    """Return architectures and their calibrations, best first; equals in the order they came.

    By advice: what the survey advises, then what most studies back, then what errs least. By
    support, or by what is measured: that first. What is not measured errs without limit. A
    calibration whose extractor or model has no name in the taxonomy comes last, but by what is
    measured.
    """
    found: list[tuple[tuple[float, ...], Place]] = []
    for place in places:
        designs = sorted(
            place.designs,
            key=lambda kept: (
                sort != "measured" and not kept.design.stated,
                *_key(sort, kept.design.advised, support(kept, place), kept.error_deg),
            ),
        )
        error = place.best.error_deg
        key = _key(sort, bool(place.advice), place.studies.bit_count(), error)
        found.append((key, (place, tuple(designs))))
    found.sort(key=lambda item: item[0])
    return [place for _, place in found]


def _key(sort: Sort, advised: bool, backing: float, error: float) -> tuple[float, ...]:
    if sort == "measured":
        return (error, not advised, -backing)
    if sort == "support":
        return (-backing, error, not advised)
    return (not advised, -backing, error)


def pareto(places: Sequence[Place]) -> frozenset[int]:
    """Return the positions of the architectures that none beats in both support and error."""
    costs = [(-place.studies.bit_count(), place.best.error_deg) for place, _ in places]
    return frozenset(
        at
        for at, cost in enumerate(costs)
        if not any(other != cost and other[0] <= cost[0] and other[1] <= cost[1] for other in costs)
    )


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


def regret(places: Sequence[Place]) -> Regret | None:
    """Return the regret of an answer; None where nothing in it is measured."""
    if not places:
        return None
    best = min((place.best for place, _ in places), key=lambda kept: kept.error_deg)
    if not math.isfinite(best.error_deg):
        return None
    first = places[0][1][0]
    return Regret(first, first if first.error_deg == best.error_deg else best)

"""Pins: the hash of every generated split, with its bound; what may not change in silence."""

from __future__ import annotations

import math
from dataclasses import dataclass

Place = tuple[str, str, str]  # (dataset, condition, split)

#: Bounds come out of linear algebra, whose last bits are other ones on other processors.
BOUND_TOLERANCE = 1e-4

#: What a board states once of its data set's test split.
BOARD_FACTS = ("bound_unit_deg", "bench_deg", "bench_aligned_deg", "boresight_deg", "oracle_deg")


@dataclass(frozen=True)
class Pin:
    """Hash of one generated split of unit 0, and its bound.

    Attributes
    ----------
    dataset, condition, split
        Which.
    version
        Of the dataset.
    n
        Samples.
    observable
        How many of them have an observable direction; None but for the test split.
    bound_deg
        Cramer-Rao bound, root mean square over the observable samples; None where there is none,
        and but for the test split.
    head_bound_deg, head_hash
        The same bound, and the hash, of the first `benchmark.datasets.samples.HEAD` samples: what
        a check in seconds compares.
    bound_unit_deg, bench_deg, bench_aligned_deg, boresight_deg, oracle_deg
        What a board states once of the test split (`benchmark.datasets.controls.board_facts`).
    data_hash
        `benchmark.datasets.samples.samples_hash`.
    """

    dataset: str
    condition: str
    split: str
    version: int
    n: int
    data_hash: str
    head_hash: str
    observable: int | None = None
    bound_deg: float | None = None
    head_bound_deg: float | None = None
    bound_unit_deg: float | None = None
    bench_deg: float | None = None
    bench_aligned_deg: float | None = None
    boresight_deg: float | None = None
    oracle_deg: float | None = None

    @property
    def place(self) -> Place:
        """What the pin is for."""
        return (self.dataset, self.condition, self.split)

    def difference(self, other: Pin) -> str:
        """Say in what another pin of the same place differs beyond rounding; empty for nothing."""
        for name in ("n", "data_hash", "head_hash", "observable"):
            if getattr(self, name) != getattr(other, name):
                return f"{name} {getattr(other, name)}, pinned {getattr(self, name)}"
        for name in ("bound_deg", "head_bound_deg", *BOARD_FACTS):
            pinned, found = getattr(self, name), getattr(other, name)
            if not bounds_agree(pinned, found):
                return f"{name} {found}, pinned {pinned}"
        return ""


def bounds_agree(one: float | None, other: float | None) -> bool:
    """Say whether two bounds are the same but for rounding; none is like none."""
    if one is None or other is None:
        return one is other
    return math.isclose(one, other, rel_tol=BOUND_TOLERANCE)

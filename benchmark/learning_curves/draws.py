"""Which poses a calibration is given: growing, nested subsets of the calibration split.

On a bench the poses of a draw are the first of a random permutation, in the order of the split: a
draw's larger subset holds the smaller ones. In flight poses are a time series that filters read
in order; there a draw is a stretch without a gap of its own, from a random moment on, that grows
to the end of the split and then backwards. Draws are seeded by names alone.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from benchmark import seeds

#: Numbers of poses, each about the root of two times the one before.
LADDER = (
    *(4, 6, 9, 13, 18, 25, 36, 50, 71, 100, 141, 200, 283, 400, 566, 800, 1131, 1600),
    *(2263, 3200, 4525, 6400),
)

#: From a step of the ladder half way to the next, as a factor.
_HALF_STEP = 2.0**0.25

Rows = NDArray[np.int64]


def sizes(poses: int) -> tuple[int, ...]:
    """Return how many poses are taken of so many: the steps of `LADDER`, then all.

    A step less than half a step below all of them, which would say the same again, is left out.
    """
    if poses < 1:
        raise ValueError(f"a calibration needs poses; got {poses}")
    return (*(size for size in LADDER if size * _HALF_STEP < poses), poses)


def subsets(poses: int, *names: str | int, in_order: bool = False) -> Iterator[tuple[int, Rows]]:
    """Yield (size, rows) of one draw for each of `sizes`, smallest first.

    `names` are those of the random stream; `in_order`: the split is a time series.

    Yields
    ------
    tuple of int and ndarray, shape (size,)
        Rows of the split, ascending; each subset holds those before it.
    """
    generator = seeds.generator("learning-curve", *names)
    if in_order:
        start = int(generator.integers(poses))
        for size in sizes(poses):
            first = min(start, poses - size)
            yield size, np.arange(first, first + size, dtype=np.int64)
        return
    order = generator.permutation(poses)
    for size in sizes(poses):
        yield size, np.sort(order[:size])

"""Which points of a plane lie in a convex region, many at a time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats


@compiled
def in_region(
    x: Floats,
    y: Floats,
    slices: tuple[Floats, Floats, float, float],
    sides: tuple[Floats, float],
    inside: NDArray[np.bool_],
) -> None:
    """Whether each point (N,) is inside a region or within its margin, into `inside`.

    Parameters
    ----------
    x, y : ndarray, shape (N,)
        Points; NaN is nowhere.
    slices : tuple
        Lowest and highest y (S,) of each slice of x between which all is inside, the first and
        the last of which is empty; where the first begins, and slices of a unit of x.
    sides : tuple
        Sides (F, 3) as `Hull` has them, and the margin past them: what no slice holds is asked
        of these.
    inside : ndarray of bool, shape (N,)
        Overwritten.
    """
    low, high, first, slices_a_unit = slices
    facets, margin = sides
    last = len(low) - 1.0
    for i in range(len(x)):
        place = (x[i] - first) * slices_a_unit
        if not place > 0.0:
            place = 0.0
        number = int(min(place, last))
        held = (y[i] >= low[number]) & (y[i] <= high[number])
        if not held:
            held = True
            for side in range(len(facets)):
                past = facets[side, 2] + facets[side, 0] * x[i]
                past += facets[side, 1] * y[i]
                if not past <= margin:
                    held = False
                    break
        inside[i] = held

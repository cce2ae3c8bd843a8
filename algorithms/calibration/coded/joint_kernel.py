"""One displacement of all spots of a list: least squares, without spots that disagree."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.copies import copy_row

#: Least distance from the median, px, that counts as disagreement.
_LEAST_PX = 0.01


@compiled
def joint(  # noqa: C901, PLR0917 - one pass over spots; positional for Numba
    lists: Floats,
    places: Floats,
    partners: NDArray[np.int64],
    worst: float,
    agreeing: int,
    found: Floats,
) -> None:
    """Write each list's displacement (N, 2): the mean of spot less place, NaN for none.

    Spots farther than `worst` times the median distance from the median, an axis at a time taken,
    lose their partner (N, K), unless fewer than `agreeing` would be left. There is none where
    fewer have a partner.
    """
    room = np.empty((3, lists.shape[1]))
    previous = np.empty(lists.shape[1], dtype=np.int64)
    for k in range(lists.shape[0]):
        own = partners[k]
        found[k] = math.nan
        n = 0
        for s in range(lists.shape[1]):
            if own[s] >= 0:
                room[0, n] = lists[k, s, 0] - places[own[s], 0]
                room[1, n] = lists[k, s, 1] - places[own[s], 1]
                n += 1
        if n < agreeing:
            own[:] = -1
            continue
        x = np.median(room[0, :n])
        y = np.median(room[1, :n])
        for m in range(n):
            room[2, m] = math.hypot(room[0, m] - x, room[1, m] - y)
        copy_row(own, previous)
        reach = worst * max(np.median(room[2, :n]), _LEAST_PX)
        across, along, kept, n = 0.0, 0.0, 0, 0
        for s in range(lists.shape[1]):
            if own[s] < 0:
                continue
            if room[2, n] <= reach:
                across += room[0, n]
                along += room[1, n]
                kept += 1
            else:
                own[s] = -1
            n += 1
        if kept < agreeing:  # of so few, two that happen to agree do not make the third wrong
            across, along, kept = 0.0, 0.0, 0
            for s in range(lists.shape[1]):
                if previous[s] >= 0:
                    across += lists[k, s, 0] - places[previous[s], 0]
                    along += lists[k, s, 1] - places[previous[s], 1]
                    kept += 1
            copy_row(previous, own)
        found[k, 0] = across / kept
        found[k, 1] = along / kept

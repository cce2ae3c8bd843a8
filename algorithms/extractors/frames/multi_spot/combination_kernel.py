"""One displacement from those of many spots, weighted, without the spots that disagree."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Deviations by which a spot may be away from the others, and its misfit above theirs.
_AWAY, _MISFIT = 4.0, 8.0
#: Least number of spots of which one can be found to disagree.
_VOTERS = 4
#: Turns of finding what spots scatter more than noise, and weights from it.
_TURNS = 3
#: Deviations of the scatter of N spots above which it is more than noise: what is below, cut off at
#: zero, would make every answer seem less sure than it is.
_MORE = 2.0


@compiled
def _middle(values: Floats, used: NDArray[np.bool_], work: Floats) -> float:
    """Median of the values used; NaN for none."""
    number = 0
    for a in range(values.size):
        if used[a]:
            work[number] = values[a]
            number += 1
    return float(np.median(work[:number])) if number > 0 else np.nan


@compiled
def _leave_out(values: Floats, noise: Floats, limit: float, used: NDArray[np.bool_]) -> None:
    """Leave out values further from the median than `limit` deviations, the wider of two.

    That of the values about the median, and a value's own.
    """
    work = np.empty(values.size)
    middle = _middle(values, used, work)
    away = np.abs(values - middle)
    usual = 1.4826 * _middle(away, used, work)
    for a in range(values.size):
        used[a] = used[a] and away[a] <= limit * max(usual, noise[a])


@compiled
def _weight(values: Floats, variances: Floats, used: NDArray[np.bool_]) -> tuple[float, float]:
    """Mean of the values used, weighted by their variances, and its own variance.

    What they scatter more than their variances say, surely, places of apertures are off: it is
    added to all of them alike.
    """
    common = 0.0
    for turn in range(_TURNS + 1):
        number = 0
        weight = 0.0
        squares = 0.0
        total = 0.0
        for a in range(values.size):
            if used[a]:
                w = 1.0 / (variances[a] + common)
                number += 1
                weight += w
                squares += w * w
                total += w * values[a]
        mean = total / weight
        free = weight - squares / weight
        if turn == _TURNS or not free > 1e-12 * weight:
            break
        spread = 0.0
        explained = 0.0  # by the variances alone, under these weights
        for a in range(values.size):
            if used[a]:
                w = 1.0 / (variances[a] + common)
                spread += w * (values[a] - mean) ** 2
                explained += w * (1.0 - w / weight) * variances[a]
        if turn == 0 and spread < explained * (1.0 + _MORE * math.sqrt(2.0 / (number - 1))):
            break
        common = max((spread - explained) / free, 0.0)
    return mean, 1.0 / weight


@compiled
def combine(  # noqa: PLR0917 - Numba takes no keyword-only ones
    centres: Floats,
    variances: Floats,
    misfits: Floats,
    apertures: Floats,
    found: Floats,
    sure: Floats,
    used: NDArray[np.bool_],
) -> None:
    """Write the displacement that each frame's spots agree on, its variance and those used.

    Parameters
    ----------
    centres, variances, misfits
        (N, A, 2), (N, A) and (N, A): places of spots, NaN for none, their variances along an
        axis, and how badly each resembles the others: one for as well as noise lets it.
    apertures
        (A, 3) x, y, width.
    found, sure, used
        (N, 2), (N, 2) and (N, A): receive the displacement, the variances along x and y, and
        the spots in it.
    """
    away = np.empty((2, apertures.shape[0]))
    even = np.zeros(apertures.shape[0])
    for k in range(centres.shape[0]):
        found[k] = np.nan
        sure[k] = np.nan
        noise = np.sqrt(variances[k])
        number = 0
        for a in range(apertures.shape[0]):
            used[k, a] = math.isfinite(centres[k, a, 0]) and math.isfinite(variances[k, a])
            number += used[k, a]
            away[0, a] = centres[k, a, 0] - apertures[a, 0]
            away[1, a] = centres[k, a, 1] - apertures[a, 1]
        if number >= _VOTERS:
            even[:] = 0.1
            _leave_out(misfits[k], even, _MISFIT, used[k])
            _leave_out(away[0], noise, _AWAY, used[k])
            _leave_out(away[1], noise, _AWAY, used[k])
        if number > 0 and used[k].any():
            found[k, 0], sure[k, 0] = _weight(away[0], variances[k], used[k])
            found[k, 1], sure[k, 1] = _weight(away[1], variances[k], used[k])

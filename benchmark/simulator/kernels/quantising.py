"""Compiled information of readings that are rounded and clipped (loaded on first use: Numba).

Compare `benchmark.simulator.readout.quantisation`, which says of what.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Codes further from the mean than this many deviations tell nothing that double precision keeps.
_REACH = 8.0
#: The table's deviations, in codes: from the first, in equal steps, to the second.
FINE, COARSE, _ROWS = 0.2, 0.8, 121
#: Half a code of fractions of the mean, in equal steps.
_COLUMNS = 257
#: From this distance on, in deviations, an end of the scale takes less than 1e-6 away.
_FAR = 4.5
#: A little more than that: no rounding of a quotient makes it less.
_SURELY_FAR = 1.02 * _FAR
#: A deviation below which information is far above the least that counts.
_LARGEST = 1e100
#: Ends of the scale are summed code by code up to this deviation, then by the normal distribution.
_SUMMED = 6.0

_ROOT_HALF = math.sqrt(0.5)
_PEAK = 1.0 / math.sqrt(2.0 * math.pi)


@compiled
def _upper(z: float) -> float:
    """Probability of a normal value above `z`, right far out, too."""
    return float(0.5 * math.erfc(z * _ROOT_HALF))


@compiled
def _density(z: float) -> float:
    return float(_PEAK * math.exp(-0.5 * z * z))


@compiled
def add_up(mean: float, sigma: float, lowest: float, highest: float) -> float:
    """Information of one reading times sigma^2, code by code; `lowest` and `highest` are lumped."""
    first = max(lowest, math.floor(mean - _REACH * sigma + 0.5))
    last = min(highest, math.ceil(mean + _REACH * sigma - 0.5))
    if first >= last:
        # hardly any noise, or a mean beyond the scale: the edges on either side, where there are
        nearest = min(max(math.floor(mean + 0.5), lowest), highest)
        first, last = max(nearest - 1.0, lowest), min(nearest + 1.0, highest)
    total = 0.0
    phi_below, lower_below, z_below = 0.0, 0.0, -math.inf
    # from the middle on what lies above, of which less is left
    upper_below, middle = 1.0, False
    code = first
    while code <= last:
        z = math.inf if code == last else (code + 0.5 - mean) / sigma
        phi = _density(z) if code < last else 0.0
        # the difference of the smaller tails keeps its digits
        lower = 1.0 if z > 1.0 else _upper(-z)
        if lower > 0.5:
            if not middle:
                upper_below, middle = _upper(z_below), True
            upper = _upper(z) if code < last else 0.0
            chance, upper_below = upper_below - upper, upper
        else:
            chance = lower - lower_below
        if chance > 1e-290:
            total += (phi_below - phi) ** 2 / chance
        phi_below, lower_below, z_below = phi, lower, z
        code += 1.0
    return float(total)


@lru_cache(maxsize=1)
def table() -> Floats:
    """(121, 257) information times sigma^2 far from the ends of the scale.

    By deviation from `FINE` to `COARSE` and by the fraction of the mean from 0, the middle of a
    code, to 1/2, its edge.
    """
    out = np.empty((_ROWS, _COLUMNS))
    for row in range(_ROWS):
        sigma = FINE + (COARSE - FINE) * row / (_ROWS - 1)
        for column in range(_COLUMNS):
            out[row, column] = add_up(0.5 * column / (_COLUMNS - 1), sigma, -99.0, 99.0)
    out.flags.writeable = False
    return out


@compiled
def _tabulate(fraction: float, sigma: float, table: Floats) -> float:
    y = (sigma - FINE) * ((_ROWS - 1) / (COARSE - FINE))
    x = fraction * (2.0 * (_COLUMNS - 1))
    row, column = min(int(y), _ROWS - 2), min(int(x), _COLUMNS - 2)
    y -= row
    x -= column
    near = table[row, column] + x * (table[row, column + 1] - table[row, column])
    far = table[row + 1, column] + x * (table[row + 1, column + 1] - table[row + 1, column])
    return float(near + y * (far - near))


@compiled
def _keep(z: float) -> float:
    """Share of the information on its mean that a normal value keeps when known below `z` only."""
    if z > _FAR:
        return 1.0
    if z < -30.0:
        return 0.0
    phi = _density(z)
    return float(max(_upper(-z) - z * phi + phi * phi / _upper(z), 0.0))


@compiled
def _variance(mu: float, sigma: float, ends: tuple[float, float], table: Floats) -> float:
    """Inverse information of one reading of any mean and deviation."""
    lowest, highest = ends
    information = 0.0
    if sigma > 0.0:
        below = (mu - lowest - 0.5) / sigma
        above = (highest - 0.5 - mu) / sigma
        ended = min(below, above) < _FAR
        if sigma < FINE or (ended and sigma < _SUMMED):
            information = add_up(mu, sigma, lowest, highest) / (sigma * sigma)
        elif sigma < COARSE:
            fraction = abs(mu - math.floor(mu + 0.5))
            information = _tabulate(fraction, sigma, table) / (sigma * sigma)
        else:
            information = 1.0 / (sigma * sigma + 1.0 / 12.0)
            if ended:
                information *= max(_keep(below) + _keep(above) - 1.0, 0.0)
    return 1.0 / information if information > 1e-290 else math.inf


@compiled
def reading_variances(
    out: Floats, mean: Floats, deviation: Floats, ends: tuple[float, float], table: Floats
) -> None:
    """Write the inverse information of readings (n,), in squared codes; inf where there is none.

    Parameters
    ----------
    out
        (n,), overwritten.
    mean, deviation
        (n,) before rounding, in codes.
    ends
        Lowest and highest code.
    table
        `table`.
    """
    lowest, highest = ends
    # all as if noise were above a code and the ends far off, which the processor does side by side
    for n in range(out.shape[0]):
        out[n] = 1.0 / (1.0 / (deviation[n] * deviation[n] + 1.0 / 12.0))
    for n in range(out.shape[0]):
        mu, sigma = mean[n], deviation[n]
        room = min(mu - lowest - 0.5, highest - 0.5 - mu)
        if not (room > _SURELY_FAR * sigma and COARSE <= sigma < _LARGEST):
            out[n] = _variance(mu, sigma, ends, table)

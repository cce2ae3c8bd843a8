"""Confidence intervals that assume no distribution: of a median, and of a share."""

from __future__ import annotations

import math
from collections.abc import Sequence

#: Confidence level of every interval that is printed.
LEVEL = 0.95


def median_interval(values: Sequence[float], level: float = LEVEL) -> tuple[float, float]:
    """Return the interval of a median by order statistics, which may be infinite.

    From the k-th smallest value to the k-th largest, with the largest k for which the interval
    misses the median with a probability of at most 1 - level, half of it on either side. Fewer than
    six values do not bound a median at 95 %: the interval is then the whole line.

    Parameters
    ----------
    values
        Independent draws; infinite ones count as larger than all others.
    level
        Confidence.

    Raises
    ------
    ValueError
        For no values, or one that is no number.

    Examples
    --------
    >>> median_interval([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    (1.0, 6.0)
    """
    if not values or any(math.isnan(value) for value in values):
        raise ValueError("expected at least one value, each a number")
    ordered = sorted(values)
    count = len(ordered)
    below, place = 0, 0
    while 2 * (below + math.comb(count, place)) <= (1.0 - level) * 2**count:
        below += math.comb(count, place)
        place += 1
    if place == 0:
        return -math.inf, math.inf
    return ordered[place - 1], ordered[count - place]


def share_interval(count: int, of: int, level: float = LEVEL) -> tuple[float, float]:
    """Return the exact interval of a share by Clopper and Pearson.

    Parameters
    ----------
    count, of
        How many of how many independent draws.
    level
        Confidence.

    Raises
    ------
    ValueError
        For more than there are, or none to draw from.

    Examples
    --------
    >>> low, high = share_interval(0, 10)
    >>> low, round(high, 3)
    (0.0, 0.308)
    """
    from scipy.special import betaincinv  # noqa: PLC0415 - SciPy, at the first use

    if not 0 <= count <= of or of == 0:
        raise ValueError(f"expected 0 to {of} of at least 1, got {count}")
    tail = (1.0 - level) / 2.0
    low = 0.0 if count == 0 else float(betaincinv(count, of - count + 1, tail))
    high = 1.0 if count == of else float(betaincinv(count + 1, of - count, 1.0 - tail))
    return low, high

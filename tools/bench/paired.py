"""Ratios to a reference measured in turns with it, and limits.

What else a machine does hits subject and reference alike: a ratio holds on any machine. asv counts
a benchmark above its limit as failed.
"""

from __future__ import annotations

import time
from collections.abc import Callable


class OverLimitError(AssertionError):
    """A figure is above its limit."""


def ratio(
    call: Callable[[], object],
    reference: Callable[[], object],
    *,
    repeats: int = 15,
    clock: Callable[[], float] = time.perf_counter,
) -> float:
    """Return the best time of a call over that of its reference, after one call of each."""
    reference()
    call()
    best = [float("inf"), float("inf")]
    for _ in range(repeats):
        for place, each in enumerate((reference, call)):
            started = clock()
            each()
            best[place] = min(best[place], clock() - started)
    return best[1] / best[0]


def at_most(limit: float | None, value: float) -> float:
    """Return the value.

    Raises
    ------
    OverLimitError
        Where it is above the limit or NaN; None is no limit.
    """
    if limit is not None and not value <= limit:
        raise OverLimitError(f"{value:.4g}, limit {limit:g}")
    return value

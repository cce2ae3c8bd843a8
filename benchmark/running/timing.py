"""Running times that can be compared: the reference interleaved, the best of a few."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

_REPEATS = 3
_ENOUGH_S = 0.03

T = TypeVar("T")


@dataclass(frozen=True)
class TimingResult:
    """Best wall time of a call and of the reference measured between the same repeats."""

    seconds: float
    reference_s: float


def best_of(call: Callable[[], T], reference: Callable[[], object]) -> tuple[T, TimingResult]:
    """Return the result of `call` and its best time of up to 3 runs.

    The reference runs before each. Slow calls run once: repeating stops when 0.03 s are spent.
    """
    best = best_reference = float("inf")
    spent = 0.0
    for _ in range(_REPEATS):
        reference_s, _ignored = _time(reference)
        seconds, result = _time(call)
        best = min(best, seconds)
        best_reference = min(best_reference, reference_s)
        spent += seconds + reference_s
        if spent > _ENOUGH_S:
            break
    return result, TimingResult(best, best_reference)


def best_time(call: Callable[[], T]) -> tuple[T, float]:
    """Return the result of `call` and its best time in seconds of up to 3 runs, as `best_of`."""
    result, timing = best_of(call, _nothing)
    return result, timing.seconds


def _nothing() -> None:
    """Take no time: for what is timed beside a reference measured already."""


def _time(call: Callable[[], T]) -> tuple[float, T]:
    started = time.perf_counter()
    result = call()
    return time.perf_counter() - started, result

"""Running times that can be compared: one thread, the reference interleaved, the best of a few."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TypeVar

_REPEATS = 3
_ENOUGH_S = 0.03

T = TypeVar("T")


@dataclass(frozen=True)
class Timing:
    """Best wall time of a call and of the reference measured between the same repeats."""

    seconds: float
    reference_s: float


def best_of(call: Callable[[], T], reference: Callable[[], object]) -> tuple[T, Timing]:
    """Return the result of `call` and its best time of up to 3 runs.

    The reference runs before each. Slow calls run once: repeating stops when 0.03 s are spent.
    """
    best = best_reference = float("inf")
    spent = 0.0
    for _ in range(_REPEATS):
        reference_s, _ignored = _timed(reference)
        seconds, result = _timed(call)
        best = min(best, seconds)
        best_reference = min(best_reference, reference_s)
        spent += seconds + reference_s
        if spent > _ENOUGH_S:
            break
    return result, Timing(best, best_reference)


def best_time(call: Callable[[], T]) -> tuple[T, float]:
    """Return the result of `call` and its best time in seconds of up to 3 runs, as `best_of`."""
    result, timing = best_of(call, _nothing)
    return result, timing.seconds


def _nothing() -> None:
    """Take no time: for what is timed beside a reference measured already."""


def _timed(call: Callable[[], T]) -> tuple[float, T]:
    started = time.perf_counter()
    result = call()
    return time.perf_counter() - started, result


@contextmanager
def one_thread() -> Iterator[None]:
    """One thread for BLAS and OpenCV: scores must not depend on the machine's number of cores."""
    import cv2  # noqa: PLC0415 - only the process that measures needs OpenCV

    opencv_threads = cv2.getNumThreads()
    blas = [(library, library.get()) for library in _bundled_blas()]
    cv2.setNumThreads(1)
    for library, _ in blas:
        library.set(1)
    try:
        yield
    finally:
        cv2.setNumThreads(opencv_threads)
        for library, count in blas:
            library.set(count)


@dataclass(frozen=True)
class _Blas:
    get: Callable[[], int]
    set: Callable[[int], object]


@cache
def _bundled_blas() -> tuple[_Blas, ...]:
    """OpenBLAS libraries that come inside the NumPy and SciPy wheels.

    A BLAS from elsewhere is set by the environment (``OMP_NUM_THREADS``, as the Makefile does).
    """
    found = []
    for package in ("numpy", "scipy"):
        spec = find_spec(package)
        if spec is None or spec.origin is None:
            continue
        for path in sorted(Path(spec.origin).parents[1].glob(f"{package}.libs/*openblas*")):
            library = ctypes.CDLL(str(path))
            for name in ("scipy_openblas_{}_num_threads64_", "scipy_openblas_{}_num_threads"):
                if hasattr(library, name.format("set")):
                    found.append(
                        _Blas(
                            getattr(library, name.format("get")),
                            getattr(library, name.format("set")),
                        )
                    )
                    break
    return tuple(found)

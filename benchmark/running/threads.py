"""One thread a worker: scores must not depend on the machine's number of cores."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold BLAS and OpenCV to one thread."""
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

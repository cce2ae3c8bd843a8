"""One thread a worker: scores must not depend on the machine's number of cores."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold BLAS to one thread, and OpenCV where it is loaded."""
    # Only the process that measures needs SciPy, which brings a BLAS of its own; what is not loaded
    # yet cannot be limited.
    import scipy.linalg  # noqa: F401, PLC0415

    opencv = sys.modules.get("cv2")  # no extractor loads it: see docs/decisions/opencv.md
    threads = opencv.getNumThreads() if opencv else None
    if opencv:
        opencv.setNumThreads(1)
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            yield
    finally:
        if opencv:
            opencv.setNumThreads(threads)

"""One thread a worker: scores must not depend on the machine's number of cores."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold BLAS and OpenCV to one thread."""
    # Only the process that measures needs these. SciPy brings a BLAS of its own, and what is not
    # loaded yet cannot be limited.
    import cv2  # noqa: PLC0415
    import scipy.linalg  # noqa: F401, PLC0415

    opencv_threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            yield
    finally:
        cv2.setNumThreads(opencv_threads)

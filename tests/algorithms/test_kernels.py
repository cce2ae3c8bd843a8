"""The compiled loops: quick beside OpenCV, right where nothing can be cached, on one thread."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import cv2
import numpy as np
import pytest

import algorithms
from algorithms.extractors.frames.centroid import (
    BasicCentroid,
    FilteredCentroid,
    ThresholdedCentroid,
)
from algorithms.extractors.frames.peak import PixelMax

ROOT = Path(algorithms.__file__).parent.parent


def opencv_loop(frames, threshold=0.3):
    found = np.empty((len(frames), 2))
    for k, frame in enumerate(frames):
        _, cut = cv2.threshold(frame, threshold * frame.max(), 0, cv2.THRESH_TOZERO)
        moments = cv2.moments(cut)
        found[k] = moments["m10"] / moments["m00"], moments["m01"] / moments["m00"]
    return found


@pytest.mark.parametrize(
    "extractor", [ThresholdedCentroid(), BasicCentroid(), FilteredCentroid(), PixelMax()], ids=str
)
def test_a_stack_takes_no_longer_than_a_loop_of_opencv(extractor):
    """Interleaved in one process, medians compared: measured 0.10 to 0.22, allowed 1.0."""
    rng = np.random.default_rng(0)
    y, x = np.mgrid[:64, :64]
    spot = 2000 * (np.hypot(x - 31.2, y - 30.7) < 8)
    frames = (spot + rng.normal(60, 10, (1000, 64, 64))).astype(np.uint16)
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        extractor.extract(frames[:2])
        opencv_loop(frames[:2])
        ours, loop = [], []
        for _ in range(7):
            start = time.perf_counter()
            extractor.extract(frames)
            middle = time.perf_counter()
            opencv_loop(frames)
            ours.append(middle - start)
            loop.append(time.perf_counter() - middle)
    finally:
        cv2.setNumThreads(threads)
    assert np.median(ours) <= np.median(loop)


def test_kernels_work_where_nothing_can_be_cached():
    """A read-only installation: Numba finds no place for its cache and says so with an error."""
    code = (
        "import numba, numpy as np\n"
        "real = numba.njit\n"
        "def without_cache(*args, **kwargs):\n"
        "    if kwargs.get('cache'):\n"
        "        raise RuntimeError('cannot cache function: no locator available')\n"
        "    return real(*args, **kwargs)\n"
        "numba.njit = lambda *a, **k: (lambda f: without_cache(*a, **k)(f))\n"
        "from algorithms.extractors.frames.peak import PixelMax\n"
        "frames = np.zeros((1, 4, 5), np.uint16); frames[0, 2, 3] = 7\n"
        "assert PixelMax().extract(frames).tolist() == [[3.0, 2.0]]\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT, timeout=120)


def test_numba_itself_refuses_to_cache_as_expected(tmp_path):
    """The error `compiled` answers is the one Numba raises when no cache place is writable."""
    module = tmp_path / "frozen.py"
    module.write_text("def twice(x):\n    return 2 * x\n")
    code = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from numba.core import caching\n"
        "caching.CacheImpl._locator_classes = []\n"
        "import frozen\n"
        "from algorithms.compiled import compiled\n"
        "assert compiled(frozen.twice)(21) == 42\n"
    )
    command = [sys.executable, "-c", code, str(tmp_path)]
    subprocess.run(command, check=True, cwd=ROOT, timeout=120)

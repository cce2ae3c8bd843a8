"""Measuring uses one thread: NumPy's and SciPy's own BLAS, and OpenCV."""

import os
import subprocess
import sys
from pathlib import Path

import cv2
import scipy.linalg  # noqa: F401 - brings a BLAS of its own
from threadpoolctl import threadpool_info, threadpool_limits

from algorithms.threads import one_thread


def threads():
    """Threads of NumPy's and SciPy's: OpenCV has had a BLAS that knows one only."""
    return {
        info["filepath"]: info["num_threads"]
        for info in threadpool_info()
        if Path(info["filepath"]).parent.name in {"numpy.libs", "scipy.libs"}
    }


def test_measuring_uses_one_thread_and_restores_the_number_after():
    with threadpool_limits(limits=2, user_api="blas"):
        before = threads()
        assert len(before) == 2
        assert set(before.values()) == {2}
        with one_thread():
            assert cv2.getNumThreads() == 1
            assert set(threads().values()) == {1}
        assert threads() == before


def test_a_blas_that_is_not_loaded_yet_is_held_to_one_thread_too():
    code = (
        "import sys\n"
        "from algorithms.threads import one_thread\n"
        "assert not {'numpy', 'scipy', 'cv2'} & set(sys.modules)\n"
        "with one_thread():\n"
        "    import scipy.linalg\n"
        "    from threadpoolctl import threadpool_info\n"
        "    found = threadpool_info()\n"
        "    assert any('scipy.libs' in info['filepath'] for info in found), found\n"
        "    assert {i['num_threads'] for i in found if i['user_api'] == 'blas'} == {1}, found\n"
    )
    environment = os.environ | {"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "2"}
    subprocess.run([sys.executable, "-c", code], check=True, env=environment, timeout=600)

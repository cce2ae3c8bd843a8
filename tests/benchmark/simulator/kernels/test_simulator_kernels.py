"""The simulator's compiled loops: where nothing can be cached, and what may be cached at all."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import benchmark

ROOT = Path(benchmark.__file__).parent.parent


@pytest.mark.slow
def test_kernels_work_where_no_cache_can_be_written():
    """A read-only installation and home: Numba has no place left where it could write."""
    code = (
        "import importlib, pkgutil\n"
        "from numba.core import caching\n"
        "caching.CacheImpl._locator_classes = []\n"
        "import numpy as np\n"
        "from benchmark.simulator import kernels\n"
        "for found in pkgutil.iter_modules(kernels.__path__):\n"
        "    importlib.import_module(f'{kernels.__name__}.{found.name}')\n"
        "from benchmark.simulator.kernels.areas import convex_area\n"
        "square = np.array([[-1.0, 0, 0], [1, 0, 3], [0, -1, 0], [0, 1, 2]])\n"
        "assert convex_area(square, np.empty((0, 3))) == 6.0\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT, timeout=600)

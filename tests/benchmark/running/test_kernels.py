"""Measuring as an older processor would: what the limited process is given, and what it finds."""

import json
import platform
import subprocess
import sys
from types import SimpleNamespace

import pytest

from benchmark.running import kernels
from benchmark.running.kernels import (
    NoOlderKernelsError,
    older_environment,
    update_with_older_kernels,
)

# What each library makes of its environment, in its own words.
FOUND = """
import ctypes, json, sys
from importlib.util import find_spec
from pathlib import Path
import cv2, numba, numpy
from numpy._core._multiarray_umath import __cpu_features__ as features

cores = set()
for path in Path(find_spec("numpy").origin).parents[1].glob("*.libs/*openblas*"):
    library = ctypes.CDLL(str(path))
    for name in ("scipy_openblas_get_corename64_", "scipy_openblas_get_corename"):
        if hasattr(library, name):
            call = getattr(library, name)
            call.restype = ctypes.c_char_p
            cores.add(call().decode())
            break
opencv = {cv2.getHardwareFeatureName(n) for n in range(512) if cv2.checkHardwareSupport(n)}
print(json.dumps({
    "numpy": sorted(name for name, on in features.items() if on),
    "openblas": sorted(cores),
    "opencv": sorted(opencv),
    "numba": numba.config.CPU_NAME,
}))
"""


@pytest.fixture
def called(monkeypatch):
    """Processes that would have been started; nothing is measured."""
    calls, answer = [], SimpleNamespace(returncode=0)

    def run(call, **options):
        calls.append((call, options))
        return answer

    monkeypatch.setattr(subprocess, "run", run)
    return calls, answer


def test_every_library_does_as_it_is_told():
    """A new process: none finds code of a later processor than one of 2013, and none complains."""
    if platform.machine().lower() not in {"x86_64", "amd64"}:
        with pytest.raises(NoOlderKernelsError):
            older_environment()
        return
    done = subprocess.run(
        [sys.executable, "-c", FOUND],
        env=older_environment(),
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == "", "a name that a library does not know switches nothing off"
    found = json.loads(done.stdout)
    assert found["openblas"] == ["Haswell"]
    assert found["numba"] == "haswell"
    later = set(kernels._beyond_avx2())
    assert not later & set(found["numpy"])
    assert not [name for name in found["opencv"] if name.startswith("AVX512-")]


def test_another_family_of_processors_is_told_before_anything_starts(tmp_path, called, monkeypatch):
    monkeypatch.setattr(platform, "machine", lambda: "aarch64")
    with pytest.raises(NoOlderKernelsError, match="this machine is aarch64"):
        update_with_older_kernels(tmp_path, 1)
    assert called[0] == []

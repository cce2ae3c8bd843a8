"""Measuring with the numerical kernels of an older processor, in a process of their own.

NumPy, OpenBLAS, OpenCV and Numba choose code by the processor they find, and sums in another
order have other last bits. What is published must not hang on them: a check measures once as this
machine does, and once as a processor of 2013 would (AVX2 and FMA, no AVX-512).
"""

from __future__ import annotations

import os
import platform
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from benchmark.processes import INTERRUPTED, TERMINATED, for_coordinator

#: What limits each library; read by it when it is loaded, so it takes a new process.
OLDER: Mapping[str, str] = {
    "OPENBLAS_CORETYPE": "Haswell",
    "NPY_DISABLE_CPU_FEATURES": "",  # filled in by `older_environment`
    "NUMBA_CPU_NAME": "haswell",
    "OPENCV_CPU_DISABLE": "",  # filled in by `older_environment`, too
}

#: Numbers that OpenCV may give to features of a processor (CV_HARDWARE_MAX_FEATURE).
OPENCV_FEATURES = 512


class NoOlderKernelsError(RuntimeError):
    """There are no older kernels on this machine to measure with; the message says why."""


class OlderRunError(RuntimeError):
    """The process with older kernels failed; what it said stands on standard error."""


def older_environment() -> dict[str, str]:
    """Return this process's environment with every library held to an older processor's code."""
    if platform.machine().lower() not in {"x86_64", "amd64"}:
        raise NoOlderKernelsError(
            f"older kernels are those of x86-64; this machine is {platform.machine()}"
        )
    return {
        **os.environ,
        **OLDER,
        "NPY_DISABLE_CPU_FEATURES": " ".join(_beyond_avx2()),
        "OPENCV_CPU_DISABLE": ",".join(_beyond_avx2_in_opencv()),
    }


def update_with_older_kernels(directory: Path, workers: int) -> None:
    """Bring a record up to date (`benchmark.leaderboard.update`) with an older processor's code.

    An empty directory is measured from nothing. KeyboardInterrupt when it was broken off.
    """
    call = [sys.executable, "-m", "benchmark.leaderboard", str(directory), str(workers)]
    environment = {**older_environment(), **for_coordinator()}
    # this program with a directory and a number: nothing of it comes from outside
    done = subprocess.run(call, env=environment, check=False)  # noqa: S603
    if done.returncode in (-signal.SIGINT, INTERRUPTED, TERMINATED):
        raise KeyboardInterrupt
    if done.returncode != 0:
        raise OlderRunError(f"measuring with older kernels ended with code {done.returncode}")


def _beyond_avx2() -> list[str]:
    """Names of the groups of instructions that NumPy found here and that came after AVX2."""
    config: Any = np.show_config(mode="dicts")
    found: list[str] = config["SIMD Extensions"].get("found", [])
    return [name for name in found if name == "X86_V4" or name.startswith("AVX512")]


def _beyond_avx2_in_opencv() -> list[str]:
    """Names of what OpenCV found here and that came after AVX2; it complains of any other name."""
    disabled = os.environ.get("OPENCV_CPU_DISABLE", "")  # switched off already, hence not found
    return sorted({name for name in disabled.split(",") if name} | set(_found_by_opencv()))


def _found_by_opencv() -> list[str]:
    names = (
        cv2.getHardwareFeatureName(number)
        for number in range(OPENCV_FEATURES)
        if cv2.checkHardwareSupport(number)
    )
    return [name for name in names if name.startswith("AVX512-")]

"""Kernels compiled ahead are read from disk by every later process."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

PARTS = """
from algorithms.extractors.profiles.centroid import ProfileCentroid
from algorithms.models.non_physical.linear import LinearFit
from benchmark import datasets
from benchmark.plan.parts import Parts
presets = {"pda-slit": datasets.get("pda-slit")}
parts = Parts(presets, {"bcm-profile": ProfileCentroid}, {"linear": LinearFit})
"""


def run(code: str, cache: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", PARTS + code],
        env={**os.environ, "NUMBA_CACHE_DIR": str(cache)},
        capture_output=True,
        text=True,
        check=True,
        timeout=600,
    )
    return done.stdout


@pytest.mark.slow
def test_what_was_compiled_ahead_is_not_compiled_again(tmp_path: Path) -> None:
    ahead = (
        "from benchmark.running.compiling import compile_kernels\n"
        "print(compile_kernels(parts=parts))"
    )
    later = """
import json, sys
from dataclasses import replace
from numba.core.dispatcher import Dispatcher
pda = presets["pda-slit"]
samples = pda.generate("nominal", "calibration", 1)
ProfileCentroid.for_sensor(pda.geometry).extract(samples.observations)
setup = pda.setups["nominal"]
plain = replace(setup, sensor=replace(setup.sensor, spectrum=None))
replace(pda, setups={"nominal": plain}).generate("nominal", "test", 1)
stats = [
    kernel.stats
    for name, module in list(sys.modules.items())
    if name.startswith(("algorithms", "benchmark"))
    for kernel in vars(module).values()
    if isinstance(kernel, Dispatcher)
]
hits = sum(sum(one.cache_hits.values()) for one in stats)
misses = sum(sum(one.cache_misses.values()) for one in stats)
print(json.dumps([hits, misses]))
"""
    assert run(ahead, tmp_path) == "3\n"  # a data set, an extractor and a model
    hits, misses = json.loads(run(later, tmp_path))
    assert hits > 3
    assert misses == 0

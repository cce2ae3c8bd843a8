"""Calibration benches that are drawn anew: their directions, and what they add to an error.

The readings of a calibration stay as they are; what changes is where a bench says that the Sun or
the lamp stood. A preset's own bench is one draw of many: conclusions rest on many.
"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from algorithms.contract import Floats
from benchmark.metrics.separation import aligned_error_deg

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

#: Benches that are drawn to say what alignment leaves of their errors, and directions looked at.
_DRAWN, _DIRECTIONS = 40, 200


def report(preset: Preset, condition: str, sun: Floats, draw: int) -> Floats:
    """Return the directions (N, 3) that a drawn bench gives for true ones (N, 3).

    Benches are numbered from 0; each unit has its own, which are the same for every data set, so
    that errors on them compare. True directions where the condition has no bench.
    """
    bench = _bench(preset, condition)
    if bench is None:
        return sun
    return np.asarray(bench.report(sun, "bench", "drawn", preset.unit, draw))


def aligned_bench_deg(preset: Preset, condition: str, sun: Floats) -> float:
    """Return what the best rotation leaves of the fixed errors of a bench, root mean square.

    Over benches that are drawn for it and at most 200 of the directions (N, 3); 0 without a bench.
    """
    bench = _bench(preset, condition)
    if bench is None:
        return 0.0
    sizes = {f.name: 0.0 for f in dataclasses.fields(bench) if f.name.endswith("_random_deg")}
    fixed = dataclasses.replace(bench, **sizes)
    seen = sun[:: max(1, len(sun) // _DIRECTIONS)]
    reports = (fixed.report(seen, "bench", "aligned", draw) for draw in range(_DRAWN))
    left = [aligned_error_deg(one, seen) for one in reports]
    return math.sqrt(float(np.mean(np.square(left))))


def _bench(preset: Preset, condition: str) -> Any:
    return cast("Any", preset).condition(condition).bench

"""C25: a calibration on the ground and an EKF in orbit, on faces that drift (Radan2019).

The photodiode cube in orbit, its gains moving with temperature and age: `assembled-faces` behind
`sun-and-earth`, which stay as they were calibrated, and `assembly-drift`, which goes on
calibrating; both know the nadir and take the Earth's light off. Both learn from the same three
orbits; the test begins a quarter of a year later. Samples in sunlight that both answer.
"""

from __future__ import annotations

import numpy as np

from algorithms.chain import Chain
from algorithms.compensations.interference.sun_and_earth import SunAndEarth
from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.filters.assembly_drift import AssemblyDriftFilter
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from benchmark.claims.benches import Seen, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.coarse.in_sunlight import orbits_since
from benchmark.datasets.standard import pd_orbit

EDGES = np.arange(0.0, 3.01, 0.25)


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = Seen(pd_orbit.PRESET, "nominal", number)
    static = seen.errors(DirectSignals, Chain((SunAndEarth,), AssembledFaces))
    tracked = seen.errors(DirectSignals, AssemblyDriftFilter)
    both = np.isfinite(static) & np.isfinite(tracked)
    since = orbits_since(seen)
    errors = {
        "static calibration": np.where(both, static, np.nan),
        "assembly-drift": np.where(both, tracked, np.nan),
    }
    slopes = [_slope(since, found) for found in errors.values()]
    values = {
        "corrects": ratio(*(rms(found, since >= 2.0) for found in errors.values())),
        "drift": slopes[1] / slopes[0] if slopes[0] > 0 else float("nan"),
    }
    lines = {name: (middles(EDGES), rms_within(e, since, EDGES)) for name, e in errors.items()}
    return Trial(values, lines)


def _slope(since: Floats, errors: Floats) -> float:
    """Of the errors over the orbits, deg an orbit, from whole orbits: the attitude repeats."""
    each = [rms(errors, (since >= k) & (since < k + 1)) for k in range(3)]
    return float(np.polyfit(range(3), each, 1)[0])

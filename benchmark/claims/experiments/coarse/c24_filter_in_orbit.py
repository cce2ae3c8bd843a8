"""C24: a consider Kalman filter in orbit against each sample by itself (OKeefe2017).

The photodiode cube in orbit: `consider-kalman` and the least-squares direction of every single
sample (`assembled-faces`), which is given what the filter has too: the nadir, and with it the
Earth's light taken off (`sun-and-earth`). Both are calibrated on the same three orbits and tested a
quarter of a year later, over samples in sunlight that both answer. `basic`, which knows nothing of
response and Earth, is drawn beside them.
"""

from __future__ import annotations

import numpy as np

from algorithms.chain import Chain, Scored
from algorithms.compensations.interference.sun_and_earth import SunAndEarth
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.filters.consider import ConsiderKalmanFilter
from algorithms.models.geometric.multisensor_fusion import SixFaces
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from benchmark.claims.benches import Seen, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.coarse.in_sunlight import orbits_since
from benchmark.datasets.standard import pd_orbit

METHODS: dict[str, Scored] = {
    "consider-kalman": ConsiderKalmanFilter,
    "least squares, sample by sample": Chain((SunAndEarth,), AssembledFaces),
    "basic, sample by sample": SixFaces,
}
EDGES = np.arange(0.0, 3.01, 0.25)


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = Seen(pd_orbit.PRESET, "nominal", number)
    errors = {name: seen.errors(DirectSignals, method) for name, method in METHODS.items()}
    filtered, single, _ = errors.values()
    both = np.isfinite(filtered) & np.isfinite(single)
    since = orbits_since(seen)
    lines = {name: (middles(EDGES), rms_within(e, since, EDGES)) for name, e in errors.items()}
    return Trial({"filter": ratio(rms(single, both), rms(filtered, both))}, lines)

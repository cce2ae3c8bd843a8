"""C26: what albedo can cost an analog sensor at worst (Soken2023).

The photodiode cube in orbit, every face calibrated over a black Earth, then flown over the sunlit
one: the largest error of the first orbit's sunlit samples. The same orbit over a black Earth tells
what is not albedo.
"""

from __future__ import annotations

import itertools

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from benchmark.claims.benches import Seen, middles
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.coarse.in_sunlight import orbits_since
from benchmark.datasets.standard import pd_orbit

EDGES = np.linspace(0.0, 1.0, 13)


def trial(number: int) -> Trial:
    """Measure one unit."""
    bare, earth = (Seen(pd_orbit.PRESET, c, number) for c in ("no-albedo", "nominal"))
    calibrated = bare.calibrated(DirectSignals, AssembledFaces)
    errors = {
        "sunlit Earth": earth.errors_of(calibrated, DirectSignals),
        "black Earth": bare.errors_of(calibrated, DirectSignals),
    }
    since = orbits_since(earth)
    worst = float(np.nanmax(np.where(since < 1.0, errors["sunlit Earth"], np.nan)))
    lines = {n: (middles(EDGES), _largest(e, since)) for n, e in errors.items()}
    return Trial({"size": worst}, lines)


def _largest(errors: Floats, since: Floats) -> list[float]:
    found = []
    for low, high in itertools.pairwise(EDGES):
        chosen = errors[(low <= since) & (since < high) & np.isfinite(errors)]
        found.append(float(chosen.max()) if len(chosen) else float("nan"))
    return found

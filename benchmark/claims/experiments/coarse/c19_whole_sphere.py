"""C19: weighting solar cells all over a sphere and leaving grazing ones out (Zhang2022b).

`panoramic` weighted by signal, cells beyond 75 deg of incidence left out, against equal weights
with every cell down to 89 deg. Whether the whole sphere is covered is asked of 4000 evenly spread
directions beside the test split, whether the answer is continuous along six great circles walked
in steps of 0.25 deg, noiseless, so that a step of the answer is the model's and not the noise's.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.geometric.detector_faces import directions
from algorithms.models.geometric.panoramic import WeightedCells
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within, separation
from benchmark.claims.experiment import Sketch, Trial
from benchmark.datasets.standard import pva_maskless_sphere
from benchmark.simulator.readout.detectors import RESPONSES

PRESET = pva_maskless_sphere.PRESET
NORMALS = np.asarray(PRESET.geometry.face_normals)
SKETCH = Sketch(log_up=True)
BANDS = np.linspace(-90.0, 90.0, 10)
_STEP_DEG = 0.25
_CIRCLES = 6


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(PRESET, "nominal", number)
    weighted = WeightedCells(PRESET.geometry.face_normals or ())
    equal = replace(weighted, weighting="equal", largest_incidence_deg=89.0)
    errors = {
        "weighted, grazing cells left out": seen.errors(DirectSignals, weighted),
        "equal weights, every lit cell": seen.errors(DirectSignals, equal),
    }
    ours, plain = errors.values()
    everywhere = directions(None)
    full = weighted.reference_
    answered = np.isfinite(weighted.predict(full * _noiseless(everywhere))).all(axis=1)
    solved = (answered.mean() + np.isfinite(ours).mean()) / 2.0
    steps = [_largest_step(weighted, full, k) for k in range(_CIRCLES)]
    values = {
        "solved": float(solved),
        "weighting": ratio(rms(plain), rms(ours)),
        "continuous": max(steps),
    }
    elevation = np.degrees(np.arcsin(np.clip(seen.samples("test").sun[:, 2], -1.0, 1.0)))
    lines = {n: (middles(BANDS), rms_within(e, elevation, BANDS)) for n, e in errors.items()}
    return Trial(values, lines)


def _noiseless(sun: Floats) -> Floats:
    return np.asarray(RESPONSES["kelly"](sun @ NORMALS.T))


def _largest_step(model: WeightedCells, full: Floats, circle: int) -> float:
    """Largest step of the answer over the Sun's, along a great circle tilted from the others."""
    turn = np.radians(np.arange(0.0, 360.0 + _STEP_DEG, _STEP_DEG))
    tilt = np.pi * circle / _CIRCLES
    first = np.array([np.cos(tilt), 0.0, -np.sin(tilt)])
    sun = np.outer(np.cos(turn), first) + np.outer(np.sin(turn), [0.0, 1.0, 0.0])
    said = model.predict(full * _noiseless(sun))
    return float(np.nanmax(separation(said[1:], said[:-1])) / _STEP_DEG)

"""C19: weighting solar cells all over a sphere and leaving grazing ones out (Zhang2022b).

`panoramic` weighted by signal, cells beyond 75 deg of incidence left out, against equal weights
with every cell down to 89 deg. Whether the whole sphere is covered is asked of 4000 evenly spread
directions beside the test split, noiseless. "Continuous" is said of the coverage, so that no
statistic is about steps of the answer.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.geometric.detector_faces import directions
from algorithms.models.geometric.panoramic import WeightedCells
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Sketch, Trial
from benchmark.datasets.standard import pva_maskless_sphere
from benchmark.simulator.readout.detectors import RESPONSES

PRESET = pva_maskless_sphere.PRESET
NORMALS = np.asarray(PRESET.geometry.face_normals)
SKETCH = Sketch(log_up=True)
BANDS = np.linspace(-90.0, 90.0, 10)


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
    values = {"solved": float(solved), "weighting": ratio(rms(plain), rms(ours))}
    elevation = np.degrees(np.arcsin(np.clip(seen.samples("test").sun[:, 2], -1.0, 1.0)))
    lines = {n: (middles(BANDS), rms_within(e, elevation, BANDS)) for n, e in errors.items()}
    return Trial(values, lines)


def _noiseless(sun: Floats) -> Floats:
    return np.asarray(RESPONSES["kelly"](sun @ NORMALS.T))

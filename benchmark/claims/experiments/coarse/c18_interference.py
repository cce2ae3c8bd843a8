"""C18: interference on a pyramid of photodiodes (Wang2019).

Wang2019's pyramid is meant to be immune to interference that all faces see alike, and to noise of
zero mean. The same currents, with a constant, or with a random part of zero mean, added after the
calibration, go through the printed three rows (`pyramidal`), which are least squares over the
faces, and through the two rows in which a constant cancels (`pyramidal-constant`), each calibrated
without interference. Measured is the angle by which the interference moves an answer, so that the
faces' angular response, which both leave, does not count. Samples are those that both answer
without interference; a direction that one gives up counts as its farthest moved one, so that
silence is no merit.
"""

from __future__ import annotations

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Floats, Model
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.geometric.pyramidal import RegularPyramid
from algorithms.models.geometric.pyramidal_constant import SteadyPyramid
from benchmark.claims.benches import ConditionView, ratio, rms, separation
from benchmark.claims.experiment import Sketch, Trial
from benchmark.datasets.standard import pd_maskless_pyramid
from benchmark.seeds import generator

SKETCH = Sketch(log_x=True)
SHARES = (0.005, 0.01, 0.02, 0.05, 0.1)
#: At which the rules are judged.
JUDGED = 0.05
METHODS: dict[str, Scored] = {"pyramidal": RegularPyramid, "pyramidal-constant": SteadyPyramid}


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(pd_maskless_pyramid.PRESET, "nominal", number)
    features = seen.features(DirectSignals, "test")
    models = {n: seen.calibrate(DirectSignals, method).model for n, method in METHODS.items()}
    clean = {n: model.predict(features) for n, model in models.items()}
    both = np.isfinite(list(clean.values())).all(axis=(0, 2))
    full = float(np.max(features))
    noise = generator("claims", "C18", number).standard_normal(features.shape)
    added = {"constant": np.ones_like(features), "zero mean": noise}
    found = {
        (kind, name): [
            _moved(model, features[both] + share * full * shape[both], clean[name][both])
            for share in SHARES
        ]
        for kind, shape in added.items()
        for name, model in models.items()
    }
    at = SHARES.index(JUDGED)
    values = {
        rule: ratio(found[kind, "pyramidal-constant"][at], found[kind, "pyramidal"][at])
        for rule, kind in (("constant", "constant"), ("zero-mean", "zero mean"))
    }
    lines = {f"{name}, {kind}": (SHARES, moved) for (kind, name), moved in found.items()}
    return Trial(values, lines)


def _moved(model: Model, features: Floats, clean: Floats) -> float:
    """RMS angle in degrees from the answers without interference."""
    moved = separation(model.predict(features), clean)
    if not np.isfinite(moved).any():
        return float("nan")
    return rms(np.where(np.isfinite(moved), moved, np.nanmax(moved)))

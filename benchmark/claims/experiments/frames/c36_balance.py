"""C36: how straight the balance of a quadrant photodiode is in the tangent (Boslooper2017).

Of each axis the balance over the Suns of the test split is compared with its own best line in the
tangent of that axis; offsets and gains of a unit are the line's. Full scale is a balance of one:
all light on one half. The second method is the closed form of a square spot on four quadrants with
a gap, which the detector's rim cuts, for the same Suns and the design's dimensions.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import VoltageBalance
from benchmark.claims.benches import ConditionView, middles
from benchmark.claims.experiment import Sketch, Trial
from benchmark.datasets.standard.qpd_single_aperture import PRESET

SKETCH = Sketch()

INNER_DEG = 30.0
#: Of the tangent, for the line of the plot.
EDGES = np.linspace(-0.84, 0.84, 15)
#: The design's aperture, focal length, half width of the detector and gap, mm.
_WIDTH, _HEIGHT, _HALF, _GAP = 2.0, 1.0, 1.8, 0.05


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(PRESET, unit=number)
    sun = seen.samples("test").sun
    # the balance along x goes with tan(beta) = s_x / s_z
    tangents = sun[:, :2] / sun[:, 2:]
    inner = seen.incidence_deg() <= INNER_DEG
    lines, said = {}, {}
    for name, balance in (
        ("simulated unit", seen.features(VoltageBalance, "test")),
        ("closed form", _closed_form(tangents)),
    ):
        off = _departures(tangents, balance)
        said[name] = {
            "full": _rms(off),
            "inner": _rms(_departures(tangents[inner], balance[inner])),
        }
        lines[name] = (middles(EDGES), _along(tangents, off))
    return Trial(said["simulated unit"], lines, said["closed form"])


def _departures(tangents: Floats, balance: Floats) -> Floats:
    """Balances (N, 2) less each axis's line by least squares."""
    off = np.empty_like(balance)
    for axis in (0, 1):
        gain, offset = np.polyfit(tangents[:, axis], balance[:, axis], 1)
        off[:, axis] = balance[:, axis] - offset - gain * tangents[:, axis]
    return off


def _along(tangents: Floats, off: Floats) -> list[float]:
    """Root mean square departure between neighbouring edges."""
    part = np.digitize(tangents, EDGES) - 1
    return [_rms(off[part == k]) for k in range(len(EDGES) - 1)]


def _rms(values: Floats) -> float:
    return math.sqrt(float(np.mean(values**2))) if values.size else math.nan


def _closed_form(tangents: Floats) -> Floats:
    middle = _HEIGHT * tangents
    low = np.maximum(middle - _WIDTH / 2.0, -_HALF)
    high = np.minimum(middle + _WIDTH / 2.0, _HALF)
    above = np.maximum(high - np.maximum(low, _GAP / 2.0), 0.0)
    below = np.maximum(np.minimum(high, -_GAP / 2.0) - low, 0.0)
    return np.asarray((above - below) / (above + below))

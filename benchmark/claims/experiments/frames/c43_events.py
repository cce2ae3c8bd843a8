"""C43: the mean of time-stamped events beside the winners' address (Farian2022).

Twice: `event-single-aperture` seen by each unit at 150 directions, both methods calibrated by the
pinhole model at 169 poses, errors in degrees; and single spots of the same size as events with 1 %
jitter, errors in pixels, which the lines show for arrays that are reset after so many events.
"Beats" is the geometric mean of both ratios at 20 events. Times are for these 20 events and for the
frame of 64 x 64 px that the same spot makes.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.extractors.events.centroid import EventCentroid, EventWinner
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.geometric.pinhole import BuiltPinhole
from benchmark.claims.benches import ConditionView, ratio, rms, times_s
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import error_px
from benchmark.datasets.fields import AngleField
from benchmark.datasets.standard import event_single_aperture
from benchmark.seeds import generator
from benchmark.synthetic_features.light import spots

SKETCH = Sketch(log_across=True)

NUMBERS = (5, 7, 10, 14, 20, 28, 40)
EVENTS = 20
#: Fewer poses and Suns than the standard data set, whose light takes a minute to make.
PRESET = replace(
    event_single_aperture.PRESET, directions=AngleField(50.0, steps=13, test_samples=150)
)
_SPOTS, _SIZE_PX, _RADIUS_PX, _RANGE_PX = 200, 64, 2.0, 10.0
#: Time of a fully lit pixel, light of an unlit one, and scatter of the times.
_LIT_US, _STRAY, _JITTER = 100.0, 0.002, 0.01


def trial(number: int) -> Trial:
    """Measure one unit of the sensor and one draw of spots."""
    seen = ConditionView(PRESET, unit=number)
    mean, winner = (m.for_sensor(PRESET.geometry) for m in (EventCentroid, EventWinner))
    unit = ratio(*(rms(seen.errors(m, BuiltPinhole)) for m in (EventWinner, EventCentroid)))
    rng = generator("claims", "C43", number)
    centres = (_SIZE_PX - 1) / 2.0 + rng.uniform(-_RANGE_PX, _RANGE_PX, (_SPOTS, 2))
    light = spots(_SIZE_PX, centres[:, None], _RADIUS_PX, "flat")
    events = _events(light, rng)
    errors = {
        name: [error_px(method.extract(events[:, :n]), centres) for n in NUMBERS]
        for name, method in (("escm", mean), ("escm-wta", winner))
    }
    at = NUMBERS.index(EVENTS)
    first = events[:, :EVENTS].copy()
    frames = np.rint(200.0 + 2000.0 * light + 10.0 * rng.standard_normal(light.shape))
    read: NDArray[np.uint16] = frames.astype(np.uint16)
    bctm = ThresholdedCentroid()
    times = times_s(escm=lambda: mean.extract(first), bctm=lambda: bctm.extract(read))
    values = {
        "beats": math.sqrt(unit * ratio(errors["escm-wta"][at], errors["escm"][at])),
        "latency": ratio(times["escm"], times["bctm"]),
    }
    return Trial(values, {name: (NUMBERS, along) for name, along in errors.items()})


def _events(light: Floats, rng: np.random.Generator) -> Floats:
    """(N, M, 3) column, row and time of the first pixels to fire."""
    times = (_LIT_US / (light + _STRAY)).reshape(len(light), -1)
    times *= 1.0 + _JITTER * rng.standard_normal(times.shape)
    first = np.argsort(times, axis=1, kind="stable")[:, : NUMBERS[-1]]
    stamps = np.take_along_axis(times, first, axis=1)
    return np.stack([first % _SIZE_PX, first // _SIZE_PX, stamps], axis=2).astype(np.float64)

"""C24: what a consider Kalman filter in orbit gains against noise (OKeefe2017).

The photodiode cube in orbit. `consider-kalman` is set beside itself without a memory: the same
fit, with the same readings, Earth's light, temperature and rates, but a direction that is taken to
wander by a radian from sample to sample, so that every sample is a least-squares answer of its
own. Both are given the true directions in their calibration and tested a quarter of a year later,
over samples in sunlight that both answer. Once as it is, once with ten times the noise, which is
what a filter is for. `sun-and-earth` and `assembled-faces`, which know less, are drawn beside them.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np

from algorithms.chain import Chain
from algorithms.compensations.interference.sun_and_earth import SunAndEarth
from algorithms.contract import FeatureKind, Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.filters import ConsiderKalmanFilter
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within, separation
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.coarse.in_sunlight import orbits_since
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.standard import pd_orbit

EDGES = np.arange(0.0, 3.01, 0.25)
#: Some radian a step: what the last sample said of this one is worth nothing.
FORGETFUL_DEG_SQRT_H = 1000.0


@dataclass(frozen=True)
class _Pair:
    """RMS errors in degrees of the filter and of itself without a memory, on the same samples."""

    filtered: float
    single: float


def trial(number: int) -> Trial:
    """Measure one unit."""
    preset = with_true_directions(pd_orbit.PRESET)
    seen = {c: ConditionView(preset, c, number) for c in ("nominal", "high-noise")}
    errors = {condition: _errors(one) for condition, one in seen.items()}
    pairs = {condition: _pair(*two) for condition, two in errors.items()}
    since = orbits_since(seen["nominal"])
    less = seen["nominal"].errors(DirectSignals, Chain((SunAndEarth,), AssembledFaces))
    drawn = dict(
        zip(("consider-kalman", "the same, sample by sample"), errors["nominal"], strict=True)
    )
    drawn["assembled-faces, sample by sample"] = less
    return Trial(
        values(pairs["nominal"], pairs["high-noise"]),
        {name: (middles(EDGES), rms_within(e, since, EDGES)) for name, e in drawn.items()},
    )


def values(nominal: _Pair, noisy: _Pair) -> dict[str, float]:
    """Give the rules' statistics: a ratio of errors, and of what noise adds to their squares."""
    return {
        "filter": ratio(nominal.single, nominal.filtered),
        "noise": ratio(
            noisy.filtered**2 - nominal.filtered**2, noisy.single**2 - nominal.single**2
        ),
    }


def _errors(seen: ConditionView) -> tuple[Floats, Floats]:
    """Errors (N,) of the filter, and of itself without a memory."""
    known, tested = seen.samples("calibration"), seen.samples("test")
    geometry = seen.preset.geometry_for(seen.condition)
    filtered = ConsiderKalmanFilter.for_sensor(geometry, FeatureKind.SIGNALS)
    filtered.fit(seen.features(DirectSignals, "calibration"), known.sun, known.context)
    single = copy.copy(filtered)  # of the same readings and noise
    single.angle_walk_deg_sqrt_h = FORGETFUL_DEG_SQRT_H
    asked = seen.features(DirectSignals, "test")
    first, second = (
        separation(model.predict(asked, tested.context), tested.sun) for model in (filtered, single)
    )
    return first, second


def _pair(filtered: Floats, single: Floats) -> _Pair:
    both = np.isfinite(filtered) & np.isfinite(single)
    return _Pair(rms(filtered, both), rms(single, both))

"""C25: what an EKF that estimates the assembly in orbit gains over one that does not (Radan2019).

A linear CCD under a filter in orbit, whose head tilts, shifts and lengthens, as the study has it.
`assembly-drift` carries the assembly in its state; the other is `extended-kalman`, the same filter
of the same readings, light, temperature and rates, whose assembly stays as the calibration found
it. Both learn from the same three orbits, given the true directions, and are tested a quarter of a
year later over samples in sunlight that both answer. The same flight without drift and ageing tells
how much of the error is drift.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.extractors.profiles.peak_position import PeakPositionEstimate
from algorithms.models.filters import AssemblyDriftFilter, ExtendedKalmanFilter
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Line, Trial
from benchmark.claims.experiments.coarse.in_sunlight import orbits_since
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.standard import ccd_multi_slit_orbit

EDGES = np.arange(0.0, 3.01, 0.25)


@dataclass(frozen=True)
class _Pair:
    """RMS errors in degrees of both filters on the same samples: of all, and of the last orbit."""

    kept: float
    tracked: float
    kept_last: float
    tracked_last: float


def trial(number: int) -> Trial:
    """Measure one unit."""
    lines: dict[str, Line] = {}
    drifting = _pair("nominal", number, lines)
    return Trial(values(drifting, _pair("stable", number, {})), lines)


def values(drifting: _Pair, stable: _Pair) -> dict[str, float]:
    """Give the rules' statistics from the sensor as it drifts, and as it does not."""
    tracked = drifting.tracked**2 - stable.tracked**2
    kept = drifting.kept**2 - stable.kept**2
    return {
        "corrects": ratio(drifting.kept_last, drifting.tracked_last),
        "drift": ratio(tracked, kept),
    }


def _pair(condition: str, number: int, lines: dict[str, Line]) -> _Pair:
    seen = ConditionView(with_true_directions(ccd_multi_slit_orbit.PRESET), condition, number)
    kept, tracked = (
        seen.errors(PeakPositionEstimate, model)
        for model in (ExtendedKalmanFilter, AssemblyDriftFilter)
    )
    both, since = np.isfinite(kept) & np.isfinite(tracked), orbits_since(seen)
    for name, found in (("assembly as calibrated", kept), ("assembly-drift", tracked)):
        within = rms_within(np.where(both, found, np.nan), since, EDGES)
        lines[name] = (middles(EDGES), within)
    last = both & (since >= 2.0)
    return _Pair(rms(kept, both), rms(tracked, both), rms(kept, last), rms(tracked, last))

"""C25: what an EKF that estimates the assembly in orbit gains over one that does not (Radan2019).

Two sensors in orbit: the CCD behind a hole, whose head tilts, shifts and lengthens, and the
photodiode cube, whose gains move. `assembly-drift` carries the assembly in its state; the other is
`extended-kalman`, the same filter of the same readings, light, temperature and rates, whose
assembly stays as the calibration found it. Both learn from the same three orbits, given the true
directions, and are tested a quarter of a year later over samples in sunlight that both answer. The
same flights without drift and ageing tell how much of the error is drift; on the cube that is too
little to tell, so that the CCD alone decides of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Extractor
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.models.filters import AssemblyDriftFilter, ExtendedKalmanFilter
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Line, Trial
from benchmark.claims.experiments.coarse.in_sunlight import orbits_since
from benchmark.claims.experiments.fits.means import geometric
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import ccd_orbit, pd_orbit

EDGES = np.arange(0.0, 3.01, 0.25)


@dataclass(frozen=True)
class Pair:
    """RMS errors in degrees of both filters on the same samples: of all, and of the last orbit."""

    kept: float
    tracked: float
    kept_last: float
    tracked_last: float


def trial(number: int) -> Trial:
    """Measure one unit of both sensors."""
    lines: dict[str, Line] = {}
    cube = _pair(pd_orbit.PRESET, "nominal", DirectSignals, number, lines)
    camera = _pair(ccd_orbit.PRESET, "nominal", ThresholdedCentroid, number, lines)
    stable = _pair(ccd_orbit.PRESET, "stable", ThresholdedCentroid, number, {})
    return Trial(values(cube, camera, stable), lines)


def values(cube: Pair, camera: Pair, stable: Pair) -> dict[str, float]:
    """Give the rules' statistics from both sensors as they drift, and the camera as it does not."""
    return {
        "corrects": geometric([ratio(one.kept_last, one.tracked_last) for one in (cube, camera)]),
        "drift": ratio(camera.tracked**2 - stable.tracked**2, camera.kept**2 - stable.kept**2),
    }


def _pair(
    preset: Preset,
    condition: str,
    extractor: type[Extractor],
    number: int,
    lines: dict[str, Line],
) -> Pair:
    seen = ConditionView(with_true_directions(preset), condition, number)
    kept, tracked = (
        seen.errors(extractor, model) for model in (ExtendedKalmanFilter, AssemblyDriftFilter)
    )
    both, since = np.isfinite(kept) & np.isfinite(tracked), orbits_since(seen)
    for name, found in (("assembly as calibrated", kept), ("assembly-drift", tracked)):
        within = rms_within(np.where(both, found, np.nan), since, EDGES)
        lines[f"{preset.name}, {name}"] = (middles(EDGES), within)
    last = both & (since >= 2.0)
    return Pair(rms(kept, both), rms(tracked, both), rms(kept, last), rms(tracked, last))

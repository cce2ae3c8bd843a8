"""C34: a network beside a sensor model where the sensor departs from the model (Rufino2009b).

Centroids of `cmos-multi-aperture` (MCAM, as the study's) calibrate `ann`, one hidden layer, and
`lsq`, the five numbers of a pinhole with its boresight. To the centroids a smooth distortion is
added that no pinhole has: along each axis one wave over the calibrated range, of either coordinate,
with phases drawn for each unit. The rule takes a height of one pixel; lines show others, and none.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from algorithms.models.neural_network.axis_networks import AxisNetworks
from benchmark.claims.benches import ConditionView, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.fits.poses import Poses, errors
from benchmark.datasets.standard import cmos_multi_aperture
from benchmark.seeds import generator

HEIGHTS_PX = (0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
#: Of the rule.
ADDED_PX = 1.0


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(cmos_multi_aperture.PRESET, unit=number)
    known, asked = (Poses.of(seen, MultipleCentroids, s) for s in ("calibration", "test"))
    phases = generator("claims", "C34", number).uniform(0.0, 2.0 * np.pi, (2, 2))
    low, high = (end(known.features, axis=0) for end in (np.nanmin, np.nanmax))

    def bent(poses: Poses, height: float) -> Poses:
        turns = 2.0 * np.pi * (poses.features - low) / (high - low)
        return poses.shift(height * _wave(turns, phases))

    model = LeastSquaresGeometry.for_sensor(seen.preset.geometry, MultipleCentroids.about.kind)
    networks, pinholes = (
        [rms(errors(fitted, bent(known, h), bent(asked, h))) for h in HEIGHTS_PX]
        for fitted in (AxisNetworks(), model)
    )
    at, none = HEIGHTS_PX.index(ADDED_PX), HEIGHTS_PX.index(0.0)
    return Trial(
        {
            "unmodelled": ratio(pinholes[at], networks[at]),
            "without": ratio(networks[none], pinholes[none]),
        },
        {"ann": (HEIGHTS_PX, networks), "lsq": (HEIGHTS_PX, pinholes)},
    )


def _wave(turns: Floats, phases: Floats) -> Floats:
    """(N, 2) of height one: each coordinate is moved by a wave of both."""
    return np.asarray(
        np.sin(turns + phases[0]) * np.cos(turns[:, ::-1] / 2.0 + phases[1]), dtype=np.float64
    )

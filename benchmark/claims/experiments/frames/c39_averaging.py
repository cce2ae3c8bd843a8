"""C39: the error of averaged centroids against the number of spots (Rufino2009b).

The same grid of 1 to 10 x 10 spots; the exponent is that of a power law through all numbers. The
second method fits single spots, each drawn in a frame of its own with noise of its own, by least
squares with a rendered disc, and averages their errors.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from benchmark.claims.benches import exponent
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import error_px
from benchmark.claims.experiments.frames.spot_grids import (
    RADIUS_PX,
    grid_frames,
    grid_geometry,
    middles_px,
    present,
)
from benchmark.seeds import generator
from benchmark.synthetic_features.light import BACKGROUND_E, READ_NOISE_E, detect, peak_e, spots
from benchmark.synthetic_features.series import REFERENCE_SNR

SKETCH = Sketch(log_x=True)

SIDES = (1, 2, 3, 4, 5, 7, 10)
NUMBERS = tuple(side * side for side in SIDES)
FRAMES = 40

_APART, _CROP_PX, _ROUNDS, _STEP_PX = 12, 17, 3, 1e-3


def trial(number: int) -> Trial:
    """Measure one draw of places and noise."""
    middles = middles_px("C39", number, FRAMES)
    errors = []
    for side in SIDES:
        method = MultipleCentroids.for_sensor(grid_geometry(side))
        there = present("C39", number, FRAMES, 0.0, side)
        frames = grid_frames("C39", number, middles, there, f"noise of {side}")
        errors.append(error_px(method.extract(frames), middles))
    apart = _apart(number)
    lines = {
        "mcam": (NUMBERS, errors),
        "least squares, spots apart": (NUMBERS, apart),
        "one over the square root": (NUMBERS, [errors[0] / math.sqrt(n) for n in NUMBERS]),
    }
    return Trial(
        {"exponent": exponent(NUMBERS, errors)}, lines, {"exponent": exponent(NUMBERS, apart)}
    )


def _apart(number: int) -> list[float]:
    """Errors of the mean of N spots, fitted one by one."""
    rng = generator("claims", "C39", number, "apart")
    most = NUMBERS[-1]
    truth = (_CROP_PX - 1) / 2.0 + rng.uniform(-0.5, 0.5, (_APART * most, 2))
    peak = peak_e(REFERENCE_SNR)
    frames = detect(BACKGROUND_E + peak * _discs(truth), peak, 0.0, rng).astype(np.float64)
    away = (_fit(frames) - truth).reshape(_APART, most, 2)
    return [math.sqrt(float(np.mean(np.mean(away[:, :n], axis=1) ** 2))) for n in NUMBERS]


def _discs(places: Floats) -> Floats:
    return spots(_CROP_PX, places[:, None], RADIUS_PX, "flat")


def _fit(frames: Floats) -> Floats:
    """Places (N, 2) by Gauss-Newton from the middle, with height and background unknown."""
    found = np.full((len(frames), 2), (_CROP_PX - 1) / 2.0)
    weight = 1.0 / np.sqrt(np.maximum(frames, 0.0) + READ_NOISE_E**2)
    height = frames.max(axis=(1, 2))
    for _ in range(_ROUNDS):
        here = _discs(found)
        slopes = [
            (_discs(found + step) - _discs(found - step)) / (2.0 * _STEP_PX) * height[:, None, None]
            for step in _STEP_PX * np.eye(2)
        ]
        design = np.stack([*slopes, here, np.ones_like(here)], axis=-1) * weight[..., None]
        design = design.reshape(len(frames), -1, 4)
        wanted = (frames * weight).reshape(len(frames), -1, 1)
        across = np.swapaxes(design, 1, 2)
        solved = np.linalg.solve(across @ design, across @ wanted)[..., 0]
        found = found + np.clip(solved[:, :2], -1.0, 1.0)
        height = solved[:, 2]
    return np.asarray(found)

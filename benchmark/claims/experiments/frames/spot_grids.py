"""Grids of spots that move together, some of them missing.

The spots are those of `benchmark.synthetic_features`: discs of radius 4 px with a rim of 0.7 px,
16.37 px apart, so that no two fall alike on the pixels; a peak of 50 times the noise of light and
read-out.
The truth is where the grid's middle falls.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats, SensorGeometry
from benchmark.seeds import generator
from benchmark.synthetic_features.light import BACKGROUND_E, detect, peak_e, spots
from benchmark.synthetic_features.series import REFERENCE_SNR, SeriesPoint
from benchmark.synthetic_features.spots import GridSeries

SIZE_PX: Final = 192
RADIUS_PX: Final = 4.0
SERIES: Final = GridSeries(size_px=SIZE_PX)
#: Spots along an axis where the number is not what is varied.
SIDE: Final = 10
#: How far the middle moves along an axis: less than half of the spots' distance.
_RANGE_PX = 4.0


def offsets_px(side: int) -> Floats:
    """(S, 2) places of the spots from the grid's middle, in rows."""
    steps = (np.arange(side) - (side - 1) / 2.0) * SERIES.spacing_px
    x, y = np.meshgrid(steps, steps)
    return np.column_stack([x.ravel(), y.ravel()])


def grid_geometry(side: int = SIDE) -> SensorGeometry:
    """Return the design of a sensor whose round apertures cast such a grid."""
    return SERIES.geometry(SeriesPoint("", "", None, 0, size_px=RADIUS_PX, features=side))


def middles_px(claim: str, number: int, frames: int) -> Floats:
    """Where the grid's middle falls (N, 2) in the frames of one trial, px."""
    rng = generator("claims", claim, number, "places")
    return (SIZE_PX - 1) / 2.0 + rng.uniform(-_RANGE_PX, _RANGE_PX, (frames, 2))


def present(claim: str, number: int, frames: int, share: float, side: int = SIDE) -> Floats:
    """(N, S) ones, and zeros for a share of the spots, drawn anew in every frame.

    The spots of a small share are among those of a larger one.
    """
    rng = generator("claims", claim, number, "missing")
    order = rng.permuted(np.tile(np.arange(side * side), (frames, 1)), axis=1)
    return np.where(order < round(share * side * side), 0.0, 1.0)


def grid_frames(
    claim: str, number: int, middles: Floats, there: Floats, name: str = "noise"
) -> NDArray[np.uint16]:
    """Frames (N, H, W) of grids about the middles (N, 2), with the spots that are there (N, S)."""
    side = math.isqrt(there.shape[1])
    each = middles[:, None] + offsets_px(side)[None]
    peak = peak_e(REFERENCE_SNR)
    light = BACKGROUND_E + peak * spots(SIZE_PX, each, RADIUS_PX, "flat", there)
    return detect(light, peak, 0.0, generator("claims", claim, number, name))

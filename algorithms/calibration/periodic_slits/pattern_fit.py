"""Equal slits over lines of pixels: their raster, and spots of the shifts on two lines."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from algorithms.contract import Floats, UnsuitableDesignError

#: How far a slit may be off the raster of the others, as a share of their period.
_OFF_RASTER = 1e-3


class Raster(NamedTuple):
    """Slits at whole multiples of a period.

    Attributes
    ----------
    slits, gaps
        (S,), (G,) px from the line's middle: of the slits, and of the places in between without.
    period
        px.
    """

    slits: Floats
    gaps: Floats
    period: float


def raster(slits: tuple[tuple[float, float, float], ...], pitch_mm: float, by: str) -> Raster:
    """Return the raster that slits (position mm, slant deg, width mm) are on.

    Raises
    ------
    UnsuitableDesignError
        If there are fewer than four, if they differ in slant or width, or are on none.
    """
    places = np.sort([slit[0] for slit in slits]) / pitch_mm
    if len(places) < 4 or len({slit[1:] for slit in slits}) > 1 or slits[0][1]:
        raise UnsuitableDesignError(
            f"{by} needs four or more equal slits square to their line; got {slits!r}"
        )
    period = float(np.diff(places).min())
    numbers = (places - places[0]) / period
    whole = np.rint(numbers)
    if not (np.abs(numbers - whole) < _OFF_RASTER).all():
        raise UnsuitableDesignError(f"{by} needs slits on one raster; got {slits!r}")
    period = float((places[-1] - places[0]) / whole[-1])
    empty = np.setdiff1d(np.arange(whole[-1]), whole)
    return Raster(places, places[0] + period * empty, period)


def spots_of(shifts: Floats, axes: tuple[str, ...], middle_px: float) -> Floats:
    """Spots (N, 2) px of the shifts (N, 2) of two lines along the axes; NaN rows stay whole."""
    spots = middle_px + (shifts if axes == ("x", "y") else shifts[:, ::-1])
    return np.where(np.isfinite(spots).all(axis=1, keepdims=True), spots, np.nan)

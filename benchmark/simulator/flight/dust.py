"""How far a particle at the rim of an opening moves the light behind a mask: `dust_shift_mm`."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture

#: An opening so many times as long as wide is a slit, whose light is read across it alone.
_SLIT = 2.0
#: Points along an opening at which it is looked at from the detector.
_ALONG = 2001


def dust_shift_mm(sensor: object, diameter_mm: float) -> float:
    """Return how far one particle moves the light that is read together, as an RMS over the field.

    A disc of area a within an opening of width w, touching its rim, takes light from
    ``(w - d) / 2`` beside the middle: what is left of open area A has its centre
    ``a (w - d) / 2 / (A - a)`` further to the other side. A is that of all openings which are read
    together, those of the first one's shape and direction; of a mask that is larger than its
    detector only a part A' is seen at a time, and the particle's with the chance A' / A, so that
    the root mean square over the field has ``sqrt(A A')`` for A. A particle counts as at most half
    as wide as its opening: a larger one would leave no image.

    Parameters
    ----------
    sensor
        Of any kind; 0 for one without a mask.
    diameter_mm
        Of the particle.
    """
    camera: Any = getattr(sensor, "camera", None)
    mask = getattr(camera, "mask", None)
    if mask is None:
        return 0.0
    first = mask.apertures[0]
    alike = [one for one in mask.apertures if _direction(one) == _direction(first)]
    whole = math.fsum(one.area_mm2 for one in alike)
    lit = whole
    if (half := _half_mm(sensor)) is not None:
        blur = math.radians(SolarDisc().diameter_deg / 2.0) * camera.focal_length_mm
        shares = [_over(one, half[0] + blur, half[1] + blur) for one in alike]
        seen = math.fsum(s * one.area_mm2 for s, one in zip(shares, alike, strict=True))
        lit = max(seen, min(one.area_mm2 for one in alike) / _ALONG)
    width = min(first.width_mm, first.height_mm)
    d = min(diameter_mm, width / 2.0)
    area = math.pi * d * d / 4.0
    return float(area * (width - d) / 2.0 / (math.sqrt(whole * lit) - area))


def _direction(opening: Aperture) -> float | None:
    """Return the direction across a slit, in degrees below 180; None of any other opening."""
    if max(opening.width_mm, opening.height_mm) < _SLIT * min(opening.width_mm, opening.height_mm):
        return None
    across = opening.rotation_deg + (90.0 if opening.width_mm > opening.height_mm else 0.0)
    return round(across % 180.0, 6)


def _half_mm(sensor: object) -> tuple[float, float] | None:
    """Return half the size of an array of pixels; None of a detector that takes all light."""
    detector: Any = getattr(sensor, "detector", None)
    if not hasattr(detector, "pitch_mm"):
        return None
    height = getattr(sensor, "pixel_height_mm", detector.rows * detector.pitch_mm)
    return detector.columns * detector.pitch_mm / 2.0, height / 2.0


def _over(opening: Aperture, half_x: float, half_y: float) -> float:
    """Return the share of an opening that lies over a rectangle about the middle."""
    tall = opening.height_mm >= opening.width_mm
    turn = math.radians(opening.rotation_deg + (90.0 if tall else 0.0))
    along = ((np.arange(_ALONG) + 0.5) / _ALONG - 0.5) * max(opening.width_mm, opening.height_mm)
    x, y = opening.x_mm + along * math.cos(turn), opening.y_mm + along * math.sin(turn)
    return float(np.mean((np.abs(x) <= half_x) & (np.abs(y) <= half_y)))

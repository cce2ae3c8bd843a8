"""What a sensor's design says of its mask's pattern of apertures."""

from __future__ import annotations

import math
from typing import Any

from algorithms.contract import SensorGeometry, UnsuitableDesignError
from algorithms.extractors.frames.multi_spot.aperture_pattern import FieldPx

PATTERN_NEEDS = ("focal_length_mm", "pixel_pitch_mm", "aperture_width_mm", "aperture_shape")
"""Fields of a sensor's design that `design_pattern` reads; slits have no shape there."""

#: Angular diameter of the Sun, rad: its image behind a hole is this times the distance.
SOLAR_DIAMETER = 0.0093
#: Middle of the light that silicon sees.
_WAVELENGTH_MM = 550e-6
#: How far a sensor may be tilted and off from its design: the field of view ends as much later.
_ASTRAY_DEG = 2.0


def design_pattern(geometry: SensorGeometry, by: str) -> dict[str, Any]:
    """Parameters ``apertures_px``, ``blur_px`` and ``field_px`` of a sensor's mask.

    A sensor without a list of apertures has one, over the detector's middle. The field is None
    where the design does not tell where its edge is cast.

    Raises
    ------
    UnsuitableDesignError
        Where a field needed is None, or the design's light is no image of apertures.
    """
    geometry.require(*PATTERN_NEEDS, by=by)
    for field in ("slits", "code_bits", "lens_distortion"):
        if getattr(geometry, field) is not None:
            raise UnsuitableDesignError(
                f"{by} reads spots behind apertures; the sensor's design has {field}"
            )
    pitch, width = geometry.pixel_pitch_mm, geometry.aperture_width_mm
    focal = geometry.focal_length_mm
    if pitch is None or width is None or focal is None:
        raise UnsuitableDesignError(
            f"{by} needs pixel_pitch_mm, aperture_width_mm and focal_length_mm"
        )
    apertures = geometry.apertures or ((0.0, 0.0, width),)
    fresnel = min(w for _, _, w in apertures) ** 2 / (4.0 * _WAVELENGTH_MM * focal)
    if fresnel < 1.0:
        raise UnsuitableDesignError(
            f"{by} reads images of apertures; the sensor's are of Fresnel number {fresnel:.2g}: "
            "diffraction makes their spots, at least 1 is needed"
        )
    return {
        # a thousandth of a pixel is a fraction of what masks are made to
        "apertures_px": tuple(tuple(round(v / pitch, 6) for v in row) for row in apertures),
        "blur_px": round(SOLAR_DIAMETER * focal / pitch, 6),
        "field_px": _field(geometry, focal / pitch),
    }


def _field(geometry: SensorGeometry, focal_px: float) -> FieldPx | None:
    """Where the middle of the pattern is for a Sun in the field of view; None for not known."""
    edge, centre = geometry.half_fov_deg, geometry.centre_px
    if edge is None or centre is None or geometry.cover_glass or edge + _ASTRAY_DEG >= 90.0:
        return None
    reach = focal_px * math.tan(math.radians(edge + _ASTRAY_DEG))
    return (*centre, round(reach, 6))

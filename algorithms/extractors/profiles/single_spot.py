"""What a design with one aperture says of its spot: that it is one, and how wide it gets."""

from __future__ import annotations

from algorithms.contract import SensorGeometry, UnsuitableDesignError
from algorithms.extractors.profiles.slit_lines import edge_margin_px

#: Middle of the light that silicon and sunlight make, mm: sets how far a small hole bends it.
_WAVELENGTH_MM = 5.5e-4


def require_one_spot(geometry: SensorGeometry, by: str) -> None:
    """Raise UnsuitableDesignError for a sensor whose mask casts many spots, or lines of light."""
    if geometry.apertures is not None and len(geometry.apertures) > 1:
        raise UnsuitableDesignError(
            f"{by} reads one spot a frame; got a mask of {len(geometry.apertures)} apertures"
        )
    if geometry.slits is not None:
        raise UnsuitableDesignError(
            f"{by} reads one spot a frame; got a mask of slits, which cast lines"
        )


def spot_size_px(geometry: SensorGeometry, by: str) -> tuple[float, float]:
    """Width of a spot, px, and what its rim adds to it on each side.

    The width is the aperture's or, where diffraction widens the spot beyond it, the radius of the
    first dark ring, near the width at half the light. The rim is blurred by the Sun's width at
    the field's edge, by diffraction and by the pixels.

    Raises
    ------
    UnsuitableDesignError
        If the design lacks a focal length, pixel pitch, aperture's width or field of view.
    """
    needed = ("focal_length_mm", "pixel_pitch_mm", "aperture_width_mm", "half_fov_deg")
    geometry.require(*needed, by=by)
    height, pitch, width, fov = (getattr(geometry, name) for name in needed)
    ring = 1.22 * _WAVELENGTH_MM * height / width / pitch
    return max(width / pitch, ring), edge_margin_px(height / pitch, fov) + ring

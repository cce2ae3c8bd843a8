"""What is known of a sensor before any calibration: its design, as its builder drew it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


class UnsuitableDesignError(ValueError):
    """A sensor's design that a method does not read; what ``for_sensor`` raises."""


@dataclass(frozen=True)
class SensorGeometry:
    """The sensor's nominal design: what its builder knows before any calibration.

    A field is None where the architecture has no such thing.

    Parameters
    ----------
    focal_length_mm : float, optional
        Distance h from the mask or lens to the detector.
    pixel_pitch_mm : float, optional
        Distance of two pixels.
    centre_px : tuple of two float, optional
        Where the boresight meets the detector, (x, y).
    aperture_width_mm : float, optional
        Diameter or side of the one aperture.
    aperture_shape : {"round", "square"}, optional
        Of the one aperture, or of all of them.
    face_normals : tuple of K vectors, optional
        Unit vectors in the sensor frame, one a detector element.
    half_fov_deg : float, optional
        Largest off-axis angle of the field of view.
    line_axes : tuple of {"x", "y"}, optional
        The detector axis along which each linear array (or code dial) lies, in the order of
        their columns in a profile; all arrays lie behind slits of the same layout.
    line_pixels : int, optional
        Pixels of each linear array.
    slits : tuple of (float, float, float), optional
        Position mm, slant deg and width mm of each. Its spot falls ``position + D_u + D_v
        tan(slant)`` from the array's middle, D the displacement (h tan(beta), h tan(alpha)), u
        the array's axis and v the other one.
    mask_thickness_mm : float, optional
        Of the mask.
    cover_glass : tuple of (float, float), optional
        Thickness mm and index of each plate.
    code_bits : int, optional
        Gray tracks of a code dial; four fine tracks follow them.
    code_cell_mm : float, optional
        Length of a Gray cell.
    fine_period_mm : float, optional
        Period of the fine tracks.
    apertures : tuple of (float, float, float), optional
        Place (x mm, y mm) over the detector's centre and width mm of each aperture of many.
    subfields : int, optional
        Coded groups of apertures an axis, in rows of groups.
    lens_distortion : tuple of two float, optional
        (k1, k2): a lens images the tangents t of a direction, r = abs(t), at ``focal_length_mm t
        (1 + k1 r^2 + k2 r^4)``.
    gap_mm : float, optional
        Between the photodiodes of a quadrant.

    Examples
    --------
    >>> quadrants = SensorGeometry(focal_length_mm=2.0, aperture_width_mm=4.0)
    >>> quadrants.require("line_axes", by="pd")
    Traceback (most recent call last):
    algorithms.design.UnsuitableDesignError: pd needs the sensor geometry's line_axes; got None
    """

    focal_length_mm: float | None = None
    pixel_pitch_mm: float | None = None
    centre_px: tuple[float, float] | None = None
    aperture_width_mm: float | None = None
    aperture_shape: Literal["round", "square"] | None = None
    face_normals: tuple[tuple[float, float, float], ...] | None = None
    half_fov_deg: float | None = None
    line_axes: tuple[Literal["x", "y"], ...] | None = None
    line_pixels: int | None = None
    slits: tuple[tuple[float, float, float], ...] | None = None
    mask_thickness_mm: float | None = None
    cover_glass: tuple[tuple[float, float], ...] | None = None
    code_bits: int | None = None
    code_cell_mm: float | None = None
    fine_period_mm: float | None = None
    apertures: tuple[tuple[float, float, float], ...] | None = None
    subfields: int | None = None
    lens_distortion: tuple[float, float] | None = None
    gap_mm: float | None = None

    def require(self, *fields: str, by: str) -> None:
        """Raise UnsuitableDesignError naming the fields that `by` needs and that are None."""
        missing = [name for name in fields if getattr(self, name) is None]
        if missing:
            raise UnsuitableDesignError(
                f"{by} needs the sensor geometry's {', '.join(missing)}; got None"
            )

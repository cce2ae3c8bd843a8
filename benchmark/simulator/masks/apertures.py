"""A mask is data: apertures with shape, position and size in an opaque foil."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from algorithms.contract import Floats

ROUND, RECTANGLE = 0.0, 1.0


@dataclass(frozen=True)
class Aperture:
    """One opening.

    Attributes
    ----------
    shape
        ``round`` (width = height = diameter) or ``rectangle``.
    width_mm, height_mm
        Full size along the aperture's own x and y.
    x_mm, y_mm
        Centre in the mask plane; (0, 0) lies over the detector's centre.
    rotation_deg
        Of a rectangle, from the detector's x towards its y axis.
    """

    shape: Literal["round", "rectangle"]
    width_mm: float
    height_mm: float
    x_mm: float = 0.0
    y_mm: float = 0.0
    rotation_deg: float = 0.0

    def __post_init__(self) -> None:
        if self.shape not in {"round", "rectangle"}:
            raise ValueError(f"shape must be 'round' or 'rectangle'; got {self.shape!r}")
        if not (self.width_mm > 0 and self.height_mm > 0):
            raise ValueError(f"sizes must be positive; got {self.width_mm} x {self.height_mm} mm")
        if self.shape == "round" and self.width_mm != self.height_mm:
            raise ValueError(
                f"a round aperture has one diameter; got {self.width_mm} x {self.height_mm} mm"
            )

    @property
    def area_mm2(self) -> float:
        """Open area seen at normal incidence."""
        box = self.width_mm * self.height_mm
        return box * math.pi / 4.0 if self.shape == "round" else box

    @property
    def smallest_half_width_mm(self) -> float:
        """The half width that decides on diffraction."""
        return min(self.width_mm, self.height_mm) / 2.0


@dataclass(frozen=True)
class Mask:
    """An opaque foil with openings that do not overlap.

    `thickness_mm` makes the lit area the intersection of the two displaced rims (Antonello2018);
    the focal length counts from the detector to the foil's middle, so that the lit area stays
    centred on the ray through the aperture's centre.
    """

    apertures: tuple[Aperture, ...]
    thickness_mm: float = 0.0

    def __post_init__(self) -> None:
        if not self.apertures:
            raise ValueError("a mask needs at least one aperture; got none")
        if not self.thickness_mm >= 0:
            raise ValueError(f"thickness_mm must not be negative; got {self.thickness_mm}")

    def table(self, unit_mm: float = 1.0) -> Floats:
        """Tabulate for the kernels, (A, 7): shape, x, y, half width, half height, cosine, sine."""
        return np.array(
            [
                (
                    ROUND if a.shape == "round" else RECTANGLE,
                    a.x_mm / unit_mm,
                    a.y_mm / unit_mm,
                    a.width_mm / 2.0 / unit_mm,
                    a.height_mm / 2.0 / unit_mm,
                    math.cos(math.radians(a.rotation_deg)),
                    math.sin(math.radians(a.rotation_deg)),
                )
                for a in self.apertures
            ]
        )

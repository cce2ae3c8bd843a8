"""A lens with radial distortion: `Lens`, exact both ways."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats

_NEWTON_STEPS = 60


@dataclass(frozen=True)
class Lens:
    """Focal length, entrance pupil and radial (Brown-Conrady) distortion.

    A direction with tangents ``t = (s_x, s_y) / s_z`` and ``r = |t|`` is imaged at
    ``f t (1 + k1 r^2 + k2 r^4)``; without distortion this is eq:stdproj and the inverse of
    eq:cameq.

    Attributes
    ----------
    focal_length_mm
        From the rear principal point to the detector.
    pupil_mm
        Diameter of the entrance pupil: the lens gathers the light of this opening.
    k1, k2
        Coefficients in the tangent of the field angle; negative k1 is barrel distortion.
    """

    focal_length_mm: float
    pupil_mm: float
    k1: float = 0.0
    k2: float = 0.0

    def __post_init__(self) -> None:
        if not (self.focal_length_mm > 0 and self.pupil_mm > 0):
            raise ValueError(
                f"focal_length_mm and pupil_mm must be positive; got {self.focal_length_mm} and "
                f"{self.pupil_mm}"
            )

    @property
    def pupil_area_mm2(self) -> float:
        """Open area seen on axis."""
        return math.pi / 4.0 * self.pupil_mm**2

    def image_mm(self, directions: Floats, focal_length_mm: float | None = None) -> Floats:
        """(..., 2) image points of directions (..., 3), z > 0; from the optical axis.

        `focal_length_mm` replaces the design's, for a lens built with another.
        """
        tangents = directions[..., :2] / directions[..., 2:]
        square = np.sum(tangents**2, axis=-1, keepdims=True)
        stretch = 1.0 + square * (self.k1 + square * self.k2)
        return np.asarray((focal_length_mm or self.focal_length_mm) * stretch * tangents)

    def directions(self, image_mm: Floats, focal_length_mm: float | None = None) -> Floats:
        """Return unit vectors (..., 3) imaged at `image_mm` (..., 2): `image_mm` inverted.

        NaN where the distortion folds the image back before it reaches that far out.
        """
        distorted = image_mm / (focal_length_mm or self.focal_length_mm)
        reach = np.sqrt(np.sum(distorted**2, axis=-1, keepdims=True))
        radius = reach.copy()
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for _ in range(_NEWTON_STEPS):
                square = radius**2
                value = radius * (1.0 + square * (self.k1 + square * self.k2)) - reach
                slope = 1.0 + square * (3.0 * self.k1 + 5.0 * self.k2 * square)
                radius = radius - value / slope
            square = radius**2
            stretch = 1.0 + square * (self.k1 + square * self.k2)
            rising = 1.0 + square * (3.0 * self.k1 + 5.0 * self.k2 * square) > 0.0
            good = rising & (np.abs(radius * stretch - reach) <= 1e-12 * (1.0 + reach))
            tangents = np.where(good, distorted / stretch, np.nan)
        vectors = np.concatenate([tangents, np.ones_like(reach)], axis=-1)
        return np.asarray(vectors / np.sqrt(np.sum(vectors**2, axis=-1, keepdims=True)))

"""Between mask and detector: plane glass plates, and the Fresnel number."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats


@dataclass(frozen=True)
class Plate:
    """A plane-parallel layer: thickness and refractive index."""

    thickness_mm: float
    index: float

    def __post_init__(self) -> None:
        if not self.thickness_mm > 0:
            raise ValueError(f"thickness_mm must be positive; got {self.thickness_mm}")
        if not self.index >= 1:
            raise ValueError(f"index must be at least 1; got {self.index}")


@dataclass(frozen=True)
class CoverGlass:
    """Layers in contact with each other, vacuum on both sides; no plate is no glass."""

    plates: tuple[Plate, ...] = ()

    @property
    def thickness_mm(self) -> float:
        """Of all plates together."""
        return float(sum(plate.thickness_mm for plate in self.plates))

    def within(self, height_mm: float) -> CoverGlass:
        """Return plates that fit under a plane `height_mm` up.

        Where the mask lies on its glass and the gap is shorter than drawn, the glass is thinner.
        """
        share = height_mm / self.thickness_mm if self.plates else 1.0
        if share >= 1.0:
            return self
        thinner = (Plate(plate.thickness_mm * share, plate.index) for plate in self.plates)
        return CoverGlass(tuple(thinner))

    def displacement(self, directions: Floats, height_mm: float) -> Floats:
        """Where the ray through the origin of a plane `height_mm` up meets the detector.

        Parameters
        ----------
        directions
            (..., 3) unit vectors to the source, z > 0.
        height_mm
            Of the plane above the detector, plates included.

        Returns
        -------
        (..., 2) in mm: ``(h - t) tan(theta) + sum t_i tan(theta_i)`` with Snell's
        ``sin(theta) = n_i sin(theta_i)``, along the detector's axes (eq:refcomp1).

        Raises
        ------
        ValueError
            When the plates do not fit under the plane.
        """
        gap = height_mm - self.thickness_mm
        if gap < 0:
            raise ValueError(
                f"plates of {self.thickness_mm} mm do not fit under a mask at {height_mm} mm"
            )
        across = directions[..., :2]
        scale = gap / directions[..., 2]
        sine2 = np.sum(across**2, axis=-1)
        for plate in self.plates:
            scale = scale + plate.thickness_mm / np.sqrt(plate.index**2 - sine2)
        return np.asarray(across * scale[..., None])

    def transmission(self, directions: Floats) -> Floats:
        """Share (...) of unpolarised light passed at once through all surfaces (Fresnel).

        Light reflected inside a plate and coming back is left out.
        """
        before, cosine = 1.0, directions[..., 2]
        sine2 = np.clip(1.0 - cosine**2, 0.0, 1.0)
        passed = [np.ones(cosine.shape), np.ones(cosine.shape)]
        for index in (*(plate.index for plate in self.plates), 1.0):
            if index == before:
                continue
            inside = np.sqrt(index**2 - sine2) / index
            perpendicular = (before * cosine - index * inside) / (before * cosine + index * inside)
            parallel = (index * cosine - before * inside) / (index * cosine + before * inside)
            passed[0] = passed[0] * (1.0 - perpendicular**2)
            passed[1] = passed[1] * (1.0 - parallel**2)
            before, cosine = index, inside
        return np.asarray((passed[0] + passed[1]) / 2.0)


def fresnel_number(half_width_mm: float, distance_mm: float, wavelength_nm: float = 550.0) -> float:
    """``a^2 / (lambda h)``: far below 1 the far pattern, far above it a shadow with soft edges.

    550 nm is the middle of the visible band, near the peak of sunlight times silicon response.
    """
    return half_width_mm**2 / (wavelength_nm * 1e-6 * distance_mm)

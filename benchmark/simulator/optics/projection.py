"""From Sun directions to displaced apertures on the detector plane."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.plates import CoverGlass


@dataclass(frozen=True)
class ProjectedLight:
    """Where K points of the Sun put the mask's two rims, and how much light each carries.

    `rims_mm` (2, N, K, 2) are the displacements of the lower and the upper rim, `light` (N, K)
    the irradiance on the detector plane in units of normal incidence without glass.
    """

    rims_mm: Floats
    light: Floats


@dataclass(frozen=True)
class Camera:
    """Sun, mask, glass and assembly above a detector plane; no lens.

    `focal_length_mm` is nominal, from the detector to the middle of the mask.
    """

    focal_length_mm: float
    mask: Mask
    sun: SolarDisc = field(default_factory=SolarDisc)
    glass: CoverGlass = field(default_factory=CoverGlass)
    assembly: Assembly = field(default_factory=Assembly)

    def assemble(self, assembly: Assembly) -> Camera:
        """Return the camera with other errors of assembly; glass yields where the gap shrinks."""
        lowest = self.focal_length_mm + assembly.focal_length_error_mm
        lowest -= self.mask.thickness_mm / 2.0
        return replace(self, assembly=assembly, glass=self.glass.within(lowest))

    @property
    def height_mm(self) -> float:
        """Built distance from the detector to the middle of the mask."""
        return self.focal_length_mm + self.assembly.focal_length_error_mm

    @property
    def _offset(self) -> Floats:
        return np.array([self.assembly.offset_x_mm, self.assembly.offset_y_mm])

    def spot_mm(self, sun: Floats) -> Floats:
        """(N, 2) where the ray through the mask's origin from the Sun's centre falls.

        Without errors and glass ``(h tan(beta), h tan(alpha))`` (eq:stdproj).
        """
        head = self.assembly.to_head(sun)
        shift = self.glass.displacement(head, self.height_mm)
        return np.asarray(shift + self._offset)

    def project(self, sun: Floats) -> ProjectedLight:
        """Displacements and light for Sun directions `sun` (N, 3); no light from behind."""
        points = self.sun.directions(self.assembly.to_head(sun))
        cosine = points[..., 2]
        front = cosine > 1e-6
        safe = np.where(front[..., None], points, [0.0, 0.0, 1.0])
        thickness = self.mask.thickness_mm
        lower = self.glass.displacement(safe, self.height_mm - thickness / 2.0) + self._offset
        upper = lower
        if thickness > 0:
            upper = lower + thickness * safe[..., :2] / safe[..., 2:]
        _, shares = self.sun.quadrature()
        light = np.where(front, shares * cosine * self.glass.transmission(safe), 0.0)
        return ProjectedLight(np.stack([lower, upper]), light)

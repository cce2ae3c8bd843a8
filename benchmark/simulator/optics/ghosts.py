"""Light that goes up again between detector and mask: `Ghost`, the second image of an opening."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.optics.projection import Camera, ProjectedLight
from benchmark.simulator.scene import Scene


@dataclass(frozen=True)
class Ghost:
    """Light that the detector throws back and a surface above it throws down again.

    From the underside of the mask it comes after three heights instead of one: an image of the
    opening displaced by ``3 h tan(theta)``, ``2 h tan(theta)`` beyond the direct one, the Sun's
    penumbra three times as wide. What goes up through the opening again is lost: where the direct
    image of the same ray direction lies there is no ghost, none at all at normal incidence. From
    the upper side of a cover glass light comes after the glass alone a second and third time, and
    no opening is in its way.

    Both reflectances are taken as the same at every angle, both surfaces as mirrors; light that
    goes around twice is left out, the mask taken as thin, diffraction of the dim image left out.

    Attributes
    ----------
    detector_reflectance
        Bare silicon has 0.33 to 0.37 in the middle of the visible band (Fresnel's
        ``((n - 1) / (n + 1))^2`` with n = 3.7 to 4.1), a coated one some hundredths.
    surface_reflectance
        Of the mask's underside: as a rule 0.6 for bare chromium, 0.05 to 0.1 for chromium blackened
        with its oxide, as mask blanks are sold; of uncoated glass of index 1.52 0.043.
    surface
        Which of the two.
    """

    detector_reflectance: float = 0.3
    surface_reflectance: float = 0.1
    surface: Literal["mask", "glass"] = "mask"

    def __post_init__(self) -> None:
        for name in ("detector_reflectance", "surface_reflectance"):
            if not 0 <= getattr(self, name) <= 1:
                raise ValueError(f"{name} must be in [0, 1]; got {getattr(self, name)}")
        if self.surface not in {"mask", "glass"}:
            raise ValueError(f"surface must be 'mask' or 'glass'; got {self.surface!r}")

    @property
    def share(self) -> float:
        """Of direct light that is thrown back twice."""
        return self.detector_reflectance * self.surface_reflectance

    def paths(self, camera: Camera, sun: Floats) -> tuple[Floats, Floats, Floats]:
        """Displacements of the direct image and of the ghost, (N, K, 2) mm each, and light (N, K).

        For Suns (N, 3) of K points; as of a thin mask.
        """
        points = camera.sun.directions(camera.assembly.to_head(sun))
        front = points[..., 2] > 1e-6
        safe = np.where(front[..., None], points, [0.0, 0.0, 1.0])
        direct = camera.project(sun)
        thin = np.asarray((direct.rims_mm[0] + direct.rims_mm[1]) / 2.0)
        through = camera.height_mm if self.surface == "mask" else camera.glass.thickness_mm
        far = thin + 2.0 * camera.glass.displacement(safe, through)
        return thin, far, self.share * direct.light

    def project(self, camera: Camera, sun: Floats) -> ProjectedLight:
        """Rims and light of the ghost for Suns (N, 3), as `Camera.project` has them.

        Between the rims lies what both leave open: of a mask, the ghost's image comes first, then,
        with negative light, its overlap with the direct image. What leaves through another opening
        than its own is not taken off (linear arrays and full frames do that by themselves).
        """
        thin, far, light = self.paths(camera, sun)
        if self.surface == "glass":
            return ProjectedLight(np.stack([far, far]), light)
        rims = np.stack([np.concatenate([far, thin], axis=1), np.concatenate([far, far], axis=1)])
        return ProjectedLight(rims, np.concatenate([light, -light], axis=1))


def add_ghost(flux: Floats, camera: Camera, ghost: Ghost, scene: Scene, pitch_mm: float) -> None:
    """Add a ghost to frames (N, H, W) of light, in place.

    Parameters
    ----------
    flux
        In units of mean normal sunlight.
    camera, ghost
        Of the sensor.
    scene
        Sun, irradiance; ``origin_px`` counts from the detector's middle to each window's first
        corner.
    pitch_mm
        Of the pixels.
    """
    from benchmark.simulator.kernels.rasteriser import render  # noqa: PLC0415 - Numba on demand

    seen = ghost.project(camera, scene.sun)
    table = camera.mask.table(pitch_mm)
    origin = np.asarray(scene.origin_px, dtype=np.float64)
    light = seen.light * scene.irradiance[:, None]
    half = light.shape[1] // 2 if ghost.surface == "mask" else light.shape[1]
    part = np.empty_like(flux)
    for sign, points in ((1.0, slice(0, half)), (-1.0, slice(half, None))):
        if not light[:, points].any():
            continue
        rims = np.ascontiguousarray(seen.rims_mm[:, :, points] / pitch_mm)
        render(part, table, rims, np.ascontiguousarray(sign * light[:, points]), origin)
        flux += sign * part

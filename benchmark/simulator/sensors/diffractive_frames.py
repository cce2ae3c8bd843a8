"""Frames of a pixel array behind apertures so small that light bends: `DiffractiveFrameSensor`."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.optics.diffraction import COSINES_BELOW, SUNLIT_SILICON, Spectrum
from benchmark.simulator.optics.diffraction_tables import RoundPattern
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.rectangle_patterns import (
    RectanglePattern,
    disc_image,
    disc_strips,
    matrix,
)
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.uneven_frames import UnevenFrameSensor

#: Points of the Sun that give the middle of its image and its light.
_RINGS = (8, 12)


@dataclass(frozen=True)
class DiffractiveFrameSensor(UnevenFrameSensor):
    """A `FrameSensor` whose light is diffracted; pixels, noise and windows are the same.

    The mask is thin; stray light may slope (`stray_light`).

    Scalar Fresnel diffraction about the chief ray (see `diffraction`), for each wavelength and
    each point of the Sun. Round apertures take tables in two coordinates, which hold any oblique
    incidence: below a Fresnel number of 1 positions count in direction cosines, in which the
    far pattern keeps its shape however oblique the light; from 1 on in millimetres about the chief
    ray, in which the shadow does. Rectangles take Fresnel integrals side by side: ``J_xx = J_r
    cos^2 + J_t sin^2`` of the azimuth for the sides across x, alike for y. The product leaves out
    the phase ``q_x q_y`` that couples the sides where the Sun stands off both axes.

    Attributes
    ----------
    spectrum
        Wavelengths and weights.
    widest_deg
        Largest incidence tabulated; beyond, the pattern keeps this one's Fresnel numbers.
    nodes
        Gauss nodes a side in a pixel (round apertures; rectangles are integrated exactly).
    """

    spectrum: Spectrum = SUNLIT_SILICON
    widest_deg: float = 60.0
    nodes: int = 2

    def __post_init__(self) -> None:
        mask = self.camera.mask
        if mask.thickness_mm > 0 and any(a.shape == "round" for a in mask.apertures):
            raise ValueError(
                "diffraction at round holes is simulated for thin masks; got thickness "
                f"{mask.thickness_mm} mm"
            )
        if not 0 < self.widest_deg < 90:
            raise ValueError(f"widest_deg must be in (0, 90); got {self.widest_deg}")
        if self.nodes < 1:
            raise ValueError(f"nodes must be at least 1; got {self.nodes}")

    def _optics(self) -> tuple[Hashable, ...]:
        far = self.window_jitter_px, self.widest_deg, self.nodes
        return (*super()._optics(), self.spectrum, far)

    def _rendered(self, scene: Scene, origin_px: NDArray[np.int64]) -> Floats:
        """(N, H, W) as `FrameSensor._rendered`, diffracted."""
        sun = scene.sun
        pitch = self.detector.pitch_mm
        columns, rows = self.window_px
        flux = np.zeros((len(sun), rows, columns))
        assembly = self.camera.assembly
        offset = np.array([assembly.offset_x_mm, assembly.offset_y_mm])
        corner = (origin_px - 0.5 - np.asarray(self.detector.centre_px)) * pitch - offset
        round_ones: dict[float, list[Aperture]] = {}
        rectangles = [a for a in self.camera.mask.apertures if a.shape == "rectangle"]
        for aperture in self.camera.mask.apertures:
            if aperture.shape == "round":
                round_ones.setdefault(aperture.width_mm, []).append(aperture)
        if rectangles:
            self._add_rectangles(flux, scene, origin_px, rectangles)
        for diameter, apertures in round_ones.items():
            self._add_round(flux, sun, corner, diameter, apertures)
        return flux

    def _pattern(self, diameter: float) -> RoundPattern:
        columns, rows = self.window_px
        far = self.detector.pitch_mm * (max(columns, rows) / 2.0 + self.window_jitter_px + 1.0)
        return RoundPattern(
            radius_mm=diameter / 2.0,
            height_mm=self.camera.height_mm,
            glass=self.camera.glass,
            sun=self.camera.sun,
            spectrum=self.spectrum,
            reach_mm=math.sqrt(2.0) * far,
            widest_deg=self.widest_deg,
        )

    def _add_round(
        self, flux: Floats, sun: Floats, corner: Floats, diameter: float, group: list[Aperture]
    ) -> None:
        from benchmark.simulator.kernels.diffraction import add_round  # noqa: PLC0415 - Numba

        pattern = self._pattern(diameter)
        head = self.camera.assembly.to_head(sun)
        front = head[:, 2] > 1e-6
        safe = np.where(front[:, None], head, [0.0, 0.0, 1.0])
        sine = np.sqrt(np.sum(safe[:, :2] ** 2, axis=1))
        known = np.minimum(sine, math.sin(math.radians(self.widest_deg)))
        steps, unit = pattern.scales(known)
        light = safe[:, 2] * self.camera.glass.transmission(safe) * unit
        numbers = np.column_stack([np.where(front, light, 0.0), pattern.place(known), 1.0 / steps])
        centres = np.array([(a.x_mm, a.y_mm) for a in group])
        gauss, shares = np.polynomial.legendre.leggauss(self.nodes)
        inside = self.detector.pitch_mm * (gauss + 1.0) / 2.0
        add_round(
            flux,
            pattern.tables(),
            (safe, numbers, centres[None] - corner[:, None]),
            (
                pattern.layers(),
                np.column_stack([inside, shares / 2.0]),
                fresnel_number(diameter / 2.0, self.camera.height_mm) < COSINES_BELOW,
            ),
        )

    def _stance(self, scene: Scene) -> tuple[Floats, Floats]:
        """Return directions to the Sun in the head's frame (N, 3), and the foil's heights (N,)."""
        head = self.camera.assembly.to_head(scene.sun)
        return head, np.full(len(head), self.camera.height_mm)

    def _rectangle(self, aperture: Aperture) -> RectanglePattern:
        columns, rows = self.window_px
        far = self.detector.pitch_mm * (max(columns, rows) / 2.0 + self.window_jitter_px + 1.0)
        camera = self.camera
        return RectanglePattern(
            half_mm=(aperture.width_mm / 2.0, aperture.height_mm / 2.0),
            thickness_mm=camera.mask.thickness_mm,
            height_mm=camera.height_mm,
            glass=camera.glass,
            sun=camera.sun,
            spectrum=self.spectrum,
            pitch_mm=self.detector.pitch_mm,
            reach_mm=math.sqrt(2.0) * far,
            widest_deg=self.widest_deg,
        )

    def _add_rectangles(
        self, flux: Floats, scene: Scene, origin_px: NDArray[np.int64], group: list[Aperture]
    ) -> None:
        # the disc's middle of light, a little off the Sun's, and all of its light
        coarse = replace(self.camera.sun, rings=_RINGS, spiral=0)
        seen = replace(self, camera=replace(self.camera, sun=coarse)).projected(scene)
        light = seen.light.sum(axis=1)
        weights = seen.light / np.where(light > 0, light, 1.0)[:, None]
        lower, upper = np.sum(seen.rims_mm * weights[None, :, :, None], axis=2)
        middles = (lower + upper) / 2.0 - (
            (origin_px - 0.5 - np.asarray(self.detector.centre_px)) * self.detector.pitch_mm
        )
        head, heights = self._stance(scene)
        front = np.where(head[:, 2:] > 1e-6, head, [0.0, 0.0, 1.0])
        for aperture in group:
            self._add_rectangle(flux, (light, middles, upper - lower), (front, heights), aperture)

    def _add_rectangle(
        self,
        flux: Floats,
        spots: tuple[Floats, Floats, Floats],
        stance: tuple[Floats, Floats],
        aperture: Aperture,
    ) -> None:
        from benchmark.simulator.kernels.diffraction_slits import (  # noqa: PLC0415 - Numba
            add_rectangle,
        )

        light, middles, apart = spots
        pattern = self._rectangle(aperture)
        turn = math.radians(aperture.rotation_deg)
        c, s = math.cos(turn), math.sin(turn)
        own = _turned(stance[0], c, s)
        sine = np.sqrt(np.sum(own[:, :2] ** 2, axis=1))
        limit = math.sin(math.radians(self.widest_deg))
        share = np.minimum(1.0, limit / np.maximum(sine, limit))[:, None]
        known = np.column_stack([own[:, :2] * share, np.sqrt(1.0 - np.minimum(sine, limit) ** 2)])
        spread = matrix(known, stance[1], self.camera.glass)
        across, along, both = spread
        radius = math.sin(math.radians(self.camera.sun.diameter_deg / 2.0))
        shade = np.abs(_turned(apart, c, s)) / 2.0
        shapes = np.column_stack(
            [
                light,
                aperture.width_mm / 2.0 - shade[:, 0],
                aperture.height_mm / 2.0 - shade[:, 1],
                across,
                along,
                disc_image(known, spread, radius),
                both / np.sqrt(across * along),
            ]
        )
        add_rectangle(
            flux,
            (middles + np.array([aperture.x_mm, aperture.y_mm]), shapes, pattern.place(known)),
            (
                np.array([c, s, self.detector.pitch_mm, 2.0]),
                pattern.waves(),
                disc_strips(self.camera.sun.limb_darkening),
            ),
            pattern.widths(),
            pattern.corners(),
        )


def _turned(vectors: Floats, cosine: float, sine: float) -> Floats:
    """Vectors (N, 2 or 3) in axes turned by an angle about z."""
    out = vectors.copy()
    out[:, 0] = cosine * vectors[:, 0] + sine * vectors[:, 1]
    out[:, 1] = cosine * vectors[:, 1] - sine * vectors[:, 0]
    return out

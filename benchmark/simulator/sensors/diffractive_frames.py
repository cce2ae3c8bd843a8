"""Frames of a pixel array behind apertures so small that light bends: `DiffractiveFrameSensor`."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.optics.diffraction import COSINES_BELOW, SUNLIT_SILICON, Spectrum
from benchmark.simulator.optics.diffraction_tables import (
    RoundPattern,
    fresnel_table,
    landing,
    layers,
)
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.uneven_frames import UnevenFrameSensor


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
        if mask.thickness_mm > 0:
            raise ValueError(
                f"diffraction is simulated for thin masks; got thickness {mask.thickness_mm} mm"
            )
        turned = [a for a in mask.apertures if a.shape == "rectangle" and a.rotation_deg]
        if turned:
            raise ValueError(
                "diffraction is simulated for rectangles along the pixel rows; got one turned by "
                f"{turned[0].rotation_deg} deg"
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
        for aperture in self.camera.mask.apertures:
            if aperture.shape == "round":
                round_ones.setdefault(aperture.width_mm, []).append(aperture)
            else:
                self._add_rectangle(flux, scene, corner, aperture)
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

    def _add_rectangle(
        self, flux: Floats, scene: Scene, corner: Floats, aperture: Aperture
    ) -> None:
        from benchmark.simulator.kernels.diffraction_slits import (  # noqa: PLC0415 - Numba
            add_rectangle,
        )

        projected = self.projected(scene)
        assembly = self.camera.assembly
        offset = np.array([assembly.offset_x_mm, assembly.offset_y_mm])
        head = assembly.to_head(scene.sun)
        square = np.minimum(head[:, :2] ** 2, 1.0)
        sine2 = np.sum(square, axis=1)
        turn = np.where(sine2[:, None] > 0, square / np.where(sine2 > 0, sine2, 1.0)[:, None], 0.5)
        limit = math.sin(math.radians(self.widest_deg))
        _, along, across = landing(
            np.minimum(np.sqrt(sine2), limit), layers(self.camera.height_mm, self.camera.glass)
        ).T
        spread = along[:, None] * turn + across[:, None] * (1.0 - turn)
        add_rectangle(
            flux,
            (
                projected.rims_mm[0] - offset + np.array([aperture.x_mm, aperture.y_mm]),
                projected.light,
                corner,
                spread,
            ),
            np.array([aperture.width_mm / 2.0, aperture.height_mm / 2.0, self.detector.pitch_mm]),
            np.column_stack(
                [np.array(self.spectrum.wavelengths_nm) * 1e-6, np.array(self.spectrum.weights)]
            ),
            fresnel_table(),
        )

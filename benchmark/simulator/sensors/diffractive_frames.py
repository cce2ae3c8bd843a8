"""Frames of a pixel array behind apertures that bend light: `DiffractiveFrameSensor`."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON, Spectrum
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.diffracted_light import DiffractedLight, Stance, few_points
from benchmark.simulator.sensors.uneven_frames import UnevenFrameSensor


@dataclass(frozen=True)
class DiffractiveFrameSensor(UnevenFrameSensor):
    """A `FrameSensor` whose light is diffracted (`DiffractedLight`).

    Pixels, noise and windows are the same; stray light may slope.

    Attributes
    ----------
    spectrum
        Wavelengths and weights.
    widest_deg
        Largest incidence tabulated; beyond, the pattern keeps this one's Fresnel numbers.
    """

    spectrum: Spectrum = SUNLIT_SILICON
    widest_deg: float = 70.0

    def __post_init__(self) -> None:
        # wrong parameters are refused when the sensor is made, not when it sees something
        self._light()

    def _optics(self) -> tuple[Hashable, ...]:
        far = self.window_jitter_px, self.widest_deg
        return (*super()._optics(), self.spectrum, far)

    def _light(self) -> DiffractedLight:
        pitch = self.detector.pitch_mm
        far = max(self.window_px) / 2.0 + self.window_jitter_px + 1.0
        return DiffractedLight(
            camera=self.camera,
            spectrum=self.spectrum,
            pitch_mm=pitch,
            size_px=self.window_px,
            reach_mm=math.sqrt(2.0) * far * pitch,
            widest_deg=self.widest_deg,
        )

    def _stance(self, scene: Scene) -> Stance:
        """How the head stands at each sample."""
        head = self.camera.assembly.to_head(scene.sun)
        coarse = replace(self, camera=few_points(self.camera))
        return Stance(head, np.full(len(head), self.camera.height_mm), coarse.project(scene))

    def _render(self, scene: Scene, origin_px: NDArray[np.int64]) -> Floats:
        """(N, H, W) as `FrameSensor._render`, diffracted."""
        corner = origin_px - 0.5 - np.asarray(self.detector.centre_px)
        return self._light().render(self._stance(scene), corner * self.detector.pitch_mm)

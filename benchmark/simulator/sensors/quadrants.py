"""Currents of a quadrant photodiode behind a mask: `QuadrantSensor`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.stray_slope import slope
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.projection import ProjectedLight
from benchmark.simulator.readout.detectors import CurrentReadout, Quadrants
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.four_elements import LitAreas


@dataclass(frozen=True)
class QuadrantSensor(LitAreas):
    """Four photodiodes (order Q1..Q4 of `Quadrants`) under one aperture, with a ghost or none."""

    detector: Quadrants
    readout: CurrentReadout
    ghost: Ghost | None = None

    @property
    def open_mm2(self) -> float:
        """Area of all apertures, mm^2."""
        return sum(a.area_mm2 for a in self.camera.mask.apertures)

    def areas(self, projected: ProjectedLight, scene: Scene) -> Floats:
        """(N, 4) lit areas of the quadrants, mm^2, times the light.

        Exact; light on the gap and beyond the detector's edge is lost.
        """
        from benchmark.simulator.kernels.areas import lit_boxes  # noqa: PLC0415 - Numba on demand

        area = np.empty((len(scene), 4))
        lit_boxes(
            area,
            self.detector.boxes(),
            self.camera.mask.table(),
            projected.rims_mm,
            projected.light * scene.irradiance[:, None],
        )
        return area

    def stray(self, scene: Scene) -> Floats:
        """(N, 4) stray light at the middles of the quadrants."""
        boxes = self.detector.boxes() / self.detector.half_width_mm
        middles = np.stack([boxes[:, :2].mean(axis=1), boxes[:, 2:].mean(axis=1)], axis=1)
        return slope(scene, middles)

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
from benchmark.simulator.sensors.four_elements import FourElements


@dataclass(frozen=True)
class QuadrantSensor(FourElements):
    """Four photodiodes (order Q1..Q4 of `Quadrants`) under one aperture, with a ghost or none."""

    detector: Quadrants
    readout: CurrentReadout
    ghost: Ghost | None = None

    def lit(self, scene: Scene) -> Floats:
        """(N, 4) light on the quadrants, in units of the whole aperture at normal incidence.

        Exact areas; light on the gap and beyond the detector's edge is lost.
        """
        area = self._areas(self.camera.project(scene.sun), scene)
        if self.ghost is not None:
            area += self._areas(self.ghost.project(self.camera, scene.sun), scene)
        return np.asarray(area / sum(a.area_mm2 for a in self.camera.mask.apertures))

    def _areas(self, light: ProjectedLight, scene: Scene) -> Floats:
        """(N, 4) lit areas of the quadrants, mm^2, times the light."""
        from benchmark.simulator.kernels.areas import lit_boxes  # noqa: PLC0415 - Numba on demand

        area = np.empty((len(scene), 4))
        lit_boxes(
            area,
            self.detector.boxes(),
            self.camera.mask.table(),
            light.rims_mm,
            light.light * scene.irradiance[:, None],
        )
        return area

    def stray(self, scene: Scene) -> Floats:
        """(N, 4) stray light at the middles of the quadrants."""
        boxes = self.detector.boxes() / self.detector.half_width_mm
        middles = np.stack([boxes[:, :2].mean(axis=1), boxes[:, 2:].mean(axis=1)], axis=1)
        return slope(scene, middles)

"""Currents of a quadrant photodiode behind a mask: `QuadrantSensor`."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.optics.earthlight import EarthInView, on_elements
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.projection import Camera, ProjectedLight
from benchmark.simulator.readout import currents as readout
from benchmark.simulator.readout.detectors import CurrentReadout, Quadrants
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.stray_slope import slope


@dataclass(frozen=True)
class QuadrantSensor:
    """Four photodiodes (order Q1..Q4 of `Quadrants`) under one aperture, with a ghost or none."""

    camera: Camera
    detector: Quadrants
    readout: CurrentReadout
    ghost: Ghost | None = None
    sees_slopes: ClassVar[bool] = True

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` (4,): relative gains of the quadrants."""
        return {"gain": readout.element_gains(self.readout, 4, *names)}

    def origins(self, sun: Floats, generator: np.random.Generator) -> None:
        """Nothing is windowed (the arguments are the protocol's)."""

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

    def receive(self, scene: Scene) -> Floats:
        """(N, 4) all light: direct, stray and from the Earth; units as of `lit`."""
        boxes = self.detector.boxes() / self.detector.half_width_mm
        middles = np.stack([boxes[:, :2].mean(axis=1), boxes[:, 2:].mean(axis=1)], axis=1)
        response = self.lit(scene) + slope(scene, middles)
        if scene.albedo is not None:
            response += scene.albedo
        return np.asarray(response)

    def earth_through(
        self,
        earth: Earth,
        nadir: Floats,
        scene: Scene,
        pattern: FixedPattern,  # noqa: ARG002 - the protocol's
    ) -> Floats:
        """(N, 4) light of the Earth, as `lit` has that of the Sun; for nadir (N, 3)."""

        def lit(camera: Camera, sky: Scene) -> Floats:
            return replace(self, camera=camera).lit(sky)

        return on_elements(self.camera, lit, EarthInView(earth, nadir, scene.sun))

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, 4) mean microamperes."""
        return readout.currents(self.readout, self.receive(scene), pattern)

    def variance(self, expected: Floats) -> Floats:
        """Squared microamperes."""
        return readout.variance(self.readout, expected)

    def unit_variance(self, expected: Floats, scene: Scene, references: References) -> Floats:  # noqa: ARG002 - the protocol's
        """Squared microamperes that unknown gains of the quadrants add."""
        return readout.unit_variance(self.readout, expected, references)

    def reference_readings(
        self, pattern: FixedPattern, references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """``dark_ua`` and ``flat_ua`` (4,): mean readings of the quadrants."""
        return readout.mean_readings(self.readout, pattern["gain"], references, streams)

    def observe(self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams) -> Floats:
        """(N, 4) microamperes."""
        return readout.convert(self.readout, self.expected(scene, pattern), streams)

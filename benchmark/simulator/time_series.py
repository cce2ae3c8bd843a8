"""Sensors whose samples follow each other in time, each at its own temperature and age."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from benchmark.seeds import generator
from benchmark.simulator.assembly import Assembly
from benchmark.simulator.drift import (
    AssemblyDrift,
    PhotodiodeDrift,
    ThermalCycle,
    dark_levels,
)
from benchmark.simulator.faces import FaceSensor
from benchmark.simulator.frames import FrameSensor
from benchmark.simulator.projection import ProjectedLight
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern, Sensor

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TimedScene(Scene):
    """A scene whose samples have a time.

    Attributes
    ----------
    temperature_k, age_years
        (N,) of the sensor, at each sample.
    """

    temperature_k: Floats
    age_years: Floats

    def part(self, start: int, stop: int) -> TimedScene:
        """Return samples `start` to `stop` (exclusive)."""
        whole = super().part(start, stop)
        return TimedScene(
            whole.sun,
            whole.irradiance,
            whole.stray,
            whole.origin_px,
            whole.albedo,
            temperature_k=self.temperature_k[start:stop],
            age_years=self.age_years[start:stop],
        )


class DriftingSensor(Sensor, Protocol):
    """A sensor that follows the temperatures of a thermal cycle."""

    @property
    def thermal(self) -> ThermalCycle:
        """The temperatures it goes through."""
        ...


def timed(scene: Scene, sensor: object) -> TimedScene:
    """Return the scene itself; TypeError where its samples have no temperature and age."""
    if not isinstance(scene, TimedScene):
        raise TypeError(
            f"{type(sensor).__name__} needs each sample's temperature and age (TimedScene); got "
            f"{type(scene).__name__}"
        )
    return scene


@dataclass(frozen=True)
class DriftingFaceSensor(FaceSensor):
    """Photodiodes on faces whose gains and dark currents follow temperature and age.

    The readout's own dark-current temperature is not used.
    """

    drift: PhotodiodeDrift = field(default_factory=PhotodiodeDrift)
    thermal: ThermalCycle = field(default_factory=ThermalCycle)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """As `FaceSensor`; with ``gain_per_k`` and ``loss_per_year`` (K,), the elements' own."""
        spread = generator(*names, "drift").standard_normal((2, len(self.normals)))
        drift = self.drift
        return {
            **super().fixed_pattern(*names),
            "gain_per_k": drift.gain_per_k + drift.gain_per_k_spread * spread[0],
            "loss_per_year": drift.loss_per_year + drift.loss_per_year_spread * spread[1],
        }

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) mean microamperes; TypeError for a scene that is not a `TimedScene`."""
        at = timed(scene, self)
        factor = self.drift.factors(
            at.temperature_k, at.age_years, pattern["gain_per_k"], pattern["loss_per_year"]
        )
        light = self.received(scene, pattern) * pattern["gain"] * factor
        dark = dark_levels(self.readout.dark, at.temperature_k)
        return np.asarray(self.readout.sunlit_ua * light + dark[:, None])


@dataclass(frozen=True)
class DriftingFrameSensor(FrameSensor):
    """A pixel array behind a mask that moves against it with temperature and age.

    Windows are placed where the spot would be without drift. The detector's own dark-current
    temperature is not used.
    """

    drift: AssemblyDrift = field(default_factory=AssemblyDrift)
    thermal: ThermalCycle = field(default_factory=ThermalCycle)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """As `FrameSensor`, dark signal at 25 deg C."""
        dark = replace(self.detector.dark, temperature_c=25.0)
        still = FrameSensor(self.camera, replace(self.detector, dark=dark))
        return still.fixed_pattern(*names)

    def assemblies(self, scene: TimedScene) -> list[Assembly]:
        """How the head is assembled at each sample."""
        built = self.camera.assembly
        return [
            replace(
                built,
                tilt_x_deg=built.tilt_x_deg + float(tilt_x),
                tilt_y_deg=built.tilt_y_deg + float(tilt_y),
                focal_length_error_mm=built.focal_length_error_mm + float(height),
                offset_x_mm=built.offset_x_mm + float(x),
                offset_y_mm=built.offset_y_mm + float(y),
            )
            for tilt_x, tilt_y, height, x, y in self.drift.moved(
                scene.temperature_k, scene.age_years
            )
        ]

    def projected(self, scene: Scene) -> ProjectedLight:
        """As `Camera.project`, every sample with its own assembly."""
        camera = self.camera
        sun = np.empty_like(scene.sun)
        moved = np.empty((len(scene), 3))  # offset x, y and height beyond the nominal one
        for n, assembly in enumerate(self.assemblies(timed(scene, self))):
            sun[n] = assembly.to_head(scene.sun[n : n + 1])[0]
            moved[n] = assembly.offset_x_mm, assembly.offset_y_mm, assembly.focal_length_error_mm
        # projected by a camera at its nominal place; the rest is straight lines in the gap
        level = replace(camera, assembly=Assembly()).project(sun)
        points = camera.sun.directions(sun)
        front = points[..., 2:] > 0
        slope = np.where(front, points[..., :2] / np.where(front, points[..., 2:], 1.0), 0.0)
        rims = level.rims_mm + moved[:, None, 2:] * slope + moved[:, None, :2]
        return ProjectedLight(rims, level.light)

    def _electrons(self, scene: Scene, pattern: FixedPattern) -> Floats:
        electrons = super()._electrons(scene, pattern)
        temperature = timed(scene, self).temperature_k
        warmer = dark_levels(replace(self.detector.dark, at_25_c=1.0), temperature) - 1.0
        columns, rows = self.window_px
        for n, (x, y) in enumerate(np.asarray(scene.origin_px)):
            electrons[n] += warmer[n] * pattern["dark_e"][y : y + rows, x : x + columns]
        return electrons

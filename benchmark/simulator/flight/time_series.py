"""Sensors whose samples follow each other in time, each at its own temperature and age."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.flight.drift import (
    REFERENCE_K,
    AssemblyDrift,
    PhotodiodeDrift,
    ThermalCycle,
    dark_levels,
)
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.projection import ProjectedLight
from benchmark.simulator.readout.currents import flat_information, gain_information
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.readout.references import References, pixel_unit_variance
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern, Sensor
from benchmark.simulator.sensors.diffracted_light import Stance, few_points
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.faces import FaceSensor
from benchmark.simulator.sensors.frames import FrameSensor


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


class DriftingSensor(Sensor, Protocol):
    """A sensor that follows the temperatures of a thermal cycle."""

    @property
    def thermal(self) -> ThermalCycle:
        """The temperatures it goes through."""
        ...


def with_times(scene: Scene, sensor: object) -> TimedScene:
    """Return the scene itself; TypeError where its samples have no temperature and age."""
    if not isinstance(scene, TimedScene):
        raise TypeError(
            f"{type(sensor).__name__} needs each sample's temperature and age (TimedScene); got "
            f"{type(scene).__name__}"
        )
    return scene


def drifted(
    readout: CurrentReadout,
    drift: PhotodiodeDrift,
    received: Floats,
    pattern: FixedPattern,
    at: TimedScene,
) -> Floats:
    """(N, K) mean microamperes of photodiodes that drift, for all light that they receive."""
    factor = drift.factors(
        at.temperature_k, at.age_years, pattern["gain_per_k"], pattern["loss_per_year"]
    )
    light = received * pattern["gain"] * factor
    dark = dark_levels(readout.dark, at.temperature_k)
    return np.asarray(readout.sunlit_ua * light + dark[:, None])


def drift_slopes(
    readout: CurrentReadout, drift: PhotodiodeDrift, expected: Floats, at: TimedScene
) -> Floats:
    """(N, K, 3) microamperes by one standard deviation of gains and of their drifts.

    Those a kelvin and a year; of means (N, K).
    """
    light = expected - dark_levels(readout.dark, at.temperature_k)[:, None]
    warmer_k = at.temperature_k - REFERENCE_K
    return drift.slopes(readout.gain_mismatch, light, warmer_k[:, None], at.age_years[:, None])


def drift_information(
    readout: CurrentReadout, drift: PhotodiodeDrift, references: References
) -> Floats:
    """(3, 3) information on an element's gain and its drifts, of which flats tell nothing."""
    spreads = [readout.gain_mismatch, drift.gain_per_k_spread, drift.loss_per_year_spread]
    return gain_information(spreads, flat_information(readout, references))


@dataclass(frozen=True)
class DriftingFaceSensor(FaceSensor):
    """Photodiodes on faces whose gains and dark currents follow temperature and age.

    The readout's own dark-current temperature is not used.
    """

    drift: PhotodiodeDrift = field(default_factory=PhotodiodeDrift)
    thermal: ThermalCycle = field(default_factory=ThermalCycle)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """As `FaceSensor`; with ``gain_per_k`` and ``loss_per_year`` (K,), the elements' own."""
        drifts = self.drift.drawn(len(self.normals), *names)
        return {**super().fixed_pattern(*names), **drifts}

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) mean microamperes; TypeError for a scene that is not a `TimedScene`."""
        at = with_times(scene, self)
        return drifted(self.readout, self.drift, self.receive(scene, pattern), pattern, at)

    def gain_slopes(self, expected: Floats, scene: Scene) -> Floats:
        """(N, K, 3) microamperes by gains and by their drifts."""
        return drift_slopes(self.readout, self.drift, expected, with_times(scene, self))

    def gain_information(self, references: References) -> Floats:
        """(3, 3) of the spreads and the flats, which are taken before the flight."""
        return drift_information(self.readout, self.drift, references)


@dataclass(frozen=True)
class DriftingFrameSensor(DiffractiveFrameSensor):
    """A pixel array behind a mask that moves against it with temperature and age.

    Light is diffracted, at rectangles. Windows are placed where the spot would be without drift.
    The detector's own dark-current temperature is not used.
    """

    drift: AssemblyDrift = field(default_factory=AssemblyDrift)
    thermal: ThermalCycle = field(default_factory=ThermalCycle)

    def __post_init__(self) -> None:
        super().__post_init__()
        if any(aperture.shape == "round" for aperture in self.camera.mask.apertures):
            raise ValueError("a mask that drifts must have rectangles only; got a round aperture")

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """As `FrameSensor`, dark signal at 25 deg C."""
        dark = replace(self.detector.dark, temperature_c=25.0)
        still = FrameSensor(self.camera, replace(self.detector, dark=dark))
        return still.fixed_pattern(*names)

    def moved(self, scene: Scene) -> Floats:
        """(N, 5) how the head stands at each sample beyond its design.

        Tilts about x and y (deg), focal length and offsets x and y (mm): errors of assembly and
        drift together. TypeError for a scene that is not a `TimedScene`.
        """
        at = with_times(scene, self)
        built = self.camera.assembly
        errors = (
            built.tilt_x_deg,
            built.tilt_y_deg,
            built.focal_length_error_mm,
            built.offset_x_mm,
            built.offset_y_mm,
        )
        return np.asarray(errors + self.drift.moved(at.temperature_k, at.age_years))

    def project(self, scene: Scene) -> ProjectedLight:
        """As `Camera.project`, every sample with its own assembly."""
        camera = self.camera
        moved = self.moved(scene)
        sun = self._head(scene, moved)
        # projected by a camera at its nominal place; the rest is straight lines in the gap
        level = replace(camera, assembly=Assembly()).project(sun)
        points = camera.sun.directions(sun)
        front = points[..., 2:] > 0
        slope = np.where(front, points[..., :2] / np.where(front, points[..., 2:], 1.0), 0.0)
        rims = level.rims_mm + moved[:, None, 2:3] * slope + moved[:, None, 3:]
        return ProjectedLight(rims, level.light)

    def _head(self, scene: Scene, moved: Floats) -> Floats:
        """(N, 3) directions to the Sun as the head sees them."""
        sun = _turned_about(0, scene.sun, moved[:, 0])
        sun = _turned_about(1, sun, moved[:, 1])
        return Assembly(rotation_deg=self.camera.assembly.rotation_deg).to_head(sun)

    def _stance(self, scene: Scene) -> Stance:
        moved = self.moved(scene)
        height = self.camera.focal_length_mm + moved[:, 2]
        coarse = replace(self, camera=few_points(self.camera))
        return Stance(self._head(scene, moved), height, coarse.project(scene))

    def _moment(self, scene: Scene) -> tuple[Hashable, ...]:
        return (self.moved(scene).tobytes(),)

    def _electrons(self, scene: Scene, pattern: FixedPattern) -> Floats:
        electrons = super()._electrons(scene, pattern)
        temperature = with_times(scene, self).temperature_k
        warmer = dark_levels(replace(self.detector.dark, at_25_c=1.0), temperature) - 1.0
        columns, rows = self.window_px
        for n, (x, y) in enumerate(np.asarray(scene.origin_px)):
            electrons[n] += warmer[n] * pattern["dark_e"][y : y + rows, x : x + columns]
        return electrons

    def unit_variance(self, expected: Floats, scene: Scene, references: References) -> Floats:
        """As `FrameSensor`; references are taken at 25 deg C, dark signals grow with warmth."""
        at = with_times(scene, self)
        warmth = dark_levels(replace(self.detector.dark, at_25_c=1.0), at.temperature_k)
        cold = replace(self.detector, dark=replace(self.detector.dark, temperature_c=25.0))
        return pixel_unit_variance(cold, expected, references, warmth[:, None, None])


def _turned_about(axis: int, vectors: Floats, angle_deg: Floats) -> Floats:
    """Vectors (N, 3), each turned about an axis by its own angle (N,)."""
    angles = [math.radians(angle) for angle in angle_deg.tolist()]
    # one by one: NumPy's cosine has other last bits on other processors
    c = np.array([math.cos(angle) for angle in angles])
    s = np.array([math.sin(angle) for angle in angles])
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turned = vectors.copy()
    turned[:, i] = c * vectors[:, i] - s * vectors[:, j]
    turned[:, j] = s * vectors[:, i] + c * vectors[:, j]
    return turned

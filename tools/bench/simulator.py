"""Frames of the simulator: times, and ratios to counting sub-pixels with NumPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmark import datasets
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor

from .paired import at_most, ratio

_SUBPIXELS = 4
#: Largest time of a frame over that of counting its light: all of a frame, and light alone.
_WHOLE, _LIGHT = 1.0 / 20.0, 1.0 / 30.0


class Generate:
    """A few readings of a data set, with fixed pattern, noise and converter."""

    params = (
        *("cmos-single-aperture", "cmos-single-aperture-pinhole", "cmos-multi-aperture"),
        *("cmos-encoded", "cmos-slit", "pd-slit", "qpd-single-aperture"),
    )
    param_names = ("dataset",)

    def setup(self, name: str) -> None:
        self.preset = datasets.get(name)
        self.preset.generate("nominal", "test", 2)  # compiles, and makes tables

    def time_20_readings(self, name: str) -> None:
        self.preset.generate("nominal", "test", 20)


class Shadow:
    """`cmos-single-aperture` beside brute force; results are compared on shadows."""

    def setup(self) -> None:
        self.preset = datasets.get("cmos-single-aperture")
        sensor = self.preset.condition("nominal").sensor
        assert isinstance(sensor, FrameSensor)
        # neither does light bend, nor do pixels see less of it askew
        plain = replace(sensor.detector, tunnel=0.0)
        self.sensor = FrameSensor(sensor.camera, plain, sensor.window_px, sensor.window_jitter_px)
        self.scene = self.preset.scene("nominal", "test").part(0, 50)
        self.one = self.scene.part(0, 1)

    def track_largest_difference(self) -> float:
        exact, counted = self.sensor.lit(self.one), counted_light(self.sensor, self.one)
        return at_most(0.05, float(np.abs(exact - counted).max() / exact.max()))

    def track_light_over_counting(self) -> float:
        found = ratio(lambda: self.sensor.lit(self.scene), self._counted)
        return at_most(_LIGHT, found / len(self.scene))

    def track_frame_over_counting(self) -> float:
        many = len(self.scene)
        found = ratio(lambda: self.preset.generate("nominal", "test", many), self._counted)
        return at_most(_WHOLE, found / many)

    def _counted(self) -> object:
        return counted_light(self.sensor, self.one)


def counted_light(sensor: FrameSensor, one: Scene) -> NDArray[np.float64]:
    """(1, H, W) light of one sample: for each point of the Sun, which sub-pixels see it.

    For one round aperture. Shares the projection with the simulator, not the areas.
    """
    pitch = sensor.detector.pitch_mm
    [aperture] = sensor.camera.mask.apertures
    projected = sensor.camera.project(one.sun)
    columns, rows = sensor.window_px
    sub = (np.arange(_SUBPIXELS) + 0.5) / _SUBPIXELS - 0.5
    origin = np.zeros(2) if one.origin_px is None else one.origin_px[0]
    x0, y0 = (origin - np.asarray(sensor.detector.centre_px)) * pitch
    x = x0 + (np.arange(columns)[:, None] + sub).ravel() * pitch - aperture.x_mm
    y = y0 + (np.arange(rows)[:, None] + sub).ravel() * pitch - aperture.y_mm
    seen = np.zeros((len(y), len(x)))
    for k in range(projected.light.shape[1]):
        lit = np.ones(seen.shape, dtype=np.bool_)
        for rim in projected.rims_mm[:, 0, k]:
            square = (x - rim[0])[None, :] ** 2 + (y - rim[1])[:, None] ** 2
            lit &= square <= (aperture.width_mm / 2.0) ** 2
        seen += projected.light[0, k] * lit
    shape = (rows, _SUBPIXELS, columns, _SUBPIXELS)
    return np.asarray(one.irradiance[0] * seen.reshape(shape).mean(axis=(1, 3)))[None]

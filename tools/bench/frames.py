"""Full frames of a million pixels beside brute force: subjects for `tools.bench.simulator`."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmark import datasets
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

Floats = NDArray[np.float64]

#: A whole frame with its noise must cost at most a quarter of counting sub-pixels with NumPy where
#: there is light: half of a frame of 100 small spots is noise and conversion, which is not counted.
_LIMIT = 0.25
_SUBPIXELS = 4
_FRAMES = 20


def frames_of_many_spots() -> dict[str, Any]:
    """Simulate 1024 x 1024 frames of `cmos-multi-aperture`, 100 spots."""
    return _subject("multi-aperture", *_parts("cmos-multi-aperture"))


def frames_of_a_coded_mask() -> dict[str, Any]:
    """Simulate frames of `cmos-encoded` with 1024 x 1024 px of 5 um on the same area."""
    sensor, scene = _parts("cmos-encoded")
    detector = replace(sensor.detector, columns=1024, rows=1024, pitch_mm=0.005)
    return _subject("encoded", replace(sensor, detector=detector), scene)


def _parts(name: str) -> tuple[MultiSpotSensor, Scene]:
    preset = datasets.get(name)
    sensor = preset.condition("nominal").sensor
    if not isinstance(sensor, MultiSpotSensor):
        raise TypeError(f"{name} must have full frames; its sensor is {type(sensor).__name__}")
    return sensor, preset.scene("nominal", "test").part(0, _FRAMES)


def _subject(name: str, sensor: MultiSpotSensor, scene: Scene) -> dict[str, Any]:
    """Compare all of the simulation, light, fixed pattern, noise and converter, with light alone.

    What is simulated is diffracted; results are compared on the shadows: the largest difference
    of a pixel, in units of a fully lit one.
    """
    pattern = sensor.fixed_pattern("speed", name)
    one = scene.part(0, 1)
    # what stands above the pixels is not counted either
    shadows = replace(sensor, spectrum=None, detector=replace(sensor.detector, tunnel=0.0))
    exact = shadows.lit(one, pattern)[0]
    counted = counted_spots(shadows, one, pattern)
    return {
        "name": f"simulating {name} frames of (1024, 1024) px",
        "reference_name": (
            f"counting {_SUBPIXELS} x {_SUBPIXELS} sub-pixels around each spot with NumPy, "
            "light only"
        ),
        "call": lambda: sensor.observe(scene, pattern, NoiseStreams.named("speed", name)),
        "reference": lambda: counted_spots(shadows, one, pattern),
        "items": len(scene),
        "reference_items": 1,
        "limit": _LIMIT,
        "worst": float(np.abs(exact - counted).max() / exact.max()),
        "tolerance": 0.05,
    }


def counted_spots(sensor: MultiSpotSensor, one: Scene, pattern: FixedPattern) -> Floats:
    """(rows, columns) light of one sample by brute force: which sub-pixels see the Sun's points.

    For round apertures, within the box each of them lights. Shares projection and boxes with the
    simulator, not the areas.
    """
    pitch = sensor.detector.pitch_mm
    projected = sensor.camera.project(one.sun)
    found = np.zeros((sensor.detector.rows, sensor.detector.columns))
    half = np.array([sensor.detector.columns, sensor.detector.rows]) / 2.0
    sub = (np.arange(_SUBPIXELS) + 0.5) / _SUBPIXELS
    boxes = sensor.boxes(one, pattern)[0]
    for box, aperture, passed in zip(
        boxes, pattern["apertures"], pattern["transmission"], strict=True
    ):
        left, right, top, bottom = box
        if right <= left or bottom <= top:
            continue
        x = (np.arange(left, right)[:, None] + sub).ravel() - half[0] - aperture[1]
        y = (np.arange(top, bottom)[:, None] + sub).ravel() - half[1] - aperture[2]
        seen = np.zeros((len(y), len(x)))
        for k in range(projected.light.shape[1]):
            open_ = np.ones(seen.shape, dtype=np.bool_)
            for rim in projected.rims_mm[:, 0, k] / pitch:
                square = (x - rim[0])[None, :] ** 2 + (y - rim[1])[:, None] ** 2
                open_ &= square <= aperture[3] ** 2
            seen += projected.light[0, k] * open_
        shape = (bottom - top, _SUBPIXELS, right - left, _SUBPIXELS)
        found[top:bottom, left:right] += passed * seen.reshape(shape).mean(axis=(1, 3))
    return np.asarray(one.irradiance[0] * found)

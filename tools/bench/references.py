"""What speed is measured against: plain OpenCV and brute-force NumPy, with their results compared.

Each function prepares one subject of `tools.bench.simulator`: the calls and how far their results
differ.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from benchmark import datasets
from benchmark.seeds import generator
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor

_FRAMES, _SIZE = 1000, 64
#: The issue's "not slower than" OpenCV in a loop.
_CENTROID_LIMIT = 1.0
#: A frame must cost at most a twentieth of counting sub-pixels with NumPy.
_RENDERING_LIMIT = 0.05
_SUBPIXELS = 4
_BRUTE_FRAMES = 2


def spots() -> NDArray[np.uint16]:
    """(1000, 64, 64) uint16 frames: a blurred 12-bit spot anywhere, background and noise."""
    rng = generator("speed", "spots")
    axis = np.arange(_SIZE)
    x, y = rng.uniform(16.0, 48.0, size=(2, _FRAMES, 1))
    across = np.exp(-((axis - x) ** 2) / (2 * 5.0**2))
    along = np.exp(-((axis - y) ** 2) / (2 * 5.0**2))
    light = 100.0 + 3000.0 * along[:, :, None] * across[:, None, :]
    counts: NDArray[np.uint16] = rng.poisson(light).astype(np.uint16)
    return counts


def centroid_of_spots() -> dict[str, Any]:
    """Thresholded centroid (BCTM) of 1000 frames against a loop of OpenCV threshold + moments.

    The loop is given its thresholds ready; ours finds them. The loop's own result differs by what
    BCTM subtracts, so results are compared after correcting it by the moments of the lit pixels.
    """
    frames = spots()
    extractor = ThresholdedCentroid()
    cuts = [_dark_level(frame) for frame in frames]

    def loop() -> list[tuple[float, float]]:
        found = []
        for frame, cut in zip(frames, cuts, strict=True):
            _, above = cv2.threshold(frame, cut, 0, cv2.THRESH_TOZERO)
            m = cv2.moments(above)
            found.append((m["m10"] / m["m00"], m["m01"] / m["m00"]))
        return found

    ours = extractor.extract(frames)
    return {
        "name": "BCTM over (1000, 64, 64) uint16",
        "reference_name": "a Python loop of cv2.threshold and cv2.moments",
        "call": lambda: extractor.extract(frames),
        "reference": loop,
        "items": _FRAMES,
        "reference_items": _FRAMES,
        "limit": _CENTROID_LIMIT,
        "worst": float(np.abs(ours - _thresholded_moments(frames, cuts)).max()),
        "tolerance": 1e-9,
    }


def _dark_level(frame: NDArray[np.uint16]) -> float:
    """Six standard deviations above the mean of a side: the second lowest of the four."""
    sides = (frame[0], frame[-1], frame[:, 0], frame[:, -1])
    return float(sorted(side.mean() + 6.0 * side.std() for side in sides)[1])


def _thresholded_moments(frames: NDArray[np.uint16], cuts: list[float]) -> Floats:
    """Centroids of max(I - cut, 0) from OpenCV's moments of I and of 1 where I > cut."""
    found = []
    for frame, cut in zip(frames, cuts, strict=True):
        _, above = cv2.threshold(frame, cut, 0, cv2.THRESH_TOZERO)
        lit = cv2.moments((frame > cut).astype(np.uint8))
        light = cv2.moments(above)
        total, x, y = (light[name] - cut * lit[name] for name in ("m00", "m10", "m01"))
        found.append((x / total, y / total))
    return np.array(found)


def rendering_of_frames() -> dict[str, Any]:
    """Simulate `cmos-single-aperture` against counting sub-pixels with NumPy.

    The simulator does all of it, light, fixed pattern, noise and converter; the reference the
    light alone. Results are compared on the light of the shadow: the largest difference of a
    pixel, in units of a fully lit one.
    """
    preset = datasets.get("cmos-single-aperture")
    sensor = preset.condition("nominal").sensor
    if not isinstance(sensor, FrameSensor):
        raise TypeError(f"{preset.name} must have frames; its sensor is {type(sensor).__name__}")
    scene = preset.scene("nominal", "test").part(0, _BRUTE_FRAMES)
    exact = shadows_of(sensor).lit(scene)
    counted = counted_light(sensor, scene)
    return {
        "name": f"simulating {preset.name}, a (64, 64) frame",
        "reference_name": f"counting {_SUBPIXELS} x {_SUBPIXELS} sub-pixels with NumPy, light only",
        "call": lambda: preset.generate("nominal", "test"),
        "reference": lambda: counted_light(sensor, scene),
        "items": len(preset.scene("nominal", "test")),
        "reference_items": _BRUTE_FRAMES,
        "limit": _RENDERING_LIMIT,
        "worst": float(np.abs(exact - counted).max() / exact.max()),
        "tolerance": 0.05,
    }


def shadows_of(sensor: FrameSensor) -> FrameSensor:
    """Return the same pixels and windows in light that casts shadows alone, as is counted.

    Neither does light bend, nor do pixels see less of it askew.
    """
    plain = replace(sensor.detector, tunnel=0.0)
    return FrameSensor(sensor.camera, plain, sensor.window_px, sensor.window_jitter_px)


def counted_light(sensor: FrameSensor, scene: Scene) -> Floats:
    """(N, H, W) light by brute force: for each point of the Sun, which sub-pixels see it.

    For one round aperture. Shares the projection with the simulator, not the areas.
    """
    pitch = sensor.detector.pitch_mm
    [aperture] = sensor.camera.mask.apertures
    projected = sensor.camera.project(scene.sun)
    columns, rows = sensor.window_px
    sub = (np.arange(_SUBPIXELS) + 0.5) / _SUBPIXELS - 0.5
    found = np.zeros((len(scene), rows, columns))
    origins = np.zeros((len(scene), 2)) if scene.origin_px is None else scene.origin_px
    for n, origin in enumerate(origins):
        x0, y0 = (origin - np.asarray(sensor.detector.centre_px)) * pitch
        x = x0 + (np.arange(columns)[:, None] + sub).ravel() * pitch
        y = y0 + (np.arange(rows)[:, None] + sub).ravel() * pitch
        seen = np.zeros((len(y), len(x)))
        for k in range(projected.light.shape[1]):
            open_ = np.ones_like(seen, dtype=np.bool_)
            for rim in projected.rims_mm[:, n, k]:
                off_x, off_y = x - rim[0] - aperture.x_mm, y - rim[1] - aperture.y_mm
                radius = aperture.width_mm / 2.0
                open_ &= off_x[None, :] ** 2 + off_y[:, None] ** 2 <= radius**2
            seen += projected.light[n, k] * open_
        shape = (rows, _SUBPIXELS, columns, _SUBPIXELS)
        found[n] = scene.irradiance[n] * seen.reshape(shape).mean(axis=(1, 3))
    return found

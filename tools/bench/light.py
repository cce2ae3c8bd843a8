"""Light alone, geometric and diffracted, beside brute force: subjects for the simulator."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmark import datasets
from benchmark.datasets.preset import BATCH
from benchmark.simulator.light.sun_disc import tangent_axes
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.frames import FrameSensor
from tools.bench.references import counted_light, shadows_of

Floats = NDArray[np.float64]

_FRAMES = 512
#: Light without noise must cost at most a thirtieth of counting sub-pixels with NumPy.
_SHADOW_LIMIT = 1.0 / 30.0
#: A diffracted frame must cost at most a fiftieth of integrating over the hole with NumPy.
_BENT_LIMIT = 0.02
_RINGS, _SPOKES = 8, 24
#: Pixels a side the integral is taken for, around the window's middle.
_PATCH = 32


def light_of_frames() -> dict[str, Any]:
    """Render the shadow of `cmos-single-aperture`, no noise, against counting sub-pixels."""
    bent, scene = _parts("cmos-single-aperture")
    sensor = shadows_of(bent)
    one = scene.part(0, 1)
    exact, counted = sensor.lit(one), counted_light(sensor, one)
    return {
        "name": "rendering cmos-single-aperture, a (64, 64) frame, shadows only",
        "reference_name": "counting 4 x 4 sub-pixels with NumPy",
        "call": lambda: _in_batches(sensor, scene),
        "reference": lambda: counted_light(sensor, one),
        "items": len(scene),
        "reference_items": 1,
        "limit": _SHADOW_LIMIT,
        "worst": float(np.abs(exact - counted).max() / exact.max()),
        "tolerance": 0.05,
    }


def diffracted_frames() -> dict[str, Any]:
    """Render `cmos-single-aperture-pinhole`, light only, against an integral over its hole.

    Tables are ready, as in every run but the first. The reference does a quarter of the frame,
    puts the Sun on a ring of four points and takes pixels at their middles.
    """
    sensor, scene = _parts("cmos-single-aperture-pinhole")
    if not isinstance(sensor, DiffractiveFrameSensor):
        raise TypeError(f"the pinhole must bend light; its sensor is {type(sensor).__name__}")
    one = scene.part(0, 1)
    columns, rows = ((size - _PATCH) // 2 for size in sensor.window_px)
    middle = slice(rows, rows + _PATCH), slice(columns, columns + _PATCH)
    open_pixels = replace(sensor, detector=replace(sensor.detector, tunnel=0.0))
    exact, integrated = open_pixels.lit(one)[0][middle], integrated_light(sensor, one)
    return {
        "name": "rendering cmos-single-aperture-pinhole, a (64, 64) frame, light only",
        "reference_name": (
            f"integrating over {_RINGS * _SPOKES} points of the hole with NumPy, "
            f"({_PATCH}, {_PATCH}) px of it"
        ),
        "call": lambda: _in_batches(sensor, scene),
        "reference": lambda: integrated_light(sensor, one),
        "items": len(scene),
        "reference_items": 1,
        "limit": _BENT_LIMIT,
        "worst": float(np.abs(exact - integrated).max() / exact.max()),
        "tolerance": 0.02,
    }


def _parts(name: str) -> tuple[FrameSensor, Scene]:
    preset = datasets.get(name)
    sensor = preset.condition("nominal").sensor
    if not isinstance(sensor, FrameSensor):
        raise TypeError(f"{name} must have frames; its sensor is {type(sensor).__name__}")
    return sensor, preset.scene("nominal", "test").part(0, _FRAMES)


def _in_batches(sensor: FrameSensor, scene: Scene) -> None:
    for start in range(0, len(scene), BATCH):
        sensor.lit(scene.part(start, start + BATCH))


def integrated_light(sensor: DiffractiveFrameSensor, one: Scene) -> Floats:
    """(P, P) light of one sample by Kirchhoff's integral over the one round hole, no glass."""
    [aperture] = sensor.camera.mask.apertures
    height, pitch = sensor.camera.height_mm, sensor.detector.pitch_mm
    assembly = sensor.camera.assembly
    columns, rows = sensor.window_px
    corner = np.zeros(2) if one.origin_px is None else one.origin_px[0]
    corner = corner + (np.array([columns, rows]) - _PATCH) // 2
    x0, y0 = (corner - np.asarray(sensor.detector.centre_px)) * pitch
    x = x0 + pitch * np.arange(_PATCH) - assembly.offset_x_mm - aperture.x_mm
    y = y0 + pitch * np.arange(_PATCH) - assembly.offset_y_mm - aperture.y_mm
    nodes, shares = np.polynomial.legendre.leggauss(_RINGS)
    radius = aperture.width_mm / 2.0 * np.sqrt((nodes + 1.0) / 2.0)
    turn = 2.0 * math.pi * np.arange(_SPOKES) / _SPOKES
    holes = np.stack(
        [np.outer(radius, np.cos(turn)).ravel(), np.outer(radius, np.sin(turn)).ravel()]
    )
    weights = np.repeat(shares / 2.0 * aperture.area_mm2 / _SPOKES, _SPOKES)
    across = (x[:, None] - holes[0]) ** 2
    along = (y[:, None] - holes[1]) ** 2
    path = np.sqrt(across[None] + along[:, None] + height**2)
    offsets, sun_shares = sensor.camera.sun.quadrature()
    ring = math.sqrt(float(sun_shares @ np.sum(offsets**2, axis=1)))
    head = assembly.to_head(one.sun)
    first, second = tangent_axes(head)
    found = np.zeros((_PATCH, _PATCH))
    for off_x, off_y in ((ring, 0.0), (0.0, ring), (-ring, 0.0), (0.0, -ring)):
        point = math.sqrt(1.0 - ring**2) * head[0] + off_x * first[0] + off_y * second[0]
        behind = path + point[:2] @ holes
        for wavelength, weight in zip(
            sensor.spectrum.wavelengths_nm, sensor.spectrum.weights, strict=True
        ):
            phase = 2.0 * math.pi / (wavelength * 1e-6) * behind
            field = np.exp(1j * phase) @ (weights / (wavelength * 1e-6))
            found += weight / 4.0 * (field.real**2 + field.imag**2)
    middle = np.sqrt(x[None] ** 2 + y[:, None] ** 2 + height**2)
    # spherical waves thin out, and leave the hole at a slant
    return np.asarray(one.irradiance[0] * found * (height / middle**2) ** 2 * height / middle)

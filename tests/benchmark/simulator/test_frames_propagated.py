"""Frames of the standard datasets against a propagator that shares nothing with the simulator."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from frame_propagator import Design, Hole, frame

from benchmark import datasets
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.events import EventSensor

#: Cells of the propagator's grid, mm: fringes in a window are not finer than a few of them.
STEP_MM = 0.0012


def design_of(camera: Camera) -> Design:
    return Design(
        tuple(
            Hole(a.shape, a.width_mm, a.height_mm, a.x_mm, a.y_mm, a.rotation_deg)
            for a in camera.mask.apertures
        ),
        camera.height_mm,
        camera.mask.thickness_mm,
        tuple((plate.thickness_mm, plate.index) for plate in camera.glass.plates),
    )


def both(name: str, condition: str, alpha_deg: float, beta_deg: float, step_mm: float = STEP_MM):
    """Frames of the simulator and of the propagator, and what lies in the window's border."""
    sensor = datasets.get(name).condition(condition).sensor
    camera, pitch = sensor.camera, sensor.detector.pitch_mm
    sun = from_angles(np.array([alpha_deg]), np.array([beta_deg]))
    if isinstance(sensor, EventSensor):
        size = sensor.detector.columns, sensor.detector.rows
        origin = np.zeros((1, 2), dtype=np.int64)
        scene = Scene(sun, np.ones(1), np.zeros(1))
    else:
        assert isinstance(sensor, DiffractiveFrameSensor)
        size = sensor.window_px
        origin = np.rint(sensor.spot_px(sun)).astype(np.int64) - np.array(size) // 2
        scene = Scene(sun, np.ones(1), np.zeros(1), origin)
    found = sensor.lit(scene)[0]
    offset = np.array([camera.assembly.offset_x_mm, camera.assembly.offset_y_mm])
    first = (origin[0] - np.array(sensor.detector.centre_px)) * pitch - offset
    head = camera.assembly.to_head(sun)[0]
    design = design_of(camera)
    chief = design.landing(head)
    last = first + pitch * (np.array(size) - 1)
    half = np.maximum(np.abs(first - chief), np.abs(last - chief)) + pitch
    reach = tuple(float(r) * 1.25 + 0.05 for r in half)
    expected = frame(design, head, pitch, tuple(first), size, step_mm=step_mm, reach_mm=reach)
    return found, expected


def apart(found: np.ndarray, expected: np.ndarray) -> tuple[float, float]:
    """Largest difference over the peak, and pixels between centroids of what is bright.

    Bright is a fiftieth of the peak in the propagator's frame: what a centroid reads. The skirt
    below it, cut by the window's border, has a centroid of its own.
    """
    peak = expected.max()
    y, x = np.mgrid[: found.shape[0], : found.shape[1]]
    lit = expected > 0.02 * peak
    centroids = [
        np.array([np.sum(x * f * lit), np.sum(y * f * lit)]) / np.sum(f * lit)
        for f in (found, expected)
    ]
    return float(np.abs(found - expected).max() / peak), float(
        np.abs(centroids[0] - centroids[1]).max()
    )


CASES = [
    ("ccd-single-aperture", "nominal", 0.0, 0.0),
    ("ccd-single-aperture", "nominal", 20.0, -25.0),
    ("ccd-single-aperture", "nominal", 50.0, 0.0),
    ("ccd-single-aperture", "nominal", 50.0, 50.0),
    ("cmos-slit", "nominal", 0.0, 0.0),
    ("cmos-slit", "nominal", -30.0, 25.0),
    ("cmos-slit", "nominal", 0.0, 60.0),
    ("cmos-slit", "nominal", 60.0, 0.0),
    ("cmos-slit", "nominal", 60.0, 60.0),
    ("cmos-slit", "inclined", 0.0, 0.0),
    ("cmos-slit", "inclined", 40.0, 45.0),
    ("cmos-l-slit", "nominal", 0.0, 0.0),
    ("cmos-l-slit", "nominal", 30.0, -30.0),
    ("cmos-l-slit", "nominal", 60.0, 60.0),
    ("cmos-single-aperture", "nominal", 0.0, 0.0),
    ("cmos-single-aperture", "nominal", 25.0, -30.0),
    ("cmos-single-aperture", "nominal", 0.0, 60.0),
    ("cmos-single-aperture", "nominal", 60.0, 60.0),
    ("cmos-single-aperture", "glass", 40.0, 0.0),
    ("cmos-single-aperture-pinhole", "nominal", 0.0, 0.0),
    ("cmos-single-aperture-pinhole", "nominal", 30.0, 30.0),
]

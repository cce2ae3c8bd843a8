"""Frames of the standard datasets against a propagator that shares nothing with the simulator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from bare_pixels import bare
from frame_propagator import Design, Hole, frame, grid_for, monochrome

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
        sensor = replace(sensor, detector=bare(sensor.detector))
        size = sensor.window_px
        origin = np.rint(sensor.spot_px(sun)).astype(np.int64) - np.array(size) // 2
        scene = Scene(sun, np.ones(1), np.zeros(1), origin)
    # light on the detector: what walls about the pixels take is not the propagator's
    sensor = replace(sensor, detector=replace(sensor.detector, tunnel=0.0))
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


#: Name, alpha and beta in degrees, most of the peak and of a pixel apart: 1 % at 0, 2 % elsewhere,
#: and 0.01 px, but for the round hole at 68 deg off axis. There its pattern is so much wider than
#: its shadow at normal incidence that tables, on one grid for all incidences, end within it: 2.7 %
#: of the peak at the window's corner.
CASES = [
    ("ccd-single-aperture", 0.0, 0.0, 0.01, 0.01),
    ("ccd-single-aperture", 20.0, -25.0, 0.02, 0.01),
    ("ccd-single-aperture", 55.0, 55.0, 0.02, 0.01),
    ("cmos-slit", 0.0, 0.0, 0.01, 0.01),
    ("cmos-slit", -30.0, 25.0, 0.02, 0.01),
    ("cmos-slit", 0.0, 60.0, 0.02, 0.01),
    ("cmos-slit", 60.0, 0.0, 0.02, 0.01),
    ("cmos-slit", 60.0, 60.0, 0.02, 0.01),
    ("cmos-l-slit", 0.0, 0.0, 0.01, 0.01),
    ("cmos-l-slit", 30.0, -30.0, 0.02, 0.01),
    ("cmos-l-slit", 60.0, 60.0, 0.02, 0.01),
    ("cmos-single-aperture", 0.0, 0.0, 0.01, 0.01),
    ("cmos-single-aperture", 25.0, -30.0, 0.02, 0.01),
    ("cmos-single-aperture", 60.0, 60.0, 0.03, 0.01),
]
#: As `CASES`; far patterns do with coarse cells.
QUICK = [
    ("cmos-single-aperture-pinhole", 0.0, 0.0, 0.01, 0.01),
    ("cmos-single-aperture-pinhole", 30.0, 30.0, 0.02, 0.01),
]


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=str)
def test_frames_are_the_propagated_light(case: tuple[str, float, float, float, float]) -> None:
    """Within 1 % of the peak at normal incidence, 2 % off it, and 0.01 px; an exception above."""
    name, alpha_deg, beta_deg, share, pixels = case
    found, expected = both(name, "nominal", alpha_deg, beta_deg)
    worst, off = apart(found, expected)
    assert worst < share
    assert off < pixels


@pytest.mark.slow
@pytest.mark.parametrize("case", QUICK, ids=str)
def test_far_patterns_are_the_propagated_light(
    case: tuple[str, float, float, float, float],
) -> None:
    name, alpha_deg, beta_deg, share, pixels = case
    found, expected = both(name, "nominal", alpha_deg, beta_deg, step_mm=0.004)
    worst, off = apart(found, expected)
    assert worst < share
    assert off < pixels


@pytest.mark.slow
@pytest.mark.parametrize(("alpha_deg", "beta_deg"), [(58.0, 57.0), (44.0, 41.0)])
def test_light_is_continuous_in_the_sun(alpha_deg: float, beta_deg: float) -> None:
    """In steps of 0.02 deg second differences are nowhere more than twice what they mostly are.

    Where tables meet, a jump would stand out against them: spots move by 0.1 px a step.
    """
    sensor = datasets.get("cmos-slit").condition("nominal").sensor
    assert isinstance(sensor, DiffractiveFrameSensor)
    steps = 0.02 * (np.arange(81) - 40)
    sun = from_angles(alpha_deg + steps, beta_deg + steps)
    middle = np.rint(sensor.spot_px(sun[40:41])).astype(np.int64) - np.array(sensor.window_px) // 2
    scene = Scene(sun, np.ones(81), np.zeros(81), np.repeat(middle, 81, axis=0))
    seconds = np.abs(np.diff(sensor.lit(scene), n=2, axis=0)).max(axis=(1, 2))
    assert seconds.max() < 2.0 * np.median(seconds)


def test_the_propagator_gives_the_shadow_of_a_point_sun_its_place_and_light() -> None:
    """Behind glass and a foil: what passes is the box that both rims leave open, less its walls."""
    sun = from_angles(np.array([30.0]), np.array([20.0]))[0]
    design = Design((Hole("rectangle", 0.1, 0.12),), 1.0, 0.01, ((0.5, 1.52),))
    chief = design.landing(sun)
    grid = grid_for((0.3, 0.3), 0.001)
    light = monochrome(design, sun, 550.0, grid)
    x, y = grid.axes
    total = light.sum()
    assert abs((light.sum(axis=0) * x).sum() / total) < 1e-3
    assert abs((light.sum(axis=1) * y).sum() / total) < 1e-3
    shadow = 0.01 * np.abs(sun[:2]) / sun[2]
    open_mm2 = (0.1 - shadow[0]) * (0.12 - shadow[1])
    passed = float(design.passed(sun)) * sun[2]
    assert total * 0.001**2 == pytest.approx(open_mm2 * passed, rel=0.03)
    inside = 0.5 / np.sqrt(1.52**2 - sun[0] ** 2 - sun[1] ** 2) + 0.5 / sun[2]
    assert chief == pytest.approx(sun[:2] * inside, rel=1e-12)

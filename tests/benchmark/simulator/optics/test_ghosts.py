"""Light thrown back by the detector and again by what is above it, against rays that are folded."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from bare_pixels import bare
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import lit_by, toward

from benchmark import datasets
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import CurrentReadout, Quadrants
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.quadrants import QuadrantSensor

IDEAL = CurrentReadout(100.0, 0.0, 0.0, full_scale_ua=200.0, bits=24)
POINT = SolarDisc(diameter_deg=0.0)
GHOST = Ghost(0.5, 0.4)


def quadrants(half_width_mm: float, shape: str = "rectangle") -> QuadrantSensor:
    mask = Mask((Aperture(shape, 2.0, 2.0),))
    camera = Camera(1.0, mask, POINT)
    return QuadrantSensor(camera, Quadrants(half_width_mm, 0.0), IDEAL, GHOST)


def ghost_alone(sensor: QuadrantSensor, sun: np.ndarray) -> np.ndarray:
    return sensor.lit(lit_by(sun)) - replace(sensor, ghost=None).lit(lit_by(sun))


def test_at_normal_incidence_all_of_it_leaves_through_the_opening() -> None:
    assert ghost_alone(quadrants(1.8), toward(0.0, 0.0)) == pytest.approx(0.0, abs=1e-15)


@given(alpha=st.floats(-60.0, 60.0), beta=st.floats(-60.0, 60.0))
@settings(deadline=None, derandomize=True, max_examples=40)
def test_what_does_not_leave_is_the_share_of_both_mirrors(alpha: float, beta: float) -> None:
    """A square opening of width w holds ``(1 - 2 h tan(beta) / w)(1 - 2 h tan(alpha) / w)``."""
    sun = toward(alpha, beta)
    back = [
        max(1.0 - 2.0 * abs(math.tan(math.radians(angle))) / 2.0, 0.0) for angle in (alpha, beta)
    ]
    expected = 0.2 * sun[0, 2] * (1.0 - back[0] * back[1])
    assert ghost_alone(quadrants(50.0), sun).sum() == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("shape", ["rectangle", "round"])
def test_quadrants_count_the_folded_rays(shape: str) -> None:
    """Down, up to the mask (through the opening: gone), down again."""
    sensor, count = quadrants(1.8, shape), 200_000
    rng = np.random.default_rng(3)
    for alpha, beta in [(5.0, 12.0), (-20.0, 30.0)]:
        sun = toward(alpha, beta)
        tangent = sun[0, :2] / sun[0, 2]
        start = rng.uniform(-1.0, 1.0, (count, 2))

        def open_at(point: np.ndarray) -> np.ndarray:
            inside = np.abs(point).max(axis=1) <= 1.0
            return inside & (np.hypot(*point.T) <= 1.0) if shape == "round" else inside

        start = start[open_at(start)]
        at_mask = start + 2.0 * tangent
        x, y = (at_mask[~open_at(at_mask)] + tangent).T
        found = ghost_alone(sensor, sun)[0]
        for k, (left, right, low, high) in enumerate(sensor.detector.boxes()):
            share = np.sum((left < x) & (x < right) & (low < y) & (y < high)) / len(start)
            error = math.sqrt(max(share * (1.0 - share), 1e-6) / len(start))
            expected = 0.2 * sun[0, 2]
            assert abs(found[k] - expected * share) < 4.0 * expected * error


def one_hole(glass: CoverGlass | None = None) -> FrameSensor:
    sensor = datasets.get("cmos-single-aperture").setups["nominal"].sensor
    camera = Camera(1.2, Mask((Aperture("round", 0.1, 0.1),)), POINT, glass or CoverGlass())
    detector = replace(bare(sensor.detector), pitch_mm=0.012, full_well_e=1e9)
    return FrameSensor(camera, detector, (200, 64))


def added(sensor: FrameSensor, ghost: Ghost, sun: np.ndarray) -> tuple[float, float]:
    """Light of the ghost in units of a pixel's, and the column of its middle."""
    origin = np.array([[255, 224]])
    scene = replace(lit_by(sun), origin_px=origin)
    pattern = {"gain": np.ones((512, 512)), "dark_e": np.zeros((512, 512))}
    frames = [replace(sensor, ghost=one).expected(scene, pattern)[0] for one in (ghost, None)]
    light = (frames[0] - frames[1]) * sensor.detector.gain_e_per_dn / sensor.detector.sunlit_e
    return float(light.sum()), float(light.sum(axis=0) @ np.arange(255, 455) / light.sum())


def test_a_frame_shows_the_opening_again_three_heights_below_it() -> None:
    sensor, sun = one_hole(), toward(0.0, 20.0)
    light, column = added(sensor, GHOST, sun)
    pitch = sensor.detector.pitch_mm
    assert light == pytest.approx(0.2 * sun[0, 2] * math.pi * 0.05**2 / pitch**2, rel=1e-9)
    place = 255.5 + 3.0 * 1.2 * math.tan(math.radians(20.0)) / pitch
    assert column == pytest.approx(place, abs=0.02)  # pixels average over their area


def test_a_cover_glass_repeats_what_falls_through_it() -> None:
    """``(h - t) tan(theta) + 3 t tan(theta')``, and nothing is lost through the opening."""
    sensor, sun = one_hole(CoverGlass((Plate(0.5, 1.52),))), toward(0.0, 20.0)
    light, column = added(sensor, Ghost(0.5, 0.04, "glass"), sun)
    inside = math.asin(math.sin(math.radians(20.0)) / 1.52)
    reach = 0.7 * math.tan(math.radians(20.0)) + 3.0 * 0.5 * math.tan(inside)
    pitch = sensor.detector.pitch_mm
    assert column == pytest.approx(255.5 + reach / pitch, abs=0.02)
    passed = sensor.camera.glass.transmission(sun)[0]
    expected = 0.02 * passed * sun[0, 2] * math.pi * 0.05**2 / pitch**2
    assert light == pytest.approx(expected, rel=1e-9)

"""Second images on lines, dials and position sensors, against folded rays and sums."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scenes import lit_by, nominal, toward

from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.masks.slits import SlitErrors, crossed_pairs, periodic, slit_row
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.code_dial import CodeDialSensor
from benchmark.simulator.sensors.line_sensor import LineSensor
from benchmark.simulator.sensors.position_sensitive import PositionSensor, common_rule

POINT = SolarDisc(diameter_deg=0.0)
GHOST = Ghost(0.5, 0.4)


def shared(apart: float) -> float:
    """Share of a circle within another one of its size, centres so many diameters apart."""
    if apart >= 1.0:
        return 0.0
    return 2.0 / math.pi * (math.acos(apart) - apart * math.sqrt(1.0 - apart * apart))


def line(mask: Mask, height_mm: float = 1.0) -> LineSensor:
    camera = Camera(height_mm, mask, POINT)
    base: LineSensor = nominal("ccd-periodic")
    return replace(
        base,
        camera=camera,
        errors=SlitErrors(),
        spectrum=None,
        ghost=GHOST,
        axes=("x",),
    )


def ghost_alone(sensor: Any, sun: np.ndarray, *pattern: Any) -> np.ndarray:
    scene = lit_by(sun)
    bare = replace(sensor, ghost=None)
    return np.asarray(sensor.lit(scene, *pattern) - bare.lit(scene, *pattern))


@pytest.mark.parametrize("beta", [0.0, 1.5, 20.0, -30.0])
def test_a_slits_ghost_falls_three_heights_below_it(beta: float) -> None:
    """Of width w it keeps ``min(2 h tan(beta) / w, 1)`` of itself, the far side."""
    sensor, sun = line(slit_row((0.0,), 0.2, 9.0)), toward(5.0, beta)
    found, pitch = ghost_alone(sensor, sun)[0], sensor.detector.pitch_mm
    tangent = math.tan(math.radians(beta))
    kept = min(2.0 * abs(tangent), 0.2)
    assert found.sum() * pitch == pytest.approx(0.2 * sun[0, 2] * kept, abs=1e-12)
    if kept > 0.0:
        place = (np.arange(1024) - 511.5) * pitch
        middle = 3.0 * tangent + math.copysign((0.2 - kept) / 2.0, beta)
        # the mean of what even light covers of pixels is within an eighth of one, squared, of it
        assert found @ place / found.sum() == pytest.approx(middle, abs=pitch**2 / kept)


@pytest.mark.parametrize(
    ("mask", "rows"),
    [
        (periodic(6, 0.4, 0.2, 8.0), 1),
        (crossed_pairs(1.2, (0.5, 0.6), 0.1, 1.6, 0.0), 8),
    ],
)
def test_lines_count_the_folded_rays_whichever_slit_they_leave_through(
    mask: Mask, rows: int
) -> None:
    """Rays through the plate evenly: down, up (through any slit: gone), down on the array."""
    sensor, count = line(mask, 0.6), 400_000
    rng = np.random.default_rng(11)
    bins, high = 16, sensor.pixel_height_mm / 2.0
    edges = np.linspace(-512, 512, bins + 1) * sensor.detector.pitch_mm

    def opened(point: np.ndarray) -> np.ndarray:
        inside = np.zeros(len(point), dtype=bool)
        for _, x, y, a, b, c, s in mask.table():
            u, v = point[:, 0] - x, point[:, 1] - y
            inside |= (np.abs(c * u + s * v) <= a) & (np.abs(c * v - s * u) <= b)
        return inside

    for alpha, beta in [(10.0, 8.0), (-15.0, 25.0)]:
        sun = toward(alpha, beta)
        tangent = sun[0, :2] / sun[0, 2] * 0.6
        landed = np.column_stack([rng.uniform(-4, 4, count), rng.uniform(-high, high, count)])
        seen = opened(landed - 3.0 * tangent) & ~opened(landed - tangent)
        share = np.histogram(landed[seen, 0], edges)[0] / count
        found = ghost_alone(sensor, sun)[0].reshape(bins, -1).sum(axis=1)
        found *= sensor.detector.pitch_mm / 8.0 / (0.2 * sun[0, 2])
        error = np.sqrt(np.maximum(share, 1e-5) / count)
        # slanted edges cross bins' borders on lines a `rows`-th of the array's height apart
        uneven = 0.0 if rows == 1 else 4 * (2.0 * high / rows) / 8.0 / 2.0
        assert np.all(np.abs(found - share) < 4.5 * error + uneven)
        assert share.sum() > 0.01


def test_a_cover_glass_repeats_slits_whole() -> None:
    glass = CoverGlass((Plate(0.5, 1.52),))
    sensor = line(slit_row((0.0,), 0.2, 9.0))
    ghost = Ghost(0.5, 0.04, "glass")
    sensor = replace(sensor, camera=replace(sensor.camera, glass=glass), ghost=ghost)
    sun = toward(0.0, 0.0)
    passed = glass.transmission(sun)[0]
    total = ghost_alone(sensor, sun).sum() * sensor.detector.pitch_mm
    assert total == pytest.approx(0.02 * passed * 0.2, rel=1e-9)


@pytest.mark.parametrize("beta", [0.0, 2.0, -5.0])
def test_complementary_rows_of_a_dial_have_all_of_the_ghost(beta: float) -> None:
    """F1 and F3 pass ``(1 - cos p) / 2`` and ``(1 + cos p) / 2``: together everything."""
    sensor: CodeDialSensor = nominal("pd-code-dial")
    camera = replace(sensor.camera, assembly=Assembly(), sun=POINT)
    dial = replace(sensor.dial, track_error_mm=0.0)
    sensor = replace(sensor, camera=camera, dial=dial, deflection_deg=0.0, ghost=GHOST)
    sun = toward(0.0, beta)
    found = ghost_alone(sensor, sun, sensor.fixed_pattern("test"))[0]
    first, third = sensor.dial.bits, sensor.dial.bits + 2
    width = camera.mask.apertures[0].width_mm
    kept = min(2.0 * camera.height_mm * abs(math.tan(math.radians(beta))) / width, 1.0)
    assert found[first] + found[third] == pytest.approx(0.2 * sun[0, 2] * kept, abs=1e-12)


@pytest.mark.parametrize("beta", [0.0, 2.0, 6.0, 20.0])
def test_a_position_sensor_sees_the_crescent_that_stays(beta: float) -> None:
    """Without non-linearity: its light, and its centre of mass from both circles'."""
    sensor: PositionSensor = nominal("psd-single-aperture")
    camera = replace(sensor.camera, assembly=Assembly(), sun=POINT)
    device = replace(sensor.detector, nonlinearity=0.0)
    sensor = replace(sensor, camera=camera, detector=device, ghost=GHOST)
    sun = toward(0.0, beta)
    q1, q2, q3, q4 = ghost_alone(sensor, sun)[0]
    moved, width = camera.height_mm * math.tan(math.radians(beta)), 0.56
    back = shared(2.0 * moved / width)
    light = 0.2 * sun[0, 2]
    assert q1 + q2 + q3 + q4 == pytest.approx(light * (1.0 - back), abs=1e-9 * light)
    moment = light * (3.0 * moved - back * 2.0 * moved) / (device.length_mm / 2.0)
    assert q2 + q3 - q1 - q4 == pytest.approx(moment, abs=1e-9 * light)
    assert q1 + q2 - q3 - q4 == pytest.approx(0.0, abs=1e-12)


def test_the_rule_over_two_circles_is_exact_for_what_electrodes_ask() -> None:
    """Second moment along the line of centres, by a fine sum over the lens."""
    apart = 0.3
    points, weights = common_rule(apart)
    across = (np.arange(20_000) + 0.5) / 20_000 * 2.0 - 1.0
    half = np.sqrt(1.0 - across**2) - apart
    inside = half > 0.0
    second = np.sum(2.0 / 3.0 * half[inside] ** 3) * (2.0 / 20_000) / math.pi
    assert weights @ points[:, 0] ** 2 == pytest.approx(second, abs=1e-6)
    assert weights.sum() == pytest.approx(shared(apart), abs=1e-6)

"""Frames of a sensor that turns, exposed at once or row by row: against loops and closed forms."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import numpy as np
import pytest
from shadows import shadows

from benchmark import datasets
from benchmark.metrics.bounds import cramer_rao
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.rolling_frames import (
    RollingDiffractiveSensor,
    RollingFrameSensor,
    row_shares,
    seen_at,
)

ROW_S = 1e-4
#: Of peak: how near a turning sensor's light is to that of many moments.
NEAR = 1e-3


def standard(name: str = "cmos-single-aperture") -> FrameSensor:
    return datasets.get(name).setups["nominal"].sensor


def square(exposure_s: float = 1e-6) -> FrameSensor:
    """A square hole, its sides along the rows, without errors of assembly; sees it all at once."""
    sensor = standard("ccd-single-aperture")
    mask = Mask((Aperture("rectangle", 0.2, 0.2),))
    camera = replace(sensor.camera, mask=mask, assembly=Assembly())
    detector = replace(sensor.detector, exposure_s=exposure_s)
    return replace(sensor, camera=camera, detector=detector)


def turning(sensor: FrameSensor, **changes) -> RollingFrameSensor:
    plain = type(sensor) is FrameSensor
    kind = RollingFrameSensor if plain else RollingDiffractiveSensor
    return kind(**{f.name: getattr(sensor, f.name) for f in fields(sensor)}, **changes)


def scene_of(
    sensor: FrameSensor,
    angles: list[tuple[float, float]],
    rate: tuple[float, float, float] | None = None,
    shift: tuple[int, int] = (0, 0),
) -> Scene:
    alpha, beta = np.array(angles).T
    sun, count = from_angles(alpha, beta), len(alpha)
    origin = np.rint(sensor.spot_px(sun)).astype(np.int64) - 32 + np.array(shift)
    rates = None if rate is None else np.tile(np.array(rate), (count, 1))
    return Scene(sun, np.ones(count), np.zeros(count), origin, rate_deg_s=rates)


def row_by_row(sensor: RollingFrameSensor, scene: Scene, moments: int = 16) -> np.ndarray:
    """One sample, each row the mean of sensors at rest at the middles of equal times."""
    still, detector = sensor.still(**rest(sensor)), sensor.detector
    light = np.zeros((1, *sensor.window_px[::-1]))
    spot = sensor.spot_px(scene.sun)[0, 1]
    for row in range(light.shape[1]):
        middle = (scene.origin_px[0, 1] + row - spot) * sensor.row_time_s
        for step in range(moments):
            time = middle + ((step + 0.5) / moments - 0.5) * detector.exposure_s
            there = replace(scene.seen_from(seen_at(scene, np.array([time]))), rate_deg_s=None)
            light[0, row] += still.lit(there)[0, row] / moments
    return light


def rest(sensor: RollingFrameSensor) -> dict:
    return {f.name: getattr(sensor, f.name) for f in fields(sensor.still)}


@pytest.mark.slow
@pytest.mark.parametrize("plain", [False, True])
@pytest.mark.parametrize("rate", [None, (0.0, 0.0, 0.0)])
def test_a_sensor_that_does_not_turn_sees_what_one_at_rest_sees(plain: bool, rate) -> None:
    still = shadows(standard()) if plain else standard()
    sensor = turning(still, row_time_s=ROW_S)
    scene = scene_of(still, [(21.0, -13.0), (-55.0, 40.0)], rate)
    assert sensor.lit(scene).tobytes() == still.lit(scene).tobytes()


@pytest.mark.slow
def test_samples_that_turn_and_samples_at_rest_do_not_touch_each_other() -> None:
    sensor = turning(standard(), row_time_s=ROW_S)
    scene = scene_of(sensor, [(21.0, -13.0), (-5.0, 40.0), (0.0, 3.0)], (20.0, -30.0, 9.0))
    rates = np.array([[20.0, -30.0, 9.0], [0.0, 0.0, 0.0], [0.0, 300.0, 0.0]])
    scene = replace(scene, rate_deg_s=rates)
    whole = sensor.lit(scene)
    for n in range(3):
        assert sensor.lit(scene.part(n, n + 1)).tobytes() == whole[n].tobytes()
    assert whole[1].tobytes() == standard().lit(scene)[1].tobytes()


@pytest.mark.slow
@pytest.mark.parametrize("row_s", [0.0, ROW_S, -ROW_S])
def test_rows_are_those_of_a_loop_over_rows_and_times(row_s: float) -> None:
    sensor = turning(standard(), row_time_s=row_s)
    scene = scene_of(sensor, [(48.0, -31.0)], (-50.0, 40.0, 30.0), (5, -7))
    found, expected = sensor.lit(scene), row_by_row(sensor, scene)
    assert np.abs(found - expected).max() < NEAR * expected.max()
    at_rest = standard().lit(scene)
    assert np.abs(found - at_rest).max() > 10 * NEAR * expected.max()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "angles"),
    [
        ("cmos-single-aperture", [(0.0, 0.0), (20.0, -35.0), (60.0, 0.0), (-45.0, 55.0)]),
        ("ccd-single-aperture", [(0.0, 0.0), (20.0, -35.0), (-45.0, 45.0), (50.0, 40.0)]),
    ],
)
def test_more_moments_change_less_than_a_thousandth_of_the_peak(name: str, angles: list) -> None:
    sensor = datasets.get(name).setups["spinning"].sensor
    for rate in ((30.0, 0.0, 0.0), (-17.0, 17.0, 17.0), (-60.0, 60.0, 30.0)):
        scene = scene_of(sensor, angles, rate)
        few, many = sensor.lit(scene), replace(sensor, more_nodes=9).lit(scene)
        peak = many.max(axis=(1, 2))
        assert (np.abs(few - many).max(axis=(1, 2)) < NEAR * peak).all()


@pytest.mark.slow
def test_turning_about_a_column_shears_the_spot() -> None:
    """Row by row the Sun is ``w t`` further on, and its light at ``h tan`` of where it stands."""
    rate, beta = 40.0, 10.0
    still = square()
    sensor, h_mm = turning(still, row_time_s=ROW_S), still.camera.focal_length_mm
    scene = scene_of(still, [(0.0, beta)], (0.0, rate, 0.0))
    rows = np.arange(26, 39)  # well within the spot
    x = np.arange(64)
    moved, fixed = (s.lit(scene)[0, rows] for s in (sensor, still))
    places = moved @ x / moved.sum(axis=1) - fixed @ x / fixed.sum(axis=1)
    detector = still.detector
    spot = still.spot_px(scene.sun)[0]
    time_s = (rows + scene.origin_px[0, 1] - spot[1]) * ROW_S
    # a turn about y takes z towards x: the Sun goes back along x by as much
    x_px = h_mm * np.tan(np.radians(beta - rate * time_s)) / detector.pitch_mm
    expected = x_px + detector.centre_px[0] - spot[0]
    assert np.ptp(expected) > 0.1
    # skirts beyond the window: less than a hundredth of the shift
    assert places == pytest.approx(expected, abs=0.01 * np.ptp(expected))


@pytest.mark.slow
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_turning_along_the_read_out_stretches_or_squeezes_the_spot(direction: float) -> None:
    """Light that moves v pixels a row as the shutter passes is seen 1 / (1 - v) as long."""
    rate = direction * 60.0
    still = square()
    sensor = turning(still, row_time_s=ROW_S)
    scene = scene_of(still, [(0.0, 0.0)], (rate, 0.0, 0.0))
    # a turn about x takes y towards z: the Sun's y grows, and the spot goes to higher rows
    speed = still.camera.focal_length_mm * math.radians(rate) * ROW_S / still.detector.pitch_mm
    assert abs(speed) > 0.01
    ratio = sensor.lit(scene).sum() / still.lit(scene).sum()
    assert ratio - 1 == pytest.approx(1 / (1 - speed) - 1, rel=0.02)


@pytest.mark.slow
def test_motion_within_the_exposure_blurs_by_its_variance() -> None:
    """A uniform smear of v T adds (v T)^2 / 12 to the spot's variance along it."""
    rate, x, exposure_s = 60.0, np.arange(64), 0.01
    still = square(exposure_s)
    sensor = turning(still)
    h_px = still.camera.focal_length_mm / still.detector.pitch_mm
    smear = h_px * math.radians(rate) * exposure_s
    assert smear > 1.5
    angles = [(0.0, math.degrees(math.atan(step / 16 / h_px))) for step in range(16)]
    scene = scene_of(still, angles, (0.0, rate, 0.0))
    off = np.square(x - (still.spot_px(scene.sun)[:, 0] - scene.origin_px[:, 0])[:, None])
    near = np.abs(off) < 14.0**2  # the skirt's square counts for much, and is the same
    moved, fixed = (
        (light * off * near).sum(axis=1) / (light * near).sum(axis=1)
        for light in (sensor.lit(scene).sum(axis=1), still.lit(scene).sum(axis=1))
    )
    assert np.mean(moved - fixed) == pytest.approx(smear**2 / 12, rel=0.03)


@pytest.mark.slow
def test_the_row_through_the_spot_tells_the_time() -> None:
    """Sheared, stretched and blurred as it is, the spot lies where that of the scene's Sun does."""
    still = square(0.01)
    sensor = turning(still, row_time_s=ROW_S)
    y, x = np.indices((64, 64))
    for rate in ((60.0, 0.0, 0.0), (0.0, 60.0, 0.0), (40.0, -30.0, 20.0)):
        scene = scene_of(still, [(12.0, -7.0)], rate)
        middles = []
        for light in (sensor.lit(scene)[0], still.lit(scene)[0]):
            bright = np.where(light > 0.02 * light.max(), light, 0.0)
            middles.append(((bright * x).sum() / bright.sum(), (bright * y).sum() / bright.sum()))
        assert middles[0] == pytest.approx(middles[1], abs=0.03)
        late = replace(scene, sun=seen_at(scene, np.array([64 * ROW_S])))
        assert np.abs(still.spot_px(late.sun) - still.spot_px(scene.sun)).max() > 0.3


def test_shares_of_an_exposure_at_once_are_gauss_weights() -> None:
    moments, shares = row_shares(np.zeros(64), 0.01, 5)
    place, weight = np.polynomial.legendre.leggauss(5)
    assert moments == pytest.approx(place * 0.01 / 2)
    assert shares == pytest.approx(np.tile(weight / 2, (64, 1)), abs=1e-14)


@pytest.mark.parametrize("row_s", [3e-5, -2e-3])
def test_shares_integrate_polynomials_over_each_row(row_s: float) -> None:
    unit, half = 0.1, 0.005
    middles = (np.arange(64) - 30.0) * row_s
    moments, shares = row_shares(middles, 2 * half, 4)
    for power in range(4):
        upper, lower = ((middles + s * half) / unit for s in (1, -1))
        mean = (upper ** (power + 1) - lower ** (power + 1)) / (power + 1) * unit / (2 * half)
        assert shares @ (moments / unit) ** power == pytest.approx(mean, abs=1e-12)


def test_directions_turn_against_the_sensor_and_stay_unit_vectors() -> None:
    sun = from_angles(np.zeros(3), np.full(3, 45.0))
    rates = np.tile([0.0, 0.0, 90.0], (3, 1))
    scene = Scene(sun, np.ones(3), np.zeros(3), rate_deg_s=rates)
    half = math.sqrt(0.5)
    found = seen_at(scene, np.array([0.0, 1.0, 2.0]))
    assert found == pytest.approx(np.array([[half, 0, half], [0, -half, half], [-half, 0, half]]))
    other = seen_at(
        replace(scene, rate_deg_s=rates + np.array([3.0, -7.0, 0.0])), np.array([0.3, 40, 0])
    )
    assert np.linalg.norm(other, axis=1) == pytest.approx(1.0, abs=1e-14)


def test_blur_costs_information() -> None:
    preset = datasets.get("cmos-single-aperture")
    sensor, pattern = preset.setups["spinning"].sensor, preset.fixed_pattern("spinning")
    light = preset.setups["spinning"].irradiance
    still = scene_of(sensor, [(10.0, -20.0)])
    fast = scene_of(sensor, [(10.0, -20.0)], (0.0, 600.0, 0.0))
    bounds = [cramer_rao(sensor, scene, pattern, light) for scene in (still, fast)]
    lost_along, lost_across = (
        1.0 - getattr(bounds[0], axis)[0] / getattr(bounds[1], axis)[0]
        for axis in ("beta_deg", "alpha_deg")
    )
    assert lost_along > lost_across > 0.0
    assert lost_along > 0.2

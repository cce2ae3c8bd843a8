"""Full frames of a sensor that turns, read row by row: against loops over rows and times."""

from __future__ import annotations

from dataclasses import fields, replace
from functools import cache

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.conditions.full_frames import for_bound
from benchmark.datasets.conditions.motion import spinning
from benchmark.metrics.bounds import cramer_rao
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.layouts import grid
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.lit_pixels import LitPixels
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor
from benchmark.simulator.sensors.rolling_frames import RollingMultiSpotSensor, seen_at

RATE = np.array([[20.0, -15.0, 17.0]])
#: Of peak.
NEAR = 1e-3


@cache
def still() -> MultiSpotSensor:
    """Nine holes of the standard dataset above a quarter of its rows and columns."""
    sensor = datasets.get("cmos-multi-aperture").setups["nominal"].sensor
    assert isinstance(sensor, MultiSpotSensor)
    mask = grid(3, 3, 0.833, Aperture("round", 0.1, 0.1), thickness_mm=0.01)
    detector = replace(sensor.detector, columns=320, rows=320)
    return replace(sensor, camera=replace(sensor.camera, mask=mask), detector=detector)


def rolling(**changes) -> RollingMultiSpotSensor:
    parts = {f.name: getattr(still(), f.name) for f in fields(still())}
    return RollingMultiSpotSensor(**parts, **{"row_time_s": 2e-4, **changes})


def scene_of(alpha: float, beta: float, rate: np.ndarray | None = RATE) -> Scene:
    sun = from_angles(np.array([alpha]), np.array([beta]))
    return Scene(sun, np.ones(1), np.zeros(1), np.zeros((1, 2), np.int64), rate_deg_s=rate)


@pytest.fixture(scope="module")
def unit() -> dict:
    return dict(still().fixed_pattern("test"))


@pytest.mark.slow
def test_without_rates_frames_are_those_of_the_sensor_at_rest(unit) -> None:
    scene = scene_of(12.0, -7.0, None)
    sensor = rolling()
    assert sensor.lit(scene, unit).tobytes() == still().lit(scene, unit).tobytes()
    streams = [NoiseStreams.named("test") for _ in range(2)]
    one, other = (
        s.observe(scene, unit, t) for s, t in zip((sensor, still()), streams, strict=True)
    )
    assert one.tobytes() == other.tobytes()


@pytest.mark.slow
@pytest.mark.parametrize("row_s", [2e-4, -1e-4, 0.0])
def test_rows_are_those_of_a_loop_over_times(unit, row_s: float) -> None:
    sensor, scene = rolling(row_time_s=row_s), scene_of(12.0, -7.0)
    found = sensor.lit(scene, unit)[0]
    middle = still()._whole().spot_px(scene.sun)[0, 1]
    bright = np.flatnonzero(found.max(axis=1) > 0.05 * found.max())
    checked = bright[:: max(1, len(bright) // 8)]
    steps = 8
    for row in checked:
        expected = np.zeros(found.shape[1])
        for step in range(steps):
            time = (row - middle) * row_s + ((step + 0.5) / steps - 0.5) * 0.01
            there = scene.seen_from(seen_at(scene, np.array([time])))
            expected += still().lit(replace(there, rate_deg_s=None), unit)[0, row] / steps
        # middles of eight parts of less than two pixels of motion: 2^2 / 24 / 64 of a second
        # difference, which is below a tenth of the peak
        assert np.abs(found[row] - expected).max() < NEAR * found.max()
    at_rest = still().lit(scene, unit)[0]
    assert np.abs(found - at_rest).max() > 5 * NEAR * found.max()


@pytest.mark.slow
def test_more_moments_change_less_than_a_thousandth_of_the_peak(unit) -> None:
    for angles in ((0.0, 0.0), (-35.0, 20.0), (10.0, 48.0)):
        few, many = (rolling(more_nodes=more).lit(scene_of(*angles), unit) for more in (0, 6))
        assert np.abs(few - many).max() < NEAR * many.max()


def test_what_is_observed_is_the_mean_and_the_bound_sees_the_lit_pixels_of_it(unit) -> None:
    sensor, scene = rolling(), scene_of(12.0, -7.0)
    mean = sensor.expected(scene, unit)
    seen = sensor.observe(scene, unit, NoiseStreams.named("test"))
    spread = np.sqrt(sensor.variance(mean))
    pulls = ((seen - mean) / spread)[mean > 100]
    assert np.sqrt(np.mean(pulls**2)) == pytest.approx(1.0, abs=4 / np.sqrt(2 * len(pulls)))
    lit = LitPixels(sensor, scene, unit)
    part = lit.expected(scene, unit)[0, :-1]
    whole = np.sort(mean.ravel())[::-1]
    assert np.sort(part)[::-1][:500] == pytest.approx(whole[:500], rel=1e-12)


def test_the_bound_of_a_turning_sensor_is_near_that_at_rest(unit) -> None:
    """A blur of less than a pixel costs spots ten pixels wide little."""
    light = datasets.get("cmos-multi-aperture").setups["nominal"].irradiance
    bounds = []
    for rate in (None, RATE):
        scene = scene_of(12.0, -7.0, rate)
        lit = LitPixels(for_bound(rolling()), scene, unit)  # type: ignore[arg-type]
        bounds.append(cramer_rao(lit, scene, unit, light).angle_deg[0])
    assert bounds[1] == pytest.approx(bounds[0], rel=0.1)


def test_the_condition_turns_the_nominal_sensor() -> None:
    condition = spinning(still(), rolls=True)
    assert isinstance(condition.sensor, RollingMultiSpotSensor)
    assert condition.sensor.row_time_s == pytest.approx(320 * 80e-9)
    assert "under the mask's middle" in condition.description
    assert condition.spin is not None


def test_impossible_read_outs_are_refused() -> None:
    with pytest.raises(ValueError, match="row_time_s must be finite"):
        rolling(row_time_s=float("nan"))
    with pytest.raises(ValueError, match="more_nodes must not be negative"):
        rolling(more_nodes=-1)

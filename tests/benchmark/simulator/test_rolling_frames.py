"""Rolling read-out of a turning sensor: what each row sees, against closed forms."""

from __future__ import annotations

import math
from dataclasses import fields

import numpy as np
import pytest
from shadows import shadows

from benchmark import datasets
from benchmark.simulator.light.sun_disc import SolarDisc, from_angles
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor
from benchmark.simulator.sensors.rolling_frames import RollingFrameSensor

H_MM, ROW_S = 2.0, 1e-4


def plain() -> FrameSensor:
    sensor = datasets.get("cmos-single-aperture").setups["nominal"].sensor
    mask = Mask((Aperture("rectangle", 0.3, 0.4),))
    camera = Camera(H_MM, mask, SolarDisc(0.0), assembly=Assembly())
    return shadows(sensor, camera=camera, pitch_mm=0.012)


def rolling(**changes) -> RollingFrameSensor:
    base = plain()
    return RollingFrameSensor(**{f.name: getattr(base, f.name) for f in fields(base)}, **changes)


def scene_of(sensor: FrameSensor, alpha: float = 0.0, beta: float = 0.0) -> Scene:
    sun = from_angles(np.array([alpha]), np.array([beta]))
    origin = np.rint(sensor.spot_px(sun)).astype(np.int64) - 32
    return Scene(sun, np.ones(1), np.zeros(1), origin)


def light(sensor: FrameSensor, **angles: float) -> np.ndarray:
    return sensor.lit(scene_of(sensor, **angles))[0]


def middles(frame: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows fully within the spot, and where its light lies in each, from its two sides."""
    rows = np.flatnonzero(frame.sum(axis=1) > 0.99 * frame.sum(axis=1).max())
    places = []
    for row in frame[rows]:
        inner = np.flatnonzero(row > row.max() * (1 - 1e-9))
        left = inner[0] - row[: inner[0]].sum() / row.max()
        right = inner[-1] + 1 + row[inner[-1] + 1 :].sum() / row.max()
        places.append((left + right) / 2 - 0.5)
    return rows, np.array(places)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"row_time_s": ROW_S},
        {"rate_deg_s": (20.0, -30.0, 5.0)},
        {"row_time_s": ROW_S, "instants": 3},
    ],
)
def test_a_sensor_that_does_not_roll_or_does_not_turn_sees_the_same(changes: dict) -> None:
    still = light(plain(), alpha=21.0, beta=-13.0)
    assert np.array_equal(light(rolling(**changes), alpha=21.0, beta=-13.0), still)


def test_turning_about_the_rows_normal_shears_the_spot() -> None:
    """Row by row the Sun is ``w t`` further on; its light at ``h tan`` of where it stands."""
    rate, beta = 40.0, 10.0
    sensor = rolling(row_time_s=ROW_S, rate_deg_s=(0.0, rate, 0.0))
    scene = scene_of(sensor, beta=beta)
    rows, places = middles(sensor.lit(scene)[0])
    assert len(rows) > 25
    detector = sensor.detector
    time_s = (rows + scene.origin_px[0, 1] - detector.centre_px[1]) * ROW_S
    # a turn about y takes z towards x: the Sun goes back along x by as much
    angle = np.radians(beta - rate * time_s)
    x_px = H_MM * np.tan(angle) / detector.pitch_mm + detector.centre_px[0]
    assert places + scene.origin_px[0, 0] == pytest.approx(x_px, abs=1e-9)
    assert abs(x_px[-1] - x_px[0]) > 0.1


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_turning_along_the_read_out_stretches_or_squeezes_the_spot(direction: float) -> None:
    """Light that moves v pixels a row as the shutter passes is seen 1 / (1 - v) as long."""
    rate = direction * 60.0
    sensor = rolling(row_time_s=ROW_S, rate_deg_s=(rate, 0.0, 0.0))
    frame = light(sensor)
    speed = H_MM * math.radians(rate) * ROW_S / sensor.detector.pitch_mm
    column = frame[:, 32]
    seen = column.sum() / column.max()
    drawn = 0.4 / sensor.detector.pitch_mm
    # the edge within a row is that row's: whole numbers of rows make up the length
    assert seen == pytest.approx(drawn / (1 - speed), abs=abs(speed))
    assert abs(seen - drawn) > 0.3


def test_motion_within_the_exposure_blurs_by_its_variance() -> None:
    """A uniform smear of v T adds (v T)^2 / 12 to the spot's variance along it."""
    rate, x = 60.0, np.arange(64)
    sensor = rolling(rate_deg_s=(0.0, rate, 0.0), instants=8)
    pitch = sensor.detector.pitch_mm
    smear = H_MM * math.radians(rate) * sensor.detector.exposure_s / pitch
    assert smear > 1.5
    added = []
    for step in range(16):  # pixels distort moments; over all places within a pixel that averages
        beta = math.degrees(math.atan(step / 16 * pitch / H_MM))
        middle = 31.5 + step / 16
        still, moved = (light(s, beta=beta).sum(axis=0) for s in (plain(), sensor))
        assert moved.sum() == pytest.approx(still.sum(), rel=1e-3)
        off = np.square(x - middle)
        added.append(moved @ off / moved.sum() - still @ off / still.sum())
    assert np.mean(added) == pytest.approx(smear**2 / 12, rel=0.02)


def test_directions_turn_against_the_sensor_and_stay_unit_vectors() -> None:
    sensor = rolling(rate_deg_s=(0.0, 0.0, 90.0))
    sun = from_angles(np.array([0.0]), np.array([45.0]))
    seen = sensor.seen_at(sun, np.array([[0.0, 1.0, 2.0]]))[0]
    half = math.sqrt(0.5)
    assert seen == pytest.approx(np.array([[half, 0, half], [0, -half, half], [-half, 0, half]]))
    other = rolling(rate_deg_s=(3.0, -7.0, 11.0)).seen_at(sun, np.array([[0.3, 40.0]]))
    assert np.linalg.norm(other, axis=2) == pytest.approx(1.0, abs=1e-14)


def test_impossible_read_outs_are_refused() -> None:
    with pytest.raises(ValueError, match="instants must be at least 1"):
        rolling(instants=0)
    with pytest.raises(ValueError, match="must be finite"):
        rolling(row_time_s=math.inf)

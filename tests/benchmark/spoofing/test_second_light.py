"""A second light in simulated sensors: against sums of single lights and closed forms."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmark import datasets
from benchmark.plan.parts import installed_parts
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.scene import Scene
from benchmark.spoofing.readings import Calibrated
from benchmark.spoofing.second_light import with_laser

SUN = from_angles(np.array([5.0, -10.0, 12.0]), np.array([3.0, 8.0, -6.0]))
LASER = from_angles(np.array([-15.0, -10.0, 20.0]), np.array([18.0, -9.0, 11.0]))


def quadrants() -> tuple[Any, Any, Scene]:
    preset = datasets.get("qpd-single-aperture")
    sensor: Any = preset.sensor_for("nominal", "test")
    return sensor, preset.fixed_pattern("nominal"), Scene(SUN, np.ones(3), np.zeros(3))


def balances(light: np.ndarray) -> np.ndarray:
    q1, q2, q3, q4 = light.T
    return np.column_stack([q2 + q3 - q1 - q4, q1 + q2 - q3 - q4]) / light.sum(axis=1)[:, None]


@pytest.mark.parametrize("suns", [0.1, 1.0, 10.0])
def test_the_balance_of_two_lights_is_the_mean_weighed_by_their_light(suns) -> None:
    sensor, pattern, scene = quadrants()
    dark = sensor.readout.dark.level()
    one, other = (sensor.expected(replace(scene, sun=sun), pattern) - dark for sun in (SUN, LASER))
    both = sensor.expected(with_laser(sensor, scene, pattern, LASER, suns), pattern) - dark
    first, second = one.sum(axis=1)[:, None], suns * other.sum(axis=1)[:, None]
    mean = (first * balances(one) + second * balances(other)) / (first + second)
    # a disc's edge against a point: the Sun's half degree moves no balance by more
    assert balances(both) == pytest.approx(mean, abs=2e-4)


def test_four_quadrants_notice_two_lights_only_where_they_differ_in_row_and_column() -> None:
    """A square opening lights quadrants by products: ``Q1 Q3 - Q2 Q4`` is 0 of one light.

    Of two it is ``-E1 E2 w^2 dx dy`` for images w wide and dx and dy apart.
    """
    sensor, _, scene = quadrants()
    camera = replace(sensor.camera, assembly=replace(sensor.camera.assembly, rotation_deg=0.0))
    mask = camera.mask
    straight = tuple(replace(a, rotation_deg=0.0) for a in mask.apertures)
    camera = replace(camera, mask=replace(mask, apertures=straight, thickness_mm=0.0))
    plain = replace(sensor, camera=camera, detector=replace(sensor.detector, gap_mm=0.0))
    pattern = {"gain": np.ones(4)}
    seen = plain.receive(with_laser(plain, scene, pattern, LASER, 1.0))
    odd = seen[:, 0] * seen[:, 2] - seen[:, 1] * seen[:, 3]
    spots = [camera.spot_mm(sun) for sun in (SUN, LASER)]
    dx, dy = (spots[1] - spots[0]).T
    width = 2.0
    light = SUN[:, 2] * LASER[:, 2]
    assert odd == pytest.approx(-light * width**2 * dx * dy / width**4, abs=1e-4)
    assert dy[1] == pytest.approx(0.0, abs=2e-3)
    assert odd[1] == pytest.approx(0.0, abs=1e-3)


def test_a_face_turned_from_the_sun_sees_the_laser_alone() -> None:
    preset = datasets.get("pd-maskless-cube")
    sensor: Any = preset.sensor_for("nominal", "test")
    pattern = {**preset.fixed_pattern("nominal"), "normals": np.array(sensor.normals)}
    laser = -SUN
    seen = sensor.receive(
        with_laser(sensor, Scene(SUN, np.ones(3), np.zeros(3)), pattern, laser, 3.0), pattern
    )
    single = sensor.receive(Scene(SUN, np.ones(3), np.zeros(3)), pattern)
    opposite = [1, 0, 3, 2, 5, 4]
    assert seen == pytest.approx(single + 3.0 * single[:, opposite], abs=1e-3)


def test_a_laser_takes_no_place_beside_the_earth() -> None:
    sensor, pattern, scene = quadrants()
    earth = replace(scene, albedo=np.ones((3, 4)))
    with pytest.raises(ValueError, match="takes the place of the Earth's light"):
        with_laser(sensor, earth, pattern, LASER, 1.0)


def test_quadrants_answer_between_the_two_and_their_residual_shows_it() -> None:
    parts = installed_parts()
    one = Calibrated(
        parts.preset("qpd-single-aperture"),
        parts.extractor("voltage-balance"),
        parts.model("polynomial-2d"),
    )
    scene = Scene(SUN, np.ones(3), np.zeros(3))
    clean, fooled = one.read(scene, "t"), one.read(scene, "t", laser=LASER, suns=1.0)
    assert (clean.errors_deg(SUN) < 0.5).all()
    # light goes with the cosine; places on the detector with the tangents
    weights = np.stack([SUN[:, 2], LASER[:, 2]])
    tangents = np.stack([sun[:, :2] / sun[:, 2:] for sun in (SUN, LASER)])
    middle = (weights[..., None] * tangents).sum(axis=0) / weights.sum(axis=0)[:, None]
    found = fooled.answers[:, :2] / fooled.answers[:, 2:]
    assert found == pytest.approx(middle, abs=math.radians(0.5))
    assert (fooled.pattern[[0, 2]] > 100.0).all()
    assert fooled.brightness == pytest.approx(2.0 * np.ones(3), abs=0.1)

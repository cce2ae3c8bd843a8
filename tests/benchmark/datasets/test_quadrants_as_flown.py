"""What a straight line in the tangent leaves of quadrants, beside a flown sensor's factory table.

From `shared/hardware/README.md`: such a line misses that table by 0.5 deg RMS over +-30 deg, 1.6
over +-45 and 4.4 over +-60; a flat cover glass leaves 0.7 over +-45.
"""

from dataclasses import replace

import numpy as np
import pytest

from benchmark.datasets.standard.qpd_single_aperture_glass import PRESET
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.scene import Scene


def balance(condition, half_deg):
    """Angles, in radians, and the balance along x of a sensor without errors of assembly."""
    sensor = PRESET.setups[condition].sensor
    aligned = replace(sensor, camera=replace(sensor.camera, assembly=Assembly()))
    angle = np.radians(np.linspace(-half_deg, half_deg, 121))
    sun = np.stack([np.sin(angle), np.zeros(angle.size), np.cos(angle)], axis=1)
    left_up, right_up, right_down, left_down = aligned.lit(
        Scene(sun, np.ones(angle.size), np.zeros(angle.size))
    ).T
    read = (left_up + left_down - right_up - right_down) / (
        left_up + left_down + right_up + right_down
    )
    return angle, read


def left(angle, read, straight, angle_of):
    """RMS error, degrees, of the line through the origin that fits `straight` best."""
    slope = read @ straight / (read @ read)
    return np.degrees(np.sqrt(np.mean((angle_of(slope * read) - angle) ** 2)))


@pytest.mark.parametrize(("half_deg", "flown_deg"), [(30, 0.5), (45, 1.6), (60, 4.4)])
def test_a_round_window_in_metallised_glass_bends_as_flown_quadrants_do(half_deg, flown_deg):
    angle, read = balance("round-aperture", half_deg)
    found = left(angle, read, np.tan(angle), np.arctan)
    assert found == pytest.approx(flown_deg, rel=0.15)
    square = left(*balance("nominal", half_deg), np.tan(angle), np.arctan)
    assert square < found


def test_glass_alone_explains_a_square_window_and_not_a_round_one():
    index = 1.52

    def angle_of(tangent):
        return np.arcsin(index * np.sin(np.arctan(tangent)))

    left_of = {}
    for condition in ("nominal", "round-aperture"):
        angle, read = balance(condition, 45)
        in_glass = np.tan(np.arcsin(np.sin(angle) / index))
        left_of[condition] = left(angle, read, in_glass, angle_of)
    assert left_of["nominal"] < 0.05
    assert 0.3 < left_of["round-aperture"] < 0.7

"""The sample file is a pinhole camera's, with the two wrong poses that it is meant to have."""

import csv
import io

import numpy as np

from algorithms.angles import sun_from_rotations
from calibrate.sample import sample


def test_readings_are_a_pinhole_s_but_at_two_poses() -> None:
    rows = list(csv.DictReader(io.StringIO(sample().decode())))
    assert list(rows[0]) == ["x_px", "y_px", "theta_x_deg", "theta_y_deg"]
    table = np.array([[float(value) for value in row.values()] for row in rows])
    spots, stated = table[:, :2], table[:, 2:]
    line = np.linspace(-45.0, 45.0, 15)
    planned = np.array([(inner, outer) for inner in line for outer in line])
    np.testing.assert_allclose(stated[:, 0], planned[:, 0], atol=6e-4)
    off = stated[:, 1] - planned[:, 1]
    assert {row: round(off[row], 1) for row in np.flatnonzero(np.abs(off) > 0.01)} == {
        37: 3.0,
        118: -4.5,
    }
    sun = sun_from_rotations(planned, inner="alpha")
    tangents = sun[:, :2] / sun[:, 2:]
    for axis in range(2):  # a line through the spots of either axis: centre and focal length
        focal, centre = np.polyfit(tangents[:, axis], spots[:, axis], 1)
        left = spots[:, axis] - centre - focal * tangents[:, axis]
        assert abs(focal - 380.0) < 0.05
        assert abs(centre - (511.2, 509.4)[axis]) < 0.02
        assert 0.03 < left.std() < 0.05

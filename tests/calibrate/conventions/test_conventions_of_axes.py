"""Axes, forms of angles and signs of runs that a file follows, or that it does not tell."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import found_in, samples, spot_table, table

from calibrate.conventions.findings import findings, linear_map
from calibrate.readings import readings_of
from calibrate.roles import guess

ANGLES = bench.grid(15, 40.0)
SUN = bench.sun_of(ANGLES)
SPOTS = bench.spots(SUN, 1)


def test_degrees_of_a_field_of_three_degrees_are_no_radians() -> None:
    sun = bench.sun_of(ANGLES / 40.0)
    spots = bench.CENTRE + 9000.0 * sun[:, :2] / sun[:, 2:]
    made = table(("x_px", "y_px", "theta_x", "theta_y"), spots, ANGLES / 40.0)
    assert "unit" not in [one.about for one in found_in(made)]


def test_where_azimuths_stand_for_rotations_nothing_is_said_of_axes() -> None:
    # a sensor that is also mirrored: its axes follow from directions that are wrong as stated
    mirrored = (SPOTS - bench.CENTRE) * [-1, 1] + bench.CENTRE
    x, y, z = SUN.T
    azimuth = np.degrees(np.column_stack([np.arctan2(y, x), np.arcsin(z)]))
    names = ("x_px", "y_px", "azimuth_deg", "elevation_deg")
    assert [one.about for one in found_in(table(names, mirrored, azimuth))] == ["axes"]
    stated = guess(table(names, mirrored, azimuth)).model_copy(
        update={"direction": guess(spot_table(SPOTS, ANGLES)).direction}
    )
    made = table(("x_px", "y_px", "theta_x_deg", "theta_y_deg"), mirrored, azimuth)
    every = readings_of(made, stated, behind=True)
    found = findings(readings_of(made, stated), stated, every)
    assert [(one.about, one.change) for one in found] == [
        ("angles", {"direction": {"form": "azimuth-elevation"}})
    ]


@pytest.mark.parametrize(
    "sun",
    [
        pytest.param(SUN[:7], id="fewer than eight poses"),
        pytest.param(bench.sun_of(np.column_stack([ANGLES[:, 0], 0 * ANGLES[:, 0]])), id="a line"),
        pytest.param(bench.sun_of(ANGLES / 4.0 + [0.0, 75.0]), id="all far off the boresight"),
    ],
)
def test_no_map_is_told_by_poses_that_do_not_spread_near_the_boresight(sun: np.ndarray) -> None:
    assert linear_map(samples(SPOTS[: len(sun)], sun)) is None


def test_a_map_over_tangents_is_the_cameras() -> None:
    found = linear_map(samples(SPOTS, SUN))
    assert found is not None
    assert found[0] == pytest.approx(bench.FOCAL * np.eye(2), abs=8.0)
    assert found[1] == pytest.approx([bench.CENTRE] * 2, abs=4.0)

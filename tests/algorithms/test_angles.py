"""Conversions between Sun vectors and angles against closed forms and each other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.angles import (
    angles_from_sun,
    rotations_from_sun,
    separation_deg,
    sun_from_angles,
    sun_from_rotations,
    sun_from_tangents,
    tangents_from_sun,
)

front = st.tuples(st.floats(-89.0, 89.0), st.floats(-89.0, 89.0))


def test_alpha_goes_with_y_and_beta_with_x():
    sun = np.array([[np.tan(np.radians(20.0)), np.tan(np.radians(-35.0)), 1.0]])
    np.testing.assert_allclose(angles_from_sun(sun), [[-35.0, 20.0]], atol=1e-13)
    np.testing.assert_allclose(sun_from_angles([[0.0, 30.0]]), [[0.5, 0.0, np.sqrt(0.75)]])
    np.testing.assert_allclose(sun_from_rotations([[30.0, 0.0]]), [[0.0, 0.5, np.sqrt(0.75)]])


@settings(deadline=None, derandomize=True)
@given(front)
def test_conversions_invert_each_other(angles):
    sun = sun_from_angles([angles])
    assert np.linalg.norm(sun) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(angles_from_sun(sun), [angles], atol=1e-10)
    np.testing.assert_allclose(sun_from_rotations(rotations_from_sun(sun)), sun, atol=1e-15)
    np.testing.assert_allclose(sun_from_tangents(tangents_from_sun(sun)), sun, atol=1e-15)


@settings(deadline=None, derandomize=True)
@given(front)
def test_rotation_angles_are_an_azimuth_and_an_elevation(angles):
    """tan(alpha_rotation) = tan(alpha_projected) cos(beta); beta is the same in both."""
    rotated = rotations_from_sun(sun_from_angles([angles]))[0]
    assert rotated[1] == pytest.approx(angles[1], abs=1e-10)
    alpha, beta = np.radians(angles)
    assert np.tan(np.radians(rotated[0])) == pytest.approx(np.tan(alpha) * np.cos(beta), abs=1e-9)


def test_directions_not_in_front_have_no_projected_angles():
    sun = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [np.nan, 0.0, 1.0], [0.0, 0.0, 1.0]])
    assert np.isnan(angles_from_sun(sun)).any(axis=1).tolist() == [True, True, True, False]
    outside = sun_from_angles([[90.0, 0.0], [0.0, -90.0], [100.0, 0.0], [np.nan, 0.0]])
    assert np.isnan(outside).all()


@settings(deadline=None, derandomize=True)
@given(front, st.floats(1e-12, 179.0), st.floats(0, 2 * np.pi))
def test_separation_is_the_angle_turned_through_however_small(angles, turn_deg, around):
    sun = sun_from_angles([angles])
    side = np.cross(sun, [[np.cos(around), np.sin(around), 0.3]])
    side /= np.linalg.norm(side)
    turn = np.radians(turn_deg)
    turned = sun * np.cos(turn) + side * np.sin(turn)
    # Coordinates of unit vectors are rounded to about 1e-16: 1e-14 degrees.
    assert separation_deg(sun, turned)[0] == pytest.approx(turn_deg, rel=1e-9, abs=3e-14)


@pytest.mark.parametrize(
    "call",
    [
        lambda: angles_from_sun([1.0, 0.0, 0.0]),
        lambda: sun_from_angles([[1.0, 2.0, 3.0]]),
        lambda: separation_deg([[1.0, 0.0, 0.0]] * 2, [[1.0, 0.0, 0.0]]),
    ],
)
def test_wrong_shapes_are_named(call):
    with pytest.raises(ValueError, match="got"):
        call()


@pytest.mark.parametrize("inner", ["alpha", "beta"])
def test_a_turntable_is_two_rotations_one_inside_the_other(inner):
    """The sensor, turned by the inner axis and then by the outer, sees the lamp there."""
    alpha, beta = 23.0, -41.0
    a, b = np.radians([alpha, beta])
    about_x = np.array([[1, 0, 0], [0, np.cos(a), np.sin(a)], [0, -np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    lamp = np.array([0.0, 0.0, 1.0])
    seen = about_y @ (about_x @ lamp) if inner == "alpha" else about_x @ (about_y @ lamp)
    np.testing.assert_allclose(sun_from_rotations([[alpha, beta]], inner)[0], seen, atol=1e-15)
    np.testing.assert_allclose(rotations_from_sun([seen], inner), [[alpha, beta]], atol=1e-12)

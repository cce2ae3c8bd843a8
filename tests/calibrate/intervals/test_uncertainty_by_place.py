"""The 1-sigma of a direction by its place, from errors whose size is known."""

from __future__ import annotations

from collections.abc import Callable

import bench
import numpy as np
import pytest

from calibrate.places import Grid, tangent_axes
from calibrate.uncertainty import (
    NORMAL_95,
    Intervals,
    covariance_of,
    intervals,
    parts_of,
    tangent_offsets,
)

#: 1-sigma (N, 2) of errors away from the boresight and across, by the angle off it and the azimuth.
Law = Callable[[np.ndarray, np.ndarray], np.ndarray]


def cone(count: int, half_deg: float, seed: int) -> np.ndarray:
    """Directions (count, 3) drawn evenly over a cone about the boresight."""
    drawn = np.random.default_rng(seed)
    z = drawn.uniform(np.cos(np.radians(half_deg)), 1.0, count)
    turn = drawn.uniform(0.0, 2.0 * np.pi, count)
    return np.column_stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z])


def off_of(sun: np.ndarray) -> np.ndarray:
    return np.asarray(np.degrees(np.arccos(np.clip(sun[:, 2], -1.0, 1.0))))


def errors(sun: np.ndarray, law: Law, seed: int, bounded: bool = False) -> np.ndarray:
    """Errors (N, 3) of directions, normal or evenly drawn, in a frame of their own."""
    x, y, z = sun.T
    across = np.column_stack([-y, x, 0 * x]) / np.hypot(x, y)[:, None]
    away = np.cross(across, sun)
    drawn = np.random.default_rng(seed)
    size = drawn.uniform(-1.0, 1.0, (len(sun), 2)) if bounded else drawn.normal(size=(len(sun), 2))
    size *= np.radians(law(np.degrees(np.arctan2(np.hypot(x, y), z)), np.arctan2(y, x)))
    return np.asarray(size[:, [0]] * away + size[:, [1]] * across)


def worse_outside(off: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """Fourfold from the boresight to 50 deg; away from it less than across, as of a spot."""
    across = 0.25 + 0.75 * (off / 50.0) ** 2
    return np.column_stack([across * np.cos(np.radians(off)), across])


def worse_to_one_side(off: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """Three times as large towards +x as towards -x at 50 deg."""
    size = 0.4 * (1.0 + 0.5 * off / 50.0 * np.cos(azimuth))
    return np.column_stack([size, size])


def covered(found: Intervals, sun: np.ndarray, off: np.ndarray) -> np.ndarray:
    """Share (2,) of errors within the 95 % interval of their axis."""
    inside = np.abs(tangent_offsets(off, sun)) <= NORMAL_95 * found.at(sun)
    return np.asarray(inside.mean(axis=0))


@pytest.mark.parametrize("bounded", [False, True])
@pytest.mark.parametrize("law", [worse_outside, worse_to_one_side])
def test_95_percent_intervals_hold_in_every_band_and_axis(law: Law, bounded: bool) -> None:
    sun, fresh = cone(3000, 50.0, 1), cone(40_000, 50.0, 2)
    found = intervals(errors(sun, law, 3, bounded), sun)
    assert found is not None
    new = errors(fresh, law, 4, bounded)
    band = (off_of(fresh) // 10).astype(int)
    for number in range(1, 5):  # the innermost has fewer than 100 poses
        share = covered(found, fresh[band == number], new[band == number])
        assert ((share >= 0.93) & (share <= 0.97)).all(), (number, share)
    assert found.coverage == pytest.approx(0.95, abs=0.01)


def test_a_side_with_larger_errors_has_wider_intervals() -> None:
    sun = cone(4000, 50.0, 1)
    found = intervals(errors(sun, worse_to_one_side, 3), sun)
    assert found is not None
    sides = bench.sun_of(np.array([[0.0, 45.0], [0.0, -45.0]]))  # towards +x, -x
    larger, smaller = found.at(sides).mean(axis=1)
    assert 2.0 < larger / smaller < 3.2  # 0.58 over 0.22


def test_between_centres_it_is_linear_and_beyond_the_last_ring_constant() -> None:
    table = np.arange(24.0).reshape(3, 4, 2)
    table[0] = 1.0
    found = Intervals(
        1.0, 0.95, 100, np.array([0.0, 0.0, 1.0]), np.array([0.0, 20.0, 40.0]), 4, table
    )
    off, turn = (
        np.radians([20.0, 30.0, 80.0, 20.0, 20.0]),
        np.radians([0.0, 90.0, 180.0, -45.0, 315]),
    )
    sun = np.column_stack([np.sin(off) * np.cos(turn), np.sin(off) * np.sin(turn), np.cos(off)])
    expected = [table[1, 0], (table[1, 1] + table[2, 1]) / 2, table[2, 2]]
    expected += [(table[1, 0] + table[1, 3]) / 2] * 2
    assert found.at(sun) == pytest.approx(np.array(expected))
    assert np.isnan(found.at(np.full((1, 3), np.nan))).all()


def test_the_rings_of_a_field_to_one_side_lie_about_its_middle() -> None:
    sun = cone(500, 20.0, 1) @ bench.turn("y", 70.0).T
    found = intervals(np.random.default_rng(2).normal(0.0, 1e-3, sun.shape), sun)
    assert found is not None
    assert found.axis @ bench.turn("y", 70.0)[:, 2] > np.cos(np.radians(2.0))
    assert found.rings_deg[-1] < 25.0


def test_a_field_all_around_has_one_value_at_either_end() -> None:
    sun = bench.sphere(3000, 1)
    grid = Grid.over(sun)
    assert grid.rings_deg[-1] > 170.0
    found = intervals(np.random.default_rng(2).normal(0.0, 1e-3, sun.shape), sun)
    assert found is not None
    for ring in (0, -1):
        assert np.ptp(found.sigma_deg[ring], axis=0) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_the_covariance_is_that_of_the_directions_drawn() -> None:
    sun = bench.sun_of(np.array([[20.0, -35.0]]))
    sigma = np.array([[0.3, 0.8]])
    first, second = tangent_axes(sun)
    drawn = np.random.default_rng(1).normal(size=(200_000, 2)) * np.radians(sigma)
    turned = sun + drawn[:, [0]] * first + drawn[:, [1]] * second
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    assert covariance_of(sigma, sun)[0] == pytest.approx(np.cov(turned.T), abs=3e-6)


def test_repeats_of_a_pose_are_left_out_together() -> None:
    sun = np.tile(cone(100, 50.0, 1), (3, 1))
    part = parts_of(sun, 5)
    assert (part[:100] == part[100:200]).all()
    assert (part[:100] == part[200:]).all()
    assert set(np.bincount(part).tolist()) == {60}
    assert parts_of(sun[:0], 5).shape == (0,)

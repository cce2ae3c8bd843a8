"""Where a calibration reaches, which samples are left out together, and which setting is best."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from algorithms.calibration.blocks import folds
from algorithms.calibration.hull import Hull
from algorithms.calibration.orders import choose_order, errors_of_orders
from algorithms.contract import UnusableDataError


@settings(deadline=None, derandomize=True, max_examples=40)
@given(seed=st.integers(0, 10_000), count=st.integers(4, 60))
def test_a_hull_holds_what_scipy_s_triangulation_does(seed, count):
    """And large batches, which are sorted by slices, as small ones, which are not."""
    rng = np.random.default_rng(seed)
    points = rng.normal((300.0, -20.0), (40.0, 2.0), (count, 2))
    hull = Hull(Hull.around(points, "test").facets, 0.0, (points[:, 0].min(), points[:, 0].max()))
    asked = rng.normal((300.0, -20.0), (60.0, 3.0), (3000, 2))
    inside = Delaunay(points).find_simplex(asked) >= 0
    clear = np.abs(hull.outside(asked)) > 1e-9
    np.testing.assert_array_equal(hull.holds(asked)[clear], inside[clear])
    parts = np.concatenate([hull.holds(asked[k : k + 100]) for k in range(0, 3000, 100)])
    np.testing.assert_array_equal(parts, hull.holds(asked))


def test_half_a_step_beyond_the_outermost_pose_is_within():
    axis = np.linspace(-10.0, 10.0, 6)  # 4 a step
    hull = Hull.around(np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2), "test")
    assert hull.margin == pytest.approx(2.0)
    assert hull.holds(np.array([[11.9, 0.0], [12.1, 0.0], [0.0, -12.1]])).tolist() == [
        True,
        False,
        False,
    ]
    wide = Hull.around(np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2), "test", 0.5)
    assert wide.margin == pytest.approx(2.0 + 0.5 * math.sqrt(400 / math.pi))


def test_a_hull_of_a_line_is_refused():
    line = np.column_stack([np.arange(9.0), 2 * np.arange(9.0)])
    with pytest.raises(UnusableDataError, match=r"test needs .* one line"):
        Hull.around(line, "test")
    with pytest.raises(UnusableDataError, match="test needs"):
        Hull.around(line[:1], "test")


def cone(half_deg, count=400, seed=0):
    rng = np.random.default_rng(seed)
    z = rng.uniform(np.cos(np.radians(half_deg)), 1, count)
    turn = rng.uniform(0, 2 * np.pi, count)
    wide = np.sqrt(1 - z**2)
    return np.column_stack([wide * np.cos(turn), wide * np.sin(turn), z])


def test_directions_are_held_by_their_cone_and_all_of_them_by_a_sphere():
    hull = Hull.of_directions(cone(40.0), "test")
    asked = cone(80.0, seed=1)
    off = np.degrees(np.arccos(asked[:, 2]))
    assert hull.holds(asked[off < 38]).all()
    assert not hull.holds(asked[off > 43]).any()
    sphere = cone(180.0, 500)
    assert len(Hull.of_directions(sphere, "test").facets) == 0
    assert Hull.of_directions(sphere, "test").holds(asked).all()
    with pytest.raises(UnusableDataError, match="one plane"):
        Hull.of_directions(np.column_stack([sphere[:, :1] * 0, sphere[:, 1:]]), "test")


def test_folds_are_alike_in_size_and_in_place():
    sun = cone(50.0, 441)
    fold = folds(sun)
    assert set(fold) == {-1, 0, 1, 2, 3, 4}  # the rim is always fitted
    assert np.bincount(fold[fold >= 0]).min() > (fold >= 0).sum() / 5 * 0.7
    for number in range(5):
        # a random fifth's mean is 0.06 off, one side's 0.4
        assert np.linalg.norm(sun[fold == number].mean(axis=0) - sun.mean(axis=0)) < 0.25


def test_repeats_and_neighbours_are_left_out_together():
    sun = cone(50.0, 300)
    np.testing.assert_array_equal(folds(np.repeat(sun, 4, axis=0)), np.repeat(folds(sun), 4))
    close = sun + 1e-11 * np.random.default_rng(4).standard_normal(sun.shape)
    np.testing.assert_array_equal(folds(close), folds(sun))


#: No places between poses: errors on samples left out as they are.
NOWHERE = np.empty((0, 9))


def test_errors_of_nested_orders_are_those_of_one_fit_each():
    rng = np.random.default_rng(8)
    x = rng.uniform(-1, 1, 120)
    design = np.polynomial.chebyshev.chebvander(x, 8)
    wanted = np.stack([np.sin(3 * x), x**3], axis=1) + rng.normal(0, 0.05, (120, 2))
    fold = np.arange(120) % 5
    sizes = [2, 3, 5, 9]
    found = errors_of_orders(design, sizes, wanted, fold, NOWHERE)
    for size, error in zip(sizes, found, strict=True):
        total = 0.0
        for number in range(5):
            fit = np.linalg.lstsq(design[fold != number, :size], wanted[fold != number])[0]
            total += ((design[fold == number, :size] @ fit - wanted[fold == number]) ** 2).sum()
        assert error == pytest.approx(total / 120, rel=1e-9)
    assert choose_order(found, "test").rms == pytest.approx(math.sqrt(found.min()))


def test_orders_that_samples_leave_open_are_not_chosen():
    x = np.repeat([-1.0, -0.3, 0.4, 1.0], 10)  # four places settle a cubic and no more
    design = np.polynomial.chebyshev.chebvander(x, 6)
    found = errors_of_orders(design, [2, 3, 5], np.sin(x)[:, None], np.arange(40) % 5, design)
    assert np.isfinite(found).tolist() == [True, True, False]
    with pytest.raises(UnusableDataError, match="test needs more samples"):
        choose_order(np.array([np.inf, np.inf]), "test")


def test_orders_are_open_that_hang_on_the_samples_of_one_fold() -> None:
    """Without them all others lie in one place, and not even a line is settled."""
    x = np.where(np.arange(40) % 5 == 0, np.linspace(-1.0, 1.0, 40), 0.0)
    design = np.polynomial.chebyshev.chebvander(x, 2)
    found = errors_of_orders(design, [2, 3], x[:, None], np.arange(40) % 5, NOWHERE[:, :3])
    assert np.isinf(found).all()


@pytest.mark.parametrize("seed", range(4))
def test_rounding_moves_no_pose_into_another_fold(seed: int) -> None:
    generator = np.random.default_rng(seed)
    steps = np.tan(np.radians(np.linspace(-60.0, 60.0, 21)))
    grid = np.stack(np.meshgrid(steps, steps, [1.0]), axis=-1).reshape(-1, 3)
    scattered = np.append(generator.uniform(-1.5, 1.5, (400, 2)), np.ones((400, 1)), axis=1)
    for places in (grid, scattered):
        sun = places / np.linalg.norm(places, axis=1, keepdims=True)
        moved = sun * (1.0 + 1e-13 * generator.standard_normal(sun.shape))
        assert (folds(moved) == folds(sun)).all()

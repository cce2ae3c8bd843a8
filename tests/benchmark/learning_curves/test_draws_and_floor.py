"""Subsets of poses: nested, seeded by names. Floors and poses needed: of curves in closed form."""

import numpy as np
import pytest

from benchmark.learning_curves.draws import LADDER, sizes, subsets
from benchmark.learning_curves.floor import NEAR, floor_of, reached_from

STEPS = sizes(441)


def rng():
    return np.random.default_rng(5)


def law(floor, excess, exponent, steps=STEPS, *, units=2, draws=3):
    """Errors (U, D, S) of the law itself."""
    square = floor**2 + excess * np.array(steps, dtype=float) ** -exponent
    return np.broadcast_to(np.sqrt(square), (units, draws, len(steps))).copy()


def every(errors):
    return np.ones(errors.shape, dtype=bool)


def test_sizes_are_the_steps_of_the_ladder_and_all_poses():
    assert sizes(81) == (4, 6, 9, 13, 18, 25, 36, 50, 81)  # 71 would say the same as 81
    assert sizes(100) == (4, 6, 9, 13, 18, 25, 36, 50, 71, 100)
    assert sizes(1) == (1,)
    ratios = np.array(LADDER[1:]) / LADDER[:-1]
    assert ratios.min() > 1.35
    assert ratios.max() <= 1.5
    with pytest.raises(ValueError, match="got 0"):
        sizes(0)


@pytest.mark.parametrize("in_order", [False, True])
def test_subsets_of_a_draw_are_nested_ascending_and_as_large_as_said(in_order):
    before = set()
    for size, rows in subsets(441, "a", "draw", 0, in_order=in_order):
        assert len(rows) == size == len(set(rows.tolist()))
        assert (np.diff(rows) > 0).all()
        assert before <= set(rows.tolist())
        if in_order:
            assert (np.diff(rows) == 1).all()
        before = set(rows.tolist())
    assert before == set(range(441))


def test_draws_follow_from_their_names_alone():
    def drawn(*names):
        return [rows.tolist() for _, rows in subsets(441, *names)]

    assert drawn("a", 1) == drawn("a", 1)
    assert drawn("a", 1) != drawn("a", 2)
    assert drawn("a", 1) != drawn("b", 1)


def test_a_random_pose_is_as_likely_as_any_other():
    counts = np.zeros(50)
    for draw in range(2000):
        _, rows = next(subsets(50, "uniform", draw))
        counts[rows] += 1
    expected = 2000 * 4 / 50
    statistic = ((counts - expected) ** 2 / expected).sum()
    assert statistic < 49 + 4 * np.sqrt(2 * 49)


@pytest.mark.parametrize(("floor", "excess", "exponent"), [(1, 100, 1), (0.02, 1, 2), (3, 10, 1.5)])
def test_the_floor_of_a_curve_that_follows_the_law_is_its_own(floor, excess, exponent):
    errors = law(floor, excess, exponent)
    found = floor_of(STEPS, errors, every(errors), rng())
    assert found.is_fitted
    assert found.exponent == exponent
    assert found.error_deg == pytest.approx([floor, floor], rel=1e-6)
    assert found.low_deg == pytest.approx([floor, floor], rel=1e-6)
    assert found.misfit < 1e-6


def test_units_have_floors_of_their_own():
    errors = np.concatenate([law(1, 50, 1, units=1), law(2, 50, 1, units=1)])
    found = floor_of(STEPS, errors, every(errors), rng())
    assert found.error_deg == pytest.approx([1, 2], rel=1e-6)


@pytest.mark.slow
def test_a_noisy_floor_lies_in_its_range_about_as_often_as_said():
    inside, found = 0, []
    for seed in range(25):
        noise = np.random.default_rng(seed)
        errors = law(1.0, 100.0, 1.0)
        excess = (errors**2 - 1.0) * np.exp(0.3 * noise.standard_normal(errors.shape) - 0.045)
        errors = np.sqrt(1.0 + excess)
        errors[:, :, -1] = errors[:, :1, -1]
        floor = floor_of(STEPS, errors, every(errors), rng())
        found += floor.error_deg
        inside += sum(a <= 1 <= b for a, b in zip(floor.low_deg, floor.high_deg, strict=True))
    assert 0.7 < inside / 50 <= 1.0
    # with all poses the error is 1.108: it does not pass for the floor
    assert np.mean(found) == pytest.approx(1.0, abs=0.03)


def test_no_floor_lies_above_what_all_poses_reach():
    errors = law(1.0, 20.0, 0.5)  # slower than the law knows
    found = floor_of(STEPS, errors, every(errors), rng())
    assert max(found.error_deg) <= errors[0, 0, -1]


def test_what_does_not_follow_the_law_ends_with_the_error_of_all_poses():
    jumps = law(1.0, 0.0, 1.0)
    jumps[:, :, ::2] = 3.0
    few = law(1.0, 50.0, 1.0)
    seen = every(few)
    seen[:, :, :-4] = False
    whole = law(1.0, 50.0, 1.0)
    for errors, counted, lawful in (
        (jumps, every(jumps), True),
        (few, seen, True),
        (whole, every(whole), False),
    ):
        found = floor_of(STEPS, errors, counted, rng(), lawful=lawful)
        assert not found.is_fitted
        assert found.error_deg == tuple(errors[:, 0, -1])
    none = every(few)
    none[1, :, -1] = False
    assert floor_of(STEPS, few, none, rng()) is None


def test_poses_needed_follow_from_the_law():
    """``f^2 + a / K <= 1.21 f^2`` from ``K = a / (0.21 f^2)`` on."""
    steps = tuple(range(1, 2000))
    errors = law(1.0, 100.0, 1.0, steps)[0, 0]
    assert reached_from(steps, errors <= NEAR) == 477
    assert reached_from(steps, errors <= 1.0) is None
    assert reached_from((4, 6, 9), [True, False, True]) == 9
    assert reached_from((4, 6, 9), [True, True, True]) == 4
    with pytest.raises(ValueError, match=r"shape \(2,\)"):
        reached_from((4, 6), [True])


def test_wrong_shapes_are_refused():
    with pytest.raises(ValueError, match=r"\(U, D, 14\)"):
        floor_of(STEPS, np.ones((2, 3, 4)), np.ones((2, 3, 4), dtype=bool), rng())

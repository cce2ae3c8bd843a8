"""How far errors follow 1/height: against SciPy's Spearman and an enumeration by hand."""

from itertools import permutations

import numpy as np
import pytest
from scipy.stats import rankdata, spearmanr

from registry.height_order import at_reference, height_order


def test_errors_that_are_one_over_height_follow_it_and_chance_is_one_of_all_orders():
    found = height_order([(0.01 / height, height) for height in (0.5, 0.75, 1.2, 3.0, 7.0)])
    assert found is not None
    assert found.correlation == pytest.approx(1.0)
    assert found.p_value == pytest.approx(1.0 / 120.0)
    assert found.holds
    assert "5 architectures" in found.sentence
    assert "1.00" in found.sentence


def test_it_is_spearmans_and_its_p_value_counts_permutations():
    drawn = np.random.default_rng(3)
    heights, errors = drawn.uniform(0.5, 7.0, 6), drawn.uniform(0.001, 1.0, 6)
    found = height_order(zip(errors.tolist(), heights.tolist(), strict=True))
    assert found is not None
    expected = spearmanr(errors, 1.0 / heights).statistic
    assert found.correlation == pytest.approx(expected)
    ranks, inverses = rankdata(errors), rankdata(1.0 / heights)
    by_chance = [np.corrcoef(order, inverses)[0, 1] for order in permutations(ranks)]
    assert found.p_value == pytest.approx(np.mean(np.array(by_chance) >= expected - 1e-9))


def test_an_order_against_the_heights_is_not_told_as_theirs():
    found = height_order([(0.01 * height, height) for height in (0.5, 0.75, 1.2, 3.0, 7.0)])
    assert found is not None
    assert found.correlation == pytest.approx(-1.0)
    assert not found.holds
    assert not found.sentence


def test_less_than_half_of_the_variance_of_ranks_is_not_most_of_an_order():
    # ranks of twenty, the lower eleven reversed: r = 0.67, r^2 = 0.45, and p below 0.01
    errors = [*range(11, 0, -1), *range(12, 21)]
    found = height_order((float(e), 1.0 / (n + 1)) for n, e in enumerate(errors))
    assert found is not None
    assert found.correlation**2 < 0.5
    assert found.p_value < 0.01
    assert not found.holds


def test_sensors_without_a_height_or_an_error_are_left_out_and_counted():
    known = [(0.01 / height, height) for height in (0.5, 0.75, 1.2, 3.0, 7.0)]
    found = height_order([*known, (0.1, None), (None, 1.0), (float("inf"), 2.0)])
    assert found is not None
    assert (found.sensors, found.without) == (5, 3)
    assert "3 have no height or error" in found.sentence


def test_four_sensors_are_too_few():
    assert height_order([(0.01 / height, height) for height in (0.5, 0.75, 1.2, 3.0)]) is None


def test_equal_heights_have_no_order():
    assert height_order([(0.01 * n, 1.0) for n in range(1, 8)]) is None


def test_a_spot_found_alike_errs_alike_at_equal_height():
    position_mm = 1e-4
    scaled = {
        round(at_reference(np.degrees(position_mm / height), height), 12)
        for height in (0.4, 1.0, 6.0)
    }
    assert scaled == {round(np.degrees(position_mm), 12)}
    assert at_reference(0.1, None) is None
    assert at_reference(None, 1.0) is None

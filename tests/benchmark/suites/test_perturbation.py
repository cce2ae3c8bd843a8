"""The search for cells whose digits hang on rounding."""

from __future__ import annotations

import numpy as np

from benchmark.plan.combinations import cells
from benchmark.plan.parts import installed
from benchmark.suites.perturbation import SIZE, perturbed, search


def test_counts_stay_and_other_numbers_move_by_a_rounding():
    values = np.array([0.0, 3.0, 0.1, np.nan])
    moved = perturbed(values, "test")
    assert moved[:2].tolist() == [0.0, 3.0]
    assert 0 < abs(moved[2] / 0.1 - 1) < 10 * SIZE
    assert np.isnan(moved[3])
    np.testing.assert_array_equal(moved, perturbed(values, "test"))


def test_no_model_of_a_cube_hangs_on_rounding():
    found = search(cells("pd-maskless-cube", "nominal"), installed())
    assert found.cells > 5
    assert [str(one) for one in found.sensitive] == []

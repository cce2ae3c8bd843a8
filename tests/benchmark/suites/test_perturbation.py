"""The search for cells whose digits hang on rounding."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark.contract import Cell
from benchmark.plan.combinations import cells
from benchmark.plan.parts import installed_parts
from benchmark.suites.perturbation import SIZE, SensitiveCell, perturb, search


def test_counts_stay_and_other_numbers_move_by_a_rounding():
    values = np.array([0.0, 3.0, 0.1, np.nan])
    moved = perturb(values, "test")
    assert moved[:2].tolist() == [0.0, 3.0]
    assert 0 < abs(moved[2] / 0.1 - 1) < 10 * SIZE
    assert np.isnan(moved[3])
    np.testing.assert_array_equal(moved, perturb(values, "test"))


@pytest.mark.slow
@pytest.mark.parametrize(
    "wanted",
    [
        cells("pd-maskless-cube", "misaligned", models="assembled-faces"),
        pytest.param(cells("pd-maskless-cube", "nominal"), marks=pytest.mark.slow),
    ],
    ids=["assembled-faces", "every model"],
)
def test_no_model_of_a_cube_hangs_on_rounding(wanted):
    found = search(wanted, installed_parts())
    assert found.cells == len(wanted) > 0
    assert [str(one) for one in found.moved_cells] == []


@pytest.mark.parametrize(
    ("before", "after", "moved"),
    [
        (0.0070338, 0.0070339, False),
        (0.75, 0.75001, False),
        (-9.3e-05, -9.4e-05, False),
        (0.99999, 1.0, False),
        (0.026765, 0.026767, True),
        (1.0, None, True),
    ],
)
def test_what_moves_is_told_from_a_last_digit_that_turns(before, after, moved):
    assert (
        SensitiveCell(Cell("d", "c", "e", "m"), "features", {"rms_deg": (before, after)}).is_moved
        is moved
    )

"""Medians of rows against NumPy's own."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from algorithms.row_arithmetic import medians

SHAPES = arrays.array_shapes(min_dims=2, max_dims=2, max_side=12)


@settings(deadline=None, derandomize=True)
@given(arrays.arrays(np.float64, SHAPES, elements=st.floats(-1e6, 1e6) | st.just(np.nan)))
def test_medians_are_numpys_and_nan_where_a_row_holds_one(rows):
    np.testing.assert_array_equal(medians(rows), np.median(rows, axis=1))


@pytest.mark.parametrize(
    "dtype", ["uint16", *(pytest.param(one, marks=pytest.mark.slow) for one in ("uint8", "int64"))]
)
@pytest.mark.parametrize("columns", [1, 2, 7, 64])
def test_the_mean_of_two_large_integers_does_not_overflow(dtype, columns):
    top = np.iinfo(dtype).max
    rows = np.random.default_rng(columns).integers(top - 9, top, (5, columns), dtype=dtype)
    np.testing.assert_array_equal(medians(rows), np.median(rows.astype(float), axis=1))


def test_medians_of_long_rows_are_numpys_whatever_their_order():
    rng = np.random.default_rng(7)
    rising = np.arange(4001.0)
    rows = [rising, rising[::-1], np.minimum(rising, rising[::-1]), rising % 977, rising % 2]
    rows += [np.zeros(4001), rng.normal(size=4001), rng.normal(100.0, 0.6, 4001).round()]
    rows += [np.where(rising % 10 == 0, 101.0, 100.0), np.sort(rng.normal(size=4001) ** 9)]
    for stack in (np.array(rows), np.array([row[1:] for row in rows])):
        np.testing.assert_array_equal(medians(stack), np.median(stack, axis=1))

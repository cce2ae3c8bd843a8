"""Direct signals and quadrant balances against closed forms of the geometry."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.extractors.currents.photodiode import DirectSignals, VoltageBalance


def quadrants_of_a_square_spot(x_mm, y_mm, width_mm):
    """Lit area of Q1 (-, +), Q2 (+, +), Q3 (+, -), Q4 (-, -) under a square spot at (x, y)."""
    right, up = width_mm / 2 + x_mm, width_mm / 2 + y_mm
    left, down = width_mm - right, width_mm - up
    return np.column_stack([left * up, right * up, right * down, left * down])


@settings(deadline=None, derandomize=True)
@given(st.floats(-40, 40), st.floats(-40, 40), st.floats(0.01, 100))
def test_balances_of_a_square_aperture_are_the_tangents_over_the_largest(alpha, beta, light):
    """ERRATA of alg:VB: tan(alpha_MAX) = d / (2 h)."""
    d, h = 4.0, 2.0
    tan_alpha, tan_beta = np.tan(np.radians([alpha, beta]))
    areas = quadrants_of_a_square_spot(np.array([h * tan_beta]), np.array([h * tan_alpha]), d)
    balances = VoltageBalance().extract(light * areas)
    np.testing.assert_allclose(
        balances, [[tan_beta * 2 * h / d, tan_alpha * 2 * h / d]], atol=1e-12
    )


@pytest.mark.parametrize(
    ("lit", "expected"),
    [(0, [-1, 1]), (1, [1, 1]), (2, [1, -1]), (3, [-1, -1])],
)
def test_quadrants_lie_where_documented(lit, expected):
    readings = np.zeros((1, 4))
    readings[0, lit] = 0.7
    assert VoltageBalance().extract(readings)[0].tolist() == expected


def test_dark_reading_and_gain_are_undone():
    rng = np.random.default_rng(1)
    light = rng.uniform(1, 5, (20, 4))
    dark, gain = (0.3, 0.1, 0.2, 0.4), (1.0, 1.1, 0.9, 2.0)
    readings = light * np.array(gain) + np.array(dark)
    np.testing.assert_allclose(
        VoltageBalance(dark=dark, gain=gain).extract(readings),
        VoltageBalance().extract(light),
        atol=1e-14,
    )
    np.testing.assert_allclose(
        DirectSignals(elements=4, dark=dark, gain=gain).extract(readings), light, atol=1e-14
    )


@pytest.mark.parametrize(
    "extractor", [DirectSignals(elements=4, saturation=5.0), VoltageBalance(saturation=5.0)]
)
def test_a_saturated_reading_makes_its_row_nan(extractor):
    readings = np.full((3, 4), 2.0)
    readings[1, 2] = 5.0
    readings[2, 0] = 4.999
    assert np.isnan(extractor.extract(readings)).all(axis=1).tolist() == [False, True, False]


def test_rows_without_positive_light_are_nan():
    readings = np.array([[-1.0, -2, -1, -1], [3.0, -2, -1, -1], [0, 0, 0, 0], [1.0, 0, 0, 0]])
    assert np.isnan(VoltageBalance().extract(readings)[:, 0]).tolist() == [True, True, True, False]
    by_sum = DirectSignals(elements=4, normalisation="sum").extract(readings)
    assert np.isnan(by_sum[:, 0]).tolist() == [True, True, True, False]
    plain = DirectSignals(elements=4).extract(readings)
    assert np.isnan(plain[:, 0]).tolist() == [True, False, True, False]

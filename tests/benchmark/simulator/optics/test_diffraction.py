"""Diffraction against quadrature, closed forms and its limits: Airy's pattern and the shadow."""

from __future__ import annotations

import math

import numpy as np
import pytest
from closed_forms import slit_intensity
from scipy import integrate, special
from scipy.special import j1

from benchmark.simulator.kernels import slit_integrals
from benchmark.simulator.optics.diffraction import (
    SUNLIT_SILICON,
    round_intensity,
)
from benchmark.simulator.optics.diffraction_tables import fresnel_table


@pytest.mark.parametrize("number", [0.02, 0.7, 3.0, 9.0])
@pytest.mark.parametrize("position", [0.0, 0.6, 1.0, 2.5])
def test_slit_is_the_integral_of_the_fresnel_phase(number: float, position: float) -> None:
    def part(function):
        inner = lambda q: function(math.pi * number * (position - q) ** 2)  # noqa: E731
        return integrate.quad(inner, -1, 1, epsabs=1e-12, epsrel=1e-12, limit=400)[0]

    expected = number * (part(math.cos) ** 2 + part(math.sin) ** 2)
    found = slit_intensity(np.array([position, -position]), number)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_straight_edge_of_a_wide_slit_has_a_quarter_of_the_light() -> None:
    assert slit_intensity(np.array([1.0]), 3000.0)[0] == pytest.approx(0.25, rel=0.02)


def test_light_behind_a_slit_is_the_light_that_entered() -> None:
    position = np.linspace(-60.0, 60.0, 60001)
    for number in (0.5, 4.0):
        total = np.trapezoid(slit_intensity(position, number), position)
        # beyond the ends, on average (1 / pi^2 N) / x^2
        tail = 2.0 / (math.pi**2 * number * 60.0)
        assert total + tail / 2.0 == pytest.approx(2.0, abs=tail)


@pytest.mark.parametrize("number", [0.004, 0.026, 0.5, 1.0, 2.0, 3.7, 9.5, 40.0])
def test_axis_behind_a_hole_swings_between_zero_and_four(number: float) -> None:
    axis = round_intensity(np.zeros(1), np.zeros(1), (number, number))[0, 0]
    assert axis == pytest.approx(4.0 * math.sin(math.pi * number / 2.0) ** 2, abs=1e-12)


@pytest.mark.parametrize("numbers", [(0.4, 0.9), (6.0, 6.0), (2.5, 8.0)])
def test_hole_is_the_double_integral_of_the_fresnel_phase(numbers: tuple[float, float]) -> None:
    """Elliptical phase fronts, as oblique light makes them; quadrature in polar coordinates."""
    x, y = np.array([0.0, 0.55, 1.3]), np.array([0.0, 0.8])
    nodes, shares = np.polynomial.legendre.leggauss(200)
    radius = (nodes[:, None] + 1.0) / 2.0
    turn = 2.0 * math.pi * np.arange(400) / 400
    q, p = radius * np.cos(turn), radius * np.sin(turn)
    weights = np.repeat(shares[:, None] / 2.0 * radius * 2.0 * math.pi / 400, 400, axis=1)
    found = round_intensity(x, y, numbers)
    for i in range(3):
        for j in range(2):
            phase = math.pi * (numbers[0] * (x[i] - q) ** 2 + numbers[1] * (y[j] - p) ** 2)
            field = np.sum(weights * np.exp(1j * phase))
            expected = numbers[0] * numbers[1] * abs(field) ** 2
            assert found[i, j] == pytest.approx(expected, abs=1e-9)


def test_small_hole_far_away_shows_airys_pattern() -> None:
    number = 0.004
    position = np.linspace(0.1, 700.0, 300)
    v = 2.0 * math.pi * number * position
    airy = (math.pi * number) ** 2 * (2.0 * j1(v) / v) ** 2
    found = round_intensity(position, np.zeros(1), (number, number))[:, 0]
    assert np.abs(found - airy).max() < 2e-5 * airy.max()
    # half the light in the radial direction, elliptical: each axis by its own number
    oblique = round_intensity(np.zeros(1), position, (number / 2.0, number))[0]
    assert np.abs(oblique - airy / 2.0).max() < 2e-5 * airy.max()


def test_light_behind_a_hole_is_the_light_that_entered() -> None:
    """Encircled energy; far out Airy's mean tail, 2 / (pi v), is missing."""
    number = 1.3
    radius = np.linspace(0.0, 25.0, 5001)
    intensity = round_intensity(radius, np.zeros(1), (number, number))[:, 0]
    total = np.trapezoid(intensity * 2.0 * radius, radius)
    missing = 2.0 / (math.pi * 2.0 * math.pi * number * 25.0)
    assert total == pytest.approx(1.0 - missing, abs=0.3 * missing)


def test_large_hole_casts_its_shadow() -> None:
    number = 400.0
    inside, outside = np.linspace(0.3, 0.8, 600), np.linspace(1.15, 1.6, 600)
    lit = round_intensity(inside, np.zeros(1), (number, number))[:, 0]
    dark = round_intensity(outside, np.zeros(1), (number, number))[:, 0]
    assert lit.mean() == pytest.approx(1.0, abs=0.01)
    assert dark.mean() < 0.01


def test_weights_are_sunlight_on_silicon() -> None:
    """Planck's photons at 5772 K times the stated quantum efficiencies."""
    efficiency = np.array([0.50, 0.60, 0.50, 0.35, 0.20, 0.08])
    micrometres = np.array(SUNLIT_SILICON.wavelengths_nm) / 1000.0
    photons = micrometres**-4.0 / np.expm1(14387.769 / (micrometres * 5772.0))
    expected = efficiency * photons / np.sum(efficiency * photons)
    assert SUNLIT_SILICON.weights == pytest.approx(expected, abs=5.1e-4)


@pytest.mark.parametrize("position", [-1.6, -0.3, 0.8, 1.4])
def test_bent_and_tilted_slits_change_light_by_the_first_order(position: float) -> None:
    """The cubic phase by quadrature; edges at two depths have Fresnel's integrals of their own."""
    number, step = 0.15, 1e-3
    nodes, shares = np.polynomial.legendre.leggauss(200)
    rho = position - nodes

    def bent(share: float) -> float:
        phase = rho**2 - 2.0 / 3.0 * share * rho**3
        field = np.sum(shares * (1.0 - share * rho) * np.exp(1j * math.pi * number * phase))
        return number * abs(field) ** 2

    def tilted(share: float) -> float:
        edges = [
            special.fresnel(math.sqrt(2.0 * number / (1.0 + side * share)) * (position - side))
            for side in (-1.0, 1.0)
        ]
        return sum((one - other) ** 2 for one, other in zip(*edges, strict=True)) / 2.0

    found = slit_integrals._skew(position, number, fresnel_table())
    for value, light in zip(found, (bent, tilted), strict=True):
        # waves from further away are faded out, here by 8 % at most
        expected = (light(step) - light(-step)) / (2.0 * step)
        assert value == pytest.approx(expected, rel=0.08, abs=2e-3)

"""Calculations of directions: against closed forms and draws."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmark.directions import paper
from benchmark.directions.paper import (
    DESIGN_MM,
    HEIGHT_MM,
    WIDTH_MM,
    hole_open,
    radial_intensity,
    zones_open,
)


def test_behind_a_hole_the_axis_has_the_intensity_of_its_fresnel_number() -> None:
    """``4 sin^2(pi N / 2)`` on the axis, N = a^2 / (lambda h)."""
    for wavelength_mm in (450e-6, 633e-6, 950e-6):
        number = (WIDTH_MM / 2.0) ** 2 / (wavelength_mm * HEIGHT_MM)
        found = radial_intensity(hole_open, wavelength_mm, np.zeros(1))[0]
        assert found == pytest.approx(4.0 * math.sin(math.pi * number / 2.0) ** 2, rel=1e-3)


def test_a_zone_plate_sends_four_times_the_square_of_its_open_zones_to_the_focus() -> None:
    """Every open zone adds a field of 2, the last one as far as the mask leaves it open."""
    zones = (WIDTH_MM / 2.0) ** 2 / (DESIGN_MM * HEIGHT_MM)
    whole, part = divmod(zones, 1.0)
    field = sum(2.0 for zone in range(int(whole)) if zone % 2 == 0)
    if int(whole) % 2 == 0:
        field += abs(1.0 - np.exp(1j * math.pi * part))
    found = radial_intensity(zones_open, DESIGN_MM, np.zeros(1))[0]
    assert found == pytest.approx(abs(field) ** 2, rel=0.05)


def test_photons_give_the_direction_of_a_slope_to_two_over_contrast_and_root_of_their_number() -> (
    None
):
    """Drawn places of photons on a disc that is brighter to one side."""
    rng = np.random.default_rng(5)
    contrast, count, found = 0.4, 4_000, []
    for _ in range(300):
        x, y = rng.uniform(-1.0, 1.0, (2, 4 * count))
        kept = (x**2 + y**2 < 1) & (rng.random(4 * count) < (1.0 + contrast * x) / (1.0 + contrast))
        found.append(math.atan2(y[kept][:count].sum(), x[kept][:count].sum()))
    assert np.std(found) == pytest.approx(2.0 / (contrast * math.sqrt(count)), rel=0.12)


def test_what_the_calculations_say() -> None:
    """Convection hides the third axis, and no baseline of a spacecraft gives the Sun's distance."""
    turn, place = paper.third_axis(), paper.positioning()
    assert not turn.pays
    assert turn.value == pytest.approx(math.degrees(0.3 / math.sqrt(1500)), rel=0.01)
    assert not place.pays
    # a metre at the Sun's distance, seen from either end to a thousandth of a degree
    assert place.value == pytest.approx(math.sqrt(2.0) * 1.745e-5 * 1.496e11, rel=1e-3)

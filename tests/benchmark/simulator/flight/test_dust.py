"""A particle's shift of the light, against openings drawn point by point with it before them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmark import datasets
from benchmark.simulator.flight.dust import dust_shift_mm
from benchmark.simulator.masks.apertures import Aperture, Mask

DUST = 0.01


def sensor(name: str, *openings: Aperture) -> Any:
    """Return a board's sensor, behind other openings if there are any."""
    held: Any = datasets.get(name).setups["nominal"].sensor
    mask = Mask(openings) if openings else held.camera.mask
    return replace(held, camera=replace(held.camera, mask=mask))


def open_points(one: Aperture, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Return places within an opening, evenly apart, from its middle."""
    sides = [
        (np.arange(round(w / step)) + 0.5) * step - w / 2.0 for w in (one.width_mm, one.height_mm)
    ]
    x, y = (axis.ravel() for axis in np.meshgrid(*sides))
    lit = np.hypot(x, y) <= one.width_mm / 2.0 if one.shape == "round" else np.full(x.shape, True)
    return x[lit], y[lit]


def moved(
    openings: tuple[Aperture, ...], y_mm: float = 0.0, half_mm: float = np.inf, step: float = 2e-4
) -> float:
    """Return how far the mean x of all light within +-half_mm moves by a disc at the first rim."""
    places = []
    for number, one in enumerate(openings):
        x, y = open_points(one, step)
        free = np.full(x.shape, True)
        if number == 0:
            free = np.hypot(x + (one.width_mm - DUST) / 2.0, y - y_mm) > DUST / 2.0
        places.append(x[free & (np.abs(y) <= half_mm)])
    return float(np.concatenate(places).mean())


ROUND, SQUARE = Aperture("round", 0.1, 0.1), Aperture("rectangle", 0.2, 0.2)
SLIT = Aperture("rectangle", 0.1, 0.5)


@pytest.mark.parametrize(
    "openings", [(ROUND,), (SQUARE,), (SLIT,), (ROUND, replace(ROUND, x_mm=0.3)), (SLIT,) * 3]
)
def test_what_is_left_of_openings_read_together_has_its_middle_there(openings: Any) -> None:
    shift = dust_shift_mm(sensor("cmos-single-aperture", *openings), DUST)
    assert shift == pytest.approx(moved(openings), rel=0.01)


def test_a_slit_of_another_direction_measures_the_other_axis() -> None:
    across = Aperture("rectangle", 0.5, 0.1)
    alone = dust_shift_mm(sensor("cmos-single-aperture", SLIT), DUST)
    assert dust_shift_mm(sensor("cmos-single-aperture", SLIT, across), DUST) == alone
    turned = replace(SLIT, rotation_deg=90.0)
    assert dust_shift_mm(sensor("cmos-single-aperture", SLIT, turned), DUST) == alone


def test_a_line_array_sees_a_particle_in_few_places_of_its_slit_and_then_strongly() -> None:
    """Root mean square over where the particle lies along the slit, the array in the middle."""
    held = sensor("pda-slit", replace(SLIT, width_mm=0.2, height_mm=2.0))
    blur = np.radians(0.533 / 2.0) * held.camera.focal_length_mm
    half = held.pixel_height_mm / 2.0 + blur
    places = np.linspace(-1.0, 1.0, 101)
    shifts = [moved(held.camera.mask.apertures, y, half, 1e-3) for y in places]
    assert dust_shift_mm(held, DUST) == pytest.approx(np.sqrt(np.mean(np.square(shifts))), rel=0.1)


def test_a_particle_wider_than_half_an_opening_counts_as_half() -> None:
    narrow = sensor("cmos-single-aperture", Aperture("round", 0.02, 0.02))
    assert dust_shift_mm(narrow, 0.03) == dust_shift_mm(narrow, 0.01) < 0.01


@pytest.mark.parametrize("name", ["ccd-lens", "pd-maskless-cube"])
def test_without_a_mask_there_is_no_rim(name: str) -> None:
    assert dust_shift_mm(datasets.get(name).setups["nominal"].sensor, DUST) == 0.0

"""How far a direction cosine reaches on the detector, against the derivative of Snell's path."""

from __future__ import annotations

import math

import numpy as np
import pytest

from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.rectangle_patterns import bend, matrix, spreading

HEIGHT_MM = 2.0
GLASS = CoverGlass((Plate(0.5, 1.46), Plate(0.2, 1.7)))


def landing_mm(sine: float, glass: CoverGlass, other: float = 0.0) -> float:
    """Distance along one axis: each layer of index n adds t s / sqrt(n^2 - s^2 - other^2)."""
    gap = HEIGHT_MM - sum(plate.thickness_mm for plate in glass.plates)
    layers = [(gap, 1.0), *((plate.thickness_mm, plate.index) for plate in glass.plates)]
    return sum(thick * sine / math.sqrt(index**2 - sine**2 - other**2) for thick, index in layers)


@pytest.mark.parametrize("glass", [CoverGlass(), GLASS])
@pytest.mark.parametrize("sine", [0.1, 0.5, 0.85])
def test_spreading_is_the_derivative_of_the_landing_point(glass: CoverGlass, sine: float) -> None:
    direction = np.array([[0.6 * sine, 0.8 * sine, math.sqrt(1 - sine**2)]])
    along, across = spreading(direction, np.full(1, HEIGHT_MM), glass)
    slope = (landing_mm(sine + 1e-6, glass) - landing_mm(sine - 1e-6, glass)) / 2e-6
    assert along[0] == pytest.approx(slope, rel=1e-6)
    assert across[0] == pytest.approx(landing_mm(sine, glass) / sine, rel=1e-12)


@pytest.mark.parametrize("glass", [CoverGlass(), GLASS])
@pytest.mark.parametrize(("x", "y"), [(0.1, 0.0), (0.5, 0.3), (-0.3, 0.6)])
def test_bend_is_half_the_second_derivative_over_the_spreading_squared(
    glass: CoverGlass, x: float, y: float
) -> None:
    direction = np.array([[x, y, math.sqrt(1 - x**2 - y**2)]])
    height = np.full(1, HEIGHT_MM)
    spread = matrix(direction, height, glass)
    found = bend(direction, height, glass, spread)[0]
    for sine, other, reach, bent in ((x, y, spread[0], found[0]), (y, x, spread[1], found[1])):
        low, middle, high = (landing_mm(sine + d, glass, other) for d in (-1e-4, 0.0, 1e-4))
        half = (low - 2 * middle + high) / 1e-8 / 2
        assert bent == pytest.approx(half / reach[0] ** 2, rel=1e-5, abs=1e-6)

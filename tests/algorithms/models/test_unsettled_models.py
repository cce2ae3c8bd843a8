"""What no model may accept: one axis swept, readings that have nothing to do with the Sun."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.contract import FeatureKind, SensorGeometry, UnusableDataError
from algorithms.discovery import discover_models

FACES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))


@pytest.mark.parametrize("held_deg", [0.0, 5.0])
def test_a_regression_an_axis_refuses_a_sweep_of_one_axis(held_deg):
    angle = np.radians(np.linspace(-35, 35, 140))
    tangents = np.column_stack([np.full(140, np.tan(np.radians(held_deg))), np.tan(angle)])
    sun = np.column_stack([tangents, np.ones(140)])
    sun /= np.linalg.norm(sun, axis=1)[:, None]
    noise = np.random.default_rng(1).normal(0.0, 0.003, (140, 2))
    with pytest.raises(UnusableDataError, match="along one axis alone"):
        discover_models()["polynomial-1d"]().fit(0.8 * tangents + noise, sun)


@pytest.mark.parametrize("name", ["basic", "solar-panel", "polynomial-signals"])
@pytest.mark.parametrize("seed", range(3))
def test_readings_that_have_nothing_to_do_with_the_sun_are_refused(name, seed):
    rng = np.random.default_rng(seed)
    sun = rng.normal(size=(200, 3))
    sun /= np.linalg.norm(sun, axis=1)[:, None]
    readings = rng.uniform(0.0, 20_000.0, (200, 6))
    geometry = SensorGeometry(face_normals=FACES)
    with pytest.raises(UnusableDataError, match="do not belong together"):
        discover_models()[name].for_sensor(geometry, FeatureKind.SIGNALS).fit(readings, sun)

"""A flight's instruments bound the direction together with the readings."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from benchmark.datasets.conditions.flight_bounds import MAGNETOMETER, posterior_bound
from benchmark.simulator.flight.gyro import Gyro

COUNT = 6
SUN = np.tile([0.0, 0.0, 1.0], (COUNT, 1))
FIELD = np.tile([30_000.0, 0.0, 0.0], (COUNT, 1))


def flight_without_instruments() -> Any:
    """A body at rest, the Sun ahead; a magnetometer whose field no model leaves anything out of."""
    leg = SimpleNamespace(
        sun_body=SUN,
        turn=np.tile(np.eye(3), (COUNT, 1, 1)),
        time_s=10.0 * np.arange(COUNT),
        field_nt=FIELD,
    )
    flight = SimpleNamespace(
        leg=lambda split: leg, gyro=Gyro(0.6, 0.0, 0.0), magnetometer_nt=300.0, horizon_deg=0.1
    )
    return SimpleNamespace(flight=flight, condition=lambda name: SimpleNamespace(bench=None))


def bound_of(deviation_rad: float | None) -> Any:
    if deviation_rad is None:
        return SimpleNamespace(fisher=None)
    fisher = np.tile(np.eye(4), (COUNT, 1, 1))
    fisher[:, :2, :2] /= deviation_rad**2
    return SimpleNamespace(fisher=fisher)


def test_a_field_known_without_error_bounds_the_turns_across_it() -> None:
    """A field along x fixes turns about y and z; with the Sun on z, one angle alone."""
    preset, single = flight_without_instruments(), bound_of(0.02)
    found = posterior_bound(preset, "nominal", MAGNETOMETER, sequential=False, bound=single)
    assert found is not None
    sun, field = 1.0 / 0.02**2, (30_000.0 / 300.0) ** 2
    expected = np.degrees(np.sqrt(1.0 / sun + 1.0 / (sun + field)))
    np.testing.assert_allclose(found, expected, rtol=1e-3)

    again = posterior_bound(preset, "nominal", MAGNETOMETER, sequential=False, bound=single)
    assert again is found, "made once for all who ask for the same"
    other = posterior_bound(preset, "nominal", MAGNETOMETER, sequential=False, bound=bound_of(0.01))
    assert other is not None
    assert (other < found).all()

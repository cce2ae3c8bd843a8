"""Errors along a flight, as they are drawn: single samples, and a filter of the same readings."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmark.sweeps import flight_plot

DARK = np.array([0, 0, 1, 1, 0])
#: Degrees that single samples and the filter are off, and that the filter states of each axis.
SINGLE, FILTERED, STATED = 2.0, 0.5, 0.3


def turned(sun: Any, angle_deg: float) -> Any:
    """Directions turned about an axis across them."""
    angle = np.radians(angle_deg)
    return np.cos(angle) * sun + np.sin(angle) * np.array([0.0, 1.0, 0.0])


class Fitted:
    """Answers with the readings, which are true directions, turned by so much."""

    @classmethod
    def for_sensor(cls, geometry: Any, kind: Any) -> Fitted:
        return cls()

    def fit(self, features: Any, sun: Any, context: Any) -> None:
        np.testing.assert_array_equal(features, sun)

    def predict(self, features: Any, context: Any) -> Any:
        return turned(features, SINGLE)

    def track(self, features: Any, context: Any) -> Any:
        stated = np.full(len(features), STATED)
        return SimpleNamespace(sun=turned(features, FILTERED), deviation_deg=stated)


def test_errors_are_from_the_first_minute_on_and_single_samples_have_none_in_the_dark(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    angles = np.linspace(0.0, 1.0, len(DARK))
    sun = np.column_stack([np.sin(angles), np.zeros(len(DARK)), np.cos(angles)])
    context = {"time_s": 600.0 + 30.0 * np.arange(len(DARK)), "eclipse": DARK}
    samples = SimpleNamespace(observations=sun, truth=sun, sun=sun, context=context)
    preset = SimpleNamespace(geometry=None, generate=lambda condition, split: samples)
    reader = SimpleNamespace(
        about=SimpleNamespace(kind="signals"), for_sensor=lambda geometry: reader
    )
    parts = SimpleNamespace(
        presets={"flight": preset}, extractor=lambda name: reader, model=lambda name: Fitted
    )
    monkeypatch.setattr(flight_plot, "installed_parts", lambda: parts)
    monkeypatch.setattr(flight_plot, "correction", lambda preset, condition: None)
    monkeypatch.setattr(flight_plot, "features_of", lambda reader, part, by: part.observations)
    found = flight_plot.along("flight", "direct", "single", "filter")
    np.testing.assert_allclose(found["minutes"], [0.0, 0.5, 1.0, 1.5, 2.0])
    np.testing.assert_array_equal(found["eclipse"], DARK)
    np.testing.assert_allclose(found["single"], np.where(DARK, np.nan, SINGLE))
    np.testing.assert_allclose(found["filtered"], FILTERED)
    np.testing.assert_allclose(found["deviation"], np.hypot(STATED, STATED))

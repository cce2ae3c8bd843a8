"""When samples of a flight are taken, in orbits."""

from __future__ import annotations

from typing import cast

import numpy as np

from algorithms.contract import Floats
from benchmark.claims.benches import ConditionView
from benchmark.datasets.conditions.flight import FlightPreset


def orbits_since(seen: ConditionView) -> Floats:
    """Orbits (N,) from the first sample of the test split; NaN in eclipse."""
    flight = cast("FlightPreset", seen.preset).flight
    context = seen.samples("test").context or {}
    since = (context["time_s"] - context["time_s"][0]) / flight.orbit.period_s
    return np.where(np.asarray(context["eclipse"], dtype=bool), np.nan, since)

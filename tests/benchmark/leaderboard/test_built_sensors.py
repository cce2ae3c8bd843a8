"""What built sensors show, the published record shows: what is off is not what scatters."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from statistics import median
from typing import Any

import pytest

from benchmark import datasets
from benchmark.datasets.conditions.flight import FlightPreset
from benchmark.datasets.realism import hardware_matches
from benchmark.results.store import PUBLISHED, Store

#: Rings of the field, degrees from the boresight, as columns of a score.
RINGS = [f"rms_{low}_{low + 10}_deg" for low in range(0, 70, 10)] + ["rms_70_90_deg"]


@cache
def leaders(model: str | None = None) -> dict[str, Mapping[str, Any]]:
    """Best answering pipeline of every data set that stands for built sensors, as it is bought.

    Of all models, or behind one.
    """
    best: dict[str, Mapping[str, Any]] = {}
    built = {name for name, one in hardware_matches().items() if one.sensors}
    for row in Store(PUBLISHED).rows():
        name = row["dataset"]
        if name not in built or row["condition"] != datasets.get(name).conditions[0] or row["unit"]:
            continue
        if row["rms_deg"] is None or row["availability"] < 0.95:
            continue
        if model not in (None, row["model"]):
            continue
        if name not in best or row["rms_deg"] < best[name]["rms_deg"]:
            best[name] = row
    return best


def over_precision() -> list[float]:
    """Three times the error on a bench over the deviation at one pose: of built sensors 10 to 60.

    Rufino 2012: 60.
    """
    flown = {name for name in leaders() if isinstance(datasets.get(name), FlightPreset)}
    still = [row for name, row in leaders().items() if name not in flown]
    answered = [row for row in still if row["repeatability_deg"] is not None]
    assert len(answered) >= 0.9 * len(still)  # in flight no pose comes twice
    return [
        3.0 * math.hypot(row["rms_deg"], bench_deg(row)) / row["repeatability_deg"]
        for row in answered
    ]


def bench_deg(row: Mapping[str, Any]) -> float:
    return datasets.get(row["dataset"]).reference_error_deg(row["condition"])


def test_accuracy_is_ten_to_sixty_times_worse_than_precision_in_the_middle() -> None:
    assert 10.0 <= median(over_precision()) <= 60.0


@pytest.mark.xfail(
    strict=True, reason="15 of 32: fitted geometry and networks bring eight more to 6 to 9.5 times"
)
def test_accuracy_is_ten_to_sixty_times_worse_than_precision_for_most() -> None:
    ratios = over_precision()
    assert sum(10.0 <= ratio <= 60.0 for ratio in ratios) >= len(ratios) / 2


def test_own_errors_tell_apart_what_a_bench_would_hide() -> None:
    """Of a third of the sensors or more the bench errs three times as much as sensor and method."""
    shares = [row["rms_deg"] / bench_deg(row) for row in leaders().values()]
    assert sum(share < 1.0 / 3.0 for share in shares) >= len(shares) / 3


def growth(row: Mapping[str, Any]) -> float:
    """Error in the outermost ring over that in the innermost."""
    rings = [row[name] for name in RINGS if row[name] is not None]
    return float(rings[-1] / rings[0])


def test_errors_grow_several_times_towards_the_edge_but_behind_tables() -> None:
    """Behind a polynomial an axis, and half as much where distance and tilt alone are fitted.

    Tables have no shape of their own: with the field's curvature they take its growth away.
    """
    by_model = {
        model: median(growth(row) for row in leaders(model).values())
        for model in ("polynomial-1d", "lsq", "lut")
    }
    assert by_model["polynomial-1d"] > 2.5
    assert by_model["lsq"] > 1.5
    assert by_model["lut"] < 1.5


def test_balances_of_quadrants_bend_towards_the_edge() -> None:
    """A line through the tangent is off several times as far beyond 40 deg as within 10."""
    rows = [
        row
        for row in Store(PUBLISHED).rows()
        if row["dataset"] == "qpd-single-aperture"
        and row["condition"] == "nominal"
        and row["extractor"] == "voltage-balance"
        and row["model"] == "linear"
        and not row["unit"]
    ]
    (row,) = rows
    assert row["rms_40_50_deg"] > 2.0 * row["rms_0_10_deg"]

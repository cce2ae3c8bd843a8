"""What the effects of a mission cost: how it is printed, and that squares add."""

from __future__ import annotations

import math

import pytest

from benchmark import datasets
from benchmark.experiments.flight_effects import FlightEffects, FlightTask
from benchmark.plan.parts import installed_parts
from benchmark.simulator.flight.mission import EFFECTS


def test_effects_are_listed_by_what_they_add_in_squares() -> None:
    row = {"extractor": "e", "model": "m", "none": 3.0, "all": 5.0}
    row |= {f"without {name}": 3.0 for name in EFFECTS}
    row |= {f"{name} alone": 3.0 for name in EFFECTS} | {"dust alone": 5.0, "heat alone": 2.0}
    said = list(FlightEffects().lines({"a": row}))
    assert said[:2] == ["a: e + m, 3 units", "  on the ground 3 deg, in flight 5 deg"]
    assert said[2] == "  dust       adds 4 deg, without it 3"
    assert any(line.startswith("  heat       adds 0 deg") for line in said)
    assert said[-5] == "  root of squares 5 deg; in flight 1.00 times that"
    assert said[-1] == "| a | 3 | 5 | dust 4, 3; launch 0, 3 |"


def test_effects_that_do_not_add_as_squares_are_named() -> None:
    row = {"extractor": "e", "model": "m", "none": 3.0, "all": 10.0}
    row |= {f"without {name}": 10.0 for name in EFFECTS} | {"without dust": 3.0}
    row |= {f"{name} alone": 3.0 for name in EFFECTS} | {"dust alone": 5.0}
    said = list(FlightEffects().lines({"a": row}))
    assert "  not as squares: dust (more with the others than alone)" in said


@pytest.mark.slow
def test_effects_of_a_mission_add_as_squares() -> None:
    parts = installed_parts()
    task = FlightTask(
        datasets.get("pd-maskless-pyramid"),
        parts.extractor("direct"),
        parts.model("assembled-faces"),
    )
    ((name, row),) = FlightEffects.measure(task)
    assert name == "pd-maskless-pyramid"
    added = [math.sqrt(max(row[f"{one} alone"] ** 2 - row["none"] ** 2, 0.0)) for one in EFFECTS]
    assert row["all"] == pytest.approx(math.hypot(row["none"], *added), rel=0.15)

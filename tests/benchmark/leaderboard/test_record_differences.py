"""Differences of two records name the file and the cell."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from fake_results import cell, components, numbers, pin
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmark.contract import Cell
from benchmark.datasets.pins import Pin
from benchmark.leaderboard.check import Difference, compare, compare_scores
from benchmark.metrics.rings import RINGS
from benchmark.metrics.score import METRICS
from benchmark.results.store import Store


def stored(directory: Path, scores: Mapping[Cell, Any], *pins: Pin) -> Store:
    store = Store(directory)
    store.write(scores, pins, components())
    return store


@pytest.mark.parametrize(
    ("pins", "states"),
    [
        (([pin()], []), ("present", "no such data")),
        (([], [pin()]), ("absent", "pinned")),
        (([pin()], [pin(version=2)]), ("version 1", "version 2")),
        (
            ([pin()], [pin(n=4)]),
            ("version 1", "n 4, pinned 3: the data changed and the version did not"),
        ),
        (([pin()], [pin()]), None),
    ],
)
def test_data_that_one_of_two_records_pins_otherwise_are_named(
    pins: tuple[list[Pin], list[Pin]], states: tuple[str, str] | None, tmp_path: Path
) -> None:
    one, other = (stored(tmp_path / str(k), {}, *each) for k, each in enumerate(pins))
    expected = [Difference("pins.csv", "d/c/test", *states)] if states else []
    assert compare(one, other) == expected


def test_scores_that_one_of_two_records_has_otherwise_are_named(tmp_path: Path) -> None:
    one = stored(tmp_path / "one", {cell("a"): numbers(0.5), cell("b"): numbers()}, pin(n=100))
    other = stored(
        tmp_path / "other",
        {cell("a"): numbers(0.6, availability=0.9951), cell("m"): numbers()},
        pin(n=100),
    )
    found = compare(one, other)
    assert [(d.file, d.cell) for d in found] == [
        ("scores/d.csv", f"{cell('a')}/{column}") for column in ("rms_deg", "rms_all_answers_deg")
    ] + [("scores/d.csv", f"{cell(name)}/row") for name in ("b", "m")]
    assert [(d.committed, d.measured) for d in found] == [
        ("0.5", "0.6"),
        ("0.5", "0.6"),
        ("present", "not measured"),
        ("absent", "measured"),
    ]
    assert str(found[0]) == f"scores/d.csv: {cell('a')}/rms_deg is 0.5, should be 0.6"


CELL = Cell("fake-diodes", "noisy", "fake-currents", "fake-least-squares")


def differences(column, value, measured, **row):
    """Compare one number with another measured; 400 samples."""
    base = {"status": "ok", **dict.fromkeys(METRICS), "reason": "", "rms_deg": 0.5, **row}
    committed, found = {CELL: {**base, column: value}}, {CELL: {**base, column: measured}}
    counted = {("fake-diodes", "noisy"): 400}
    return [d.cell for d in compare_scores(committed, found, counted)]


def test_accuracy_is_compared_within_a_ten_thousandth_and_shares_within_a_sample():
    assert differences("median_deg", 0.5, 0.5 * (1 + 9e-5)) == []
    assert differences("median_deg", 0.5, 0.5 * (1 + 2e-4)) == [f"{CELL}/median_deg"]
    assert differences("availability", 1.0, 1 - 1 / 400) == []
    assert differences("availability", 1.0, 1 - 2 / 400) == [f"{CELL}/availability"]
    assert differences("false_detection_rate", None, 0.0) == [f"{CELL}/false_detection_rate"]
    assert differences("rms_deg", None, 0.5) == [f"{CELL}/rms_deg"]
    assert differences("status", "ok", "failed") == [f"{CELL}/status"]
    # a mean near zero is as uncertain as the spread it averages
    assert differences("bias_alpha_deg", 1e-9, -4e-5) == []
    assert differences("bias_alpha_deg", 1e-9, -6e-5) == [f"{CELL}/bias_alpha_deg"]


COLUMNS = [name for name in METRICS if name not in ("availability", "false_detection_rate")]


@settings(deadline=None, derandomize=True)
@given(
    column=st.sampled_from([name for name in COLUMNS if not name.startswith("bias_")]),
    value=st.floats(1e-9, 180.0),
    factor=st.floats(1.0, 1.1),
)
def test_a_fifth_of_a_percent_is_found_in_every_column_and_rounding_in_none(column, value, factor):
    digits = 4 if column in {ring.column for ring in RINGS} else 5
    one, other = (float(f"{v:.{digits}g}") for v in (value, value * factor))
    found = bool(differences(column, one, other))
    if factor > 1.0021:  # the step of a number of four digits, and the tolerance
        assert found
    if abs(factor - 1.0) < 1e-5:
        assert not found

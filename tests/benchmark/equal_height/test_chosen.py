"""On a design the pipeline is chosen on the standard unit, and quoted on others."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from benchmark.equal_height import measure as equal
from benchmark.equal_height.designs import DESIGNS, Place


def named(name: str) -> Any:
    return SimpleNamespace(about=SimpleNamespace(name=name))


GOOD, LUCKY, SILENT = ((named(f"e-{n}"), named(f"m-{n}")) for n in ("good", "lucky", "silent"))
#: RMS errors, degrees, on the standard unit and on the others.
ERRORS = {"e-good": (0.2, 0.25), "e-lucky": (0.1, 0.5)}


def scored(built: Any, condition: str, pipeline: Any, unit: int) -> Any:
    if pipeline is SILENT:
        return None
    error = ERRORS[pipeline[0].about.name][unit > 0] * (4.0 if condition == "flight" else 1.0)
    return SimpleNamespace(rms_all_answers_deg=error, bound_deg=0.05)


def row_of(monkeypatch: pytest.MonkeyPatch, pipelines: Any, place: Place | None = None) -> Any:
    monkeypatch.setattr(equal, "_score", scored)
    return equal.measure(equal.EqualTask("n-slit", place or Place(), pipelines, units=3))


def test_what_errs_least_on_the_standard_unit_is_quoted_on_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    row = row_of(monkeypatch, (SILENT, GOOD, LUCKY))
    assert (row["extractor"], row["model"]) == ("e-lucky", "m-lucky")
    for column, error in (("own", 0.5), ("flight", 2.0)):
        for end in ("error", "low", "high"):
            assert row[f"{column}_{end}_deg"] == pytest.approx(error)
    assert (row["bound_deg"], row["units"], row["reason"]) == (0.05, 3, "")
    assert (row["design"], row["mask"]) == ("n-slit", DESIGNS["n-slit"].mask)
    assert (row["height_mm"], row["half_fov_deg"]) == (0.5, 60.0)


def test_a_design_that_nothing_reads_has_a_reason_and_no_number(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    row = row_of(monkeypatch, (SILENT,))
    assert row["reason"] == "no pipeline of this mask answers often enough here"
    assert row["own_error_deg"] is None
    assert row["extractor"] == ""


def test_one_pipeline_an_extractor_is_tried_of_those_that_answer() -> None:
    def row(extractor: str, model: str, error: float | None, **other: Any) -> dict[str, Any]:
        plain = {"dataset": "d", "condition": "c", "unit": 0, "availability": 1.0}
        found = {"extractor": extractor, "model": model, "rms_all_answers_deg": error}
        return {**plain, **found, **other}

    rows = [
        *(row("b", "one", 0.2), row("a", "two", 0.1), row("a", "three", 0.05), row("c", "x", None)),
        *(row("d", "x", 0.01, availability=0.9), row("e", "x", 0.01, unit=1)),
        *(row(f"z{n}", "x", 1.0 + n) for n in range(equal.TRIED)),
    ]
    found = equal.candidates(rows, "d", "c")
    assert found[:3] == [("a", "three"), ("b", "one"), ("z0", "x")]
    assert len(found) == equal.TRIED

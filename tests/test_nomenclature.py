"""The page of nomenclature names what the code has, no more and no less."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

from algorithms.context import CONTEXT
from algorithms.design import SensorGeometry
from algorithms.filtering.state_space import StateSpace
from benchmark.metrics.score import METRICS

PAGE = (Path(__file__).parents[1] / "docs" / "nomenclature.md").read_text("utf-8")


def names(section: str) -> set[str]:
    """Names in code of a section's table."""
    body = PAGE.split(f"## {section}\n")[1].split("\n## ")[0]
    cells = [line.split(" | ")[1] for line in body.splitlines() if line.startswith("| ")][2:]
    return set(re.findall(r"`([^`]+)`", " ".join(cells)))


def test_the_design_s_fields_are_all_there() -> None:
    assert names("Design of a sensor") == {f.name for f in dataclasses.fields(SensorGeometry)}


def test_the_context_s_columns_are_all_there() -> None:
    assert names("Context of a sample") == set(CONTEXT)


def test_the_scores_are_all_there_but_the_rings() -> None:
    scores = {name for name in METRICS if not name.startswith("rms_") or name[4].isalpha()}
    assert names("Scores") == scores | {"own_error_deg", "on_bench_deg"}


def test_the_filters_symbols_are_methods_of_the_state_space() -> None:
    assert names("Filters") <= set(vars(StateSpace))

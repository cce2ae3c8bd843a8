"""`sunatlas plan`, `run --suite`, `verify` and `gc`: what they say, and their exit codes."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli import measuring
from api.cli.command_line import app
from api.cli.commands import plan
from benchmark.contract import Cell
from benchmark.leaderboard.scope import first
from benchmark.plan.parts import Parts, installed_parts
from benchmark.results.store import Store
from benchmark.running.runner import run
from benchmark.suites import planning


def sunatlas(*arguments: object) -> Any:
    return CliRunner().invoke(app, list(map(str, arguments)), catch_exceptions=False)


@pytest.fixture
def working(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working store; what is published stays."""
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path / "working"))
    return tmp_path / "working"


@pytest.fixture
def small(working: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two small data sets with one model are all there is, and nothing is published."""
    known = installed_parts()
    names = ("pd-maskless-cube", "qpd-single-aperture")
    few = Parts(
        {name: known.presets[name] for name in names},
        {name: known.extractors[name] for name in ("direct", "voltage-balance")},
        {name: known.models[name] for name in ("basic", "qpd")},
    )
    monkeypatch.setattr(planning, "every_part", lambda: few)
    monkeypatch.setattr(measuring, "PUBLISHED", working.parent / "published")
    return working


@pytest.fixture
def published(small: Path) -> Store:
    """A record of the small plan."""
    store = Store(measuring.PUBLISHED)
    run(first(planning.every_part()), store, progress=lambda *_told: None)
    return store


@pytest.mark.slow
def test_a_record_that_holds_is_verified_and_nothing_is_written(
    published: Store, small: Path
) -> None:
    before = {path: path.read_bytes() for path in published.directory.rglob("*.csv")}
    told = ("verify", "--sample", "1", "--seed", "7", "--workers", "1", "--format", "json")
    verified = sunatlas(*told)
    assert verified.exit_code == 0, verified.stderr
    assert "2 cells, drawn by --seed 7" in verified.stderr
    assert "1 of 1" in verified.stderr
    drawn = json.loads(verified.stdout)
    assert (len(drawn["cells"]), drawn["alike"], drawn["differences"]) == (1, 1, [])
    assert drawn["seed"] == 7
    assert {path: path.read_bytes() for path in published.directory.rglob("*.csv")} == before
    assert not small.exists()


def test_a_plan_counts_what_is_new_by_data_set_and_stage(small: Path) -> None:
    cells = list(first(planning.every_part()))
    shown = sunatlas("plan", "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    found = json.loads(shown.stdout)
    assert found["planned"] == len(found["missing"]) == len(cells) > 1
    assert {row["why"] for row in found["missing"]} == {"new"}
    assert found["stages"]["predictions"] == len(cells)
    assert f"{len(cells)} of {len(cells)} cells to be measured" in shown.stderr
    table = sunatlas("plan").stdout
    for name in {cell.dataset for cell in cells}:
        count = sum(cell.dataset == name for cell in cells)
        assert re.search(rf"new\s+{name}\s+{count}\b", table), table


def test_reasons_to_measure_are_named_with_what_they_are_of() -> None:
    cell = Cell("set", "nominal", "centroid", "table")
    for reasons, said in (
        (("new",), "new"),
        ((planning.FAILED,), "failed before"),
        (("dataset", "model"), "data set, model table changed"),
        (("extractor", "metrics"), "extractor centroid, metrics changed"),
    ):
        assert plan._why(cell, reasons) == said

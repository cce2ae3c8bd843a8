"""`sunatlas plan`, `run` and `benchmark`: what they print of what was planned or measured.

Measuring has tests of its own (`test_cli_suites.py`); here a stand-in tells how it went.
"""

from __future__ import annotations

import csv
import dataclasses
import importlib
import io
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer.testing import CliRunner

from api.calibrate import calibration
from api.cli.command_line import app
from api.cli.measuring import ScoredCells
from benchmark.contract import Cell
from benchmark.running.durations import Estimate
from benchmark.running.kept_stages import StageCounts
from benchmark.suites import planning
from benchmark.suites.planning import FAILED, NEW, CellPlan
from registry.fidelity.grading import Fidelity
from registry.fidelity.runnable import Gap
from registry.resolution import Resolution

FIRST, SECOND, THIRD, FOURTH = (
    Cell("pd-slit", "nominal", "direct", model) for model in ("ann", "basic", "dnn", "lut")
)
NO_STAGES = StageCounts(0, 0, 0, 0)


def sunatlas(*arguments: object) -> Any:
    call = list(map(str, arguments))
    return CliRunner(env={"COLUMNS": "200"}).invoke(app, call, catch_exceptions=False)


def rows_of(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


# ---- plan


class Planned:
    """What planning finds, and how often it was asked."""

    def __init__(self) -> None:
        self.missing: Mapping[Cell, tuple[str, ...]] = {}
        self.stages = NO_STAGES
        self.estimate = Estimate(0.0, 0, 0)
        self.asked = 0

    def __call__(self, cells: Iterable[Cell], _: object) -> CellPlan:
        self.asked += 1
        return CellPlan(tuple(cells), self.missing, self.stages, self.estimate)


@pytest.fixture
def planned(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Planned:
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path / "cache"))
    found = Planned()
    monkeypatch.setattr(planning, "plan", found)
    monkeypatch.setattr(planning, "cells_of", lambda *_: [FIRST, SECOND, THIRD, FOURTH])
    return found


def test_a_plan_with_nothing_to_do_is_kept_until_a_file_changes(
    planned: Planned, tmp_path: Path
) -> None:
    store = tmp_path / "store"
    for times in (1, 1):
        shown = sunatlas("plan", "--store", store)
        assert (shown.exit_code, shown.stdout) == (0, "")
        assert shown.stderr == "standard: 0 of 4 cells to be measured\n"
        assert planned.asked == times
    document = json.loads(sunatlas("plan", "--store", store, "--format", "json").stdout)
    assert (document["planned"], document["missing"]) == (4, [])
    store.mkdir()
    (store / "scores.csv").write_text("changed")
    sunatlas("plan", "--store", store)
    assert planned.asked == 3


def test_a_plan_counts_cells_by_reason_and_data_set(planned: Planned) -> None:
    planned.missing = {
        FIRST: (NEW,),
        SECOND: (NEW,),
        THIRD: (FAILED,),
        FOURTH: ("dataset", "extractor", "model", "harness"),
    }
    planned.stages = StageCounts(1, 2, 3, 4)
    planned.estimate = Estimate(30.0, 3, 1)
    why = "data set, extractor direct, model lut, harness changed"
    shown = sunatlas("plan", "--workers", 2)
    lines = [line.split("  ") for line in shown.stdout.splitlines()]
    assert lines[0] == ["standard: to be measured"]
    table = [[cell.strip() for cell in line if cell.strip()] for line in lines[3:]]
    assert table == [
        [why, "pd-slit", "1"],
        ["failed before", "pd-slit", "1"],
        ["new", "pd-slit", "2"],
    ]
    assert shown.stderr == (
        "standard: 4 of 4 cells to be measured; about 15 s on 2 workers, and 1 of 3 tasks whose "
        "like never ran here\n"
        "by stage: data sets to generate 1, features to extract 2, models to fit 3, scores to "
        "compute 4\n"
    )
    listed = rows_of(sunatlas("plan", "--format", "csv").stdout)
    assert [(row["model"], row["why"]) for row in listed] == [
        *(("ann", "new"), ("basic", "new"), ("dnn", "failed before"), ("lut", why)),
    ]


@pytest.mark.parametrize(
    ("estimate", "said"),
    [
        (Estimate(0.0, 2, 2), "how long that takes is known here once it has been run\n"),
        (Estimate(30.0, 2, 0), "about 30 s on 1 workers\n"),
        (Estimate(0.0, 0, 0), "about 0 s on 1 workers\n"),  # all is predicted already
    ],
)
def test_a_plan_says_how_long_it_takes_where_that_is_known(
    planned: Planned, estimate: Estimate, said: str
) -> None:
    planned.missing, planned.estimate = {FIRST: (NEW,)}, estimate
    assert f"1 of 4 cells to be measured; {said}" in sunatlas("plan", "--workers", 1).stderr


# ---- run and benchmark


def scored(
    cells: Iterable[Cell], *, kept: int = 0, measured: int = 0, warnings: tuple[str, ...] = ()
) -> ScoredCells:
    """Scores of cells, of which some were kept or are measured now and the others published."""
    wanted = sorted(cells)
    names = ("dataset", "condition", "extractor", "model", "unit")
    rows = [
        {**{name: getattr(cell, name) for name in names}, "rms_deg": 0.1 + place}
        for place, cell in enumerate(wanted)
    ]
    published = len(wanted) - kept - measured
    return ScoredCells(rows, published, kept, measured, Path("a-store"), warnings)


def test_a_suite_is_run_until_its_scores_select_no_more_cells(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Two cells, then a third that follows from their scores; one of them was there before."""
    module = importlib.import_module("api.cli.commands.run")
    found = iter([[FIRST, SECOND], [FIRST, SECOND, THIRD], [FIRST, SECOND, THIRD]])
    results = iter(
        [
            scored([FIRST, SECOND], kept=1, measured=1),
            scored([FIRST, SECOND, THIRD], kept=2, measured=1),
        ]
    )
    asked: list[list[Cell]] = []

    def score(cells: list[Cell], *_: object) -> ScoredCells:
        asked.append(cells)
        return next(results)

    monkeypatch.setattr(module, "cells_of", lambda *_: next(found))
    monkeypatch.setattr(module, "score_cells", score)
    shown = sunatlas("run", "--suite", "quick", "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    assert asked == [[FIRST, SECOND], [FIRST, SECOND, THIRD]]
    document = json.loads(shown.stdout)
    assert document["suite"] == "quick"
    assert [row["model"] for row in document["scores"]] == ["ann", "basic", "dnn"]
    assert document["sources"] == {
        "published": 0,
        "kept": 1,
        "measured": 2,
        "directory": "a-store",
    }
    assert shown.stderr.startswith("0 published, 1 measured before, 2 measured now; ")


@pytest.mark.parametrize("form", ["table", "csv"])
def test_a_suite_is_printed_with_the_unit_of_each_score(
    monkeypatch: pytest.MonkeyPatch, form: str
) -> None:
    module = importlib.import_module("api.cli.commands.run")
    other = dataclasses.replace(FIRST, unit=3)
    monkeypatch.setattr(module, "cells_of", lambda *_: [FIRST, other])
    monkeypatch.setattr(module, "score_cells", lambda *_: scored([FIRST, other]))
    shown = sunatlas("run", "--suite", "quick", "--format", form)
    if form == "csv":
        assert [row["unit"] for row in rows_of(shown.stdout)] == ["0", "3"]
    else:
        title, heading, _, *lines = shown.stdout.splitlines()
        assert (title, heading.split()[0]) == ("quick: 2 scores", "unit")
        assert [line.split()[0] for line in lines] == ["0", "3"]


STUDY = "Allgeier2009"
GAPS = (Gap("mask", "Slit", "no such data set"), Gap("model", "Basic", "not there"))


@pytest.fixture
def resolved(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Run a study of which nothing runs: there is none, so its resolution is a stand-in."""
    grade = Fidelity("none", "Nothing of it runs.")
    nothing = Resolution(STUDY, grade, "none", (), GAPS)
    known = SimpleNamespace(of=lambda _: SimpleNamespace(resolutions={STUDY: nothing}))
    module = importlib.import_module("api.cli.commands.run")
    monkeypatch.setattr(module, "knowledge", lambda: known)

    def run(*arguments: str, warnings: tuple[str, ...] = (), kept: int = 0) -> Any:
        result = ScoredCells([], 0, kept, 0, Path("a-store"), warnings)
        monkeypatch.setattr(module, "score_cells", lambda *_: result)
        return sunatlas("run", STUDY, *arguments)

    return run


@pytest.mark.parametrize("form", ["table", "csv"])
def test_a_study_of_which_nothing_runs_fails_with_its_gaps(resolved: Any, form: str) -> None:
    shown = resolved("--format", form, warnings=("a worker was slow",))
    assert shown.exit_code == 1
    assert shown.stderr.splitlines() == [
        "none: Nothing of it runs.",
        "warning: a worker was slow",
        *(f"gap: {one.attribute} {one.value}: {one.reason}" for one in GAPS),
        f"sunatlas: nothing of {STUDY} runs yet; its gaps are listed above",
    ]


def test_in_json_the_gaps_are_of_the_document(resolved: Any) -> None:
    shown = resolved("--format", "json", warnings=("a worker was slow",))
    assert shown.exit_code == 1
    document = json.loads(shown.stdout)
    assert document["gaps"] == [one.to_dict() for one in GAPS]
    assert (document["grade"], document["scores"]) == ("none", [])
    assert shown.stderr.splitlines() == [
        "warning: a worker was slow",
        f"sunatlas: nothing of {STUDY} runs yet; its gaps are listed above",
    ]


def test_where_scores_were_kept_it_is_said_in_which_store(resolved: Any) -> None:
    said = "0 published, 2 measured before, 0 measured now; kept in a-store\n"
    assert said in resolved(kept=2).stderr
    assert "kept in" not in resolved().stderr


@pytest.mark.parametrize("form", ["table", "json", "csv"])
def test_benchmark_prints_what_the_runner_warns_of(
    monkeypatch: pytest.MonkeyPatch, form: str
) -> None:
    module = importlib.import_module("api.cli.commands.benchmark")
    monkeypatch.setattr(
        module, "score_cells", lambda cells, *_: scored(cells, warnings=("no Dask", "slow disk"))
    )
    one = ("--dataset", "pd-maskless-cube", "--condition", "nominal", "--model", "basic")
    shown = sunatlas("benchmark", *one, "--format", form)
    assert shown.exit_code == 0, shown.stderr
    assert "pd-maskless-cube" in shown.stdout
    *warnings, sources = shown.stderr.splitlines()
    assert warnings == ["warning: no Dask", "warning: slow disk"]
    assert sources.endswith("new results are kept in a-store")


def test_own_data_on_which_few_models_answer_are_like_no_data_set(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    answered = SimpleNamespace(name="homography", rms_deg=0.1, spread_deg=0.01, refused="")
    refused = SimpleNamespace(name="spm", rms_deg=9.0, spread_deg=9.0, refused="too few poses")
    found = SimpleNamespace(candidates=[answered, refused])
    monkeypatch.setattr(calibration, "calibrate", lambda *_, **__: found)
    shown = sunatlas("benchmark", "--data", tmp_path / "own.csv", "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    assert shown.stderr == "fewer than four models answer here and on a standard data set\n"
    rows = json.loads(shown.stdout)
    assert [(row["model"], row["rms_deg"], row["standard_error_deg"]) for row in rows] == [
        ("homography", 0.1, 0.01),
        ("spm", None, None),
    ]
    assert [row["reason"] for row in rows] == ["", "too few poses"]
    assert {row["dataset"] for row in rows} == {row["dataset_own_deg"] for row in rows} == {None}

"""`sunatlas leaderboard` and `rank`: what they print of what was measured, compared or chosen.

Measuring has tests of its own (`test_cli_measuring.py`); here a stand-in tells how it went.
"""

from __future__ import annotations

import csv
import json
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli import asking
from api.cli.command_line import app
from api.cli.commands import leaderboard
from api.cli.commands import rank as ranking
from api.cli.contract import ContractResult
from api.service.knowledge import Knowledge
from benchmark.contract import Cell
from benchmark.leaderboard import candidate, check, update
from benchmark.leaderboard.candidate import Ranking
from benchmark.leaderboard.check import Difference
from benchmark.leaderboard.pages import FORMATS
from benchmark.results.store import PUBLISHED
from benchmark.results.times import COLUMNS, MACHINE, TIMES, read_times
from benchmark.running import times
from benchmark.running.runner import Summary

DATASET = "qpd-maskless-pyramid"


def sunatlas(*arguments: object) -> Any:
    call = list(map(str, arguments))
    return CliRunner(env={"COLUMNS": "300"}).invoke(app, call, catch_exceptions=False)


# ---- leaderboard --check

DIFFERENT = Difference("scores/a.csv", "a/nominal/x/y/rms_deg", "1.0", "2.0", "older")


class Checked:
    """What a check finds, and how it was asked."""

    def __init__(self) -> None:
        self.found: list[Difference] = []
        self.asked: list[tuple[Any, ...]] = []

    def __call__(self, directory: Path, workers: int, **options: Any) -> list[Difference]:
        self.asked.append((directory, workers, options["stored_only"], tuple(options["kernels"])))
        return self.found


@pytest.fixture
def checked(monkeypatch: pytest.MonkeyPatch) -> Checked:
    found = Checked()
    monkeypatch.setattr(check, "check", found)
    return found


@pytest.mark.parametrize(
    ("options", "stored", "kernels", "how"),
    [
        ((), False, ("native", "older"), "measured again with native and older kernels"),
        (("--kernels", "both"), False, ("native", "older"), "with native and older kernels"),
        (("--kernels", "older"), False, ("older",), "measured again with older kernels"),
        (("--kernels", "native"), False, ("native",), "measured again with native kernels"),
        (("--stored",), True, ("native", "older"), "the files agree with each other and the code"),
    ],
)
def test_a_check_that_holds_says_how_it_was_made(
    checked: Checked, options: tuple[str, ...], stored: bool, kernels: tuple[str, ...], how: str
) -> None:
    shown = sunatlas("leaderboard", "--check", "--workers", 3, *options)
    assert (shown.exit_code, shown.stdout) == (0, "")
    assert shown.stderr.startswith("every published number holds: ")
    assert shown.stderr.endswith(f"{how}\n")
    assert checked.asked == [(PUBLISHED, 3, stored, kernels)]


def test_a_check_that_finds_differences_fails_and_lists_them(checked: Checked) -> None:
    checked.found = [DIFFERENT, Difference("leaderboard.md", "line 3", "a", "b")]
    shown = sunatlas("leaderboard", "--check", "--format", "json")
    assert shown.exit_code == 1
    assert json.loads(shown.stdout)[0] == {
        "file": "scores/a.csv",
        "cell": "a/nominal/x/y/rms_deg",
        "committed": "1.0",
        "measured": "2.0",
        "kernels": "older",
    }
    assert shown.stderr == (
        "sunatlas: 2 differences, the first: scores/a.csv: a/nominal/x/y/rms_deg is 1.0, should be "
        "2.0 (older kernels)\n"
    )
    table = sunatlas("leaderboard", "--check")
    assert table.stdout.startswith("2 differences\n")


def test_a_check_that_holds_is_an_empty_document(checked: Checked) -> None:
    shown = sunatlas("leaderboard", "--check", "--format", "json")
    assert (shown.exit_code, json.loads(shown.stdout)) == (0, [])
    assert len(checked.asked) == 1


# ---- leaderboard update, render, times


def test_an_update_says_what_failed_and_how_many_cells_were_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[tuple[Path, int]] = []
    cell = Cell("pd-slit", "nominal", "direct", "basic")
    summary = Summary(PUBLISHED, 12, 9, 3, ((cell, "no fit"),), ("a slow disk",), 4.25)

    def done(directory: Path, workers: int) -> Summary:
        asked.append((directory, workers))
        return summary

    monkeypatch.setattr(update, "update", done)
    shown = sunatlas("leaderboard", "update", "--workers", 2)
    assert (shown.exit_code, shown.stdout) == (0, "")
    assert asked == [(PUBLISHED, 2)]
    assert shown.stderr.splitlines() == [
        f"failed: {cell}: no fit",
        "warning: a slow disk",
        f"12 cells, 3 measured in 4.2 s, 9 stored before; in {PUBLISHED}",
    ]


@pytest.fixture
def board(knowledge: Knowledge, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What is published of one data set, and little else."""
    whole = knowledge.measurements.leaderboard
    one = next(found for found in whole["datasets"] if found["name"] == DATASET)
    made: dict[str, Any] = {**whole, "datasets": [one], "sweeps": whole["sweeps"][:9]}
    known = SimpleNamespace(measurements=SimpleNamespace(leaderboard=made))
    monkeypatch.setattr(asking, "knowledge", lambda: known)
    return made


@pytest.mark.parametrize("safe", [False, True])
def test_every_derived_file_is_written_and_named(
    board: dict[str, Any], tmp_path: Path, safe: bool
) -> None:
    shown = sunatlas("leaderboard", "render", "--out", tmp_path, *(["--safe"] if safe else []))
    assert shown.exit_code == 0, shown.stderr
    assert shown.stdout.splitlines() == [str(tmp_path / name) for name in FORMATS]
    assert {path.name for path in tmp_path.iterdir()} == set(FORMATS)
    with (tmp_path / "leaderboard.csv").open(newline="", encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == len(board["datasets"][0]["rows"])


def test_where_nothing_is_published_nothing_is_written(
    board: dict[str, Any], tmp_path: Path
) -> None:
    board["datasets"] = []
    shown = sunatlas("leaderboard", "render", "--out", tmp_path / "out")
    assert shown.exit_code == 2
    assert "nothing is published in" in shown.stderr
    assert "`sunatlas leaderboard update`" in shown.stderr
    assert not (tmp_path / "out").exists()


def test_times_say_how_many_are_new_and_of_which_machine(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    asked: list[tuple[Path, bool]] = []

    def update(directory: Path, *, again: bool) -> int:
        asked.append((directory, again))
        return 1

    monkeypatch.setattr(times, "update", update)
    monkeypatch.setattr(leaderboard, "PUBLISHED", tmp_path)
    (tmp_path / TIMES).write_text(
        f"{','.join(COLUMNS)}\npd-slit,direct,basic,0.5,0.25\npd-slit,direct,lut,,\n"
    )
    shutil.copy(PUBLISHED / MACHINE, tmp_path)
    shown = sunatlas("leaderboard", "times", "--again")
    assert shown.exit_code == 0, shown.stderr
    processor = read_times(PUBLISHED).machine.processor  # type: ignore[union-attr]
    assert shown.stderr == f"1 timed now, 1 before, of {processor}; in {tmp_path / TIMES}\n"
    assert asked == [(tmp_path, True)]


# ---- leaderboard --dataset


def test_a_condition_that_no_data_set_asked_for_has_leaves_nothing() -> None:
    shown = sunatlas(
        *("leaderboard", "--dataset", DATASET, "--condition", "stable", "--format", "json")
    )
    assert shown.exit_code == 1
    assert json.loads(shown.stdout) == {"items": [], "total": 0}
    assert shown.stderr == "sunatlas: no pipeline has such an error there\n"
    assert sunatlas("leaderboard", "--each", "--condition", "hot", "--max-error", 0).exit_code == 1


@pytest.mark.parametrize("options", [("--field", 20), ("--max-error", 0.01), ()])
def test_a_table_without_a_row_is_not_printed(options: tuple[Any, ...]) -> None:
    wrong = ("--dataset", DATASET, "--condition", "stable")
    shown = sunatlas("leaderboard", *wrong, *options)
    assert (shown.exit_code, shown.stdout) == (1, "")


# ---- rank

NEW, REASON = "voltage-balance", "needs more poses"


@pytest.fixture
def ranked(board: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> Ranking:
    """A board on which the pipelines of one extractor are new; one of them has no score."""
    (one,) = board["datasets"]
    rows = [dict(row) for row in one["rows"] if row["condition"] == "nominal"]
    pipelines = frozenset((r["extractor"], r["model"]) for r in rows if r["extractor"] == NEW)
    mine = [row for row in rows if row["extractor"] == NEW]
    assert len(rows) > len(mine) > 1
    mine[-1] |= {"reason": REASON, "rank": None, "best_of_extractor": False}
    found = Ranking({**board, "datasets": [{**one, "rows": rows}]}, pipelines, 3, "On one unit.")
    monkeypatch.setattr(candidate, "rank", lambda *_, **__: found)
    monkeypatch.setattr(ranking, "check_contract", lambda _: ContractResult(12, ()))
    return found


def test_a_ranked_algorithm_is_marked_and_its_failures_are_named(
    ranked: Ranking, tmp_path: Path
) -> None:
    page = tmp_path / "board.html"
    call = ("rank", NEW, "--dataset", DATASET, "--store", tmp_path / "store", "--out", page)
    shown = sunatlas(*call, "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    document = json.loads(shown.stdout)
    assert document["scope"] == "On one unit."
    assert len(document["items"]) == len(ranked.rows)
    new = {(row["extractor"], row["model"]) for row in document["items"] if row["new"]}
    assert new == ranked.pipelines
    failed = next(row for row in ranked.rows if row["reason"] == REASON)
    lines = shown.stderr.splitlines()
    assert lines[0] == "contract: 12 checks passed"
    assert f"no score: {NEW} + {failed['model']}: {REASON}" in lines
    assert lines[-2:] == [
        f"3 cells measured now, kept in {tmp_path / 'store'}",
        f"page: {page}",
    ]
    assert NEW in page.read_text("utf-8")


def test_the_table_has_all_that_is_new_and_the_best_of_the_others(
    ranked: Ranking, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    title, heading, _, *lines = sunatlas("rank", NEW, "--dataset", DATASET).stdout.splitlines()
    assert title == f"{DATASET}: best of each extractor, and {NEW} (*)"
    assert heading.split()[:2] == ["new", "rank"]
    assert lines.pop() == "On one unit."
    marked = [line for line in lines if line.startswith("*")]
    assert len(marked) == len(ranked.pipelines)
    others = [
        row
        for row in ranked.rows
        if row["extractor"] != NEW and row["best_of_extractor"] and row["rank"]
    ]
    assert len(lines) == len(marked) + len(others)
    assert (tmp_path / "out" / f"{NEW}-{DATASET}.html").is_file()


@pytest.mark.usefixtures("ranked")
def test_an_algorithm_that_fails_a_check_is_not_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    failures = ("it is slow: 9 s", "it is exact: it errs")
    monkeypatch.setattr(ranking, "check_contract", lambda _: ContractResult(5, failures))
    page = tmp_path / "board.html"
    shown = sunatlas("rank", NEW, "--dataset", DATASET, "--out", page)
    assert (shown.exit_code, shown.stdout) == (1, "")
    assert shown.stderr.splitlines()[:2] == [f"contract: {line}" for line in failures]
    assert f"sunatlas: {NEW} fails 2 of 5 checks; the rules are in docs/guide/" in shown.stderr
    assert not page.exists()


@pytest.mark.usefixtures("ranked")
def test_without_a_checkout_it_is_said_that_nothing_was_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ranking, "check_contract", lambda _: None)
    page = tmp_path / "board.html"
    shown = sunatlas("rank", NEW, "--dataset", DATASET, "--out", page)
    assert shown.exit_code == 0, shown.stderr
    assert shown.stderr.startswith("contract: not checked, the tests are in a checkout only\n")
    assert page.is_file()

"""What commands that measure say of what came of it; the measuring itself is made up."""

from __future__ import annotations

import importlib
import json
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from api.cli.contract import ContractResult
from benchmark.contract import Cell
from benchmark.leaderboard import candidate, study_record
from benchmark.leaderboard import check as checking
from benchmark.leaderboard import update as updating
from benchmark.leaderboard.check import Difference
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import pinning
from benchmark.running import times as running_times
from benchmark.running.runner import Summary
from benchmark.suites.verification import VerificationResult
from tests.survey_data.additions.offered_study import STUDY

rank, verify = (importlib.import_module(f"api.cli.commands.{name}") for name in ("rank", "verify"))
NAME, DATASET = "voltage-balance", "qpd-single-aperture"
CELL = Cell(DATASET, "nominal", NAME, "lut")
OFF = Difference("scores/d.csv", "d/c/e/m/p95_deg", "0.1", "0.2")


def sunatlas(*arguments: object) -> Any:
    return CliRunner().invoke(app, list(map(str, arguments)), catch_exceptions=False)


def summary(**changed: Any) -> Summary:
    whole: dict[str, Any] = {"store": Path("store"), "planned": 9, "already_stored": 5}
    whole |= {"computed": 4, "failed": (), "warnings": (), "seconds": 2.04}
    return Summary(**whole | changed)


def test_an_algorithm_that_fails_the_contract_is_not_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    failed = ContractResult(12, ("rows are alone: row 3", "nothing is made up"))
    monkeypatch.setattr(rank, "check_contract", lambda _: failed)
    monkeypatch.setattr(candidate, "rank", lambda *_, **__: pytest.fail("measured"))
    shown = sunatlas("rank", NAME, "--dataset", DATASET)
    assert shown.exit_code == 1
    assert "contract: rows are alone: row 3\ncontract: nothing is made up\n" in shown.stderr
    assert f"{NAME} fails 2 of 12 checks" in shown.stderr


def test_an_algorithm_is_marked_on_its_board(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(rank, "check_contract", lambda _: ContractResult(12, ()))
    plain = {"rank": 1, "reason": "", "best_of_extractor": True, "own_error_deg": 0.1}
    rows = [
        {**plain, "extractor": NAME, "model": "qpd"},
        {**plain, "extractor": NAME, "model": "lut", "rank": None, "reason": "no light"},
        {**plain, "extractor": "other", "model": "qpd", "rank": 2},
        {**plain, "extractor": "other", "model": "ann", "rank": 3, "best_of_extractor": False},
    ]
    made = SimpleNamespace(
        rows=rows, has=lambda row: row["extractor"] == NAME, scope="Unit 0.", measured=2
    )
    monkeypatch.setattr(candidate, "rank", lambda *_, **__: made)
    asked = ("rank", NAME, "--dataset", DATASET, "--store", tmp_path / "store")
    found = json.loads(sunatlas(*asked, "--format", "json").stdout)
    assert [row["new"] for row in found["items"]] == ["*", "*", None, None]
    assert found["scope"] == "Unit 0."
    shown = sunatlas(*asked)
    assert "contract: 12 checks passed" in shown.stderr
    assert f"no score: {NAME} + lut: no light" in shown.stderr
    assert "2 cells measured now" in shown.stderr
    assert ("qpd" in shown.stdout, "ann" in shown.stdout) == (True, False)


@pytest.mark.parametrize(("differences", "code"), [((), 0), ((OFF, OFF), 1)])
def test_cells_measured_again_are_counted_and_differences_named(
    monkeypatch: pytest.MonkeyPatch, differences: tuple[Difference, ...], code: int
) -> None:
    def verified(cells: list[Cell], *_: object, **__: object) -> VerificationResult:
        return VerificationResult(tuple(cells), len(cells) - 1, differences)

    monkeypatch.setattr(verify, "verified", verified)
    shown = sunatlas("verify", "--sample", 3, "--seed", 7, "--format", "json")
    assert shown.exit_code == code
    found = json.loads(shown.stdout)
    assert (found["seed"], len(found["cells"]), found["alike"]) == (7, 3, 2)
    assert len(found["differences"]) == len(differences)
    assert f"3 of {len(Store(PUBLISHED).scores())} cells, drawn by --seed 7" in shown.stderr
    assert "2 of 3 cells are alike to the last digit" in shown.stderr
    assert ("every published number that was drawn holds" in shown.stderr) == (code == 0)
    assert (f"2 differences, the first: {OFF}" in shown.stderr) == (code == 1)


def test_an_update_says_what_failed_and_how_much_was_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = summary(failed=((CELL, "no light"),), warnings=("slow",))
    monkeypatch.setattr(updating, "update", lambda *_: first)
    monkeypatch.setattr(study_record, "update", lambda **_: summary(planned=3, computed=0))
    said = sunatlas("leaderboard", "update").stderr
    assert f"failed: {CELL}: no light\nwarning: slow\n" in said
    assert "9 cells, 4 measured in 2.0 s, 5 stored before; in store" in said
    assert "3 cells, 0 measured in 2.0 s" in said
    monkeypatch.setattr(running_times, "update", lambda *_, again: 3 if again else 0)
    timed = [sunatlas("leaderboard", "times", *o).stderr for o in ((), ("--again",))]
    now, before = zip(*(re.findall(r"\d+", one)[:2] for one in timed), strict=True)
    assert now == ("0", "3")
    assert int(before[0]) - int(before[1]) == 3


@pytest.mark.parametrize(("found", "code"), [([], 0), ([OFF], 1)])
def test_a_check_names_the_first_difference(
    monkeypatch: pytest.MonkeyPatch, found: list[Difference], code: int
) -> None:
    monkeypatch.setattr(checking, "check", lambda *_, **__: found)
    monkeypatch.setattr(study_record, "check", lambda **__: found)
    shown = sunatlas("leaderboard", "--check", "--stored")
    assert shown.exit_code == code
    assert ("agree with each other and the code" in shown.stderr) == (code == 0)
    assert (f"2 differences, the first: {OFF}" in shown.stderr) == (code == 1)


def test_pins_are_renewed_or_checked(monkeypatch: pytest.MonkeyPatch) -> None:
    done = SimpleNamespace(warnings=("new",), renewed=2, kept=7, seconds=0.25, store="here")
    monkeypatch.setattr(pinning, "update", lambda *_, **__: done)
    said = sunatlas("dataset", "pin").stderr
    assert "warning: new\n2 conditions pinned in 0.2 s, 7 pinned before; in here" in said
    for wrong, code in (([], 0), (["a moved", "b moved"], 1)):
        monkeypatch.setattr(pinning, "differences", lambda *_, of=wrong, **__: of)
        shown = sunatlas("dataset", "pin", "--check")
        assert shown.exit_code == code
        assert shown.stdout.splitlines() == wrong
        assert ("every pin holds" in shown.stderr) == (code == 0)
        assert ("2 pins do not hold, the first: a moved" in shown.stderr) == (code == 1)


def test_a_study_that_is_offered_is_shown_with_what_would_run(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(STUDY)
    shown = sunatlas("survey", "add", path)
    assert shown.exit_code == 0
    said = " ".join(shown.stdout.split())
    for words in ("Study Doe2030", "A sun sensor that nobody built", "graph network (nearest)",
                  "Implementation here: ", "Nothing written; --apply adds Doe2030."):  # fmt: skip
        assert words in said
    path.write_text(STUDY.replace('value = "DNN"', 'value = "DNM"'))
    shown = sunatlas("survey", "add", path, "--format", "json")
    assert shown.exit_code == 1
    assert len(json.loads(shown.stdout)["faults"]) == 1
    assert "DNN" in shown.stderr

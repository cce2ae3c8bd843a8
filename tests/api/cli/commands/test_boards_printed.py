"""`sunatlas leaderboard --check`: what it prints of differences, and its exit code."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from benchmark.leaderboard import check, study_record
from benchmark.leaderboard.check import Difference


def sunatlas(*arguments: object) -> Any:
    call = list(map(str, arguments))
    return CliRunner(env={"COLUMNS": "300"}).invoke(app, call, catch_exceptions=False)


# ---- leaderboard --check

DIFFERENT = Difference("scores/a.csv", "a/nominal/x/y/rms_deg", "1.0", "2.0")


class Checked:
    """What a check finds, and how it was asked."""

    def __init__(self) -> None:
        self.found: list[Difference] = []
        self.asked: list[tuple[Any, ...]] = []

    def __call__(self, directory: Path, workers: int, **options: Any) -> list[Difference]:
        self.asked.append((directory, workers, options["stored_only"]))
        return self.found


@pytest.fixture
def checked(monkeypatch: pytest.MonkeyPatch) -> Checked:
    found = Checked()
    monkeypatch.setattr(check, "check", found)
    monkeypatch.setattr(study_record, "check", lambda **_: [])
    return found


def test_a_check_that_finds_differences_fails_and_lists_them(checked: Checked) -> None:
    checked.found = [DIFFERENT, Difference("leaderboard.md", "line 3", "a", "b")]
    shown = sunatlas("leaderboard", "--check", "--format", "json")
    assert shown.exit_code == 1
    assert json.loads(shown.stdout)[0] == {
        "file": "scores/a.csv",
        "cell": "a/nominal/x/y/rms_deg",
        "committed": "1.0",
        "measured": "2.0",
    }
    assert shown.stderr == (
        "sunatlas: 2 differences, the first: scores/a.csv: a/nominal/x/y/rms_deg is 1.0, should be "
        "2.0\n"
    )
    table = sunatlas("leaderboard", "--check")
    assert table.stdout.startswith("2 differences\n")

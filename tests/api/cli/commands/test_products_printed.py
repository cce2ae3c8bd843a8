"""Commands that make, send or fetch something, and what they print of it.

Files are tested elsewhere; here a fake returns the result that is printed.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from api.cli.commands import deposit as command
from api.deposit import against_record


def sunatlas(*arguments: object) -> Any:
    call = list(map(str, arguments))
    return CliRunner(env={"COLUMNS": "200"}).invoke(app, call, catch_exceptions=False)


# ---- guide


# ---- deposit


@pytest.fixture
def differences(monkeypatch: pytest.MonkeyPatch) -> dict[str, list[tuple[str, str]]]:
    """What is wrong with a bundle in itself and beside the record; how the record was asked."""
    found: dict[str, list[tuple[str, str]]] = {"itself": [], "record": [], "asked": []}

    def beside(_: Path, *, anew: bool, progress: object) -> list[tuple[str, str]]:
        found["asked"].append(("anew", str(anew and progress is not None)))
        return found["record"]

    monkeypatch.setattr(command, "verified", lambda _: found["itself"])
    monkeypatch.setattr(against_record, "differences", beside)
    return found


Differences = dict[str, list[tuple[str, str]]]


@pytest.mark.parametrize("where", ["itself", "record"])
def test_a_difference_fails_with_its_file(differences: Differences, where: str) -> None:
    differences[where] = [("a.csv", "another number")]
    shown = sunatlas("deposit", "verify", "a-bundle", "--format", "json")
    assert shown.exit_code == 1
    assert json.loads(shown.stdout) == [{"file": "a.csv", "problem": "another number"}]
    assert len(differences["asked"]) == (where == "record"), "a damaged bundle is not compared"
    table = sunatlas("deposit", "verify", "a-bundle").stdout
    assert table.startswith("a-bundle: 1 problems\n")


# ---- dataset fetch

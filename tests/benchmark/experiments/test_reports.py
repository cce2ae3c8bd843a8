"""Rows that are measured again: what is printed, and exit codes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from benchmark.experiments import __main__ as command
from benchmark.results.row_file import Row, RowFile
from benchmark.running import experiment as running
from benchmark.running.experiment import RecordedExperiment


class Squares(RecordedExperiment[str]):
    """Squares of whole numbers; what they come to is no matter of the cell alone."""

    name = "squares"
    record = RowFile("squares.json", "squares", 1, lambda row: str(row["cell"]), dict)
    off = 0.0

    def keys(self) -> dict[str, str]:
        return {cell: f"key {cell}" for cell in ("2", "3")}

    def tasks(self, cells: Sequence[str]) -> Sequence[tuple[str, float]]:
        return [(cell, self.off) for cell in cells]

    @staticmethod
    def measure(task: tuple[str, float]) -> list[tuple[str, Row]]:
        cell, off = task
        return [(cell, {"cell": cell, "square": float(cell) ** 2 + off})]


def test_a_number_that_is_not_repeated_is_printed_and_fails(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(running, "experiments", lambda: {"squares": Squares})
    call = ["squares", "--directory", str(tmp_path)]
    assert command.main(call) == 0
    assert "squares: 2 of 2 cells measured" in capsys.readouterr().err
    again = [*call, "--again", "2", "--seed", "5"]
    assert command.main(again) == 0
    said = capsys.readouterr()
    assert said.out == ""
    assert "2 cells of squares, drawn by --seed 5" in said.err
    monkeypatch.setattr(Squares, "off", 1.0)
    assert command.main(again) == 1
    lines = capsys.readouterr().out.splitlines()
    assert sorted(line.partition(": square")[0] for line in lines) == [
        "squares.json: 2",
        "squares.json: 3",
    ]

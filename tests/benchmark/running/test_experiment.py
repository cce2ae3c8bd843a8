"""The runner of experiments: what is due alone is measured, whatever the number of workers."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel

from benchmark.experiments import __main__ as command
from benchmark.progress import silent
from benchmark.results.csv_tables import StoreError
from benchmark.results.row_file import Row, RowFile
from benchmark.running import experiment as running
from benchmark.running.experiment import (
    RecordedExperiment,
    Report,
    list_due,
    update,
)


class SquareRow(BaseModel, extra="forbid"):
    cell: str
    square: float
    key: str


class Squares(RecordedExperiment[str]):
    name = "squares"
    record = RowFile("squares.json", "squares", 1, lambda row: str(row["cell"]), SquareRow)
    wanted: tuple[str, ...] = ("1", "2", "3")
    code = "first"

    def keys(self) -> dict[str, str]:
        return {cell: f"{self.code} {cell}" for cell in self.wanted}

    def tasks(self, cells: Sequence[str]) -> list[Sequence[str]]:
        return [cells[:2], cells[2:]] if len(cells) > 2 else [cells]

    @staticmethod
    def measure(task: Sequence[str]) -> list[tuple[str, Row]]:
        return [(cell, {"cell": cell, "square": float(cell) ** 2}) for cell in task]


def computed(experiment: Squares, workers: int = 1, **options: Any) -> int:
    return update(experiment, workers, silent, **options).computed


def test_what_is_due_alone_is_measured_and_what_is_gone_is_dropped(tmp_path: Path) -> None:
    experiment = Squares(tmp_path)
    assert [why for _, why in list_due(experiment)] == ["absent"] * 3
    assert computed(experiment) == 3
    assert computed(experiment) == 0
    assert list_due(experiment) == []
    experiment.wanted = ("2", "3", "4")
    assert list_due(experiment) == [("1", "no longer wanted"), ("4", "absent")]
    assert computed(experiment) == 1
    assert list(experiment.record.read(tmp_path)) == ["2", "3", "4"]
    experiment.code = "second"
    assert {why for _, why in list_due(experiment)} == {"of other code or data"}
    assert computed(experiment, only=["3"]) == 1
    assert [cell for cell, _ in list_due(experiment)] == ["2", "4"]


def test_the_file_is_the_same_for_any_number_of_workers(tmp_path: Path) -> None:
    experiment = Squares(tmp_path)
    path = tmp_path / "squares.json"
    computed(experiment)
    text = path.read_bytes()
    path.unlink()
    computed(experiment, 2)
    assert path.read_bytes() == text
    with pytest.raises(ValueError, match="workers"):
        computed(experiment, 0)


def test_a_number_that_another_run_does_not_repeat_is_named_and_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(running, "experiments", lambda: {"squares": Squares})
    call = ["squares", "--directory", str(tmp_path)]
    assert command.main(call) == 0
    assert "squares: 3 of 3 cells measured" in capsys.readouterr().err
    again = [*call, "--again", "3", "--seed", "1"]
    assert command.main(again) == 0
    said = capsys.readouterr()
    assert said.out == ""
    assert "3 cells of squares, drawn by --seed 1" in said.err
    path = tmp_path / "squares.json"
    path.write_text(path.read_text().replace("9.0", "9.1"))
    assert command.main(again) == 1
    (line,) = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r"squares\.json: 3: square\b.*\b9\.1\b.*\b9\.0\b.*", line)


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda held: held["squares"][1].pop("square"), "squares/1/square: Field required"),
        (lambda held: held["squares"].append(held["squares"][0]), "row 4: 1 is there twice"),
        (lambda held: held.update(schema=2), "expected schema 1 and squares, got 2"),
    ],
)
def test_a_row_that_is_none_is_named(tmp_path: Path, edit: Any, said: str) -> None:
    experiment = Squares(tmp_path)
    computed(experiment)
    path = tmp_path / "squares.json"
    held = json.loads(path.read_text())
    edit(held)
    path.write_text(json.dumps(held))
    with pytest.raises(StoreError, match=said):
        list_due(experiment)


class Sums(Report[int]):
    name = "sums"

    def cells(self) -> list[int]:
        return [1, 2]

    def tasks(self, cells: Sequence[int]) -> Sequence[int]:
        return cells

    @staticmethod
    def measure(task: int) -> list[tuple[int, Row]]:
        return [(task, {"sum": task + task})]

    def lines(self, rows: Mapping[int, Row]) -> Iterator[str]:
        return (f"{cell} and itself are {row['sum']}" for cell, row in rows.items())

    def passes(self, rows: Mapping[int, Row]) -> bool:
        return all(row["sum"] < 4 for row in rows.values())


def test_a_report_is_printed_and_its_exit_code_says_whether_it_passed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(running, "experiments", lambda: {"sums": Sums})
    assert command.main(["sums", "1"]) == 0
    assert capsys.readouterr().out == "1 and itself are 2\n"
    assert command.main(["sums"]) == 1
    assert "2 and itself are 4" in capsys.readouterr().out


def test_calls_that_make_no_sense_are_refused(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(running, "experiments", lambda: {"squares": Squares})
    for call, said in (
        (["squaress"], "did you mean"),
        (["squares", "--workers", "0"], "--workers"),
        (["squares", "33"], "33"),
    ):
        with pytest.raises(SystemExit):
            command.main(call)
        assert said in capsys.readouterr().err

"""Experiments that keep nothing: their cells, the lines that are printed, and exit codes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from benchmark.assessment.networks import NetworkError
from benchmark.assessment.regret import NUMBER, DrawnRequirement
from benchmark.contract import UnknownNameError
from benchmark.experiments import __main__ as command
from benchmark.experiments import networks, regret
from benchmark.experiments.networks import Networks
from benchmark.experiments.regret import Regret
from benchmark.experiments.selection import Selection
from benchmark.results.row_file import Row, RowFile
from benchmark.results.store import Store
from benchmark.running import experiment as running
from benchmark.running.experiment import RecordedExperiment


def drawn(
    measured: float, advice: float, ratio: float | None, *, best: float = 0.1, own: float = 1.0
) -> DrawnRequirement:
    """Return an answer whose best pipeline errs by `best`, and that of its first architecture."""
    first = {"measured": measured, "advice": advice}
    stated = {"measured": 1.0, "advice": ratio}
    return DrawnRequirement({"task": ["Power"]}, best, 2.0 * best, own, first, stated)  # type: ignore[arg-type]


GOOD = [
    drawn(0.1, 0.1, 1.0),
    drawn(0.1, 0.2, 2.0),
    drawn(0.1, 0.4, 4.0, own=3.0),
    drawn(0.1, math.inf, None, own=math.nan),
    drawn(math.inf, math.inf, None, best=math.inf),
]


def test_a_draw_is_summed_up_over_the_sets_that_a_measured_pipeline_meets() -> None:
    said = list(Regret().lines({7: {"drawn": GOOD}}))
    assert said[0] == "5 requirement sets (seed 7): 4 are met by a measured pipeline"
    assert said[1].endswith("the most accurate one in 4 of 4")
    assert said[2].startswith("sort=advice: the first calibration is the most accurate one in 1, ")
    assert "below 95 % availability in 1; " in said[2]
    assert said[2].endswith("2 to 4 times as much (median 3)")
    assert "calibration of its architecture in 2 of 4; " in said[3]
    assert said[3].endswith("in 2 of 3")
    assert said[4:] == ["the stated regret differs from that of brute force in 0 of 5"]
    assert Regret().passes({7: {"drawn": GOOD}})


def test_an_answer_that_states_another_regret_is_printed_and_fails() -> None:
    broken = drawn(0.1, 0.2, 1.5)
    said = list(Regret().lines({3: {"drawn": [*GOOD, broken]}}))
    assert said[-2].endswith("in 1 of 6")
    assert said[-1].startswith("  {'task': ['Power']}: {'measured': 0.1, 'advice': 0.2}, best 0.1,")
    assert not Regret().passes({7: {"drawn": GOOD}, 3: {"drawn": [broken]}})


def test_where_advice_costs_nothing_there_are_no_ratios_of_others() -> None:
    said = list(Regret().lines({1: {"drawn": GOOD[:1]}}))
    assert said[2].endswith("error ratio of the others: no more")


def test_any_seed_may_be_drawn_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    experiment = Regret(tmp_path)
    assert experiment.cells() == [20]
    assert experiment.cells_named(["3", "11"]) == [3, 11]
    for name in ("-3", "1.5", "three"):
        with pytest.raises(UnknownNameError, match=name):
            experiment.cells_named(["3", name])
    asked: list[tuple[Any, ...]] = []

    def found(store: Store, number: int, seed: int) -> list[DrawnRequirement]:
        asked.append((store.directory, number, seed))
        return GOOD

    monkeypatch.setattr(regret, "regrets", found)
    (task,) = experiment.tasks([11])
    assert Regret.measure(task) == [(11, {"drawn": GOOD})]
    assert asked == [(tmp_path, NUMBER, 11)]


def test_each_question_on_networks_has_a_line_for_each_of_its_cases(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert Networks().cells() == ["orbits", "units", "seeds", "spans", "fields"]
    cases = [NetworkError("seeds", f"seed {k}", "dnn", 0.5 + k, 1.0, 2.0, 0.75) for k in range(2)]
    monkeypatch.setitem(networks._QUESTIONS, "seeds", lambda: iter(cases))
    assert command.main(["networks", "seeds"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [" ".join(line.split()) for line in lines] == [
        f"seeds seed {k} dnn rms {0.5 + k:.4f} p95 1.0000 max 2.000 answered 0.750"
        for k in range(2)
    ]
    with pytest.raises(SystemExit):
        command.main(["networks", "seed"])
    assert "did you mean" in capsys.readouterr().err


def test_selection_has_a_cell_for_each_data_set_with_a_model_that_chooses() -> None:
    found = Selection().cells()
    assert list(found) == sorted(set(found))
    assert {"qpd-single-aperture", "pd-maskless-cube"} <= set(found)
    assert Selection().tasks(found[:2]) == found[:2]


def test_a_choice_that_is_a_tenth_worse_than_the_best_fails() -> None:
    plain = {"dataset": "d", "extractor": "e", "model": "m", "best_deg": 0.1}
    settings = {"chosen": {"degree": 3}, "best": {"degree": 5}}
    rows: dict[str, Row] = {
        name: {"choices": [{**plain, **settings, "chosen_deg": error}]}
        for name, error in (("near", 0.109), ("far", 0.12))
    }
    assert list(Selection().lines(rows))[1] == ("d e m 1.200 {'degree': 3} 0.12 {'degree': 5} 0.1")
    assert Selection().passes({"near": rows["near"]})
    assert not Selection().passes(rows)


class Squares(RecordedExperiment[str]):
    """Squares of whole numbers; what they come to is no matter of the cell alone."""

    name = "squares"
    record = RowFile("squares.json", "squares", 1, lambda row: str(row["cell"]), lambda *_: None)
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

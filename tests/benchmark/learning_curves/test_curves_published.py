"""The committed learning curves: of the board as it is, and in line with scores."""

from itertools import chain

import pytest

from benchmark.contract import Cell
from benchmark.experiments.learning_curves import LearningCurves
from benchmark.leaderboard.check import RELATIVE_TOLERANCE
from benchmark.learning_curves.measure import DRAWS, UNITS
from benchmark.learning_curves.record import RECORD
from benchmark.plan.parts import installed_parts
from benchmark.progress import silent
from benchmark.results.store import Store
from benchmark.running.experiment import measure_tasks


@pytest.fixture(scope="module")
def rows():
    return RECORD.read()


@pytest.fixture(scope="module")
def scores():
    return Store().scores()


def cell(leader, unit=0):
    return Cell(leader.dataset, leader.condition, leader.extractor, leader.model, unit)


def test_they_are_of_the_leaders_as_they_are(rows):
    assert list(rows) == LearningCurves().cells()
    assert {leader.dataset for leader in rows} == set(installed_parts().presets)


def test_with_all_poses_the_errors_are_the_published_scores(rows, scores):
    """Two ways to the same number: the runner's, and the curves' own."""
    compared = 0
    for leader, row in rows.items():
        for unit, error in zip(UNITS, row["all_deg"], strict=True):
            published = scores.get(cell(leader, unit))
            if published is not None and published["rms_deg"] is not None:
                assert error == pytest.approx(published["rms_deg"], rel=RELATIVE_TOLERANCE), leader
                compared += 1
    # every leader on the standard unit, most of them on the other one
    assert compared > 1.5 * len(rows)


def test_each_is_of_enough_draws_over_two_units_and_of_no_floor_above_its_end(rows):
    for leader, row in rows.items():
        assert len(row["needed"]) == len(UNITS) * DRAWS >= 5, leader
        assert len(row["all_deg"]) == len(UNITS) >= 2
        assert row["points"][-1][0] == row["poses"]
        assert row["bound_deg"] > 0
        if row["floor"] != "none":
            squares = [error**2 for error in row["all_deg"]]
            assert row["floor_error_deg"] ** 2 <= sum(squares) / len(squares) * 1.001, leader
        for draw, error, answers in zip(
            row["needed"], row["error_from"], row["answers_from"], strict=True
        ):
            most = row["poses"] + 1
            assert (draw or most) == max(error or most, answers or most), leader


@pytest.mark.slow
def test_measured_again_they_are_the_same(rows):
    """Of data sets whose curves take seconds."""
    experiment = LearningCurves()
    chosen = experiment.cells_named(["pd-code-dial"])
    for leader, again in chain.from_iterable(measure_tasks(experiment, chosen, 1, silent)):
        known = {name: value for name, value in rows[leader].items() if name != "key"}
        for name in ("needed", "error_from", "answers_from", "floor", "refusal", "poses"):
            assert again[name] == known[name], name
        for point, before in zip(again["points"], known["points"], strict=True):
            assert [value is None for value in point] == [value is None for value in before]
            assert [value for value in point if value is not None] == pytest.approx(
                [value for value in before if value is not None], rel=1e-3
            )

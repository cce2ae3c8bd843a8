"""Learning curves measured: closed forms, refusals, flights, numbers of workers, what is stale."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from fake_poses import Guess, Lines, Plane, Readings, mean_square
from fake_results import numbers

from benchmark.contract import Cell
from benchmark.datasets.pins import Pin
from benchmark.experiments.learning_curves import LearningCurves
from benchmark.learning_curves.draws import sizes
from benchmark.learning_curves.floor import NEAR
from benchmark.learning_curves.leaders import LEADING, Leader, leaders
from benchmark.learning_curves.measure import DRAWS, UNITS, CurveTask, measure
from benchmark.learning_curves.outcome import row_of
from benchmark.learning_curves.reading import summary
from benchmark.plan.parts import Parts
from benchmark.results.components import current
from benchmark.results.store import Store

LEADER = Leader("fake-plane", 1, "nominal", "fake-readings", "fake-lines")
BOUND, BENCH = float(np.sqrt(mean_square(np.inf))), 0.5


def task(preset=None, *models):
    """Return a task of these models, one after another."""
    known = {model.about.name: model for model in models or (Lines,)}
    found = [replace(LEADER, place=place, model=name) for place, name in enumerate(known, start=1)]
    extractors = {"fake-readings": Readings}
    return CurveTask(
        preset or Plane(), tuple(found), extractors, known, True, dict.fromkeys(found, BOUND), BENCH
    )


@pytest.fixture(scope="module")
def learnt():
    return measure(task())[0]


def test_least_squares_learns_as_its_covariance_says(learnt):
    """Mean square error ``2 SHAKE^2 + 2 NOISE^2 p / K``: of ``2 p`` squared normal errors a fit."""
    square = (learnt.rms_deg**2).mean(axis=(0, 1))
    poses = np.array(learnt.sizes)
    assert learnt.sizes == sizes(400)
    assert np.isnan(square[0])
    excess = mean_square(poses) - mean_square(np.inf)
    # six fits a size, each with 2 p = 6 squares of normal errors: relative spread sqrt(2 / 36)
    fitted = poses > 12  # below, random places settle three lines badly
    within = 4 * np.sqrt(2 / 36) * excess + 4 * np.sqrt(1 / 2000) * mean_square(np.inf)
    assert (np.abs(square - mean_square(poses)) < within)[fitted].all()
    assert (learnt.availability[:, :, 1:] == 1.0).all()


def test_its_floor_and_the_poses_it_needs_are_those_of_the_closed_form(learnt):
    row = row_of(learnt, BOUND, BENCH)
    assert row["floor"] == "fitted"
    assert row["floor_error_deg"] == pytest.approx(BOUND, rel=0.05)
    assert row["floor_low_deg"] <= row["floor_error_deg"] <= row["floor_high_deg"]
    shown = summary(row)
    assert shown["over_bound"] == pytest.approx(1.0, rel=0.05)
    assert shown["draws"] == len(UNITS) * DRAWS
    # mean_square(K) = NEAR^2 mean_square(inf) at K = p (NOISE / SHAKE)^2 / (NEAR^2 - 1) = 129
    exact = 3 * 9 / (NEAR**2 - 1)
    assert exact / 2.5 < shown["needed_poses"] < exact * 2.5
    assert shown["needed_low"] <= shown["needed_poses"]
    assert shown["answers_poses"] == 6


def test_a_refusal_is_recorded_with_its_reason(learnt):
    row = row_of(learnt, BOUND, BENCH)
    assert row["points"][0] == [4, None, None, None, None, len(UNITS) * DRAWS]
    assert row["points"][1][-1] == 0
    assert re.fullmatch(r"UnusableDataError: fake-lines\b.*\b6\b.*\b4", row["refusal"])
    refused = row_of(measure(task(Plane(poses=5)))[0], BOUND, BENCH)
    assert refused["floor"] == "none"
    assert refused["needed"] == [None] * len(UNITS) * DRAWS
    assert summary(refused)["over_bound"] is None


def test_what_answers_half_of_the_field_is_never_near():
    (found,) = measure(task(None, Guess))
    row = row_of(found, BOUND, BENCH)
    assert row["floor"] == "none"
    assert row["points"][-1][4] == pytest.approx(0.5, abs=0.05)
    assert summary(row)["reached"] == 0


class HalfSeen(Plane):
    """The same; of the left half of the field no direction can be determined."""

    def bound(self, condition, split="test", n=None):
        read = self.generate(condition, split).observations
        return replace(super().bound(condition, split, n), observable=read[:, 1] >= 0.0)


def test_samples_that_are_not_observable_are_not_asked_for():
    """What answers the right half alone answers all that can be, and errs as before: of unit 0."""
    every, seen = (
        measure(replace(task(preset, Guess), all_observable=asked))[0]
        for preset, asked in ((Plane(poses=12), True), (HalfSeen(poses=12), False))
    )
    answered = every.refusals[0] == ""
    assert (seen.availability[0][answered] == 1.0).all()
    assert every.availability[0][answered].max() < 0.6
    np.testing.assert_allclose(seen.rms_deg[0], every.rms_deg[0])


def test_flights_are_told_in_order_and_end_with_all_poses():
    """`Lines` raises where poses with a time do not follow one another."""
    flown = measure(task(Plane(context_columns=("time_s",))))[0]
    assert flown.in_order
    row = row_of(flown, BOUND, BENCH)
    assert row["floor"] == "all"
    assert row["floor_low_deg"] is None


def scored(**errors):
    """Rows of a board by model; what answers too rarely or is of another condition is none."""
    plain = {"dataset": "d", "condition": "c", "unit": 0, "extractor": "e", "availability": 1.0}
    return [
        {
            **plain,
            "model": model,
            **dict.fromkeys(("rms_all_answers_deg", "median_deg", "max_deg"), error),
        }
        for model, error in errors.items()
    ]


def test_leaders_are_the_best_pipelines_of_three_models():
    rows = scored(a=3.0, b=1.0, c=2.0, f=4.0, twin_of_c=2.0)
    rows += [{**row, "extractor": "other", "rms_all_answers_deg": 0.9} for row in scored(b=0.0)]
    rows += [
        {**scored(x=0.1)[0], "availability": 0.94},
        {**scored(y=0.1)[0], "unit": 1},
        {**scored(z=0.1)[0], "condition": "else"},
        {**scored(n=0.1)[0], "rms_all_answers_deg": None},
    ]
    found = leaders(rows, {"d": "c"})
    assert [(one.place, one.extractor, one.model) for one in found] == [
        (1, "other", "b"),
        (2, "e", "c"),
        (3, "e", "a"),
    ]
    assert len(found) == LEADING
    assert leaders(rows, {}) == []


@pytest.mark.parametrize(("observable", "every"), [(2000, True), (1999, False), (1, False)])
def test_all_samples_count_only_where_all_are_pinned_as_observable(tmp_path, observable, every):
    """Else an eclipse, or a Sun behind the sensor, would count as an error of the pipeline."""
    parts = Parts({"fake-plane": Plane()}, {"fake-readings": Readings}, {"fake-lines": Lines})
    cell = Cell("fake-plane", "nominal", "fake-readings", "fake-lines")
    pin = Pin("fake-plane", "nominal", "test", 1, 2000, "h", "hh", observable, 0.1, 0.1)
    scores = {cell: numbers(0.1, rms_all_answers_deg=0.1, bound_deg=0.1)}
    Store(tmp_path).write(scores, [pin], current(parts))
    curves = LearningCurves(tmp_path, parts)
    (task,) = curves.tasks(curves.cells())
    assert task.all_observable is every

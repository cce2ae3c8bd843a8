"""What comes of a task whose answers cannot be judged, or whose methods know more than others."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import fake_atlas
import fake_plan
import numpy as np
import pytest

from benchmark.contract import Cell
from benchmark.plan.parts import Parts
from benchmark.progress import silent
from benchmark.results.samples import CONDITION
from benchmark.results.times import read_times
from benchmark.running import condition_data, readings, times
from benchmark.running.judging import Outcome
from benchmark.running.planned import samples_of
from benchmark.running.stages import ConditionData, Task
from benchmark.running.task import TaskResult, measure
from benchmark.simulator.light.memory import memory


@pytest.fixture(autouse=True)
def _memory_is_empty() -> Iterator[None]:
    condition_data.forget()
    yield
    condition_data.forget()
    memory.forget()


def measured(preset: Any, *models: Any, unit: int = 0) -> tuple[Outcome, ...]:
    extractor: Any = fake_atlas.Currents
    task = Task(preset, "quiet", extractor, models or (fake_atlas.LeastSquares,), unit)
    return measure(task).outcomes


@dataclass
class Long(fake_atlas.LeastSquares):
    """Answers with vectors that are twice as long as directions are."""

    about = replace(fake_atlas.LeastSquares.about, name="fake-long")

    def predict(self, features: Any, context: Any = None) -> Any:
        return 2.0 * super().predict(features, context)


@dataclass
class Partial(fake_atlas.LeastSquares):
    """Answers with one coordinate of a direction that it does not know."""

    about = replace(fake_atlas.LeastSquares.about, name="fake-partial")

    def predict(self, features: Any, context: Any = None) -> Any:
        answers = super().predict(features, context)
        answers[3, 0] = np.nan
        return answers


@pytest.mark.parametrize(
    ("model", "reason"), [(Long, "unit vector"), (Partial, "row 3 is finite in some columns")]
)
def test_answers_that_are_no_directions_fail_alone(model: Any, reason: str) -> None:
    wrong, right = measured(fake_atlas.Diodes(n=40), model, fake_atlas.LeastSquares)
    assert wrong.score is None
    assert not wrong.refused, "it is a failure, tried again by the next run"
    assert wrong.reason.startswith("ValueError: ")
    assert reason in wrong.reason
    assert right.score is not None
    assert right.reason == ""


@dataclass
class Remembering(fake_atlas.LeastSquares):
    """Says that it reads the time of each sample."""

    about = replace(fake_atlas.LeastSquares.about, name="fake-remembering", context=("time_s",))


@dataclass(frozen=True)
class Flown(fake_atlas.Diodes):
    """A data set that bounds methods by all that they know: by half the single samples' bound."""

    name: str = "fake-flown"
    asked: tuple[Any, ...] = ([],)

    def posterior_bound_deg(self, condition: str, context: frozenset[str], bound: Any) -> Any:
        self.asked[0].append((condition, context))
        return 0.5 * bound.angle_deg


def bounds(outcome: Outcome) -> tuple[float, float]:
    assert outcome.score is not None
    return outcome.score.bound_deg, outcome.score.bound_unit_deg


def test_a_method_that_reads_more_than_readings_is_bound_by_all_that_it_reads() -> None:
    flown = Flown(n=40, asked=([],))
    single, posterior = map(bounds, measured(flown, fake_atlas.LeastSquares, Remembering))
    assert posterior == pytest.approx((0.5 * single[0], 0.5 * single[0]))
    assert single[1] == pytest.approx(1.25 * single[0])
    assert flown.asked[0] == [("quiet", frozenset({"time_s"}))]


def test_where_there_is_no_posterior_single_samples_bound_every_method() -> None:
    one, other = measured(fake_atlas.Diodes(n=40), fake_atlas.LeastSquares, Remembering)
    assert bounds(one) == bounds(other)


@dataclass(frozen=True)
class Referred(fake_atlas.Diodes):
    """Diodes of which dark and flat readings are there."""

    name: str = "fake-referred"

    def references(self, condition: str) -> dict[str, Any]:
        return {"dark_ua": np.full(4, 0.01), "flat_ua": np.array([1.0, 1.1, 0.9, 1.0])}


def test_readings_corrected_some_at_a_time_score_as_those_corrected_at_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (at_once,) = measured(Referred(n=40))
    condition_data.forget()
    monkeypatch.setattr(readings, "_CORRECTED_BYTES", 0)
    monkeypatch.setattr(readings, "_BATCH_BYTES", 7 * 4 * 8)
    (in_parts,) = measured(Referred(n=40))
    assert at_once.score is not None
    assert at_once.score == in_parts.score
    (plain,) = measured(fake_atlas.Diodes(n=40))
    assert plain.score != at_once.score, "the references change the readings"


class Missing:
    """Keeps nothing that it is asked for, and remembers what it was given."""

    def __init__(self, **there: Any) -> None:
        self.there = there
        self.put_stages: list[str] = []

    def get(self, stage: str, cell: Any) -> Any:
        return self.there.get(stage)

    def put(self, stage: str, cell: Any, value: Any, seconds: float) -> None:
        self.put_stages.append(stage)


@pytest.mark.parametrize("known", [False, True])
def test_what_another_unit_sees_is_taken_from_the_standard_one_where_that_is_kept(
    known: bool,
) -> None:
    preset: Any = fake_atlas.Diodes(n=40, dark=0.5)
    seen = np.zeros(40, dtype=np.bool_)
    seen[:3] = True
    standard = ConditionData(preset, {}, None, None, seen, ())
    kept: Any = Missing(**({"truth": standard} if known else {}))
    data = condition_data.generate(preset, "quiet", 1, kept=kept)
    expected = seen if known else np.arange(40) >= 20
    np.testing.assert_array_equal(data.observable, expected)
    assert kept.put_stages == ["data", "truth"]


class Unbuildable(fake_atlas.Currents):
    about = replace(fake_atlas.CURRENTS, name="fake-unbuildable-currents")

    @classmethod
    def for_sensor(cls, geometry: Any) -> Any:
        raise RuntimeError("no such sensor")


@pytest.mark.usefixtures("log")
def test_an_extractor_that_cannot_be_built_has_no_time_and_keeps_none_from_others(
    tmp_path: Any,
) -> None:
    extractors: Any = {one.about.name: one for one in (fake_atlas.Currents, Unbuildable)}
    plain = fake_plan.parts(presets=(fake_atlas.Diodes(n=40),))
    assert times.update(tmp_path, silent, parts=Parts(plain.presets, extractors, plain.models)) == 2
    found = {time.extractor: time.ratio for time in read_times(tmp_path).rows.values()}
    assert found.pop("fake-unbuildable-currents") is None
    (ratio,) = found.values()
    assert ratio is not None
    assert ratio > 0


def test_a_task_is_of_the_standard_unit_unless_it_says_otherwise() -> None:
    preset, models = fake_atlas.Diodes(n=40), (fake_atlas.LeastSquares,)
    plain = measure(Task(preset, "quiet", fake_atlas.Currents, models))
    assert {pin.split for pin in plain.pins} == {"calibration", "test", "repeat"}
    (outcome,) = plain.outcomes
    assert outcome.score is not None
    assert outcome.score.bound_deg > 0
    assert measure(Task(preset, "quiet", fake_atlas.Currents, models, 1)).pins == ()


def test_errors_of_samples_are_kept_of_the_condition_that_shows_them_and_of_no_failure() -> None:
    preset = fake_atlas.Diodes(conditions=(CONDITION,))
    task = Task(preset, CONDITION, fake_atlas.Currents, ())
    errors, found = np.array([0.1, 0.2]), np.array([True, True])
    good = Outcome("fake-least-squares", "", sample_errors_deg=errors, found=found)
    result = TaskResult(task, (), (good, replace(good, sample_errors_deg=None)))
    (kept,) = samples_of(replace(result, outcomes=(good,))).cells.values()
    (cell,) = samples_of(result).cells
    assert cell == Cell("fake-diodes", CONDITION, "fake-currents", "fake-least-squares")
    np.testing.assert_allclose(kept.error_deg, errors, rtol=1e-3)
    elsewhere = replace(result, task=replace(task, condition="noisy"))
    assert samples_of(elsewhere).cells == {}

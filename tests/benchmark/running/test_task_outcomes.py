"""What comes of a task whose answers cannot be judged, or whose methods know more than others."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import fake_atlas
import numpy as np
import pytest

from benchmark.contract import Cell
from benchmark.results.samples import CONDITION
from benchmark.running import condition_data
from benchmark.running.judging import PipelineOutcome
from benchmark.running.planned import samples_of
from benchmark.running.stages import Task
from benchmark.running.task import TaskResult, measure
from benchmark.simulator.light.memory import memory


@pytest.fixture(autouse=True)
def _memory_is_empty() -> Iterator[None]:
    condition_data.forget()
    yield
    condition_data.forget()
    memory.forget()


def measured(preset: Any, *models: Any, unit: int = 0) -> tuple[PipelineOutcome, ...]:
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

    def posterior_bound_deg(
        self, condition: str, context: frozenset[str], bound: Any, *, unit_known: bool
    ) -> Any:
        self.asked[0].append((condition, context))
        return (0.5 if unit_known else 0.8) * bound.angle_deg


def bounds(outcome: PipelineOutcome) -> tuple[float, float]:
    assert outcome.score is not None
    return outcome.score.bound_deg, outcome.score.bound_unit_deg


def test_a_method_that_reads_more_than_readings_is_bound_by_all_that_it_reads() -> None:
    flown = Flown(n=40, asked=([],))
    single, posterior = map(bounds, measured(flown, fake_atlas.LeastSquares, Remembering))
    assert posterior == pytest.approx((0.5 * single[0], 0.8 * single[0]))
    assert single[1] == pytest.approx(1.25 * single[0])
    assert set(flown.asked[0]) == {("quiet", frozenset({"time_s"}))}


def test_errors_of_samples_are_kept_of_the_condition_that_shows_them_and_of_no_failure() -> None:
    preset = fake_atlas.Diodes(conditions=(CONDITION,))
    task = Task(preset, CONDITION, fake_atlas.Currents, ())
    errors, found = np.array([0.1, 0.2]), np.array([True, True])
    good = PipelineOutcome("fake-least-squares", "", sample_errors_deg=errors, found=found)
    result = TaskResult(task, (), (good, replace(good, sample_errors_deg=None)))
    (kept,) = samples_of(replace(result, outcomes=(good,))).cells.values()
    (cell,) = samples_of(result).cells
    assert cell == Cell("fake-diodes", CONDITION, "fake-currents", "fake-least-squares")
    np.testing.assert_allclose(kept.error_deg, errors, rtol=1e-3)
    elsewhere = replace(result, task=replace(task, condition="noisy"))
    assert samples_of(elsewhere).cells == {}

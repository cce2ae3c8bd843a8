"""Where tasks go: to this process, to others bundle by bundle, never to none."""

from __future__ import annotations

import pickle
from dataclasses import replace
from typing import Any

import fake_atlas
import fake_cluster
import fake_plan
import numpy as np
import pytest

from benchmark.contract import Cell, UnknownNameError
from benchmark.plan.combinations import cells
from benchmark.progress import silent
from benchmark.results.samples import CONDITION
from benchmark.results.store import Store
from benchmark.running import backend, runner
from benchmark.running.cluster import WorkerLostError
from benchmark.running.durations import Durations
from benchmark.running.planned import samples_of
from benchmark.running.schedule import bundles
from benchmark.running.task import Outcome, Task, TaskResult, measure


def tasks(count: int, **named: Any) -> list[Task]:
    given = {"preset": fake_atlas.Diodes(), "condition": "quiet", "unit": 0, **named}
    return [
        Task(given["preset"], given["condition"], fake_atlas.Currents, (), given["unit"])
        for _ in range(count)
    ]


def test_what_a_preset_computes_when_it_is_measured_stays_with_the_worker(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def measured(task: Task, _: Any) -> TaskResult:
        vars(task.preset)["computed"] = bytes(10_000)
        return TaskResult(task, (), ())

    monkeypatch.setattr(backend, "measure", measured)
    some = tasks(2)
    for bundle in bundles(some, Durations(), 1.0, apart=True):
        done = backend.Work(bundle, Durations(), 1.0)()
        assert len(pickle.dumps(done)) < 10_000
        assert all(task is result.task for task, result, _ in done.timed)


@pytest.mark.slow
def test_a_worker_of_this_machine_that_is_killed_ends_the_run_by_name(
    tmp_path: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    deadly, store = tmp_path / "deadly", Store(tmp_path / "store")
    deadly.touch()
    parts = fake_cluster.parts(deadly=str(deadly))
    wanted = cells(parts=parts)
    with pytest.raises(WorkerLostError, match="a worker process was killed"):
        runner.run(wanted, store, 2, silent, parts=parts)
    deadly.unlink()
    kept = len(wanted) - len(runner.stale(wanted, store, parts=parts))
    assert runner.run(wanted, store, 2, silent, parts=parts).computed == len(wanted) - kept
    assert len(Store(store.directory).rows()) == len(wanted)


@pytest.mark.parametrize("name", ["dataset", "extractor", "model"])
def test_a_cell_of_what_is_not_installed_is_named_before_anything_is_done(
    name: str, tmp_path: Any
) -> None:
    known = Cell("fake-diodes", "quiet", "fake-currents", "fake-least-squares")
    wrong = replace(known, **{name: "fake-nothing"})
    parts, store = fake_plan.parts(), Store(tmp_path / "store")
    assert runner.stale([known], store, parts=parts) == [known]
    for call in (runner.stale, runner.run):
        with pytest.raises(UnknownNameError, match=f"no {name} named 'fake-nothing'"):
            call([known, wrong], store, parts=parts)
    assert not store.directory.exists()


def test_a_task_is_of_the_standard_unit_unless_it_says_otherwise() -> None:
    preset, models = fake_atlas.Diodes(n=40), (fake_atlas.LeastSquares,)
    plain = measure(Task(preset, "quiet", fake_atlas.Currents, models))
    assert {pin.split for pin in plain.pins} == {"calibration", "test", "repeat"}
    (outcome,) = plain.outcomes
    assert outcome.score is not None
    assert outcome.score.bound_deg > 0
    other = measure(Task(preset, "quiet", fake_atlas.Currents, models, 1))
    assert other.pins == ()


def test_cells_are_measured_once_each_and_the_time_is_told(tmp_path: Any) -> None:
    cell = Cell("fake-diodes", "quiet", "fake-currents", "fake-least-squares")
    store = Store(tmp_path)
    done = runner.run([cell, cell], store, progress=silent, parts=fake_plan.parts())
    assert (done.planned, done.already_stored, done.computed) == (1, 0, 1)
    assert 0.0 < done.seconds < 600.0
    assert done.store == tmp_path


def test_errors_of_samples_are_kept_of_the_condition_that_shows_them_and_of_no_failure() -> None:
    (task,) = tasks(1, preset=fake_atlas.Diodes(conditions=(CONDITION,)), condition=CONDITION)
    errors, found = np.array([0.1, 0.2]), np.array([True, True])
    good = Outcome("fake-least-squares", "", sample_errors_deg=errors, found=found)
    result = TaskResult(task, (), (good, replace(good, sample_errors_deg=None)))
    (kept,) = samples_of(replace(result, outcomes=(good,))).cells.values()
    (cell,) = samples_of(result).cells
    assert cell == Cell("fake-diodes", CONDITION, "fake-currents", "fake-least-squares")
    np.testing.assert_allclose(kept.error_deg, errors, rtol=1e-3)
    elsewhere = replace(result, task=replace(task, condition="noisy"))
    assert samples_of(elsewhere).cells == {}

"""What one worker does: generate a dataset's samples, extract once, fit and score every model.

A task is a pure function of its specification: what is kept of its stages for another time changes
no number, and is no part of it. An error of an implementation becomes an outcome with its reason.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats
from algorithms.threads import one_thread
from benchmark.contract import Cell
from benchmark.datasets.pins import Pin
from benchmark.processes import release_free_memory
from benchmark.running.condition_data import generate, truth
from benchmark.running.fitting import data_condition, fit_and_predict, reason_of
from benchmark.running.judging import PipelineOutcome, score_answers
from benchmark.running.kept_stages import FEATURES, PREDICTIONS, KeptStages
from benchmark.running.readings import found_features
from benchmark.running.stages import Answers, ConditionData, Task


@dataclass(frozen=True)
class TaskResult:
    """What a worker hands back; pins are of the standard unit only.

    `directions` are true ones (N, 3) of the test samples, which of them are observable and their
    bounds (N,), of the standard unit.
    """

    task: Task
    pins: tuple[Pin, ...]
    outcomes: tuple[PipelineOutcome, ...]
    directions: tuple[Floats, NDArray[np.bool_], Floats] | None = None


def measure(task: Task, kept: KeptStages | None = None) -> TaskResult:
    """Score every model of a task; never raises for an implementation's error.

    Stages are taken from and put into `kept`, if any.
    """
    with one_thread():
        try:
            data = _data(task, truth, kept)
        except Exception as error:  # noqa: BLE001 - any error of a dataset is a row with its reason
            return _failed(task, error, "generating data")
        answers = [_stored_answers(task, model, kept) for model in task.models]
        if None in answers:
            try:
                extractor, features = _extractor(task), _features(task, kept)
            except Exception as error:  # noqa: BLE001 - likewise of an extractor
                return _failed(task, error, "extracting", data.pins)
        outcomes = tuple(
            measured_on(task, extractor, model, features, data, kept=kept)
            if known is None
            else _judged(task, model, known, data)
            for model, known in zip(task.models, answers, strict=True)
        )
        directions = None
        if data.bound_deg is not None:
            directions = data.splits["test"].sun, data.observable, data.bound_deg
        return TaskResult(task, data.pins, outcomes, directions)


def measured_on(
    task: Task,
    extractor: Extractor,
    model: Scored,
    features: dict[str, Floats],
    data: ConditionData,
    *,
    kept: KeptStages | None = None,
) -> PipelineOutcome:
    """Calibrate and score one pipeline on the features (N, F) its extractor found, by split."""
    try:
        answers = fit_and_predict(task, extractor, model, features, data)
    except Exception as error:  # noqa: BLE001 - any error of a model is a row with its reason
        return PipelineOutcome(model.about.name, reason_of(error))
    if kept is not None:
        kept.put(PREDICTIONS, _cell(task, model), answers)
    return _judged(task, model, answers, data)


def _judged(task: Task, model: Scored, answers: Answers, data: ConditionData) -> PipelineOutcome:
    try:
        return score_answers(task, model, answers, data)
    except Exception as error:  # noqa: BLE001 - likewise of what it answers
        return PipelineOutcome(model.about.name, reason_of(error))


def _data(task: Task, look: Callable[..., ConditionData], kept: KeptStages | None) -> ConditionData:
    """Return the data of a task, by `generate` or `truth`."""
    condition = data_condition(task.preset, task.condition)
    return look(task.preset, condition, task.unit, all_observable=task.all_observable, kept=kept)


def _extractor(task: Task) -> Extractor:
    condition = data_condition(task.preset, task.condition)
    return task.extractor.for_sensor(task.preset.geometry_for(condition))


def _features(task: Task, kept: KeptStages | None) -> dict[str, Floats]:
    """Return what the extractor finds in every split, as it is kept or found now."""
    cell = _cell(task)
    known: dict[str, Floats] | None = None if kept is None else kept.get(FEATURES, cell)
    if known is not None:
        return known
    data, extractor = _data(task, generate, kept), _extractor(task)
    found = {split: found_features(data, extractor, split) for split in data.splits}
    if data.corrections:  # of frames that leave little room for what is free
        release_free_memory()
    if kept is not None:
        kept.put(FEATURES, cell, found)
    return found


def _stored_answers(task: Task, model: Scored, kept: KeptStages | None) -> Answers | None:
    found: Answers | None = None
    if kept is not None:
        found = kept.get(PREDICTIONS, _cell(task, model))
    return found


def _cell(task: Task, model: Scored | None = None) -> Cell:
    name = "" if model is None else model.about.name
    return Cell(task.preset.name, task.condition, task.extractor.about.name, name, task.unit)


def _failed(task: Task, error: Exception, doing: str, pins: tuple[Pin, ...] = ()) -> TaskResult:
    reason = f"{doing}: {reason_of(error)}"
    return TaskResult(
        task, pins, tuple(PipelineOutcome(model.about.name, reason) for model in task.models)
    )

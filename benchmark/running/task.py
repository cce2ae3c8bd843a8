"""What one worker does: generate a dataset's samples, extract once, fit and score every model.

A task is a pure function of its specification: what is kept of its stages for another time changes
no number, and is no part of it. An error of an implementation becomes an outcome with its reason.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats, UnusableDataError
from algorithms.pipeline import Pipeline
from algorithms.threads import one_thread
from benchmark.contract import ON_BENCH, Cell, Preset
from benchmark.datasets.benches import report
from benchmark.datasets.method_bound import method_bound_deg
from benchmark.datasets.pins import Pin
from benchmark.metrics.score import Score, score, separation_deg
from benchmark.processes import release_free_memory
from benchmark.running.condition_data import ConditionData, found_features, generate, truth
from benchmark.running.kept_stages import FEATURES, PREDICTIONS, KeptStages

#: Benches that each unit of a leading pipeline is calibrated on beside a perfect one.
BENCHES = 2


@dataclass(frozen=True)
class Task:
    """One dataset, condition, unit and extractor with the models to score behind it.

    Attributes
    ----------
    preset
        Of unit 0.
    unit
        Of the sensor.
    all_observable
        Whether the direction is known to be observable from every test sample, so that another
        unit than the standard one needs no bound.
    """

    preset: Preset
    condition: str
    extractor: type[Extractor]
    models: tuple[Scored, ...]
    unit: int = 0
    all_observable: bool = False


@dataclass(frozen=True)
class Answers:
    """What a fitted pipeline answers, before it is judged.

    Attributes
    ----------
    test
        Directions (N, 3) of the test split: of one fit to true directions, or of one to those of
        each drawn bench.
    repeat
        Of the split ``repeat``, or None.
    found
        Where (N,) the extractor gave features of the test split.
    refused
        Why the model refused its calibration, and there are no answers; empty where it did not.
    """

    test: tuple[Floats, ...] = ()
    repeat: Floats | None = None
    found: NDArray[np.bool_] | None = None
    refused: str = ""


@dataclass(frozen=True)
class Outcome:
    """What came of one model: a score, or the reason there is none.

    `refused`: the model's ``fit`` raised UnusableDataError, its contract's word for data it cannot
    work on. That is a result of method and data, as repeatable as a score; any other error is a
    failure, tried again by the next run. `sample_errors_deg` are the errors (N,) of the test
    samples under the first condition, NaN without an answer, and `found` says where (N,) the
    extractor gave features; None under other conditions.
    """

    model: str
    reason: str
    score: Score | None = None
    refused: bool = False
    sample_errors_deg: Floats | None = None
    found: NDArray[np.bool_] | None = None


class _RefusedError(Exception):
    """A model's ``fit`` refused its calibration: a result, unlike a refusal to predict."""

    def __init__(self, reason: UnusableDataError) -> None:
        super().__init__(reason_of(reason))


@dataclass(frozen=True)
class TaskResult:
    """What a worker hands back; pins are of the standard unit only.

    `directions` are true ones (N, 3) of the test samples, which of them are observable and their
    bounds (N,), of the standard unit.
    """

    task: Task
    pins: tuple[Pin, ...]
    outcomes: tuple[Outcome, ...]
    directions: tuple[Floats, NDArray[np.bool_], Floats] | None = None


def measure(task: Task, kept: KeptStages | None = None) -> TaskResult:
    """Score every model of a task; never raises for an implementation's error.

    Parameters
    ----------
    task
        What to measure.
    kept
        Where stages are kept; None to make all of them, and keep none.
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


def data_condition(preset: Preset, condition: str) -> str:
    """Return the condition whose readings a cell's condition is about."""
    return preset.conditions[0] if condition == ON_BENCH else condition


def measured_on(
    task: Task,
    extractor: Extractor,
    model: Scored,
    features: dict[str, Floats],
    data: ConditionData,
    *,
    kept: KeptStages | None = None,
) -> Outcome:
    """Calibrate and score one pipeline on the features (N, F) its extractor found, by split."""
    started = time.process_time()
    try:
        answers = fit_and_predict(task, extractor, model, features, data)
    except Exception as error:  # noqa: BLE001 - any error of a model is a row with its reason
        return Outcome(model.about.name, reason_of(error))
    if kept is not None:
        seconds = time.process_time() - started
        kept.put(PREDICTIONS, _cell(task, model), answers, seconds)
    return _judged(task, model, answers, data)


def _judged(task: Task, model: Scored, answers: Answers, data: ConditionData) -> Outcome:
    try:
        return score_answers(task, model, answers, data)
    except Exception as error:  # noqa: BLE001 - likewise of what it answers
        return Outcome(model.about.name, reason_of(error))


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
    started = time.process_time()
    found = {split: found_features(data, extractor, split) for split in data.splits}
    if data.correction is not None:  # of frames that leave little room for what is free
        release_free_memory()
    if kept is not None:
        kept.put(FEATURES, cell, found, time.process_time() - started)
    return found


def _stored_answers(task: Task, model: Scored, kept: KeptStages | None) -> Answers | None:
    found: Answers | None = None
    if kept is not None:
        found = kept.get(PREDICTIONS, _cell(task, model))
    return found


def _cell(task: Task, model: Scored | None = None) -> Cell:
    name = "" if model is None else model.about.name
    return Cell(task.preset.name, task.condition, task.extractor.about.name, name, task.unit)


def fit_and_predict(
    task: Task,
    extractor: Extractor,
    model: Scored,
    features: dict[str, Floats],
    data: ConditionData,
) -> Answers:
    """Fit one pipeline to its calibration and let it answer the other splits."""
    answers = _on_benches if task.condition == ON_BENCH else _own
    try:
        return answers(task, extractor, model, features, data)
    except _RefusedError as error:
        return Answers(refused=str(error))


def _own(
    task: Task,
    extractor: Extractor,
    model: Scored,
    features: dict[str, Floats],
    data: ConditionData,
) -> Answers:
    """Let a pipeline answer that was given the true directions of its calibration."""
    pipeline = _pipeline(task, extractor, model)
    _fit(pipeline, features, data, data.splits["calibration"].truth)
    repeated = None
    if "repeat" in features:
        repeated = pipeline.predict_features(features["repeat"], data.splits["repeat"].context)
    answers = pipeline.predict_features(features["test"], data.splits["test"].context)
    found = np.asarray(np.isfinite(features["test"]).all(axis=1))
    return Answers((answers,), repeated, found)


def _on_benches(
    task: Task,
    extractor: Extractor,
    model: Scored,
    features: dict[str, Floats],
    data: ConditionData,
) -> Answers:
    """Let a pipeline answer that was calibrated with the directions of each drawn bench."""
    on_bench = task.preset.for_unit(task.unit)
    known, test = data.splits["calibration"].truth, data.splits["test"]
    answers = []
    for draw in range(BENCHES):
        reported = report(on_bench, task.preset.conditions[0], np.asarray(known), draw)
        pipeline = _pipeline(task, extractor, model)
        _fit(pipeline, features, data, reported)
        answers.append(pipeline.predict_features(features["test"], test.context))
    return Answers(tuple(answers))


def score_answers(task: Task, model: Scored, answers: Answers, data: ConditionData) -> Outcome:
    """Judge what a pipeline answered."""
    name = model.about.name
    if answers.refused:
        return Outcome(name, answers.refused, refused=True)
    if task.condition == ON_BENCH:
        return Outcome(name, "", _pooled(answers, data))
    test, (own,) = data.splits["test"], answers.test
    posterior = _posterior_deg(task, model, data)
    found = score(
        own,
        test.sun,
        data.bound_deg if posterior is None else posterior,
        data.observable,
        None if answers.repeat is None else _repeat(answers.repeat, data),
        bound_unit_deg=data.bound_unit_deg if posterior is None else posterior,
    )
    if task.condition != task.preset.conditions[0]:
        return Outcome(name, "", found)
    errors = separation_deg(own, test.sun)
    return Outcome(name, "", found, sample_errors_deg=errors, found=answers.found)


def _pooled(answers: Answers, data: ConditionData) -> Score:
    """Judge the answers of all benches together; those that are aligned each by itself."""
    sun = data.splits["test"].sun
    each = [score(answer, sun, None, data.observable) for answer in answers.test]
    pooled = score(
        np.concatenate(answers.test),
        np.tile(sun, (BENCHES, 1)),
        None,
        np.tile(data.observable, BENCHES),
    )
    aligned = math.sqrt(float(np.mean([one.aligned_deg**2 for one in each])))
    return replace(pooled, aligned_deg=aligned)


def _posterior_deg(task: Task, model: Scored, data: ConditionData) -> Floats | None:
    """Bound (N,) of a method that knows the samples before or other instruments; None else."""
    if data.bound is None or not model.about.context:
        return None
    context = frozenset(model.about.context)
    return method_bound_deg(task.preset, task.condition, context, data.bound)


def _pipeline(task: Task, extractor: Extractor, model: Scored) -> Pipeline:
    geometry = task.preset.geometry_for(data_condition(task.preset, task.condition))
    return Pipeline(extractor, model.for_sensor(geometry, extractor.about.kind))


def _fit(pipeline: Pipeline, features: dict[str, Floats], data: ConditionData, sun: Floats) -> None:
    """Fit to the calibration's features; raises where the model refuses them."""
    try:
        pipeline.fit_features(features["calibration"], sun, data.splits["calibration"].context)
    except UnusableDataError as error:
        raise _RefusedError(error) from error


def _repeat(predicted: Floats, data: ConditionData) -> Floats:
    """Answers (R, P, 3) to the observable poses of the split ``repeat``."""
    chosen = data.preset.repeats.pose_indices(len(data.observable))
    passes = np.asarray(predicted).reshape(data.preset.repeats.passes, len(chosen), 3)
    return np.asarray(passes[:, data.observable[chosen]])


def reason_of(error: BaseException) -> str:
    """Spell an error as a results row states it: one line, the same on every machine."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _failed(task: Task, error: Exception, doing: str, pins: tuple[Pin, ...] = ()) -> TaskResult:
    reason = f"{doing}: {reason_of(error)}"
    return TaskResult(task, pins, tuple(Outcome(model.about.name, reason) for model in task.models))

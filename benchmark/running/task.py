"""What one worker does: generate a dataset's samples, extract once, fit and score every model.

A task is a pure function of its specification; it writes nothing. An error of an implementation
becomes an outcome with its reason.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats, UnusableDataError
from algorithms.pipeline import Pipeline
from benchmark.contract import ON_BENCH, Preset
from benchmark.datasets.benches import report
from benchmark.datasets.method_bound import method_bound_deg
from benchmark.datasets.pins import Pin
from benchmark.metrics.score import Score, score, separation_deg
from benchmark.running.condition_data import ConditionData, found_features, generate
from benchmark.running.threads import one_thread

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


class RefusedError(Exception):
    """A model's ``fit`` refused its calibration: a result, unlike a refusal to predict."""

    def __init__(self, reason: UnusableDataError) -> None:
        super().__init__(str(reason))
        self.reason = reason


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


def measure(task: Task) -> TaskResult:
    """Score every model of a task; never raises for an implementation's error."""
    condition = data_condition(task.preset, task.condition)
    with one_thread():
        try:
            data = generate(task.preset, condition, task.unit, all_observable=task.all_observable)
        except Exception as error:  # noqa: BLE001 - any error of a dataset is a row with its reason
            return _failed(task, error, "generating data")
        try:
            extractor = task.extractor.for_sensor(task.preset.geometry_for(condition))
            features = {split: found_features(data, extractor, split) for split in data.splits}
        except Exception as error:  # noqa: BLE001 - likewise of an extractor
            return _failed(task, error, "extracting", data.pins)
        outcomes = tuple(
            measured_on(task, extractor, model, features, data) for model in task.models
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
) -> Outcome:
    """Calibrate and score one pipeline on the features (N, F) its extractor found, by split."""
    scored = _on_benches if task.condition == ON_BENCH else _own
    name = model.about.name
    try:
        return scored(task, extractor, model, features, data)
    except RefusedError as error:
        return Outcome(name, reason_of(error.reason), refused=True)
    except Exception as error:  # noqa: BLE001 - any error of a model is a row with its reason
        return Outcome(name, reason_of(error))


def _own(
    task: Task,
    extractor: Extractor,
    model: Scored,
    features: dict[str, Floats],
    data: ConditionData,
) -> Outcome:
    """Score a pipeline that was told the true directions of its calibration."""
    pipeline = _pipeline(task, extractor, model)
    _fit(pipeline, features, data, data.splits["calibration"].truth)
    repeated = None
    if "repeat" in features:
        again = data.splits["repeat"].context
        repeated = _repeat(pipeline.predict_features(features["repeat"], again), data)
    test = data.splits["test"]
    answers = pipeline.predict_features(features["test"], test.context)
    posterior = _posterior_deg(task, model, data)
    found = score(
        answers,
        test.sun,
        data.bound_deg if posterior is None else posterior,
        data.observable,
        repeated,
        bound_unit_deg=data.bound_unit_deg if posterior is None else posterior,
    )
    if task.condition != task.preset.conditions[0]:
        return Outcome(model.about.name, "", found)
    return Outcome(
        model.about.name,
        "",
        found,
        sample_errors_deg=separation_deg(answers, test.sun),
        found=np.asarray(np.isfinite(features["test"]).all(axis=1)),
    )


def _posterior_deg(task: Task, model: Scored, data: ConditionData) -> Floats | None:
    """Bound (N,) of a method that knows the samples before or other instruments; None else."""
    if data.bound is None or not model.about.context:
        return None
    context = frozenset(model.about.context)
    return method_bound_deg(task.preset, task.condition, context, data.bound)


def _on_benches(
    task: Task,
    extractor: Extractor,
    model: Scored,
    features: dict[str, Floats],
    data: ConditionData,
) -> Outcome:
    """Score a pipeline calibrated with the directions of drawn benches; errors are pooled."""
    on_bench = task.preset.for_unit(task.unit)
    known, test = data.splits["calibration"].truth, data.splits["test"]
    answers = []
    for draw in range(BENCHES):
        told = report(on_bench, task.preset.conditions[0], np.asarray(known), draw)
        pipeline = _pipeline(task, extractor, model)
        _fit(pipeline, features, data, told)
        answers.append(pipeline.predict_features(features["test"], test.context))
    each = [score(answer, test.sun, None, data.observable) for answer in answers]
    pooled = score(
        np.concatenate(answers),
        np.tile(test.sun, (BENCHES, 1)),
        None,
        np.tile(data.observable, BENCHES),
    )
    aligned = math.sqrt(float(np.mean([one.aligned_deg**2 for one in each])))
    return Outcome(model.about.name, "", replace(pooled, aligned_deg=aligned))


def _pipeline(task: Task, extractor: Extractor, model: Scored) -> Pipeline:
    geometry = task.preset.geometry_for(data_condition(task.preset, task.condition))
    return Pipeline(extractor, model.for_sensor(geometry, extractor.about.kind))


def _fit(pipeline: Pipeline, features: dict[str, Floats], data: ConditionData, sun: Floats) -> None:
    """Fit to the calibration's features; RefusedError where the model refuses them."""
    try:
        pipeline.fit_features(features["calibration"], sun, data.splits["calibration"].context)
    except UnusableDataError as error:
        raise RefusedError(error) from error


def _repeat(predicted: Floats, data: ConditionData) -> Floats:
    """Answers (R, P, 3) to the observable poses of the split ``repeat``."""
    chosen = data.preset.repeats.chosen(len(data.observable))
    passes = np.asarray(predicted).reshape(data.preset.repeats.passes, len(chosen), 3)
    return np.asarray(passes[:, data.observable[chosen]])


def reason_of(error: BaseException) -> str:
    """Spell an error as a results row states it: one line, the same on every machine."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _failed(task: Task, error: Exception, doing: str, pins: tuple[Pin, ...] = ()) -> TaskResult:
    reason = f"{doing}: {reason_of(error)}"
    return TaskResult(task, pins, tuple(Outcome(model.about.name, reason) for model in task.models))

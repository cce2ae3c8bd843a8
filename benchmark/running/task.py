"""What one worker does: generate a dataset's samples, extract once, fit and score every model.

A task is a pure function of its specification; it writes nothing. An error of an implementation
becomes an outcome with its reason.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats, UnusableDataError
from algorithms.pipeline import Pipeline, extracted
from benchmark.contract import Preset
from benchmark.datasets.pins import Pin
from benchmark.metrics.score import Score, score
from benchmark.running.generated import Generated, generated
from benchmark.running.threads import one_thread


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
    failure, tried again by the next run.
    """

    model: str
    reason: str
    score: Score | None = None
    refused: bool = False


@dataclass(frozen=True)
class TaskResult:
    """What a worker hands back; pins are of the standard unit only."""

    task: Task
    pins: tuple[Pin, ...]
    outcomes: tuple[Outcome, ...]


def measure(task: Task) -> TaskResult:
    """Score every model of a task; never raises for an implementation's error."""
    with one_thread():
        try:
            data = generated(
                task.preset, task.condition, task.unit, all_observable=task.all_observable
            )
        except Exception as error:  # noqa: BLE001 - any error of a dataset is a row with its reason
            return _failed(task, error, "generating data")
        try:
            extractor = task.extractor.for_sensor(task.preset.geometry_for(task.condition))
            features = {
                split: extracted(extractor, samples.observations, samples.origin_px)
                for split, samples in data.splits.items()
            }
        except Exception as error:  # noqa: BLE001 - likewise of an extractor
            return _failed(task, error, "extracting", data.pins)
        outcomes = tuple(_outcome(task, extractor, model, features, data) for model in task.models)
        return TaskResult(task, data.pins, outcomes)


def _outcome(
    task: Task,
    extractor: Extractor,
    model_class: Scored,
    features: dict[str, Floats],
    data: Generated,
) -> Outcome:
    """Calibrate and score one pipeline on the features its extractor found."""
    name = model_class.about.name
    try:
        geometry = task.preset.geometry_for(task.condition)
        model = model_class.for_sensor(geometry, extractor.about.kind)
        pipeline = Pipeline(extractor, model)
        try:
            known = data.splits["calibration"]
            pipeline.fit_features(features["calibration"], known.sun, known.context)
        except UnusableDataError as error:
            return Outcome(name, reason_of(error), refused=True)
        predicted = pipeline.predict_features(features["test"], data.splits["test"].context)
        repeated = None
        if "repeat" in features:
            again = data.splits["repeat"].context
            repeated = _repeated(pipeline.predict_features(features["repeat"], again), data)
        truth = data.splits["test"].sun
        result = score(
            predicted,
            truth,
            data.bound_deg,
            data.observable,
            repeated,
            bound_unit_deg=data.bound_unit_deg,
            reference_error_deg=task.preset.reference_error_deg(task.condition),
        )
    except Exception as error:  # noqa: BLE001 - any error of a model is a row with its reason
        return Outcome(name, reason_of(error))
    return Outcome(name, "", result)


def _repeated(predicted: Floats, data: Generated) -> Floats:
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

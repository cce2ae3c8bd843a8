"""The stage of predictions: a pipeline is fitted to features, and answers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats, UnusableDataError
from algorithms.pipeline import Pipeline
from benchmark.contract import ON_BENCH
from benchmark.datasets.benches import report
from benchmark.running.stages import Answers, ConditionData, Task

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

#: Benches that each unit of a leading pipeline is calibrated on beside a perfect one.
BENCHES = 2


class _RefusedError(Exception):
    """A model's ``fit`` refused its calibration: a result, unlike a refusal to predict."""

    def __init__(self, reason: UnusableDataError) -> None:
        super().__init__(reason_of(reason))


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


def _pipeline(task: Task, extractor: Extractor, model: Scored) -> Pipeline:
    geometry = task.preset.geometry_for(data_condition(task.preset, task.condition))
    return Pipeline(extractor, model.for_sensor(geometry, extractor.about.kind))


def _fit(pipeline: Pipeline, features: dict[str, Floats], data: ConditionData, sun: Floats) -> None:
    """Fit to the calibration's features; raises where the model refuses them."""
    try:
        pipeline.fit_features(features["calibration"], sun, data.splits["calibration"].context)
    except UnusableDataError as error:
        raise _RefusedError(error) from error


def data_condition(preset: Preset, condition: str) -> str:
    """Return the condition whose readings a cell's condition is about."""
    return preset.conditions[0] if condition == ON_BENCH else condition


def reason_of(error: BaseException) -> str:
    """Spell an error as a results row states it: one line, the same on every machine."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"

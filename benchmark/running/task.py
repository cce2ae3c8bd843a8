"""What one worker does: generate a dataset's samples, extract once, fit and score every model.

A task is a pure function of its specification; it writes nothing. An error of an implementation
becomes an outcome with its reason.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, Floats, Model, UnusableDataError
from algorithms.pipeline import Pipeline, extracted
from benchmark.canonical import digest
from benchmark.contract import SPLITS, Bound, Preset, Samples
from benchmark.datasets.pins import Pin
from benchmark.datasets.samples import HEAD, head_hash, samples_hash
from benchmark.metrics.score import Score, score, stored
from benchmark.running.threads import one_thread
from benchmark.simulator.light.memory import memory

#: Datasets under one condition kept per process: the plan hands out a dataset's tasks in a row.
_KEPT = 2
#: Bytes of kept observations from which on only one dataset is: a worker stays below 1.5 GB.
_KEPT_BYTES = 128 * 2**20


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
    models: tuple[type[Model], ...]
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


@dataclass(frozen=True)
class _Data:
    preset: Preset  # of unit 0, as the task has it
    splits: dict[str, Samples]
    bound_deg: Floats | None
    observable: NDArray[np.bool_]
    pins: tuple[Pin, ...]


_Place = tuple[str, str, int, str]  # dataset, condition, unit, digest of the parameters
_kept: OrderedDict[_Place, _Data] = OrderedDict()


def measure(task: Task) -> TaskResult:
    """Score every model of a task; never raises for an implementation's error."""
    with one_thread():
        try:
            data = _data(task.preset, task.condition, task.unit, task.all_observable)
        except Exception as error:  # noqa: BLE001 - any error of a dataset is a row with its reason
            return _failed(task, error, "generating data")
        try:
            return _measured(task, data)
        except Exception as error:  # noqa: BLE001 - likewise of an extractor
            return _failed(task, error, "extracting", data.pins)


def generated_pins(preset: Preset, condition: str) -> tuple[Pin, ...]:
    """Pins of a dataset's splits as this machine generates them."""
    return _data(preset, condition).pins


def _data(preset: Preset, condition: str, unit: int = 0, all_observable: bool = False) -> _Data:
    place = _place_of(preset, condition, unit)
    if place not in _kept:
        _make_room()
        memory.remember((preset.name, unit))  # the conditions of a dataset see the same Suns
        _kept[place] = (
            _of_another_unit(preset, condition, unit, all_observable)
            if unit
            else _of_the_standard_unit(preset, condition)
        )
    _kept.move_to_end(place)
    return _kept[place]


def _place_of(preset: Preset, condition: str, unit: int) -> _Place:
    """Name data by what they depend on; known without a digest for what is kept of this object."""
    for place, data in _kept.items():
        if data.preset is preset and place[:3] == (preset.name, condition, unit):
            return place
    return preset.name, condition, unit, digest(preset.parameters(condition))


def _of_the_standard_unit(preset: Preset, condition: str) -> _Data:
    splits = {split: preset.generate(condition, split) for split in SPLITS}
    bound = preset.bound(condition, "test")
    angle, observable = np.asarray(bound.angle_deg), np.asarray(bound.observable, dtype=np.bool_)
    pins = tuple(_pin(preset, condition, split, splits[split], bound) for split in SPLITS)
    return _Data(preset, splits, angle, observable, pins)


def _of_another_unit(preset: Preset, condition: str, unit: int, all_observable: bool) -> _Data:
    """Calibration and test split; what is observable is taken from the standard unit's bound."""
    other = preset.as_unit(unit)
    splits = {split: other.generate(condition, split) for split in ("calibration", "test")}
    seen = (
        np.ones(len(splits["test"].sun), dtype=np.bool_)
        if all_observable
        else np.asarray(preset.bound(condition, "test").observable, dtype=np.bool_)
    )
    return _Data(preset, splits, None, seen, ())


def _pin(preset: Preset, condition: str, split: str, samples: Samples, bound: Bound) -> Pin:
    told: dict[str, Any] = {}
    if split == "test":
        told = {
            "observable": int(np.asarray(bound.observable, dtype=np.bool_).sum()),
            "bound_deg": rms_bound(bound),
            "head_bound_deg": rms_bound(bound, HEAD),
        }
    return Pin(
        preset.name,
        condition,
        split,
        preset.version,
        len(samples.sun),
        samples_hash(samples),
        head_hash(samples),
        **told,
    )


def rms_bound(bound: Bound, first: int | None = None) -> float | None:
    """Return the bound over the (first) observable samples as pins keep it; None for none."""
    seen = np.asarray(bound.observable, dtype=np.bool_)[:first]
    angle = np.asarray(bound.angle_deg)[:first][seen]
    return stored(float(np.sqrt(np.mean(angle**2)))) if len(angle) else None


def _make_room() -> None:
    """Let go of what was used longest ago, before more is generated."""
    while _kept and (len(_kept) >= _KEPT or _kept_bytes() > _KEPT_BYTES):
        _kept.popitem(last=False)


def _kept_bytes() -> int:
    splits = [split for data in _kept.values() for split in data.splits.values()]
    return sum(np.asarray(split.observations).nbytes for split in splits)


def _measured(task: Task, data: _Data) -> TaskResult:
    extractor = task.extractor.for_sensor(task.preset.geometry_for(task.condition))
    features = {
        split: extracted(extractor, samples.observations, samples.origin_px)
        for split, samples in data.splits.items()
    }
    outcomes = tuple(_outcome(task, extractor, model, features, data) for model in task.models)
    return TaskResult(task, data.pins, outcomes)


def _outcome(
    task: Task,
    extractor: Extractor,
    model_class: type[Model],
    features: dict[str, Floats],
    data: _Data,
) -> Outcome:
    """Calibrate and score one pipeline on the features its extractor found."""
    name = model_class.about.name
    try:
        geometry = task.preset.geometry_for(task.condition)
        model = model_class.for_sensor(geometry, extractor.about.kind)
        pipeline = Pipeline(extractor, model)
        try:
            pipeline.fit_features(features["calibration"], data.splits["calibration"].sun)
        except UnusableDataError as error:
            return Outcome(name, reason_of(error), refused=True)
        predicted = pipeline.predict_features(features["test"])
        repeated = None
        if "repeat" in features:
            repeated = _repeated(pipeline.predict_features(features["repeat"]), data)
        truth = data.splits["test"].sun
        result = score(predicted, truth, data.bound_deg, data.observable, repeated)
    except Exception as error:  # noqa: BLE001 - any error of a model is a row with its reason
        return Outcome(name, reason_of(error))
    return Outcome(name, "", result)


def _repeated(predicted: Floats, data: _Data) -> Floats:
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

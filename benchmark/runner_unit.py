"""What one worker does: generate a dataset's samples, extract once, fit and score every model.

A unit is a pure function of its specification; it writes nothing. An error of an implementation
becomes an outcome with its reason.
"""

from __future__ import annotations

import time
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, Floats, Model, in_detector_coordinates
from benchmark.content_key import Specifications, digest, samples_hash, seed
from benchmark.plan_parts import SPLITS, Bound, Preset, Samples
from benchmark.runner_timing import Timing, best_of, best_time, one_thread
from benchmark.scoring import Score, score, stored
from benchmark.simulator.light_memory import memory
from benchmark.store import Pin

#: Datasets under one condition kept per process: the plan hands out a dataset's units in a row.
_KEPT = 2
#: Bytes of kept observations from which on only one dataset is: a worker stays below 1.5 GB.
_KEPT_BYTES = 128 * 2**20
#: Values the reference turns to floats at a time: 32 MB of them.
_REFERENCE_VALUES = 2**22


@dataclass(frozen=True)
class Unit:
    """One dataset, condition and extractor with the models to score behind it."""

    preset: Preset
    condition: str
    extractor: type[Extractor]
    models: tuple[type[Model], ...]


@dataclass(frozen=True)
class Outcome:
    """What came of one model: a score with times, or the reason there is none.

    `refused`: the model's ``fit`` or ``predict`` raised ValueError, its contract's word for data
    it cannot work on. That is a result of method and data, as repeatable as a score; any other
    error is a failure, tried again by the next run.
    """

    model: str
    reason: str
    score: Score | None = None
    fit_s: float = 0.0
    predict_s: float | None = None
    refused: bool = False


@dataclass(frozen=True)
class UnitResult:
    """What a worker hands back."""

    unit: Unit
    pins: tuple[Pin, ...]
    n_calibration: int
    n_test: int
    extract_calibration_s: float
    extract: Timing | None
    outcomes: tuple[Outcome, ...]


@dataclass(frozen=True)
class _Data:
    preset: Preset
    calibration: Samples
    test: Samples
    bound: Bound
    pins: tuple[Pin, ...]


_kept: OrderedDict[tuple[str, str, str], _Data] = OrderedDict()


def measure(unit: Unit) -> UnitResult:
    """Score every model of a unit; never raises for an implementation's error."""
    with one_thread():
        try:
            data = _data(unit.preset, unit.condition)
        except Exception as error:  # noqa: BLE001 - any error of a dataset is a row with its reason
            return _failed(unit, error, "generating data")
        try:
            return _measured(unit, data)
        except Exception as error:  # noqa: BLE001 - likewise of an extractor
            return _failed(unit, error, "extracting", data)


def generated_pins(preset: Preset, condition: str) -> tuple[Pin, ...]:
    """Pins of a dataset's splits as this machine generates them."""
    return _data(preset, condition).pins


def _data(preset: Preset, condition: str) -> _Data:
    place = _place_of(preset, condition)
    if place not in _kept:
        _make_room()
        memory.remember(preset.name)  # the conditions of a dataset see the same Suns
        splits = {split: preset.generate(condition, split) for split in SPLITS}
        specification = _specifications_of(preset).of(preset, condition)
        bound = preset.bound(condition, "test")
        pins = tuple(
            Pin(
                preset.name,
                condition,
                split,
                preset.version,
                specification,
                samples_hash(samples),
                len(samples.sun),
                _rms_deg(bound) if split == "test" else None,
            )
            for split, samples in splits.items()
        )
        _kept[place] = _Data(preset, splits["calibration"], splits["test"], bound, pins)
    _kept.move_to_end(place)
    return _kept[place]


def _place_of(preset: Preset, condition: str) -> tuple[str, str, str]:
    """Name and digest of a dataset's parameters, taken from what is kept of the same object."""
    for place, data in _kept.items():
        if data.preset is preset and place[:2] == (preset.name, condition):
            return place
    return preset.name, condition, digest(preset.parameters(condition))


_digested: list[tuple[Preset, Specifications]] = []


def _specifications_of(preset: Preset) -> Specifications:
    """Digests kept for as long as units of the same bundle, which share the object, come in."""
    if not _digested or _digested[0][0] is not preset:
        _digested[:] = [(preset, Specifications())]
    return _digested[0][1]


def _make_room() -> None:
    """Let go of what was used longest ago, before more is generated."""
    while _kept and (len(_kept) >= _KEPT or _kept_bytes() > _KEPT_BYTES):
        _kept.popitem(last=False)


def _kept_bytes() -> int:
    splits = [split for data in _kept.values() for split in (data.calibration, data.test)]
    return sum(np.asarray(split.observations).nbytes for split in splits)


def _rms_deg(bound: Bound) -> float | None:
    seen = np.asarray(bound.angle_deg)[np.asarray(bound.observable)]
    return stored(float(np.sqrt(np.mean(seen**2)))) if seen.size else None


def _measured(unit: Unit, data: _Data) -> UnitResult:
    _seed_opencv(seed(unit.preset.name, unit.condition, unit.extractor.name))
    extractor = unit.extractor.for_sensor(unit.preset.geometry_for(unit.condition))
    started = time.perf_counter()
    calibration = _features(extractor, data.calibration)  # also warms compiled code up
    calibration_s = time.perf_counter() - started
    observations = data.test.observations
    test, extract = best_of(
        lambda: _features(extractor, data.test), lambda: reference(observations)
    )
    outcomes = tuple(_outcome(unit, model, calibration, test, data) for model in unit.models)
    return UnitResult(
        unit,
        data.pins,
        len(data.calibration.sun),
        len(data.test.sun),
        calibration_s,
        extract,
        outcomes,
    )


def _outcome(
    unit: Unit, model_class: type[Model], calibration: Floats, test: Floats, data: _Data
) -> Outcome:
    name = model_class.name
    try:
        _seed_opencv(seed(unit.preset.name, unit.condition, unit.extractor.name, name))
        model = model_class.for_sensor(
            unit.preset.geometry_for(unit.condition), unit.extractor.kind
        )
        started = time.perf_counter()
        try:
            model.fit(calibration, data.calibration.sun)
            fit_s = time.perf_counter() - started
            predicted, predict_s = best_time(lambda: model.predict(test))
        except ValueError as error:
            return Outcome(name, reason_of(error), refused=True)
        result = score(predicted, data.test.sun, data.bound.angle_deg, data.bound.observable)
    except Exception as error:  # noqa: BLE001 - any error of a model is a row with its reason
        return Outcome(name, reason_of(error))
    return Outcome(name, "", result, fit_s, predict_s)


def _features(extractor: Extractor, samples: Samples) -> Floats:
    features = extractor.extract(samples.observations)
    expected = (len(samples.sun), len(extractor.features))
    if features.shape != expected or features.dtype != np.float64:
        raise ValueError(
            f"{extractor.name} must give float64 features of shape {expected}; "
            f"got {features.dtype} {features.shape}"
        )
    return in_detector_coordinates(features, extractor.kind, samples.origin_px)


def reference(observations: NDArray[Any]) -> object:
    """Do a fixed amount of NumPy work on the same observations; times are stated against it.

    One weighted sum a sample: the least that anything reading all of an observation must do.
    """
    samples = observations.reshape(len(observations), -1)
    if samples.dtype.names is not None:
        samples = samples.view(np.uint8).reshape(len(observations), -1)  # events: their bytes
    weights = np.linspace(0.0, 1.0, samples.shape[1])
    rows = max(_REFERENCE_VALUES // samples.shape[1], 1)
    parts = range(0, len(samples), rows)
    return [samples[start : start + rows].astype(np.float64) @ weights for start in parts]


def reason_of(error: BaseException) -> str:
    """Spell an error as a results row states it: one line, the same on every machine."""
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _failed(unit: Unit, error: Exception, doing: str, data: _Data | None = None) -> UnitResult:
    reason = f"{doing}: {reason_of(error)}"
    return UnitResult(
        unit,
        data.pins if data else (),
        len(data.calibration.sun) if data else 0,
        len(data.test.sun) if data else 0,
        0.0,
        None,
        tuple(Outcome(model.name, reason) for model in unit.models),
    )


def _seed_opencv(value: int) -> None:
    import cv2  # noqa: PLC0415 - only the process that measures needs OpenCV

    cv2.setRNGSeed(value)

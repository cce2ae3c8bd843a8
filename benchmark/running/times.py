"""Measuring the published running times: every pipeline against one fixed reference loop."""

from __future__ import annotations

import json
import platform
import re
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats, SensorGeometry
from algorithms.pipeline import Pipeline, extract_features
from algorithms.threads import one_thread
from benchmark.contract import Cell, Preset, Samples
from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.csv_tables import text_of
from benchmark.results.times import COLUMNS, MACHINE, TIMES, Machine, Place, Time, read_times
from files.atomic import replace_file
from files.locks import wait_for_lock
from files.temporary import remove_stale_files

#: Observations that are timed together: as many as fill this, of what the test split has.
_TIMED_BYTES = 8 * 2**20
_FEWEST = 8
#: Values that the weighted sum turns to floats at a time: 32 MB of them.
_SUMMED_VALUES = 2**22
#: A call is timed at least so often, and on until it took so long or was timed so often.
_FEWEST_RUNS, _ENOUGH_S, _MOST_RUNS = 5, 0.1, 20
_LOOP_RUNS = 200

_VALUES = np.linspace(0.0, 1.0, 100_000)
_WEIGHTS = _VALUES[::-1].copy()
LOOP = (
    "10 weighted sums of 100,000 float64 numbers by NumPy, and 10,000 steps of x = 0.5 x + 1 in "
    "Python; processor time, best of several"
)

T = TypeVar("T")


def reference_loop() -> float:
    """Do the work that times are multiples of.

    Ten weighted sums (`numpy.dot`) of 100,000 float64 numbers, and 10,000 steps of
    ``x = 0.5 * x + 1.0`` in the interpreter. It reads no observation and never changes, so that it
    says how fast a machine does arithmetic and runs Python.
    """
    x = 0.0
    for _ in range(10):
        x += float(np.dot(_VALUES, _WEIGHTS))
    for _ in range(10_000):
        x = 0.5 * x + 1.0
    return x


def weighted_sums(observations: NDArray[Any]) -> object:
    """Sum every observation with weights.

    The least that anything reading all of an observation must do.
    """
    samples = observations.reshape(len(observations), -1)
    if samples.dtype.names is not None:
        samples = samples.view(np.uint8).reshape(len(observations), -1)  # events: their bytes
    weights = np.linspace(0.0, 1.0, samples.shape[1])
    rows = max(_SUMMED_VALUES // samples.shape[1], 1)
    parts = range(0, len(samples), rows)
    return [samples[start : start + rows].astype(np.float64) @ weights for start in parts]


def best_of(call: Callable[[], T], *references: Callable[[], object]) -> tuple[T, list[float]]:
    """Return the result of `call`, its best time in seconds, and those of references.

    Processor time of this process, so that other programs do not count. The references run before
    each run of the call, so that a change of the processor's frequency changes all alike.
    """
    best = [float("inf")] * (1 + len(references))
    spent, runs = 0.0, 0
    while runs < _FEWEST_RUNS or (spent < _ENOUGH_S and runs < _MOST_RUNS):
        seconds = [_time(reference)[0] for reference in references]
        own, result = _time(call)
        best = [min(pair) for pair in zip(best, [own, *seconds], strict=True)]
        spent, runs = spent + own, runs + 1
    return result, best


def _time(call: Callable[[], T]) -> tuple[float, T]:
    started = time.process_time()
    result = call()
    return time.process_time() - started, result


def update(
    directory: Path,
    progress: ProgressCallback | None = None,
    *,
    again: bool = False,
    parts: Parts | None = None,
) -> int:
    """Time the pipelines that have no time yet; returns how many were.

    In this process and one after another. Times are on disk data set by data set, and those of
    pipelines that there are no longer are dropped.

    Parameters
    ----------
    directory
        Of the record.
    progress
        As `benchmark.running.runner.run`.
    again
        Whether to forget all times first, and the machine they were measured on.
    parts
        Data sets and implementations; what is installed by default.

    Raises
    ------
    StoreError
        Where the files cannot be read.
    """
    known = parts or installed_parts()
    first = {name: preset.conditions[0] for name, preset in known.presets.items()}
    planned = [cell for cell in cells(parts=known) if cell.condition == first[cell.dataset]]
    for name in (TIMES, MACHINE):
        remove_stale_files(directory, name)
    if again:
        _write(directory, {}, planned, forget=True)
    there = read_times(directory).rows
    missing = [cell for cell in planned if _pipeline(cell) not in there]
    with terminal_progress() if progress is None else nullcontext(progress) as report:
        done = 0
        report(done, len(missing), "")
        for dataset, group in groupby(missing, key=lambda cell: cell.dataset):
            timed = {one.pipeline: one for one in _timed(known, list(group))}
            _write(directory, timed, planned)
            done += len(timed)
            report(done, len(missing), dataset)
    return len(missing)


def _write(
    directory: Path, timed: Mapping[Place, Time], planned: Sequence[Cell], *, forget: bool = False
) -> None:
    """Add times to those on disk, which another process may have written meanwhile."""
    directory.mkdir(parents=True, exist_ok=True)
    with wait_for_lock(directory / TIMES):
        if forget:
            (directory / TIMES).unlink(missing_ok=True)
        there = read_times(directory)
        here = there.machine or _this_machine()
        if timed and (also := _processor()) not in {here.processor, *here.also_on}:
            here = replace(here, also_on=(*here.also_on, also))
        kept = {**there.rows, **timed}
        rows = [asdict(kept[place]) for place in sorted(kept.keys() & set(map(_pipeline, planned)))]
        if rows:
            replace_file(directory / MACHINE, json.dumps(asdict(here), indent=2) + "\n")
            replace_file(directory / TIMES, text_of(list(COLUMNS), rows))


def _this_machine() -> Machine:
    with one_thread():
        _, (seconds, *_) = min(
            (best_of(reference_loop) for _ in range(_LOOP_RUNS // _MOST_RUNS)),
            key=lambda found: found[1],
        )
    return Machine(
        processor=_processor(),
        cores=1,
        python=platform.python_version(),
        numpy=np.__version__,
        date=datetime.now(UTC).date().isoformat(),
        loop=LOOP,
        loop_us=_round(1e6 * seconds),
    )


def _processor() -> str:
    """Return the processor's model, of ``/proc/cpuinfo`` where there is one."""
    try:
        about = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return platform.processor() or platform.machine()
    known = dict(re.findall(r"^(model name|cpu family|model)\s*: (.+)$", about, re.MULTILINE))
    if "model name" not in known:
        return platform.machine()
    family, model = known.get("cpu family", "?"), known.get("model", "?")
    return f"{known['model name']} (family {family}, model {model})"


def _timed(parts: Parts, group: list[Cell]) -> Iterator[Time]:
    """Time the pipelines of one data set."""
    preset, condition = parts.preset(group[0].dataset), group[0].condition
    with one_thread():
        data = _Data(
            preset.geometry_for(condition),
            preset.generate(condition, "calibration"),
            preset.generate(condition, "test", _batch(preset, condition)),
        )
        for name, of_extractor in groupby(group, key=lambda cell: cell.extractor):
            models = [parts.model(cell.model) for cell in of_extractor]
            for model, numbers in _ratios(data, parts.extractor(name), models):
                yield Time(preset.name, name, model.about.name, *numbers)


@dataclass(frozen=True)
class _Data:
    geometry: SensorGeometry
    calibration: Samples
    test: Samples


_Ratios = tuple[float | None, float | None]
_UNTIMED: _Ratios = (None, None)


def _ratios(
    data: _Data, extractor_class: type[Extractor], models: Sequence[Scored]
) -> Iterator[tuple[Scored, _Ratios]]:
    """Give the ratios of an extractor with each of the models."""
    sums = partial(weighted_sums, data.test.observations)
    try:
        extractor = extractor_class.for_sensor(data.geometry)
        known = _features(extractor, data.calibration)  # also warms compiled code up
        features, (extract_s, loop_s, sums_s) = best_of(
            lambda: _features(extractor, data.test), reference_loop, sums
        )
    except Exception:  # noqa: BLE001 - the record says what failed; here it has no time
        yield from ((model, _UNTIMED) for model in models)
        return
    for model_class in models:
        try:
            model = model_class.for_sensor(data.geometry, extractor.about.kind)
            pipeline = Pipeline(extractor, model)
            pipeline.fit_features(known, data.calibration.sun, data.calibration.context)
            predict = partial(pipeline.predict_features, features, data.test.context)
            _, (predict_s, loop_again_s) = best_of(predict, reference_loop)
        except Exception:  # noqa: BLE001 - likewise
            yield model_class, _UNTIMED
            continue
        whole = extract_s / loop_s + predict_s / loop_again_s
        yield model_class, (_round(whole / len(data.test.sun)), _round(extract_s / sums_s))


def _batch(preset: Preset, condition: str) -> int:
    """Return how many test samples to time together; a split may have fewer."""
    one = preset.generate(condition, "test", 1)
    return max(_TIMED_BYTES // max(one.observations.nbytes, 1), _FEWEST)


def _features(extractor: Extractor, samples: Samples) -> Floats:
    return extract_features(extractor, samples.observations, samples.origin_px)


def _round(value: float) -> float:
    return float(f"{value:.3g}")


def _pipeline(cell: Cell) -> Place:
    return cell.dataset, cell.extractor, cell.model

"""Measuring the published running times: every pipeline against one fixed reference loop."""

from __future__ import annotations

import platform
import re
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import asdict, replace
from datetime import UTC, datetime
from functools import partial
from itertools import groupby
from pathlib import Path
from time import process_time
from timeit import repeat
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.pipeline import Pipeline, extract_features
from algorithms.threads import one_thread
from benchmark.contract import Cell
from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.csv_tables import text_of
from benchmark.results.times import COLUMNS, MACHINE, TIMES, Machine, Time, read_times
from files.atomic import replace_file
from files.locks import lock_or_refuse

#: Test samples that are timed together: as many as fill this, at least so many.
_TIMED_BYTES, _FEWEST = 8 * 2**20, 8
#: How often a call is timed.
_RUNS = 7
_VALUES = np.linspace(0.0, 1.0, 100_000)
_WEIGHTS = _VALUES[::-1].copy()
LOOP = (
    "10 weighted sums of 100,000 float64 numbers by NumPy, and 10,000 steps of x = 0.5 x + 1 in "
    "Python; processor time, best of several"
)


def reference_loop() -> float:
    """Do the work that times are multiples of (`LOOP`)."""
    x = 0.0
    for _ in range(10):
        x += float(np.dot(_VALUES, _WEIGHTS))
    for _ in range(10_000):
        x = 0.5 * x + 1.0
    return x


def weighted_sums(observations: NDArray[Any]) -> object:
    """Sum every observation with weights: the least that reading all of it takes."""
    samples = observations.reshape(len(observations), -1)
    if samples.dtype.names is not None:
        samples = samples.view(np.uint8).reshape(len(observations), -1)  # events: their bytes
    weights = np.linspace(0.0, 1.0, samples.shape[1])
    rows = max(2**22 // samples.shape[1], 1)  # 32 MB of floats at a time
    parts = range(0, len(samples), rows)
    return [samples[start : start + rows].astype(np.float64) @ weights for start in parts]


def best_s(*calls: Callable[[], object]) -> list[float]:
    """Return the best processor time of several runs of each call, in seconds."""
    return [min(repeat(call, timer=process_time, repeat=_RUNS, number=1)) for call in calls]


def update(
    directory: Path,
    progress: ProgressCallback | None = None,
    *,
    again: bool = False,
    parts: Parts | None = None,
) -> int:
    """Time the pipelines that have no time yet, one after another; returns how many were.

    Times are on disk data set by data set; those of pipelines that are gone are dropped. `again`
    forgets all times first, and the machine. Raises StoreError for files that cannot be read,
    LockedError where another process times.
    """
    known = parts or installed_parts()
    first = {name: preset.conditions[0] for name, preset in known.presets.items()}
    planned = [cell for cell in cells(parts=known) if cell.condition == first[cell.dataset]]
    places = {(cell.dataset, cell.extractor, cell.model) for cell in planned}
    directory.mkdir(parents=True, exist_ok=True)
    with lock_or_refuse(directory / TIMES), one_thread():
        if again:
            (directory / TIMES).unlink(missing_ok=True)
        there = read_times(directory)
        rows = {place: row for place, row in there.rows.items() if place in places}
        missing = [c for c in planned if (c.dataset, c.extractor, c.model) not in rows]
        done, machine = 0, there.machine
        with terminal_progress() if progress is None else nullcontext(progress) as report:
            report(0, len(missing), "")
            for dataset, group in groupby(missing, key=lambda cell: cell.dataset):
                timed = {one.pipeline: one for one in _timed(known, list(group))}
                rows |= timed
                done += len(timed)
                machine = machine or _this_machine()
                if (also := _processor()) not in {machine.processor, *machine.also_on}:
                    machine = machine.model_copy(update={"also_on": [*machine.also_on, also]})
                replace_file(directory / MACHINE, machine.model_dump_json(indent=2) + "\n")
                table = [asdict(rows[place]) for place in sorted(rows)]
                replace_file(directory / TIMES, text_of(list(COLUMNS), table))
                report(done, len(missing), dataset)
    return len(missing)


def _this_machine() -> Machine:
    loop_s = min(best_s(*[reference_loop] * 30))
    return Machine(
        processor=_processor(),
        cores=1,
        python=platform.python_version(),
        numpy=np.__version__,
        date=datetime.now(UTC).date().isoformat(),
        loop=LOOP,
        loop_us=_round(1e6 * loop_s),
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
    """Time the pipelines of one data set; one that fails has no time, the record says why."""
    preset, condition = parts.preset(group[0].dataset), group[0].condition
    geometry = preset.geometry_for(condition)
    calibration = preset.generate(condition, "calibration")
    one = preset.generate(condition, "test", 1).observations.nbytes
    test = preset.generate(condition, "test", max(_TIMED_BYTES // max(one, 1), _FEWEST))
    sums = partial(weighted_sums, test.observations)
    for name, of_extractor in groupby(group, key=lambda cell: cell.extractor):
        models = [parts.model(cell.model) for cell in of_extractor]
        none = [Time(preset.name, name, model.about.name, None, None) for model in models]
        try:
            extractor = parts.extractor(name).for_sensor(geometry)
            learn, extract = (
                partial(extract_features, extractor, split.observations, split.origin_px)
                for split in (calibration, test)
            )
            learnt, features = learn(), extract()  # warms compiled code up, too
            loop_s, sums_s, extract_s = best_s(reference_loop, sums, extract)
        except Exception:  # noqa: BLE001
            yield from none
            continue
        for model, untimed in zip(models, none, strict=True):
            try:
                fitted = model.for_sensor(geometry, extractor.about.kind)
                pipeline = Pipeline(extractor, fitted)
                pipeline.fit_features(learnt, calibration.sun, calibration.context)
                predict = partial(pipeline.predict_features, features, test.context)
                again_s, predict_s = best_s(reference_loop, predict)
            except Exception:  # noqa: BLE001
                yield untimed
                continue
            ratio = (extract_s / loop_s + predict_s / again_s) / len(test.sun)
            yield replace(untimed, ratio=_round(ratio), extract_ratio=_round(extract_s / sums_s))


def _round(value: float) -> float:
    return float(f"{value:.3g}")

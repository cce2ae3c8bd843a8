"""Running times of every pipeline on this machine: derived, never part of the record.

A time is of one machine on one day. They are kept beside other working files in ``times.csv``, each
with a digest of what it is of, so that only what has changed is timed again.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass, replace
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats, SensorGeometry
from algorithms.pipeline import Pipeline, extract_features
from benchmark.contract import Cell, Preset, Samples
from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.components import Components, current
from benchmark.results.csv_tables import StoreError, above_zero, read_csv, text_of, word
from benchmark.running.threads import one_thread
from benchmark.running.timing import best_of, best_time
from files.atomic import replace_file
from files.locks import wait_for_lock
from files.temporary import remove_stale_files

#: Name of the file.
TIMES = "times.csv"

#: Observations that are timed together: as many as fill this, of what the test split has.
_TIMED_BYTES = 8 * 2**20
_FEWEST = 8
#: Values the reference turns to floats at a time: 32 MB of them.
_REFERENCE_VALUES = 2**22

Place = tuple[str, str, str]  # (dataset, extractor, model)


@dataclass(frozen=True)
class Time:
    """Times of one pipeline on its dataset's first condition.

    Attributes
    ----------
    dataset, extractor, model
        Which pipeline.
    latency_us
        Extraction and prediction of one sample of a batch, microseconds; None where the pipeline
        cannot be run.
    time_ratio
        The same over the time of the reference (`reference`) on the same observations.
    extract_ratio
        Extraction alone over that reference.
    digest
        Of what was timed.
    """

    dataset: str
    extractor: str
    model: str
    latency_us: float | None
    time_ratio: float | None
    extract_ratio: float | None
    digest: str

    @property
    def pipeline(self) -> Place:
        """What was timed."""
        return self.dataset, self.extractor, self.model


_COLUMNS = {
    "dataset": word,
    "extractor": word,
    "model": word,
    "latency_us": above_zero,
    "time_ratio": above_zero,
    "extract_ratio": above_zero,
    "digest": word,
}


def read_times(directory: Path) -> dict[Place, Time]:
    """Read what was timed on this machine, up to date or not; nothing where there is no file.

    Raises
    ------
    StoreError
        For a line that is no time.
    """
    found: dict[Place, Time] = {}
    for line, row in read_csv(directory / TIMES, _COLUMNS):
        time = Time(**row)
        if time.pipeline in found:
            raise StoreError(f"{directory / TIMES}, line {line}: {time.pipeline} is there twice")
        found[time.pipeline] = time
    return found


def times_of_code(
    directory: Path, parts: Parts | None = None, components: Components | None = None
) -> dict[Place, Time]:
    """Return the times that are of datasets and implementations as they now are.

    Raises
    ------
    StoreError
        For a line that is no time.
    """
    there = read_times(directory)
    if not there:
        return {}
    known = parts or installed_parts()
    now = components or current(known)
    return {
        pipeline: time
        for pipeline, time in there.items()
        if _is_installed(pipeline, known) and time.digest == _digest(pipeline, now)
    }


def update(
    directory: Path,
    progress: ProgressCallback | None = None,
    *,
    parts: Parts | None = None,
) -> int:
    """Time what is not timed for the code as it is; returns how many pipelines were.

    In this process and one after another: what runs beside takes time from it. Times are on disk
    dataset by dataset.

    Parameters
    ----------
    directory
        Where the times are kept.
    progress
        As `benchmark.running.runner.run`.
    parts
        Datasets and implementations; what is installed by default.

    Raises
    ------
    StoreError
        Where the file cannot be read.
    """
    known = parts or installed_parts()
    components = current(known)
    first = {name: preset.conditions[0] for name, preset in known.presets.items()}
    planned = [cell for cell in cells(parts=known) if cell.condition == first[cell.dataset]]
    with _held(directory):  # also where nothing is missing: what a killed process left goes
        remove_stale_files(directory, TIMES)
        there = times_of_code(directory, known, components)
    missing = [cell for cell in planned if _pipeline(cell) not in there]
    with terminal_progress() if progress is None else nullcontext(progress) as report:
        done = 0
        report(done, len(missing), "")
        for dataset, group in groupby(missing, key=lambda cell: cell.dataset):
            timed = {
                time.pipeline: replace(time, digest=_digest(time.pipeline, components))
                for time in _time(known, list(group))
            }
            done += len(timed)
            with _held(directory):  # meanwhile another process may have written
                _write(directory, times_of_code(directory, known, components) | timed)
            report(done, len(missing), dataset)
    return len(missing)


def drop_outdated(directory: Path, parts: Parts, components: Components) -> int:
    """Forget times of other code than there is; returns how many."""
    with _held(directory):
        there = read_times(directory)
        kept = times_of_code(directory, parts, components)
        if len(kept) < len(there):
            _write(directory, kept)
    return len(there) - len(kept)


def _held(directory: Path) -> AbstractContextManager[None]:
    """Hold the table of times."""
    directory.mkdir(parents=True, exist_ok=True)
    return wait_for_lock(directory / TIMES)


def _write(directory: Path, kept: Mapping[Place, Time]) -> None:
    rows = [asdict(kept[pipeline]) for pipeline in sorted(kept)]
    replace_file(directory / TIMES, text_of(list(_COLUMNS), rows))


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


def _time(parts: Parts, group: list[Cell]) -> Iterator[Time]:
    """Time the pipelines of one dataset."""
    preset, condition = parts.preset(group[0].dataset), group[0].condition
    with one_thread():
        data = _Data(
            preset.geometry_for(condition),
            preset.generate(condition, "calibration"),
            preset.generate(condition, "test", _batch(preset, condition)),
        )
        for name, of_extractor in groupby(group, key=lambda cell: cell.extractor):
            models = [parts.model(cell.model) for cell in of_extractor]
            for model, numbers in _numbers(data, parts.extractor(name), models):
                yield Time(preset.name, name, model.about.name, *numbers, digest="")


@dataclass(frozen=True)
class _Data:
    geometry: SensorGeometry
    calibration: Samples
    test: Samples


_Numbers = tuple[float | None, float | None, float | None]
_UNTIMED: _Numbers = (None, None, None)


def _numbers(
    data: _Data, extractor_class: type[Extractor], models: Sequence[Scored]
) -> Iterator[tuple[Scored, _Numbers]]:
    """Give latency and ratios of an extractor with each of the models."""
    try:
        extractor = extractor_class.for_sensor(data.geometry)
        known = _features(extractor, data.calibration)  # also warms compiled code up
        features, timing = best_of(
            lambda: _features(extractor, data.test), lambda: reference(data.test.observations)
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
            _, predict_s = best_time(predict)
        except Exception:  # noqa: BLE001 - likewise
            yield model_class, _UNTIMED
            continue
        whole_s = timing.seconds + predict_s
        yield (
            model_class,
            (
                _round_to(1e6 * whole_s / len(data.test.sun)),
                _round_to(whole_s / timing.reference_s),
                _round_to(timing.seconds / timing.reference_s),
            ),
        )


def _batch(preset: Preset, condition: str) -> int:
    """Return how many test samples to time together; a split may have fewer."""
    one = preset.generate(condition, "test", 1)
    return max(_TIMED_BYTES // max(one.observations.nbytes, 1), _FEWEST)


def _features(extractor: Extractor, samples: Samples) -> Floats:
    return extract_features(extractor, samples.observations, samples.origin_px)


def _round_to(value: float) -> float:
    return float(f"{value:.3g}")


def _pipeline(cell: Cell) -> Place:
    return cell.dataset, cell.extractor, cell.model


def _is_installed(pipeline: Place, parts: Parts) -> bool:
    dataset, extractor, model = pipeline
    return dataset in parts.presets and extractor in parts.extractors and model in parts.models


def _digest(pipeline: Place, components: Components) -> str:
    dataset, extractor, model = pipeline
    whole = components.cell_key(Cell(dataset, "", extractor, model))
    return hashlib.sha256(whole.encode()).hexdigest()[:8]

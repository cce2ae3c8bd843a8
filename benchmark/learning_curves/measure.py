"""What one worker does: a data set's leaders calibrated on growing subsets of its poses.

Features are found once for each unit of the sensor, in readings corrected by its references; a
subset only fits the model anew, to the true directions of its poses: the error over the whole test
split is the own error, without a bench's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Context, Extractor, Floats, UnusableDataError
from algorithms.pipeline import Pipeline
from algorithms.threads import one_thread
from benchmark.datasets.corrected import correction
from benchmark.datasets.features import features_of
from benchmark.learning_curves.draws import Rows, sizes, subsets
from benchmark.learning_curves.leaders import Leader
from benchmark.metrics.score import score
from benchmark.running.fitting import reason_of
from benchmark.simulator.light.memory import memory

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

#: Units of the sensor, and draws of poses on each of them.
UNITS = (0, 1)
DRAWS = 3

_SPLITS = ("calibration", "test")


@dataclass(frozen=True)
class CurveTask:
    """A data set's leaders, in order, with what they are made of.

    The preset is of unit 0, the leaders are of one condition of it. `all_observable`: the direction
    is observable from every test sample. `bounds_deg` is the bound of each leader's score,
    `bench_deg` the fixed error of the standard bench's directions, None where none is pinned: root
    mean squares.
    """

    preset: Preset
    leaders: tuple[Leader, ...]
    extractors: Mapping[str, type[Extractor]]
    models: Mapping[str, Scored]
    all_observable: bool
    bounds_deg: Mapping[Leader, float]
    bench_deg: float | None


@dataclass(frozen=True)
class CurveErrors:
    """Errors of one pipeline by unit, draw and size.

    `sizes` are numbers of poses (S,), the last all of them; errors and availability (U, D, S) are
    NaN, and refusals not empty, where the model refused the poses. All draws share the last size.
    `in_order`: the poses are a time series.
    """

    leader: Leader
    sizes: tuple[int, ...]
    in_order: bool
    rms_deg: Floats
    availability: Floats
    refusals: NDArray[np.object_]


@dataclass(frozen=True)
class _Part:
    """One split as a unit sees it: features by extractor, true Suns, and what else is known."""

    features: Mapping[str, Floats]
    sun: Floats
    context: Context | None


def measure(task: CurveTask) -> list[CurveErrors]:
    """Calibrate every leader of a data set on every subset of poses, and score it."""
    with one_thread():
        preset, condition = task.preset, task.leaders[0].condition
        geometry = preset.geometry_for(condition)
        names = {leader.extractor for leader in task.leaders}
        extractors = {name: task.extractors[name].for_sensor(geometry) for name in sorted(names)}
        seen = _observable(task, condition)
        measured: dict[Leader, list[list[list[_Point]]]] = {leader: [] for leader in task.leaders}
        steps: tuple[int, ...] = ()
        for unit in UNITS:
            memory.cache_for((preset.name, unit), preset.name)
            seen_by = preset.for_unit(unit) if unit else preset
            known, asked = (_part(seen_by, condition, split, extractors) for split in _SPLITS)
            steps = sizes(len(known.sun))
            for leader in task.leaders:
                trial = _Trial(
                    extractors[leader.extractor],
                    task.models[leader.model],
                    task,
                    known,
                    asked,
                    seen,
                )
                measured[leader].append(trial.draws(unit))
        return [
            _learnt(leader, steps, measured[leader], in_order=bool(preset.context_columns))
            for leader in task.leaders
        ]


def _observable(task: CurveTask, condition: str) -> NDArray[np.bool_] | None:
    """Test samples (N,) whose direction is observable, for every unit; None for all."""
    if task.all_observable:
        return None
    memory.cache_for((task.preset.name, 0), task.preset.name)
    return np.asarray(task.preset.bound(condition, "test").observable, dtype=np.bool_)


def _part(preset: Preset, condition: str, split: str, extractors: Mapping[str, Extractor]) -> _Part:
    """Generate one split and keep what is found in it: frames are let go before the next."""
    samples, by = preset.generate(condition, split), correction(preset, condition)
    features = {name: features_of(extractor, samples, by) for name, extractor in extractors.items()}
    return _Part(features, samples.truth, samples.context)


@dataclass(frozen=True)
class _Point:
    rms_deg: float = np.nan
    availability: float = np.nan
    refusal: str = ""


@dataclass(frozen=True)
class _Trial:
    """One pipeline on one unit."""

    extractor: Extractor
    model: Scored
    task: CurveTask
    known: _Part
    asked: _Part
    observable: NDArray[np.bool_] | None

    def draws(self, unit: int) -> list[list[_Point]]:
        """Points by draw and size."""
        preset, poses = self.task.preset, len(self.known.sun)
        everything = self.point(np.arange(poses))
        found = []
        for draw in range(DRAWS):
            rows = subsets(
                poses, preset.name, "unit", unit, "draw", draw,
                in_order=bool(preset.context_columns),
            )  # fmt: skip
            found.append(
                [everything if size == poses else self.point(chosen) for size, chosen in rows]
            )
        return found

    def point(self, rows: Rows) -> _Point:
        """Calibrate on some poses and score on the test split."""
        name = self.extractor.about.name
        geometry = self.task.preset.geometry_for(self.task.leaders[0].condition)
        model = self.model.for_sensor(geometry, self.extractor.about.kind)
        pipeline = Pipeline(self.extractor, model)
        context: Mapping[str, NDArray[Any]] | None = None
        if self.known.context is not None:
            context = {
                column: np.asarray(values)[rows] for column, values in self.known.context.items()
            }
        try:
            pipeline.fit_features(self.known.features[name][rows], self.known.sun[rows], context)
        except UnusableDataError as error:
            return _Point(refusal=reason_of(error))
        predicted = pipeline.predict_features(self.asked.features[name], self.asked.context)
        seen = np.ones(len(predicted), np.bool_) if self.observable is None else self.observable
        result = score(predicted, self.asked.sun, None, seen)
        return _Point(result.rms_deg, result.availability)


def _learnt(
    leader: Leader,
    steps: tuple[int, ...],
    units: Sequence[Sequence[Sequence[_Point]]],
    *,
    in_order: bool,
) -> CurveErrors:
    def table(name: str, kind: Any) -> NDArray[Any]:
        return np.array([[[getattr(p, name) for p in d] for d in u] for u in units], dtype=kind)

    return CurveErrors(
        leader,
        steps,
        in_order,
        table("rms_deg", np.float64),
        table("availability", np.float64),
        table("refusal", np.object_),
    )

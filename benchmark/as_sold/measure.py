"""What one worker does: a simulated sensor at every depth of calibration, on both benches."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from algorithms.chain import Chain, Scored
from algorithms.contract import Extractor, Floats, UnsuitableDesignError, UnusableDataError
from algorithms.pipeline import Pipeline
from algorithms.references import ReferenceCorrection
from algorithms.threads import one_thread
from benchmark.as_sold.cells import CELLS
from benchmark.as_sold.mapping import AsSold
from benchmark.datasets.calibration import STANDARD_BENCH
from benchmark.datasets.calibration import Bench as Turntable
from benchmark.datasets.corrected import corrections
from benchmark.datasets.features import features_of
from benchmark.datasets.preset import Preset
from benchmark.error_budget.perfected import without_fixed_pattern
from benchmark.metrics.score import is_available
from benchmark.metrics.separation import separation_deg, store
from benchmark.simulator.light.memory import memory
from benchmark.simulator.masks.slits import SlitErrors
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.projection import Camera

#: The level of a flight on which no light of the Earth is seen, as data sheets have it.
WITHOUT_EARTH = "flight-without-earth"
_SPLITS = ("calibration", "test")
_Pipeline = tuple[type[Extractor], Scored]
_Corrections = Mapping[str, ReferenceCorrection | None]
#: Units that errors are pooled over; the standard one chose the pipelines.
UNITS = 5
#: The standard bench's directions are off by 0.016 deg, the fine one's by a sixteenth.
_FINE = 1.0 / 16.0
_TURNTABLES: Mapping[str, Turntable | None] = MappingProxyType(
    {
        "standard": STANDARD_BENCH,
        "fine": dataclasses.replace(
            STANDARD_BENCH,
            axis_random_deg=_FINE * STANDARD_BENCH.axis_random_deg,
            mounting_deg=_FINE * STANDARD_BENCH.mounting_deg,
            squareness_deg=_FINE * STANDARD_BENCH.squareness_deg,
            eccentricity_deg=_FINE * STANDARD_BENCH.eccentricity_deg,
        ),
        "true": None,
    }
)
#: Where models with constants of a physical design are; all others are tables of some kind.
_PHYSICAL = tuple(
    f"algorithms.models.{name}." for name in ("geometric", "physics_informed", "multiplex")
)


def root_mean_square(error: Floats) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(error))))


#: Statistics of the angle between answer and true direction, degrees, by the name in the table.
STATISTICS: Mapping[str, Callable[[Floats], float]] = MappingProxyType(
    {
        "mean": lambda error: float(np.mean(error)),
        **dict.fromkeys(("1sigma", "rms", "unspecified"), root_mean_square),
        "p95": lambda error: float(np.quantile(error, 0.95)),
        "3sigma": lambda error: float(np.quantile(error, 0.997)),
        "max": lambda error: float(np.max(error)),
    }
)


@dataclass(frozen=True)
class AsSoldTask:
    """A data set over a field, its pipelines, and the sensors that it simulates.

    `conditions` are those on the ground, in flight and there without the Earth, `all_observable`
    says whether a direction can be determined from every test sample. `constants` and `table` are
    None where no pipeline of the kind is scored on such a sensor.
    """

    preset: Preset
    conditions: Mapping[str, str]
    sensors: tuple[AsSold, ...]
    constants: _Pipeline | None
    table: _Pipeline | None
    all_observable: bool


def has_constants(model: Scored) -> bool:
    """Say whether a model has constants of a physical design; tables, networks and so on not."""
    last = model.model if isinstance(model, Chain) else model
    return last.__module__.startswith(_PHYSICAL)


def best_pipeline(
    rows: Iterable[Mapping[str, Any]],
    models: Mapping[str, Scored],
    dataset: str,
    condition: str,
    *,
    table: bool,
) -> tuple[str, str] | None:
    """Return the most accurate pipeline (extractor, model) on a standard unit.

    Of those with constants, or, for a `table`, of all: a table has every degree of freedom.
    """
    found = [
        (row["rms_all_answers_deg"], row["extractor"], row["model"])
        for row in rows
        if (row["dataset"], row["condition"], row["unit"]) == (dataset, condition, 0)
        and row["rms_all_answers_deg"] is not None
        and is_available(row)
        and (table or has_constants(models[row["model"]]))
        and not models[row["model"]].about.context
    ]
    return min(found)[1:] if found else None


def narrowed(preset: Preset, half_fov_deg: float | None) -> Preset:
    """Return a data set over part of its field, calibration and test; whole for None."""
    if half_fov_deg is None:
        return preset
    field: Any = preset.directions
    name = "half_fov_deg" if hasattr(field, "half_fov_deg") else "half_angle_deg"
    return dataclasses.replace(
        preset,
        directions=dataclasses.replace(field, **{name: half_fov_deg}),
        geometry=dataclasses.replace(preset.geometry, half_fov_deg=half_fov_deg),
    )


def as_drawn(preset: Preset, condition: str) -> Preset:
    """Return a data set of the sensor as it was designed: assembled as drawn, elements alike."""
    setup = without_fixed_pattern(preset, condition).condition(condition)
    drawn = dataclasses.replace(setup, sensor=_as_drawn(setup.sensor), earth=None, mission=None)
    return dataclasses.replace(preset, setups={condition: drawn})


def measure(task: AsSoldTask) -> list[tuple[str, dict[str, Any]]]:
    """Return the errors of every sensor of a task, in its own statistic, by depth and bench.

    Over observable samples with an answer, pooled over units.
    """
    with one_thread():
        found = {level: _pooled(task, condition) for level, condition in task.conditions.items()}
    return [(one.sensor.id, _row(task, one, found)) for one in task.sensors]


def _row(
    task: AsSoldTask, one: AsSold, found: Mapping[str, Mapping[str, Floats]]
) -> dict[str, Any]:
    def stated(errors: Floats) -> float | None:
        return store(STATISTICS[one.statistic](errors)) if len(errors) else None

    other = "ground" if one.level == "flight" else "flight"
    return {
        "hardware": one.sensor.id,
        "dataset": task.preset.name,
        "half_fov_deg": task.preset.geometry.half_fov_deg,
        "level": one.level,
        "statistic": one.statistic,
        "constants": _name(task.constants),
        "table": _name(task.table),
        **{f"{cell}_deg": stated(found[one.level][cell]) for cell in CELLS},
        "other_level_deg": stated(found[other][one.cell]),
        "without_earth_deg": stated(found[WITHOUT_EARTH][one.cell]),
    }


def _pooled(task: AsSoldTask, condition: str) -> dict[str, Floats]:
    """Return the errors of all units by cell; none of a cell without a pipeline."""
    seen: Any = slice(None)
    if not task.all_observable:
        memory.cache_for((task.preset.name, 0), task.preset.name)
        seen = np.asarray(task.preset.bound(condition, "test").observable)
    errors: dict[str, list[Floats]] = {cell: [np.empty(0)] for cell in CELLS}
    for cell, of_unit in _errors(task, condition):
        errors[cell].append(of_unit[seen])
    whole = {cell: np.concatenate(parts) for cell, parts in errors.items()}
    return {cell: found[np.isfinite(found)] for cell, found in whole.items()}


class _Unit:
    """A unit's samples and the correction by its references, each made once."""

    def __init__(self, preset: Preset, condition: str) -> None:
        memory.cache_for((preset.name, preset.unit), preset.name)
        self.geometry = preset.geometry_for(condition)
        self.samples = {split: preset.generate(condition, split) for split in _SPLITS}
        self.by = corrections(preset, condition)

    def features(
        self, extractor: type[Extractor], split: str, by: _Corrections | None = None
    ) -> Floats:
        """Return what an extractor finds in a split, by other references than its own if given."""
        used = (self.by if by is None else by)[split]
        return features_of(extractor.for_sensor(self.geometry), self.samples[split], used)

    def fitted(
        self, pipeline: _Pipeline, bench: Turntable | None, unit: int = 0
    ) -> Pipeline | None:
        """Return a pipeline calibrated on this unit, on a bench if any; None where it refuses."""
        extractor, model = pipeline
        known = self.samples["calibration"]
        sun = known.truth if bench is None else bench.report(known.truth, "bench", "sold", unit)
        try:
            made = Pipeline(
                extractor.for_sensor(self.geometry),
                model.for_sensor(self.geometry, extractor.about.kind),
            )
            return made.fit_features(self.features(extractor, "calibration"), sun, known.context)
        except (UnusableDataError, UnsuitableDesignError):
            return None

    def errors(self, made: Pipeline, by: _Corrections | None = None) -> Floats:
        """Return the errors (N,) of a calibrated pipeline on the test split."""
        test = self.samples["test"]
        asked = self.features(type(made.extractor), "test", by)
        return separation_deg(made.predict_features(asked, test.context), test.sun)


def _errors(task: AsSoldTask, condition: str) -> Iterator[tuple[str, Floats]]:
    """Yield the errors (N,) of each unit by cell; none of a cell that has no model."""
    design = drawn = None
    if task.constants is not None:
        drawn = _Unit(as_drawn(task.preset, condition), condition)
        design = drawn.fitted(task.constants, None)
    for number in range(1, UNITS + 1):
        unit = _Unit(task.preset.for_unit(number), condition)
        if drawn is not None and design is not None:
            yield "uncalibrated", unit.errors(design, drawn.by)
        for depth, pipeline in (("constants", task.constants), ("table", task.table)):
            for bench, turntable in _TURNTABLES.items():
                made = pipeline and unit.fitted(pipeline, turntable, number)
                if made is not None:
                    yield f"{depth}_{bench}", unit.errors(made)


def _as_drawn(value: Any) -> Any:
    if isinstance(value, Assembly | SlitErrors):
        return type(value)()
    if isinstance(value, Camera):
        return value.assemble(Assembly())
    if not dataclasses.is_dataclass(value) or isinstance(value, type):
        return value
    parts = {f.name: getattr(value, f.name) for f in dataclasses.fields(value) if f.init}
    drawn = {name: _as_drawn(part) for name, part in parts.items()}
    changed = {name: part for name, part in drawn.items() if part is not parts[name]}
    return dataclasses.replace(value, **changed) if changed else value


def _name(pipeline: _Pipeline | None) -> str:
    return "" if pipeline is None else f"{pipeline[0].about.name} + {pipeline[1].about.name}"

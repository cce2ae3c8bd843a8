"""What each effect of a mission costs the leader of a data set: alone, and when it is left out."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats
from algorithms.pipeline import Pipeline
from algorithms.threads import one_thread
from benchmark.contract import FLIGHT
from benchmark.datasets.corrected import corrections
from benchmark.datasets.features import features_of
from benchmark.datasets.preset import Preset
from benchmark.experiments.error_budget import leaders
from benchmark.metrics.separation import separation_deg
from benchmark.results.row_file import Row
from benchmark.results.store import Store
from benchmark.running.experiment import Report
from benchmark.simulator.flight.mission import EFFECTS, Mission

#: Units whose squares are pooled: effects are drawn for each.
UNITS = 3


class FlightTask(NamedTuple):
    """A data set with the pipeline that leads it on the ground."""

    preset: Preset
    extractor: type[Extractor]
    model: Scored


class FlightEffects(Report[str]):
    """Error in flight of each ground data set's leader, by the effects of its mission."""

    name = "flight_effects"

    def cells(self) -> Sequence[str]:
        """List the data sets that are flown."""
        return [name for name, one in self.parts.presets.items() if FLIGHT in one.conditions]

    def tasks(self, cells: Sequence[str]) -> Iterator[FlightTask]:
        """Make a task of each data set."""
        first = {name: preset.conditions[0] for name, preset in self.parts.presets.items()}
        best = leaders(Store(self.directory).rows(unit=None), first)
        for name in cells:
            yield FlightTask(
                self.parts.preset(name),
                self.parts.extractor(best[name]["extractor"]),
                self.parts.model(best[name]["model"]),
            )

    @staticmethod
    def measure(task: FlightTask) -> list[tuple[str, Row]]:
        """Return the error, degrees, with none, all, each alone and each left out, over units."""
        mission = task.preset.condition(FLIGHT).mission
        assert mission is not None  # noqa: S101 - cells are those that have one
        flown: dict[str, Mission] = {"none": mission.without(*EFFECTS), "all": mission}
        flown |= {f"{name} alone": mission.alone(name) for name in EFFECTS}
        flown |= {f"without {name}": mission.without(name) for name in EFFECTS}
        with one_thread():
            errors = {
                name: [_error_deg(task, one, unit) for unit in range(UNITS)]
                for name, one in flown.items()
            }
        pooled = {name: math.sqrt(float(np.mean(np.square(e)))) for name, e in errors.items()}
        about = {"extractor": task.extractor.about.name, "model": task.model.about.name}
        return [(task.preset.name, {**about, **pooled})]

    def lines(self, rows: Mapping[str, Row]) -> Iterator[str]:
        """Yield the effects of each data set, the costliest first."""
        for name, row in rows.items():
            none, whole = row["none"], row["all"]
            yield f"{name}: {row['extractor']} + {row['model']}, {UNITS} units"
            yield f"  on the ground {none:.3g} deg, in flight {whole:.3g} deg"
            added = {one: _added(row[f"{one} alone"], none) for one in EFFECTS}
            for one in sorted(EFFECTS, key=lambda one: -added[one]):
                rest = row[f"without {one}"]
                yield f"  {one:<10} adds {added[one]:.2g} deg, without it {rest:.3g}"
            together = math.hypot(none, *added.values())
            times = whole / together
            yield f"  root of squares {together:.3g} deg; in flight {times:.2f} times that"


def _added(error_deg: float, none_deg: float) -> float:
    return math.sqrt(max(error_deg**2 - none_deg**2, 0.0))


def _error_deg(task: FlightTask, mission: Mission, unit: int) -> float:
    """Return the RMS error of a unit on a mission, over observable samples with an answer."""
    setup = task.preset.condition(FLIGHT)
    earth = setup.earth if mission.earthlight else None
    flight = dataclasses.replace(setup, mission=mission, earth=earth)
    preset = dataclasses.replace(task.preset, setups={**task.preset.setups, FLIGHT: flight})
    seen_by = preset.for_unit(unit)
    extractor = task.extractor.for_sensor(preset.geometry)
    by = corrections(seen_by, FLIGHT)

    def found(split: str) -> tuple[Floats, Any]:
        samples = seen_by.generate(FLIGHT, split)
        return features_of(extractor, samples, by[split]), samples

    told, poses = found("calibration")
    asked, test = found("test")
    model = task.model.for_sensor(preset.geometry, extractor.about.kind)
    pipeline = Pipeline(extractor, model).fit_features(told, poses.truth, poses.context)
    errors = separation_deg(pipeline.predict_features(asked, test.context), test.sun)
    return float(np.sqrt(np.nanmean(errors**2)))

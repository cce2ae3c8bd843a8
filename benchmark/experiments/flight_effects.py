"""What each effect of a mission costs the leader of a data set: alone, and when it is left out."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Extractor
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
from benchmark.simulator.light.memory import memory

#: Units whose squares are pooled: effects are drawn for each.
UNITS = 3
#: Share by which errors together may differ from the root of their squares without a word.
NEAR = 0.15


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
            units = [_errors_deg(task, flown, unit) for unit in range(UNITS)]
        pooled = {
            name: math.sqrt(math.fsum(unit[name] ** 2 for unit in units) / UNITS) for name in flown
        }
        about = {"extractor": task.extractor.about.name, "model": task.model.about.name}
        return [(task.preset.name, {**about, **pooled})]

    def lines(self, rows: Mapping[str, Row]) -> Iterator[str]:
        """Yield the effects of each data set, the costliest first, and a table of all of them."""
        for name, row in rows.items():
            none, whole = row["none"], row["all"]
            yield f"{name}: {row['extractor']} + {row['model']}, {UNITS} units"
            yield f"  on the ground {none:.3g} deg, in flight {whole:.3g} deg"
            added = _added_by_effect(row)
            for one, size in added.items():
                yield f"  {one:<10} adds {size:.2g} deg, without it {row[f'without {one}']:.3g}"
            together = math.hypot(none, *added.values())
            times = whole / together
            yield f"  root of squares {together:.3g} deg; in flight {times:.2f} times that"
            if abs(times - 1.0) > NEAR:
                yield f"  not as squares: {', '.join(_interacting(row, added))}"
        yield ""
        yield "| data set | on the ground, deg | in flight, deg | largest effects: alone, without |"
        yield "| --- | ---: | ---: | --- |"
        for name, row in sorted(rows.items(), key=lambda pair: float(pair[1]["none"])):
            largest = [
                f"{one} {size:.2g}, {row[f'without {one}']:.2g}"
                for one, size in list(_added_by_effect(row).items())[:2]
            ]
            yield f"| {name} | {row['none']:.2g} | {row['all']:.2g} | {'; '.join(largest)} |"


def _added_by_effect(row: Row) -> dict[str, float]:
    """Return what each effect alone adds in squares, degrees, the largest first."""
    none = row["none"]
    added = {one: math.sqrt(max(row[f"{one} alone"] ** 2 - none**2, 0.0)) for one in EFFECTS}
    return dict(sorted(added.items(), key=lambda pair: -pair[1]))


def _interacting(row: Row, added: Mapping[str, float]) -> list[str]:
    """List the effects that, left out of all, take off another square than they add alone."""
    whole = row["all"] ** 2
    apart = {one: whole - row[f"without {one}"] ** 2 - added[one] ** 2 for one in EFFECTS}
    return [
        f"{one} ({'more' if apart[one] > 0 else 'less'} with the others than alone)"
        for one in sorted(EFFECTS, key=lambda one: -abs(apart[one]))
        if abs(apart[one]) > NEAR * whole
    ]


def _errors_deg(task: FlightTask, missions: Mapping[str, Mission], unit: int) -> dict[str, float]:
    """Return the RMS error of a unit on missions, over observable samples with an answer."""
    # missions that move nothing show the same Suns
    memory.cache_for((task.preset.name, unit), task.preset.name)
    extractor = task.extractor.for_sensor(task.preset.geometry)
    fitted: dict[Any, Pipeline] = {}
    errors = {}
    for name, mission in missions.items():
        seen_by = _flown(task.preset, mission).for_unit(unit)
        by = corrections(seen_by, FLIGHT)
        # what is so on the ground, too
        built = mission.ghost_share, mission.inl_lsb
        if built not in fitted:
            poses = seen_by.generate(FLIGHT, "calibration")
            told = features_of(extractor, poses, by["calibration"])
            model = task.model.for_sensor(task.preset.geometry, extractor.about.kind)
            pipeline = Pipeline(extractor, model)
            fitted[built] = pipeline.fit_features(told, poses.truth, poses.context)
        test = seen_by.generate(FLIGHT, "test")
        asked = features_of(extractor, test, by["test"])
        found = separation_deg(fitted[built].predict_features(asked, test.context), test.sun)
        errors[name] = float(np.sqrt(np.nanmean(found**2)))
    memory.forget()
    return errors


def _flown(preset: Preset, mission: Mission) -> Preset:
    setup = preset.condition(FLIGHT)
    earth = setup.earth if mission.earthlight else None
    flight = dataclasses.replace(setup, mission=mission, earth=earth)
    return dataclasses.replace(preset, setups={**preset.setups, FLIGHT: flight})

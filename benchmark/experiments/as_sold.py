"""Built sensors, simulated at the depth of calibration and on the bench that they are sold with."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from itertools import groupby

from benchmark import datasets
from benchmark.as_sold.mapping import AsSold, as_sold
from benchmark.as_sold.measure import (
    WITHOUT_EARTH,
    AsSoldTask,
    best_pipeline,
    measure,
    narrowed,
)
from benchmark.as_sold.record import RECORD, beside_stated
from benchmark.contract import FLIGHT
from benchmark.datasets.conditions.mission import with_flight
from benchmark.plan.parts import Parts
from benchmark.results.components import current
from benchmark.results.digests import short_digest
from benchmark.results.modules import modules_digest
from benchmark.results.row_file import Row
from benchmark.results.store import Store
from benchmark.running.experiment import RecordedExperiment

#: What measures a sensor, with the data sets and methods that it is handed.
_CODE = "benchmark.as_sold.measure"
_Place = tuple[str, float]


class BuiltAsSold(RecordedExperiment[str]):
    """Errors of built sensors, simulated as they are sold, beside the figures that they state."""

    name = "as_sold"
    title = "Built sensors as sold"
    record = RECORD

    @cached_property
    def pipelines(self) -> Mapping[tuple[str, bool], tuple[str, str] | None]:
        """Extractor and model by data set, and whether the model is a table.

        Of a study's own sensor those of the first standard data set of its detector and mask.
        """
        rows, models = Store(self.directory).rows(), self.parts.models
        found = {}
        for name in {one.dataset for one in as_sold().values()}:
            own = datasets.get(name)
            alike = [
                other
                for other, preset in self.parts.presets.items()
                if (preset.detector, preset.mask) == (own.detector, own.mask)
            ]
            scored = name if name in alike else alike[0]
            first = self.parts.preset(scored).conditions[0]
            for table in (False, True):
                found[name, table] = best_pipeline(rows, models, scored, first, table=table)
        return found

    def keys(self) -> Mapping[str, str]:
        """Digest the code, the settings, and the data set and pipelines of each."""
        named = {name: with_flight(datasets.get(name)) for name, _ in self.pipelines}
        tried = [one for one in self.pipelines.values() if one is not None]
        components = current(
            Parts(
                named,
                {extractor: self.parts.extractor(extractor) for extractor, _ in tried},
                {model: self.parts.model(model) for _, model in tried},
            )
        )
        code = modules_digest(_CODE)
        return {
            name: short_digest(
                [
                    *(code, one.half_fov_deg, one.level, one.statistic),
                    components.digest("datasets", one.dataset),
                    *(
                        digest
                        for table in (False, True)
                        if (pipeline := self.pipelines[one.dataset, table]) is not None
                        for digest in (
                            components.digest("extractors", pipeline[0]),
                            components.digest("models", pipeline[1]),
                        )
                    ),
                ]
            )
            for name, one in as_sold().items()
        }

    def tasks(self, cells: Sequence[str]) -> Iterator[AsSoldTask]:
        """Make a task of the sensors that one data set over one field simulates."""
        wanted = sorted((as_sold()[name] for name in cells), key=_place)
        for (name, _), group in groupby(wanted, key=_place):
            sensors = tuple(group)
            preset = with_flight(datasets.get(name))
            ground = preset.conditions[0]
            flight = preset.condition(FLIGHT)
            assert flight.mission is not None  # noqa: S101 - data sets on the ground are flown
            dark = dataclasses.replace(flight, earth=None, mission=flight.mission.without("earth"))
            setups = {ground: preset.condition(ground), FLIGHT: flight, WITHOUT_EARTH: dark}
            constants, table = (self.pipelines[name, kind] for kind in (False, True))
            yield AsSoldTask(
                narrowed(dataclasses.replace(preset, setups=setups), sensors[0].half_fov_deg),
                {"ground": ground, "flight": FLIGHT, WITHOUT_EARTH: WITHOUT_EARTH},
                sensors,
                constants and (self.parts.extractor(constants[0]), self.parts.model(constants[1])),
                table and (self.parts.extractor(table[0]), self.parts.model(table[1])),
                all_observable=name not in self._partly_observable,
            )

    @cached_property
    def _partly_observable(self) -> frozenset[str]:
        """Data sets from some of whose samples no direction can be determined."""
        return frozenset(
            row["dataset"]
            for row in Store(self.directory).rows()
            if row["n_observable"] is not None and row["n_observable"] < row["n_test"]
        )

    def rows(self) -> list[Row]:
        """Return the sensors beside the figures that they state."""
        return beside_stated(self.directory)

    @staticmethod
    def measure(task: AsSoldTask) -> list[tuple[str, Row]]:
        """Calibrate units at every depth, on both benches, and compare with the truth."""
        return measure(task)


def _place(one: AsSold) -> _Place:
    return one.dataset, one.half_fov_deg or 0.0

"""Masks over one detector at one height and over one field, each read by its best pipeline."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path

from benchmark.contract import Cell
from benchmark.equal_height.designs import DESIGNS, Place, UnfitError, preset
from benchmark.equal_height.measure import UNITS, EqualTask, candidates, measure
from benchmark.equal_height.record import RECORD
from benchmark.plan.parts import Parts
from benchmark.results.components import current
from benchmark.results.digests import short_digest
from benchmark.results.modules import STAGES, modules_digest
from benchmark.results.row_file import Row
from benchmark.results.store import PUBLISHED, Store
from benchmark.running.experiment import RecordedExperiment

#: What chooses and builds a design, and measures it with the pipelines that it is handed.
_CODE = ("benchmark.equal_height.measure", *STAGES.values())


class EqualHeight(RecordedExperiment[str]):
    """Error of every mask over the same detector, at the same height, over the same field."""

    name = "equal_height"
    title = "Masks at equal height, detector and field"
    record = RECORD

    def __init__(
        self,
        directory: Path | str = PUBLISHED,
        parts: Parts | None = None,
        place: Place | None = None,
        units: int = UNITS,
    ) -> None:
        super().__init__(directory, parts)
        self.place, self.units = place or Place(), units

    @cached_property
    def pipelines(self) -> Mapping[str, Sequence[tuple[str, str]]]:
        """Extractors and models that are tried, by design."""
        rows = Store(self.directory).rows(unit=None)
        return {
            name: candidates(rows, one.dataset, self.parts.preset(one.dataset).conditions[0])
            for name, one in DESIGNS.items()
        }

    def cells(self) -> Sequence[str]:
        """List the designs."""
        return list(DESIGNS)

    def keys(self) -> Mapping[str, str]:
        """Digest the code, the number of units, and the design and the pipelines of each."""
        tried = [
            Cell(DESIGNS[name].dataset, "", *one)
            for name, of in self.pipelines.items()
            for one in of
        ]
        presets = {}
        for name in DESIGNS:
            try:
                presets[name] = preset(name, self.place)
            except UnfitError:
                continue
        methods = self.parts.only(tried)
        components = current(Parts(presets, methods.extractors, methods.models))
        code = modules_digest(*_CODE)
        return {
            name: short_digest(
                [
                    *(code, self.units, self.place),
                    components.digest("datasets", name) if name in presets else "",
                    *(components.digest("extractors", one) for one, _ in self.pipelines[name]),
                    *(components.digest("models", one) for _, one in self.pipelines[name]),
                ]
            )
            for name in DESIGNS
        }

    def tasks(self, cells: Sequence[str]) -> Iterator[EqualTask]:
        """Make a task of each design."""
        for name in cells:
            tried = self.pipelines[name]
            yield EqualTask(
                name,
                self.place,
                tuple((self.parts.extractor(e), self.parts.model(m)) for e, m in tried),
                self.units,
            )

    @staticmethod
    def measure(task: EqualTask) -> list[tuple[str, Row]]:
        """Choose a design's pipeline on one unit, and quote it on others."""
        return [(task.design, measure(task))]

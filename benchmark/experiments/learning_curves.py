"""Own error of each board's leaders against the number of calibration poses."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import groupby

from benchmark.contract import Cell
from benchmark.learning_curves import plots
from benchmark.learning_curves.leaders import Leader, leaders
from benchmark.learning_curves.measure import CurveTask, measure
from benchmark.learning_curves.outcome import row_of
from benchmark.learning_curves.record import RECORD, published_curves
from benchmark.results.components import current
from benchmark.results.digests import short_digest
from benchmark.results.modules import modules_digest
from benchmark.results.row_file import Row
from benchmark.results.store import Store
from benchmark.running.experiment import RecordedExperiment

#: What measures the curves of a data set, with the data and methods that it is handed.
_CODE = (
    "benchmark.learning_curves.measure",
    "benchmark.learning_curves.outcome",
)


class LearningCurves(RecordedExperiment[Leader]):
    """Own error of the best pipelines of each data set against the number of calibration poses."""

    name = "learning_curves"
    title = "Learning curves"
    record = RECORD

    @cached_property
    def store(self) -> Store:
        """The record's scores and pins."""
        return Store(self.directory)

    def cells(self) -> list[Leader]:
        """List the pipelines that have a curve."""
        first = {name: preset.conditions[0] for name, preset in self.parts.presets.items()}
        return leaders(self.store.rows(), first)

    def keys(self) -> Mapping[Leader, str]:
        """Digest the code, condition, data set, extractor and model of each."""
        wanted = self.cells()
        # digests of what leads only: all of them would take seconds
        components = current(self.parts.only(_cell(leader) for leader in wanted))
        code = modules_digest(*_CODE)
        return {
            leader: short_digest(
                [
                    code,
                    leader.condition,
                    components.digest("datasets", leader.dataset),
                    components.digest("extractors", leader.extractor),
                    components.digest("models", leader.model),
                ]
            )
            for leader in wanted
        }

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        """Draw the curves, a panel a data set."""
        return {"learning-curves.svg": lambda: plots.picture(self.rows())}

    def rows(self) -> list[Row]:
        """Return the curves in order, with what follows from their points."""
        return published_curves(self.directory)

    def name_of(self, cell: Leader) -> str:
        """Return the data set: its leaders are measured together."""
        return cell.dataset

    def tasks(self, cells: Sequence[Leader]) -> Iterator[CurveTask]:
        """Make a task of each data set's leaders, which share its data."""
        pins, scores = self.store.pins(), self.store.scores()
        for name, group in groupby(cells, key=self.name_of):
            found = tuple(group)
            pin = pins.get((name, found[0].condition, "test"))
            rows = {leader: scores[_cell(leader)] for leader in found}
            yield CurveTask(
                self.parts.preset(name),
                found,
                {leader.extractor: self.parts.extractor(leader.extractor) for leader in found},
                {leader.model: self.parts.model(leader.model) for leader in found},
                all_observable=pin is not None and pin.observable == pin.n,
                # of a unit known by its references, where there is such a bound
                bounds_deg={
                    leader: row["bound_deg"]
                    if row["bound_unit_deg"] is None
                    else row["bound_unit_deg"]
                    for leader, row in rows.items()
                },
                bench_deg=pin.bench_deg if pin else None,
            )

    @staticmethod
    def measure(task: CurveTask) -> list[tuple[Leader, Row]]:
        """Calibrate every leader of a data set on growing subsets of its poses."""
        return [
            (one.leader, row_of(one, task.bounds_deg[one.leader], task.bench_deg))
            for one in measure(task)
        ]


def _cell(leader: Leader) -> Cell:
    return Cell(leader.dataset, leader.condition, leader.extractor, leader.model)

"""A sparse network on a coded mask under faults, beside the pipeline that leads there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property

from benchmark.as_sold.measure import best_pipeline
from benchmark.contract import Cell
from benchmark.learned.network import Network
from benchmark.learned_faults import plots
from benchmark.learned_faults.curves import curve
from benchmark.learned_faults.deep import WEIGHTS, DeepReader
from benchmark.learned_faults.measure import FaultTask, measure
from benchmark.learned_faults.record import RECORD, cell_of
from benchmark.learned_faults.rule import DATASET, FAULTS
from benchmark.results.components import current
from benchmark.results.digests import short_digest
from benchmark.results.modules import modules_digest
from benchmark.results.row_file import Row
from benchmark.results.store import Store
from benchmark.running.experiment import RecordedExperiment
from files.checksums import sha256

_CODE = "benchmark.learned_faults.measure"
#: Members of the table that are shares of frames, and errors.
_SHARES, _ERRORS = ("answered", "wrong", "far"), ("rms_deg", "median_deg")


class LearnedFaults(RecordedExperiment[str]):
    """SSCNN and the best pipeline of a coded mask over the strength of lasers, dirt and glare."""

    name = "learned_faults"
    title = "A sparse network on a coded mask under faults"
    record = RECORD

    @cached_property
    def leader(self) -> Cell | None:
        """What leads the data set's standard unit, by the record."""
        first = self.parts.preset(DATASET).conditions[0]
        rows = Store(self.directory).rows()
        best = best_pipeline(rows, self.parts.models, DATASET, first, table=True)
        return None if best is None else Cell(DATASET, first, *best)

    def keys(self) -> Mapping[str, str]:
        """Digest the code, the network's file, and the data set with its extractor and model."""
        if self.leader is None:
            return {}
        components = current(self.parts.only([self.leader]))
        kinds = ("dataset", "extractor", "model")
        parts = [components.digest(f"{kind}s", getattr(self.leader, kind)) for kind in kinds]
        key = short_digest([modules_digest(_CODE), sha256(WEIGHTS), *parts])
        return dict.fromkeys(FAULTS, key)

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        """Draw both ways' curves over the strength of each fault."""
        return {"learned_faults.svg": lambda: plots.curves(self.rows())}

    def table(self) -> list[Row]:
        """Return a row for each fault, strength and way of reading, over all units."""
        return [
            {
                "dataset": row["dataset"],
                "fault": row["fault"],
                "strength": strength,
                "way": way,
                "frames": row["frames"] * len(of["answered"][at]),
                **{name: round(curve(row, way, name)[at] or 0.0, 5) for name in _SHARES},
                **{name: curve(row, way, name)[at] for name in _ERRORS},
            }
            for row in self.rows()
            for at, strength in enumerate(row["strengths"])
            for way, of in row["ways"].items()
        ]

    def tasks(self, cells: Sequence[str]) -> Iterator[FaultTask]:
        """Make one task of all faults: they share calibrations and clean frames."""
        cell = self.leader
        if cell is None or not cells:
            return
        made = Network.load(WEIGHTS)
        yield FaultTask(
            list(cells),
            self.parts.preset(cell.dataset),
            self.parts.extractor(cell.extractor),
            self.parts.model(cell.model),
            DeepReader(made, made.card["limits"]),
        )

    @staticmethod
    def measure(task: FaultTask) -> list[tuple[str, Row]]:
        """Read the frames of all units under the faults by both ways."""
        return [(cell_of(row), row) for row in measure(task)]

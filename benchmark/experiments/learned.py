"""Convolutional networks against the pipelines that lead: centres by heat map, and SSCNN."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from typing import Any

from benchmark.as_sold.measure import best_pipeline
from benchmark.contract import Cell
from benchmark.learned import measure as centres
from benchmark.learned import plots, sparse_measure
from benchmark.learned.network import Network
from benchmark.learned.networks import NETWORKS
from benchmark.learned.plans import CENTRES, SEEDS
from benchmark.learned.record import RECORD, cell_of
from benchmark.learned.sparse import SparseReader
from benchmark.learned.sparse_training import DATASET, LOOK, OF_ONE, name_of_one, scaling
from benchmark.results.components import current
from benchmark.results.digests import short_digest
from benchmark.results.modules import modules_digest
from benchmark.results.row_file import Row
from benchmark.results.store import Store
from benchmark.running.experiment import RecordedExperiment

_CODE = "benchmark.learned.measure", "benchmark.learned.sparse_measure"
_HEAT_MAP, _SPARSE = "heat map", "sscnn"
_Task = centres.CentreTask | sparse_measure.SparseTask


class Learned(RecordedExperiment[str]):
    """Networks that were trained on other units, beside the best pipeline at equal calibration."""

    name = "learned"
    title = "Convolutional networks that read frames"
    record = RECORD

    @cached_property
    def leaders(self) -> Mapping[str, tuple[Cell, float]]:
        """What leads each data set's standard unit, by the name of its cell, with its bound."""
        rows, found = Store(self.directory).rows(), {}
        for network, name in [*((_HEAT_MAP, name) for name in CENTRES), (_SPARSE, DATASET)]:
            first = self.parts.preset(name).conditions[0]
            best = best_pipeline(rows, self.parts.models, name, first, table=True)
            if best is not None:
                cell = Cell(name, first, *best)
                found[f"{network}/{name}"] = cell, _bound(rows, cell)
        return found

    def keys(self) -> Mapping[str, str]:
        """Digest the code, the weights, and data set, extractor and model of each."""
        code = modules_digest(*_CODE)
        components = current(self.parts.only([cell for cell, _ in self.leaders.values()]))
        kinds = ("dataset", "extractor", "model")
        return {
            name: short_digest(
                [
                    code,
                    *(components.digest(f"{kind}s", getattr(cell, kind)) for kind in kinds),
                    *(_digest(file) for file in _files(name)),
                ]
            )
            for name, (cell, _) in self.leaders.items()
        }

    def comparable_members(self, row: Row) -> Row:
        """Return all but times."""
        return {k: v for k, v in row.items() if k not in {"key", "times_slower"}}

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        """Draw errors over the bound by data set and way of reading."""
        return {"learned.svg": lambda: plots.errors(self.rows())}

    def table(self) -> list[Row]:
        """Return a row for each network, data set and way of reading."""
        return [
            {
                "network": row["network"],
                "dataset": row["dataset"],
                "way": way,
                "bound_deg": row["bound_deg"],
                **{
                    f"unit_{unit}_deg": error
                    for unit, error in zip(centres.UNITS, errors, strict=True)
                },
                "times_slower": None if way in {"classical", "centroid"} else row["times_slower"],
                **_wrong(row, way),
            }
            for row in self.rows()
            for way, errors in row["errors_deg"].items()
        ]

    def tasks(self, cells: Sequence[str]) -> Iterator[_Task]:
        """Make a task of each cell."""
        for name in cells:
            cell, bound = self.leaders[name]
            parts = (
                self.parts.preset(cell.dataset),
                self.parts.extractor(cell.extractor),
                self.parts.model(cell.model),
                bound,
            )
            files = _files(name)
            if name.startswith(_SPARSE):
                readers = [_sparse(file) for file in files]
                of_one = dict(zip(OF_ONE, readers[1:], strict=True))
                yield sparse_measure.SparseTask(*parts, readers[0], of_one)
            else:
                made = [Network.load(NETWORKS / f"{file}.npz") for file in files]
                seeds = dict(zip(SEEDS.get(cell.dataset, (0,)), made, strict=True))
                yield centres.CentreTask(*parts, CENTRES[cell.dataset].look, seeds)

    @staticmethod
    def measure(task: _Task) -> list[tuple[str, Row]]:
        """Score a network, and try it without a Sun, with two, and under other masks."""
        sparse = isinstance(task, sparse_measure.SparseTask)
        row: dict[str, Any]
        row = sparse_measure.measure(task) if sparse else centres.measure(task)  # type: ignore[arg-type]
        return [(cell_of(row), row)]


def _wrong(row: Row, way: str) -> Row:
    """Return the share of frames that a way answers wrongly without a flag, by trial."""
    counts = {one["trial"]: one for one in row["trust"] if one["way"] == way}
    return {
        f"wrong_{trial.lower().replace(' ', '_')}": round(
            counts[trial]["wrong"] / counts[trial]["frames"], 5
        )
        if trial in counts
        else None
        for trial in centres.TRIALS
    }


def _files(name: str) -> list[str]:
    network, dataset = name.split("/")
    if network == _SPARSE:
        return ["sscnn", *(name_of_one(*of) for of in OF_ONE)]
    return [f"centres-{dataset}-{seed}" for seed in SEEDS.get(dataset, (0,))]


def _digest(file: str) -> str:
    return hashlib.sha256((NETWORKS / f"{file}.npz").read_bytes()).hexdigest()


def _sparse(file: str) -> SparseReader:
    network = Network.load(NETWORKS / f"{file}.npz")
    return SparseReader(network, LOOK, *scaling(), network.card.get("limits"))


def _bound(rows: Sequence[Mapping[str, Any]], cell: Cell) -> float:
    names = ("dataset", "condition", "extractor", "model")
    wanted = tuple(getattr(cell, name) for name in names)
    row = next(row for row in rows if tuple(row[name] for name in names) == wanted)
    return float(row["bound_deg"])

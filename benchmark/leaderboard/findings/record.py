"""What findings are made of: the published errors, paired by sensor unit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from benchmark.contract import ON_BENCH, Cell
from benchmark.leaderboard.board import NOMINAL
from benchmark.metrics.ranking import UnitErrors, spreads
from benchmark.metrics.score import is_available
from benchmark.results.store import PUBLISHED, Store

Row = Mapping[str, Any]

#: Detectors that sample an image or a profile; the others give a reading for each element.
ARRAYS = frozenset({"CCD", "CMOS", "PDA", "Event"})


@dataclass(frozen=True)
class FindingsRecord:
    """Scores under the first condition of each data set, by cell.

    `rows` are of the standard unit, without the `unavailable`: those that answer fewer than 95 % of
    the samples, or have no error. Own errors, and errors on drawn benches, are of every unit;
    `bench_deg` is the error of the standard bench's directions, root mean square, by data set.
    """

    rows: Mapping[Cell, Row]
    errors: Mapping[Cell, UnitErrors]
    on_bench: Mapping[Cell, UnitErrors]
    bench_deg: Mapping[str, float]
    unavailable: frozenset[Cell]

    @classmethod
    def published(cls, store: Store | None = None) -> FindingsRecord:
        """Read the published record, or another store."""
        known = store or Store(PUBLISHED)
        every = known.rows(unit=None)
        spread = spreads(every)
        nominal = {
            Cell(row["dataset"], NOMINAL, row["extractor"], row["model"]): row
            for row in every
            if row["unit"] == 0 and row["condition"] == NOMINAL
        }
        rows = {
            cell: row
            for cell, row in nominal.items()
            if row["rms_all_answers_deg"] is not None and is_available(row)
        }
        on_bench = {cell: spread.get(_on_bench(cell)) for cell in rows}
        return cls(
            rows,
            {cell: spread[cell] for cell in rows},
            {cell: errors for cell, errors in on_bench.items() if errors is not None},
            {
                name: pin.bench_deg
                for (name, condition, split), pin in known.pins().items()
                if (condition, split) == (NOMINAL, "test") and pin.bench_deg is not None
            },
            frozenset(nominal.keys() - rows.keys()),
        )

    @cached_property
    def best(self) -> Mapping[str, Cell]:
        """The pipeline with the smallest own error, by data set."""
        found: dict[str, Cell] = {}
        for cell in sorted(self.rows, key=lambda cell: (self.own_error_deg(cell), cell)):
            found.setdefault(cell.dataset, cell)
        return found

    def own_error_deg(self, cell: Cell) -> float:
        """Return the own error of a cell in `rows`: geometric mean over units, degrees."""
        own = self.errors[cell].own_error_deg
        if own is None:
            raise ValueError(f"{cell} has no error on any unit")
        return own

    def ratio(self, cell: Cell, other: Cell, bench_deg: tuple[float, float] = (0.0, 0.0)) -> float:
        """Return a cell's error over another's: geometric mean over the units that both have.

        `bench_deg` are errors of a bench that each is calibrated on, which add as squares.
        """
        return geometric_mean(
            [
                math.hypot(one, bench_deg[0]) / math.hypot(two, bench_deg[1])
                for one, two in shared(self.errors[cell], self.errors[other])
            ]
        )

    def is_array(self, cell: Cell) -> bool:
        """Return whether the detector of a cell's sensor samples an image or a profile."""
        return self.rows[cell]["detector"] in ARRAYS


def shared(one: UnitErrors, other: UnitErrors) -> Iterator[tuple[float, float]]:
    """Give the errors of two methods on the units on which both have one."""
    for first, second in zip(one.errors_deg, other.errors_deg, strict=False):
        if first is not None and second is not None:
            yield first, second


def geometric_mean(values: Sequence[float]) -> float:
    """Return the geometric mean of positive numbers."""
    return math.exp(math.fsum(map(math.log, values)) / len(values))


def _on_bench(cell: Cell) -> Cell:
    return Cell(cell.dataset, ON_BENCH, cell.extractor, cell.model)

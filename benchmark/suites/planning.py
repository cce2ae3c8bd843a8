"""What a run would measure, and why: nothing is measured to tell."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from benchmark.contract import Cell
from benchmark.plan.parts import Parts, every_part
from benchmark.results.components import Components, current
from benchmark.results.csv_tables import Row
from benchmark.results.record import Record
from benchmark.results.store import Store
from benchmark.running.kept_stages import KeptStages, StageCounts, count_stages
from benchmark.running.runner import known_cells
from benchmark.suites.selection import Suite

NEW, FAILED = "new", "failed"


@dataclass(frozen=True)
class CellPlan:
    """Cells, and what is to be done about them.

    Attributes
    ----------
    cells
        All that were asked for, in order.
    missing
        Those that no store holds as code and data now are, in order, each with the reasons:
        ``new``, ``failed`` (before), or which of `benchmark.results.components.KEYED` changed.
    modules
        Modules that have changed since the stores' scores were measured, as far as the stores tell.
    stages
        How much of each stage that is, where what is kept beside the stores is used.
    """

    cells: tuple[Cell, ...]
    missing: Mapping[Cell, tuple[str, ...]]
    modules: tuple[str, ...]
    stages: StageCounts


def plan(cells: Iterable[Cell], stores: Sequence[Store], *, parts: Parts | None = None) -> CellPlan:
    """Say which cells would be measured, and why.

    A reason is by the first of the stores that holds the cell; into the last would be measured.
    UnknownNameError for what is not installed; StoreError, ComponentsError for a broken file.
    """
    known = parts or every_part()
    wanted = known_cells(cells, known)
    components = current(known)
    records = [Record(store) for store in stores]
    missing = {}
    for cell in wanted:
        reasons = [record.why_outdated(cell, components) for record in records]
        if all(reasons):
            missing[cell] = next((r for r in reasons if r != (NEW,)), (NEW,))
    *others, into = (store.work_directory for store in stores)
    kept = KeptStages.beside(into, components, others)
    before = Components()
    for store in reversed(stores):
        before = before.update(store.components())
    modules = components.changed_modules(before) if before.modules and missing else []
    counted = count_stages(missing, components, kept)
    return CellPlan(tuple(wanted), missing, tuple(modules), counted)


def cells_of(suite: Suite, stores: Sequence[Store], *, parts: Parts | None = None) -> list[Cell]:
    """Return a suite's cells by the scores that stores hold, of older code or not."""
    return suite.select(stored_scores(stores), parts or every_part())


def stored_scores(stores: Sequence[Store]) -> dict[Cell, Row]:
    """Return the scores of stores, of the first that holds a cell."""
    found: dict[Cell, Row] = {}
    for store in reversed(stores):
        found |= Record(store).scores
    return found

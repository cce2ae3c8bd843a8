"""From cells to tasks and back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import groupby

from benchmark.contract import ON_BENCH, Cell
from benchmark.datasets.pins import Pin, Place
from benchmark.metrics.score import METRICS
from benchmark.plan.parts import Parts
from benchmark.results.csv_tables import Row
from benchmark.results.samples import CONDITION, Directions, SampleErrors
from benchmark.running.fitting import data_condition
from benchmark.running.stages import Task
from benchmark.running.task import TaskResult


def tasks_of(cells: Iterable[Cell], parts: Parts, pins: Mapping[Place, Pin]) -> list[Task]:
    """Put cells into tasks, those of one dataset, unit and condition in a row: they share data."""
    return [
        Task(
            parts.preset(dataset),
            condition,
            parts.extractor(extractor),
            tuple(parts.model(cell.model) for cell in group),
            unit,
            _all_observable(pins, dataset, data_condition(parts.preset(dataset), condition)),
        )
        for (dataset, unit, _, condition, extractor), group in groupby(
            sorted(cells, key=_order), key=lambda cell: _order(cell)[:5]
        )
    ]


def _order(cell: Cell) -> tuple[str, int, bool, str, str, str]:
    """Put drawn benches first: who has just measured the first condition still has its data."""
    not_bench = cell.condition != ON_BENCH
    return cell.dataset, cell.unit, not_bench, cell.condition, cell.extractor, cell.model


def _all_observable(pins: Mapping[Place, Pin], dataset: str, condition: str) -> bool:
    pin = pins.get((dataset, condition, "test"))
    return pin is not None and pin.observable == pin.n


def cells_of(result: TaskResult) -> list[Cell]:
    """List the cells that a result is of, in the order of its outcomes."""
    task = result.task
    extractor = task.extractor.about.name
    return [
        Cell(task.preset.name, task.condition, extractor, outcome.model, task.unit)
        for outcome in result.outcomes
    ]


def samples_of(result: TaskResult) -> SampleErrors:
    """Return the errors of samples of the outcomes that have them, and what the samples are."""
    found = SampleErrors()
    if result.task.condition != CONDITION:
        return found
    if result.directions is not None:
        found.directions[result.task.preset.name] = Directions(*result.directions)
    for cell, outcome in zip(cells_of(result), result.outcomes, strict=True):
        if outcome.sample_errors_deg is not None and outcome.found is not None:
            found.add(cell, outcome.sample_errors_deg, outcome.found)
    return found


def numbers_of(result: TaskResult) -> list[Row]:
    """Make the stored numbers of the outcomes, in order: they depend on code and data only."""
    return [
        {
            "status": "ok" if outcome.score else "refused" if outcome.refused else "failed",
            **(outcome.score.row() if outcome.score else dict.fromkeys(METRICS)),
            "reason": outcome.reason,
        }
        for outcome in result.outcomes
    ]

"""How long measuring takes, by what was measured before: sums written out by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import fake_atlas

from benchmark.contract import Cell
from benchmark.results.store import Store
from benchmark.running.durations import (
    DURATIONS,
    Durations,
    ExtractionTask,
    Took,
    drop_unplanned,
)
from benchmark.running.task import Task


def task(dataset: str, extractor: str) -> Task:
    about = replace(fake_atlas.Currents.about, name=extractor)
    named: Any = type("Named", (fake_atlas.Currents,), {"about": about})
    return Task(fake_atlas.Diodes(name=dataset, conditions=("quiet",)), "quiet", named, (), 0)


def cells(condition: str, extractor: str, models: int, unit: int = 0) -> list[Cell]:
    return [Cell("a", condition, extractor, f"m{one}", unit) for one in range(models)]


def test_a_task_elsewhere_is_as_long_as_its_extractor_s_else_as_the_mean_of_all() -> None:
    durations = Durations()
    durations.add(task("b", "other"), Took(0, 1, 3.0))
    durations.add(task("c", "other"), Took(0, 1, 5.0))
    assert durations.seconds([task("a", "one")]) == 4.0
    durations.add(task("d", "one"), Took(0, 1, 10.0))
    assert durations.seconds([task("a", "one")]) == 10.0


def test_an_estimate_is_of_data_once_a_place_and_of_models_by_their_number() -> None:
    """Data cost 10 - 4 seconds; two models of one extractor 4, and fewer are no cheaper."""
    durations = Durations(
        {
            ExtractionTask("a", "quiet", 0, "one"): Took(2, 0, 4.0),
            ExtractionTask("a", "quiet", 0, "two"): Took(3, 1, 10.0),
        }
    )

    def seconds(*wanted: list[Cell]) -> float:
        return durations.estimate([cell for some in wanted for cell in some]).seconds

    assert seconds(cells("quiet", "one", 2)) == 6.0 + 4.0
    assert seconds(cells("quiet", "one", 1)) == 6.0 + 4.0
    assert seconds(cells("noisy", "one", 6)) == 6.0 + 3 * 4.0
    assert seconds(cells("noisy", "one", 2), cells("noisy", "two", 2)) == 6.0 + 4.0 + 4.0
    assert seconds(cells("noisy", "one", 2), cells("noisy", "one", 2, unit=1)) == 2 * (6.0 + 4.0)


def test_what_is_not_planned_any_more_is_forgotten_and_else_nothing_is_written(
    tmp_path: Path,
) -> None:
    store = Store(tmp_path)
    assert drop_unplanned(store, []) == 0
    assert not (store.work_directory / DURATIONS).exists()
    known = {ExtractionTask("a", name, 0, "one"): Took(2, 0, 4.0) for name in ("quiet", "noisy")}
    Durations(known).keep(store)
    assert drop_unplanned(store, cells("quiet", "one", 1)) == 1
    assert [task.condition for task in Durations.read([store]).known] == ["quiet"]

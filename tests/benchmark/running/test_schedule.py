"""Pieces: what shares data stays together while everybody has something to do."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import fake_atlas
import pytest

from benchmark.running import runner
from benchmark.running.stages import Task


def task(dataset: str, condition: str = "quiet", unit: int = 0, extractor: str = "one") -> Task:
    about = replace(fake_atlas.Currents.about, name=extractor)
    named: Any = type("Named", (fake_atlas.Currents,), {"about": about})
    return Task(fake_atlas.Diodes(name=dataset), condition, named, (fake_atlas.LeastSquares,), unit)


CONDITIONS = [
    [task("a", condition, unit, extractor) for extractor in ("one", "two")]
    for unit in (0, 1)
    for condition in ("quiet", "noisy")
]
TASKS = [one for group in CONDITIONS for one in group]


@pytest.mark.parametrize(
    ("workers", "expected"),
    [
        (1, [[one] for one in TASKS]),
        (2, CONDITIONS),
        (4, CONDITIONS),
        (5, [[one] for one in TASKS]),
    ],
)
def test_a_piece_is_as_large_as_leaves_one_to_every_worker(
    workers: int, expected: list[list[Task]]
) -> None:
    assert [list(one) for one in runner.pieces(TASKS, workers)] == expected


def test_units_stay_together_where_there_are_many_and_the_largest_is_first() -> None:
    small = [task(name, unit=unit) for name in "abcd" for unit in (1, 2)]
    large = [task("e", condition) for condition in ("noisy", "quiet")]
    assert runner.pieces([*small, *large], 2) == [tuple(large), *[(one,) for one in small]]

"""What a cell costs as the benchmark grows: made-up methods, data sets, units and studies.

Each figure is the slope of the logarithms of processor time and work; 1 is a cost that grows as its
work does.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from api.service.knowledge import Knowledge
from benchmark.leaderboard import board
from benchmark.plan import combinations
from benchmark.plan.parts import Parts
from benchmark.progress import silent
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import runner
from files.atomic import temporary_directory
from registry.answer import Answer
from registry.design_table import DesignTable
from registry.judging import Question
from registry.measured_pipelines import Measurements
from registry.requirements import Requirements
from registry.studies import facts

from .paired import at_most

sys.path.append(str(Path(__file__).parents[2] / "tests" / "benchmark" / "fakes"))

import fake_atlas  # of the tests, which have no package
import fake_plan

_MOST = 1.1
#: Amount of work, and what does it.
Prepared = tuple[int, Callable[[], object]]


def made_up(methods: int = 1, datasets: int = 1) -> Parts:
    """Return parts with so many models and data sets, alike but for their names."""
    least = fake_atlas.LeastSquares
    models = []
    for at in range(methods):
        about = replace(least.about, name=f"made-{at}")
        models.append(type(f"Made{at}", (least,), {"about": about}))
        models[-1].__module__ = least.__module__  # whose code they are
    presets = tuple(fake_atlas.Diodes(name=f"made-{at}", n=20) for at in range(datasets))
    return fake_plan.parts(*models, presets=presets)


def planning(methods: int) -> Prepared:
    """Prepare a plan of methods on ten data sets."""
    parts = made_up(methods, 10)
    return len(combinations.cells(parts=parts)), lambda: combinations.cells(parts=parts)


def running(methods: int = 1, datasets: int = 1, units: int = 1) -> Prepared:
    """Prepare planning, measuring and recording."""
    parts = made_up(methods, datasets)
    standard = combinations.cells(parts=parts)
    cells = [replace(cell, unit=unit) for cell in standard for unit in range(units)]

    def run() -> None:
        with temporary_directory() as directory:
            store = Store(directory / "store")
            runner.run(cells, store, progress=silent, parts=parts)
            store.rows(unit=None)

    return len(cells), run


def ranking(methods: int = 1, units: int = 1) -> Prepared:
    """Prepare the board of one data set: the published rows so many times, on made-up units."""
    known = [r for r in Store(PUBLISHED).rows(unit=0) if r["dataset"] == "cmos-single-aperture"]
    rng = np.random.default_rng(36)
    rows: list[dict[str, Any]] = [
        {**row, "model": f"{row['model']}-{copy}", "unit": unit}
        for row in known
        for copy in range(methods)
        for unit in range(units)
    ]
    for row in rows:
        for name in ("rms_deg", "rms_all_answers_deg"):
            if isinstance(row.get(name), float):
                row[name] *= float(np.exp(0.1 * rng.standard_normal()))
    return len(rows), lambda: board.build(rows)


def answering(studies: int, methods: int = 1) -> Prepared:
    """Prepare a table of designs, and an answer, for so many studies and times the methods."""
    known, measured = facts(), Knowledge().measured_pipelines.rows
    every = list(known.studies.values())
    made = [
        replace(study, key=f"{study.key}-{copy}")
        for copy in range(-(-studies // len(every)))
        for study in every
    ]
    grown = replace(known, studies={study.key: study for study in made[:studies]})
    rows = [replace(row, model=f"{row.model}-{n}") for row in measured for n in range(methods)]
    pipelines = Measurements(rows)

    def answer() -> object:
        table = DesignTable(grown, pipelines)
        return Answer(Question(table, Requirements()), "evidence").architectures

    return studies if methods == 1 else len(rows), answer


_STEPS: dict[str, tuple[Callable[[int], Prepared], tuple[int, ...]]] = {
    "plan by methods": (planning, (10, 25, 50, 100)),
    "run by methods": (lambda size: running(methods=size), (8, 16, 40, 80)),
    "run by data sets": (lambda size: running(datasets=size), (8, 16, 40, 80)),
    "run by units": (lambda size: running(units=size), (12, 25, 50, 100)),
    "board by methods": (lambda size: ranking(methods=size, units=5), (1, 2, 5, 10)),
    "board by units": (lambda size: ranking(units=size), (12, 25, 50, 100)),
    "answer by studies": (answering, (125, 250, 500, 1000)),
    "answer by methods": (lambda size: answering(1000, size), (2, 4, 7, 10)),
}


def track_exponent(step: str) -> float:
    """Time a step at four sizes, the best of two."""
    prepare, sizes = _STEPS[step]
    prepare(sizes[0])[1]()
    work, seconds = [], []
    for size in sizes:
        amount, run = prepare(size)
        best = float("inf")
        for _ in range(2):
            start = time.process_time()
            run()
            best = min(best, time.process_time() - start)
        work.append(amount)
        seconds.append(best)
    return at_most(_MOST, float(np.polyfit(np.log(work), np.log(seconds), 1)[0]))


track_exponent.params = list(_STEPS)  # type: ignore[attr-defined]
track_exponent.param_names = ["step"]  # type: ignore[attr-defined]
track_exponent.timeout = 1200  # type: ignore[attr-defined]

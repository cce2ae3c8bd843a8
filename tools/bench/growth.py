"""What a cell costs as the benchmark grows: ``python -m tools.bench.growth``.

Made-up parts: ten times the methods, more data sets, a hundred units, a thousand studies. Each
step is timed (processor time) at four sizes; the exponent is the slope of the logarithms of cost
and work. 1 is a cost that grows as its work does, cells or studies; above `MOST_EXPONENT`
something grows faster.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
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
from files.temporary import temporary_directory
from registry.answer import Answer
from registry.design_table import DesignTable
from registry.judging import Question
from registry.measured_pipelines import Measurements
from registry.requirements import Requirements
from registry.studies import facts
from tools.bench.verdicts import Verdict, any_broken

FAKES = str(Path(__file__).parents[2] / "tests" / "benchmark" / "fakes")
if FAKES not in sys.path:
    sys.path.append(FAKES)

import fake_atlas  # noqa: E402 - of the tests, which have no package
import fake_plan  # noqa: E402 - likewise

MOST_EXPONENT = 1.1
#: Samples of a made-up data set: few, as what is asked is the cost of all else.
_SAMPLES = 20
_TIMES = 2


@dataclass(frozen=True)
class Growth:
    """How the cost of a step grows.

    Attributes
    ----------
    step, of : what is timed, and what there is more of
    sizes : how many of these
    work : cells, or studies, that each size makes
    seconds : processor time of each
    """

    step: str
    of: str
    sizes: Sequence[int]
    work: Sequence[int]
    seconds: Sequence[float]

    @property
    def exponent(self) -> float:
        """Slope of the logarithm of the cost over that of the work."""
        return float(np.polyfit(np.log(self.work), np.log(self.seconds), 1)[0])


#: Prepares a step at a size; returns what it comes to in cells or studies, and the step.
Prepared = Callable[[int], tuple[int, Callable[[], object]]]


def measure(step: str, of: str, sizes: Sequence[int], prepare: Prepared) -> Growth:
    """Time a step at each size, the best of `_TIMES`; once before, for what is kept."""
    prepare(sizes[0])[1]()
    work, seconds = [], []
    for size in sizes:
        best = np.inf
        for _ in range(_TIMES):
            amount, run = prepare(size)
            start = time.process_time()
            run()
            best = min(best, time.process_time() - start)
        work.append(amount)
        seconds.append(float(best))
    return Growth(step, of, tuple(sizes), tuple(work), tuple(seconds))


def made_up(methods: int = 1, datasets: int = 1) -> Parts:
    """Return parts with so many models and data sets, alike but for their names."""
    least = fake_atlas.LeastSquares
    models = tuple(
        type(f"Made{at}", (least,), {"about": replace(least.about, name=f"made-{at}")})
        for at in range(methods)
    )
    for model in models:
        model.__module__ = least.__module__  # whose code they are
    presets = tuple(fake_atlas.Diodes(name=f"made-{at}", n=_SAMPLES) for at in range(datasets))
    return fake_plan.parts(*models, presets=presets)


def prepare_running(methods: int = 1, datasets: int = 1, units: int = 1) -> tuple[int, Any]:
    """Prepare planning, measuring and recording of made-up parts."""
    parts = made_up(methods, datasets)
    standard = combinations.cells(parts=parts)
    cells = [replace(cell, unit=unit) for cell in standard for unit in range(units)]

    def run() -> None:
        with temporary_directory() as directory:
            store = Store(directory / "store")
            runner.run(cells, store, progress=silent, parts=parts)
            store.rows(unit=None)

    return len(cells), run


def prepare_planning(size: int) -> tuple[int, Any]:
    """Prepare a plan of so many methods on ten data sets."""
    parts = made_up(size, 10)
    return len(combinations.cells(parts=parts)), lambda: combinations.cells(parts=parts)


def prepare_ranking(methods: int = 1, units: int = 1) -> tuple[int, Any]:
    """Prepare the board of one data set with the published rows so many times, on made-up units."""
    known = [r for r in Store(PUBLISHED).rows(unit=0) if r["dataset"] == "cmos-single-aperture"]
    rng = np.random.default_rng(36)
    rows = [
        {**row, "model": f"{row['model']}-{copy}", "unit": unit}
        for row in known
        for copy in range(methods)
        for unit in range(units)
    ]
    for row in rows:
        for name in ("rms_deg", "charged_deg"):
            if isinstance(row.get(name), float):
                row[name] *= float(np.exp(0.1 * rng.standard_normal()))
    return len(rows), lambda: board.build(rows)


def prepare_answering(studies: int, methods: int, known: Knowledge) -> tuple[int, Any]:
    """Prepare a table of designs, and an answer, for so many studies and times the methods."""
    of_survey = facts()
    every = list(of_survey.studies.values())
    copies = -(-studies // len(every))
    made = [
        replace(study, key=f"{study.key}-{copy}" if copy else study.key)
        for copy in range(copies)
        for study in every
    ]
    grown = replace(of_survey, studies={study.key: study for study in made[:studies]})
    rows = [
        replace(row, model=f"{row.model}-{copy}")
        for row in known.measured_pipelines.rows
        for copy in range(methods)
    ]
    pipelines = Measurements(rows)

    def answer() -> None:
        table = DesignTable(grown, pipelines)
        _ = Answer(Question(table, Requirements()), "evidence").architectures

    return studies if methods == 1 else len(rows), answer


def growths() -> Iterator[Growth]:
    """Measure every step."""
    tens, hundred = (8, 16, 40, 80), (12, 25, 50, 100)
    yield measure("plan", "methods", (10, 25, 50, 100), prepare_planning)
    yield measure("plan, run, record", "methods", tens, lambda size: prepare_running(methods=size))
    yield measure(
        "plan, run, record", "data sets", tens, lambda size: prepare_running(datasets=size)
    )
    yield measure("plan, run, record", "units", hundred, lambda size: prepare_running(units=size))
    yield measure(
        "board", "methods", (1, 2, 5, 10), lambda size: prepare_ranking(methods=size, units=5)
    )
    yield measure("board", "units", hundred, lambda size: prepare_ranking(units=size))
    known = Knowledge()
    many = (125, 250, 500, 1000)
    yield measure("answer", "studies", many, lambda size: prepare_answering(size, 1, known))
    yield measure(
        "answer", "methods", (2, 4, 7, 10), lambda size: prepare_answering(1000, size, known)
    )


def run() -> list[Verdict]:
    """Measure and print; return the verdicts."""
    found = []
    for growth in growths():
        each = ", ".join(
            f"{size}: {1e6 * seconds / work:.0f} us"
            for size, work, seconds in zip(growth.sizes, growth.work, growth.seconds, strict=True)
        )
        unit = "a study" if growth.of == "studies" else "a cell"
        print(
            f"{growth.step} by {growth.of} ({unit}) {each}; exponent {growth.exponent:.2f}",
            flush=True,
        )
        what = f"{growth.step}: exponent of its cost by {growth.of}"
        found.append(Verdict(what, growth.exponent, MOST_EXPONENT))
    return found


def main() -> int:
    """Measure, print, and return the exit status."""
    return 1 if any_broken(run()) else 0


if __name__ == "__main__":
    sys.exit(main())

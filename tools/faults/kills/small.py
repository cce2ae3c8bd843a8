"""Small stand-ins for what takes long: the commands are the real ones, what they measure is not.

Importable by name, so that worker processes find the same.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from benchmark.claims.experiment import Trial
from benchmark.claims.outcomes import outcome_of, row_of
from benchmark.claims.rules import claims
from benchmark.contract import Cell
from benchmark.datasets.pins import Pin
from benchmark.error_budget.variants import VARIANTS
from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts, installed_parts
from benchmark.results.components import current
from benchmark.results.store import Store

FAKES = Path(__file__).parents[3] / "tests" / "benchmark" / "fakes"
if str(FAKES) not in sys.path:
    sys.path.append(str(FAKES))

import fake_atlas  # noqa: E402 - of the tests, which have no package
import fake_plan  # noqa: E402
import fake_poses  # noqa: E402
import fake_results  # noqa: E402

#: What one piece of measuring takes, seconds.
STEP_S = 0.05


def parts(*, n: int = 40) -> Parts:
    """Two data sets of diodes, eight cells."""
    first = fake_atlas.Diodes(n=n)
    return fake_plan.parts(presets=(first, fake_atlas.Diodes(name="fake-second", n=n)))


def few_parts(dataset: str) -> Parts:
    """One installed data set, and of what fits it a few models."""
    known = installed_parts()
    fitting = cells(dataset, parts=known)
    extractors = {cell.extractor for cell in fitting}
    models = sorted({cell.model for cell in fitting} - {m for m in known.models if "+" in m})[:4]
    return Parts(
        {dataset: known.presets[dataset]},
        {name: known.extractors[name] for name in extractors},
        {name: known.models[name] for name in models},
    )


def curve_parts() -> Parts:
    """Two data sets whose learning curves take a tenth of a second each."""
    return Parts(
        {name: fake_poses.Plane(name, poses=60) for name in ("fake-plane", "fake-other")},
        {"fake-readings": fake_poses.Readings},
        {"fake-lines": fake_poses.Lines, "fake-guess": fake_poses.Guess},
    )


def write_scores(directory: Path) -> None:
    """Write a record whose leaders `curve_parts` can measure curves of."""
    known = curve_parts()
    scores = {
        Cell(name, "nominal", "fake-readings", model): fake_results.numbers(
            0.01, over_bound=place, bound_deg=0.01
        )
        for name in known.presets
        for place, model in enumerate(known.models, start=1)
    }
    pins = [
        Pin(name, "nominal", "test", 1, 2000, "h", "hh", 2000, 0.01, 0.01) for name in known.presets
    ]
    Store(directory).write(scores, pins, current(known))


def claim(name: str) -> list[tuple[str, dict[str, Any]]]:
    """The outcome of a claim whose numbers are their own."""
    time.sleep(STEP_S)
    asked = claims()[name]
    values = {rule.name: 1.0 + len(rule.name) for rule in asked.rules}
    second = values if asked.second else {}
    trials = [Trial(values, second=second) for _ in range(asked.trials)]
    return [(name, row_of(outcome_of(asked, trials)))]


def error_budget(name: str) -> list[tuple[str, dict[str, Any]]]:
    """The error budget of a data set."""
    time.sleep(STEP_S)
    score = {"condition": "quiet", "extractor": "one", "model": "two", "rms_deg": 0.05}
    score |= {"bound_deg": 0.005, "bound_unit_deg": 0.005, "answered": 40, "judged": 40}
    return [(name, {"dataset": name, **score, **{f"{one}_deg": 0.05 for one in VARIANTS}})]


def picture() -> str:
    """A generated picture of the documentation."""
    time.sleep(STEP_S)
    return str(np.arange(2000))

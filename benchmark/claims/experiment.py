"""What an experiment hands over: numbers of one trial, and lines to draw.

An experiment is a module of `benchmark.claims.experiments` named for its claim (``c04_orders``),
with a docstring that says what it does, and

- ``trial(number) -> Trial``: everything measured in one trial; a pure function of the number, by
  which units of the sensor and random streams are named;
- ``SKETCH``, optional: how the plot's axes are scaled.

Nothing else registers it.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, cast

from benchmark.claims import experiments

#: Places across and errors up of one line of the plot.
Line = tuple[Sequence[float | str], Sequence[float]]


@dataclass(frozen=True)
class Trial:
    """What one trial measured.

    `values` are the statistics by the rules' names, NaN where the trial has none; `second` the same
    by the claim's second method; `lines` are points of the plot, at the same places in every trial.
    """

    values: Mapping[str, float]
    lines: Mapping[str, Line] = field(default_factory=dict)
    second: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Sketch:
    """How the plot's axes are scaled."""

    log_x: bool = False
    log_up: bool = True


@dataclass(frozen=True)
class ClaimExperiment:
    """The module that measures a claim."""

    claim: str
    module: str
    trial: Callable[[int], Trial]
    sketch: Sketch
    about: str


class ExperimentError(ValueError):
    """A module among the experiments that is none, or two for one claim; the message names it."""


@cache
def find_experiments() -> Mapping[str, ClaimExperiment]:
    """Every experiment by its claim."""
    by_claim: dict[str, ClaimExperiment] = {}
    for package in pkgutil.iter_modules(experiments.__path__, f"{experiments.__name__}."):
        folder = importlib.import_module(package.name)
        for info in pkgutil.iter_modules(folder.__path__, f"{package.name}."):
            name = info.name.rpartition(".")[2]
            if not name.startswith("c"):
                continue  # what the experiments of a folder share
            experiment = _experiment(info.name, name.partition("_")[0].upper())
            if experiment.claim in by_claim:
                other = by_claim[experiment.claim].module
                raise ExperimentError(f"{experiment.claim} has two: {other} and {info.name}")
            by_claim[experiment.claim] = experiment
    return dict(sorted(by_claim.items()))


def _experiment(module: str, claim: str) -> ClaimExperiment:
    loaded: Any = importlib.import_module(module)
    trial = getattr(loaded, "trial", None)
    if not callable(trial):
        raise ExperimentError(f"{module} must define trial(number) -> Trial")
    about = (loaded.__doc__ or "").strip()
    if not about:
        raise ExperimentError(f"{module} must say in a docstring what it measures")
    sketch = getattr(loaded, "SKETCH", Sketch())
    return ClaimExperiment(claim, module, cast("Callable[[int], Trial]", trial), sketch, about)

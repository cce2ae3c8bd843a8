"""What an architecture is ranked by for a task: a number measured here or published, never another.

Accuracy goes by the error, Precision by the repeatability, FOV by the field and Latency by the time
an estimate takes, all of the calibration that errs least; Power, Volume and Cost go by what makers
publish of built sensors with the same detector and mask. No error stands in for those.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from statistics import median
from types import MappingProxyType
from typing import TYPE_CHECKING

from registry.taxonomy import Architecture
from survey_data.hardware import hardware

if TYPE_CHECKING:
    from registry.design_columns import Best

_UNITS = MappingProxyType(
    {
        "Accuracy": "deg",
        "Precision": "deg",
        "FOV": "deg",
        "Latency": "us",
        "Power": "mW",
        "Volume": "g",
        "Cost": "sqrt(mW g)",
    }
)
_PUBLISHED = ("Power", "Volume", "Cost")
#: What takes less, mW, as a photodiode that gives a current takes none, is ranked as taking this.
_LEAST_POWER_MW = 1.0
_FULL_CIRCLE_DEG = 360.0
_WORDS = MappingProxyType(
    {
        "Power": "the median power of",
        "Volume": "the median mass, which stands for the volume, of",
        "Cost": "the root of median power times median mass, as no prices are published, of",
    }
)


@dataclass(frozen=True)
class TaskMeasure:
    """A task's own measure of an architecture.

    Attributes
    ----------
    task, unit
        Of the taxonomy; of the value.
    value
        None where nothing is measured or published.
    built
        Built sensors that it is the median of; 0 for what is measured here.
    """

    task: str
    unit: str
    value: float | None
    built: int = 0

    @property
    def cost(self) -> float:
        """The value as a number of which less is better; infinite where there is none."""
        if self.value is None:
            return math.inf
        if self.task == "FOV":
            return _FULL_CIRCLE_DEG / self.value
        return max(self.value, _LEAST_POWER_MW) if self.task == "Power" else self.value

    @property
    def words(self) -> str:
        """What the value is, as a sentence."""
        of = " of built sensors" if self.task in _PUBLISHED else ""
        if self.value is None:
            return f"{self.task}: nothing {'published' if of else 'measured'}{of}"
        said = f"{self.task}: {self.value:.3g} {self.unit}"
        if not of:
            return f"{said}, of the calibration that errs least"
        return f"{said}, {_WORDS[self.task]} {self.built} built sensor{'s' * (self.built > 1)}"

    def to_dict(self) -> dict[str, object]:
        """Return the measure as in the HTTP answer."""
        return {
            "task": self.task,
            "value": self.value,
            "unit": self.unit,
            "basis": "published" if self.task in _PUBLISHED else "measured",
            "built": self.built,
            "words": self.words,
        }


def task_measures(
    tasks: Iterable[str], architecture: Architecture, best: Best, design: int
) -> tuple[TaskMeasure, ...]:
    """Return the own measures of tasks, in their order.

    Parameters
    ----------
    tasks
        Of the taxonomy.
    architecture
        Detector and mask.
    best, design
        What designs are judged by, and the position of the one that errs least on it.
    """
    return tuple(_measure(task, architecture, best, design) for task in tasks)


def joint_cost(measures: Sequence[TaskMeasure]) -> float:
    """Return one number of several measures, the less the better: their geometric mean.

    So a ratio counts alike in each. Infinite where one is not known.
    """
    costs = [measure.cost for measure in measures]
    if not all(map(math.isfinite, costs)):
        return math.inf
    return math.exp(math.fsum(map(math.log, costs)) / len(costs))


def _measure(task: str, architecture: Architecture, best: Best, design: int) -> TaskMeasure:
    unit = _UNITS[task]
    if task in _PUBLISHED:
        value, built = _published().get(architecture, {}).get(task, (None, 0))
        return TaskMeasure(task, unit, value, built)
    row = best.pipeline(design)
    found = {
        "Accuracy": best.error[design],
        "Precision": best.repeatability_deg[design],
        "FOV": -2.0 * best.negated_half_field_deg[design],
        "Latency": math.inf if row is None or row.latency_us is None else row.latency_us,
    }[task]
    known = math.isfinite(found) and found > 0.0
    return TaskMeasure(task, unit, float(found) if known else None)


@cache
def _published() -> Mapping[Architecture, Mapping[str, tuple[float, int]]]:
    """Return medians over built sensors by architecture and task, and of how many they are."""
    power: dict[Architecture, list[float]] = {}
    mass: dict[Architecture, list[float]] = {}
    for one in hardware().values():
        if one.detector and one.mask:
            pair = (one.detector, one.mask)
            if one.power_mw is not None:
                power.setdefault(pair, []).append(one.power_mw)
            if one.mass_g is not None:
                mass.setdefault(pair, []).append(one.mass_g)
    found: dict[Architecture, dict[str, tuple[float, int]]] = {}
    for pair in {**power, **mass}:
        of = found.setdefault(pair, {})
        if pair in power:
            of["Power"] = median(power[pair]), len(power[pair])
        if pair in mass:
            of["Volume"] = median(mass[pair]), len(mass[pair])
        if len(of) > 1:
            both = math.sqrt(max(of["Power"][0], _LEAST_POWER_MW) * of["Volume"][0])
            of["Cost"] = both, min(of["Power"][1], of["Volume"][1])
    return MappingProxyType(found)

"""The order of an answer, what nothing beats, and what following the order costs.

Where tasks are asked for, an architecture is ranked by the tasks' own measures, never by another:
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
from typing import Literal

from registry.designs import Candidate
from registry.measured_pipelines import MeasuredPipeline
from registry.taxonomy import Architecture
from survey_data.hardware import hardware

Sort = Literal["advice", "support", "measured"]
SORTS: tuple[Sort, ...] = ("advice", "support", "measured")
"""What an answer is ordered by first; the first of them is the usual one."""


MOST_CREDIT = 2.0
"""Times by which advice and studies together make up for a larger error, at most."""

_HALF_STUDIES = 5.0


def support(architecture: int, with_model: int, taken: int) -> float:
    """Return how the literature backs a calibration on an architecture.

    The geometric mean of three numbers of studies that meet the requirements: those of the
    architecture, those of them that use its compensations and model, and those that use its
    extractor too. Each step counts alike.
    """
    return float((architecture * with_model * taken) ** (1 / 3)) if taken else 0.0


def key_of(
    sort: Sort,
    advised: bool,
    backing: float,
    error: float,
    own: float | None = None,
    *,
    of_errors: bool = False,
) -> tuple[float, ...]:
    """Return what an architecture is ranked by, the best first.

    By advice: where kinds of errors are asked for (`of_errors`), what the survey advises for them;
    then what the survey advises or studies back and what is measured, then what has
    that evidence alone, then the rest; in each by the error or, where tasks are asked for, by
    their `own` measures (`joint_cost`). Evidence divides that by up to
    `MOST_CREDIT`: half of it (as a power) for advice, half for n studies in parts of n / (n + 5).
    So what stands first is at most so many times worse than the best of those with evidence. By
    support, or by what is measured: that first. What is not measured errs without limit.
    """
    if sort == "measured":
        return (error, not advised, -backing)
    if sort == "support":
        return (-backing, error, not advised)
    cost = error if own is None else own
    evident, measured = advised or backing > 0, math.isfinite(cost)
    tier = 0 if evident and measured else 1 if evident else 2
    credit = 0.5 * advised + 0.5 * backing / (backing + _HALF_STUDIES)
    unadvised = of_errors and not advised
    return (unadvised, tier, cost / MOST_CREDIT**credit, not advised, -backing)


def pareto(costs: Sequence[tuple[float, float]]) -> frozenset[int]:
    """Return the positions of the costs that no other beats in both of their numbers."""
    least = math.nan
    unbeaten: set[tuple[float, float]] = set()
    for cost in sorted(costs):  # whoever beats one comes before it
        if not least <= cost[1]:
            unbeaten.add(cost)
            least = cost[1]
    return frozenset(at for at, cost in enumerate(costs) if cost in unbeaten)


@dataclass(frozen=True)
class Regret:
    """What the first calibration of an answer errs, beside the best measured one that meets all.

    ``ratio`` is the first's error over the best's: 1 where they are the same, None where the first
    is not measured or the best has no error at all.
    """

    first: Candidate
    best: Candidate

    @property
    def ratio(self) -> float | None:
        """How many times the error."""
        first, best = self.first.error_deg, self.best.error_deg
        if first == best:
            return 1.0
        return first / best if math.isfinite(first) and best else None

    def to_dict(self, sentence: str) -> dict[str, object]:
        """Return the regret as in the HTTP answer, beside a sentence that says it."""
        first = self.first.error_deg
        return {
            "first_deg": None if math.isinf(first) else first,
            "best_deg": self.best.error_deg,
            "ratio": self.ratio,
            "sentence": sentence,
        }


def regret(first: Candidate, best: Candidate) -> Regret | None:
    """Return the regret of an answer; None where nothing in it is measured.

    Parameters
    ----------
    first, best
        The first calibration of the first architecture, and the one with the smallest error.
    """
    if not math.isfinite(best.error_deg):
        return None
    return Regret(first, first if first.error_deg == best.error_deg else best)


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
        "Power": "median power of",
        "Volume": "median mass (no volumes are tabled) of",
        "Cost": "root of median power times median mass (no prices are published) of",
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
    sensor_count
        Built sensors that it is the median of; 0 for what is measured here.
    """

    task: str
    unit: str
    value: float | None
    sensor_count: int = 0

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
            return f"{said}, of the most accurate calibration"
        plural = "s" * (self.sensor_count > 1)
        return f"{said}, {_WORDS[self.task]} {self.sensor_count} built sensor{plural}"

    def to_dict(self) -> dict[str, object]:
        """Return the measure as in the HTTP answer."""
        return {
            "task": self.task,
            "value": self.value,
            "unit": self.unit,
            "basis": "published" if self.task in _PUBLISHED else "measured",
            "built": self.sensor_count,
            "words": self.words,
        }


def task_measures(
    tasks: Iterable[str], architecture: Architecture, row: MeasuredPipeline | None, error_deg: float
) -> tuple[TaskMeasure, ...]:
    """Return the own measures of tasks, in their order.

    Parameters
    ----------
    tasks
        Of the taxonomy.
    architecture
        Detector and mask.
    row, error_deg
        The pipeline with the smallest error there, and that error; infinite where it is not judged.
    """
    return tuple(_measure(task, architecture, row, error_deg) for task in tasks)


def joint_cost(measures: Sequence[TaskMeasure]) -> float:
    """Return one number of several measures, the less the better: their geometric mean.

    So a ratio counts alike in each. Infinite where one is not known.
    """
    costs = [measure.cost for measure in measures]
    if not all(map(math.isfinite, costs)):
        return math.inf
    return math.exp(math.fsum(map(math.log, costs)) / len(costs))


def _measure(
    task: str, architecture: Architecture, row: MeasuredPipeline | None, error_deg: float
) -> TaskMeasure:
    unit = _UNITS[task]
    if task in _PUBLISHED:
        value, built = _published_medians().get(architecture, {}).get(task, (None, 0))
        return TaskMeasure(task, unit, value, built)
    judged = row if math.isfinite(error_deg) else None
    half_fov_deg = None if judged is None else judged.half_fov_deg
    found = {
        "Accuracy": error_deg,
        "Precision": None if judged is None else judged.nominal.repeatability_deg,
        "FOV": None if half_fov_deg is None else 2.0 * half_fov_deg,
        "Latency": None if row is None else row.latency_us,
    }[task]
    known = found is not None and math.isfinite(found) and found > 0.0
    return TaskMeasure(task, unit, found if known else None)


@cache
def _published_medians() -> Mapping[Architecture, Mapping[str, tuple[float, int]]]:
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

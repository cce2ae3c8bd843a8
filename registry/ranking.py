"""The order of an answer: what was built first, then both kinds of evidence, then the error.

Where one task is asked for, its own measure takes the place of the error: repeatability, field,
time, or what makers publish of at least three distinct products. Where fewer are known the number
of studies with that task decides. Several tasks are ordered by the sum of the places in each.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from types import MappingProxyType
from typing import Literal

from registry.designs import Place
from registry.measured_pipelines import MeasuredPipeline

Sort = Literal["evidence", "error", "studies"]
SORTS: tuple[Sort, ...] = ("evidence", "error", "studies")
"""Orders of an answer; the first is the usual one."""

ALIKE = 1.1
"""Errors within this ratio of the first of their group share its rank."""

FEWEST_PRODUCTS = 3
"""Distinct products below which a median is not formed."""

_UNITS = MappingProxyType(
    {"Accuracy": "deg", "Precision": "deg", "FOV": "deg", "Latency": "us", "Power": "mW",
     "Volume": "g", "Cost": ""}
)  # fmt: skip
_PUBLISHED = MappingProxyType({"Power": ("power_mw", "power"), "Volume": ("mass_g", "mass")})


@dataclass(frozen=True)
class TaskMeasure:
    """A task's own measure of an architecture.

    Attributes
    ----------
    task, unit
        Of the taxonomy; of the value.
    value
        None where too little is known: then the number of studies orders.
    products, low, high
        Distinct products of the median, and their range; 0 and None for what is measured.
    words
        The same as a sentence.
    """

    task: str
    unit: str
    value: float | None
    words: str
    products: int = 0
    low: float | None = None
    high: float | None = None

    @property
    def cost(self) -> float:
        """The value as a number of which less is better; infinite where there is none."""
        if self.value is None:
            return math.inf
        return -self.value if self.task == "FOV" else self.value


def task_measure(
    task: str, place: Place, row: MeasuredPipeline | None, error_deg: float, factor: float
) -> TaskMeasure:
    """Return a task's own measure of an architecture.

    `row` and `error_deg` are its most accurate pipeline and the error shown, None and infinite for
    none; `factor` is the time of the reader's processor over that of the published times.
    """
    unit = _UNITS[task]
    if task in _PUBLISHED:
        return _of_products(task, place)
    if task == "Cost":
        return TaskMeasure(task, unit, None, "Cost: no prices are published; ordered by studies")
    found = None
    if task == "Accuracy":
        found = error_deg
    elif row is not None and task == "Precision":
        found = row.nominal.repeatability_deg
    elif row is not None and task == "FOV":
        found = None if row.half_fov_deg is None else 2.0 * row.half_fov_deg
    elif row is not None and row.latency_us is not None:
        found = row.latency_us * factor
    if found is None or not math.isfinite(found) or not found:
        return TaskMeasure(task, unit, None, f"{task}: not measured")
    words = f"{task}: {found:.3g} {unit}, of the most accurate calibration"
    return TaskMeasure(task, unit, found, words)


def _of_products(task: str, place: Place) -> TaskMeasure:
    """Return the median over distinct products; without a value for fewer than three."""
    column, noun = _PUBLISHED[task]
    drawn = [p for p in place.products if getattr(p, column) is not None]
    values = sorted(getattr(p, column) for p in drawn)
    own = (
        [p.family for p in place.products if p.supply == "self-powered"] if task == "Power" else []
    )
    also = f"; self-powered: {', '.join(own)}" if own else ""
    unit, count = _UNITS[task], len(values)
    if count < FEWEST_PRODUCTS:
        known = f"{count} product{'s' * (count != 1)} with a published {noun}"
        words = f"{task}: {known}, too few for a median; ordered by studies{also}"
        return TaskMeasure(task, unit, None, words, count)
    middle, low, high = median(values), values[0], values[-1]
    said = f"{middle:.3g} {unit}, median {noun} of {count} products ({low:g} to {high:g} {unit})"
    return TaskMeasure(task, unit, middle, f"{task}: {said}{also}", count, low, high)


def joint_order(costs: Sequence[Sequence[tuple[float, ...]]]) -> list[float]:
    """Return for each architecture the sum of its places in the orders of several tasks.

    `costs` is for each task what each architecture is ordered by.
    """
    total = [0.0] * len(costs[0])
    for of_task in costs:
        distinct = {cost: at for at, cost in enumerate(sorted(set(of_task)))}
        total = [before + distinct[cost] for before, cost in zip(total, of_task, strict=True)]
    return total


def in_words(sort: Sort, tasks: Sequence[str], *, asked: bool, by_class: bool) -> str:
    """Return the order of an answer as a sentence."""
    if not asked:
        return "No requirement, so no ranking: ordered by the number of studies and products."
    first = "Architectures that studies or products realise come before those never built"
    if sort == "studies":
        return f"{first}; then by the number of studies and products."
    if sort == "error":
        return f"{first}; then by error."
    by = "error"
    if by_class:
        by = "the number of studies and products that report the class"
    elif len(tasks) == 1:
        by = f"the measure of {tasks[0]}, or studies of {tasks[0]} where it is unknown"
    elif tasks:
        by = f"the sum of their places by {', '.join(tasks)}"
    return (
        f"{first}; among these, those that meet the requirements by reports and by measurement, "
        f"then by reports, then by measurement alone; in each by {by}. Errors within "
        f"{100 * (ALIKE - 1):.0f} % or not separable over units share a rank."
    )

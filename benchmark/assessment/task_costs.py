"""What an architecture costs by the tasks asked for, by arithmetic of its own.

The oracle of `registry.ranking.task_measures`: stored rows and the table of built sensors alone.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from functools import cache
from statistics import geometric_mean
from typing import Any

import pandas as pd

from survey_data.descriptor import DATA_DIRECTORY

Row = Mapping[str, Any]


def joint_cost(tasks: Iterable[str], pair: tuple[str, str], error: float, row: Row) -> float:
    """Return the geometric mean of the costs of tasks, of the error where there are none.

    Parameters
    ----------
    tasks
        Of the taxonomy.
    pair
        Detector and mask.
    error, row
        Of the calibration that errs least on it: what it is judged by, and its stored row.
    """
    costs = [_cost(task, pair, error, row) for task in tasks] or [error]
    return geometric_mean(costs) if all(map(math.isfinite, costs)) else math.inf


def _cost(task: str, pair: tuple[str, str], error: float, row: Row) -> float:
    if task == "Accuracy":
        return error
    if task == "Precision":
        return row["repeatability_deg"] or math.inf
    if task == "FOV":
        return 180.0 / (row["half_fov_deg"] or 180.0)  # None means the whole sphere
    if task == "Latency":
        return math.inf  # stored pipelines are not timed
    built = _build()
    built = built[(built["detector"] == pair[0]) & (built["mask"] == pair[1])]
    power, mass = built["power_mw"].median(), built["mass_g"].median()
    power = power if math.isnan(power) else max(power, 1.0)
    cost = {"Power": power, "Volume": mass, "Cost": math.sqrt(power * mass)}[task]
    return math.inf if math.isnan(cost) else float(cost)


@cache
def _build() -> pd.DataFrame:
    return pd.read_csv(DATA_DIRECTORY / "hardware.csv")

"""How much a method is worth: its share of right answers less its share of wrong ones."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from algorithms.contract import Floats

Row = Mapping[str, Any]


def worths(row: Row, method: Row, *, scoring: bool) -> Floats:
    """Worth on each of the units that score, or of those that choose."""
    found, answered, frames = (
        _of_units(row, counts, scoring=scoring)
        for counts in (method["found"], method["answered"], row["frames"])
    )
    return np.asarray((2.0 * found - answered) / frames)


def member(row: Row, fault: Row, *, learned: bool) -> Row:
    """Return the method of a family that is worth most on the units that choose."""
    family = [one for one in fault["methods"] if one["learned"] == learned]
    return max(family, key=lambda one: float(worths(row, one, scoring=False).mean()))


def pooled(row: Row, fault: Row) -> list[dict[str, Any]]:
    """Return counts of every method over the units that score, and its error in right answers."""
    frames = int(_of_units(row, row["frames"], scoring=True).sum())
    found = []
    for one in fault["methods"]:
        right = _of_units(row, one["found"], scoring=True)
        answered = int(_of_units(row, one["answered"], scoring=True).sum())
        sizes = _of_units(row, [size or 0.0 for size in one["error_deg"]], scoring=True)
        error = math.sqrt(float((right * sizes**2).sum() / right.sum())) if right.any() else None
        found.append(
            {
                "method": one["method"],
                "learned": one["learned"],
                "frames": frames,
                "answered": answered,
                "right": int(right.sum()),
                "wrong": answered - int(right.sum()),
                "worth": round((2.0 * float(right.sum()) - answered) / frames, 4),
                "error_deg": None if error is None else float(f"{error:.4g}"),
                "overlap": one["overlap"],
            }
        )
    return found


def leaders(row: Row, fault: Row) -> list[dict[str, Any]]:
    """Return what came of the leading extractor, bare and under the network's mask."""
    by = {one["method"]: one for one in pooled(row, fault)}
    return [by[row["leader"]], by[f"U-Net, {row['leader']}"]]


def fault_of(row: Row, name: str) -> Row:
    """Return the part of a row that is of a fault."""
    return next(fault for fault in row["faults"] if fault["fault"] == name)


def _of_units(row: Row, numbers: Any, *, scoring: bool) -> Floats:
    odd = np.array(row["units"]) % 2 == 1
    return np.asarray(np.array(numbers, dtype=np.float64)[odd if scoring else ~odd])

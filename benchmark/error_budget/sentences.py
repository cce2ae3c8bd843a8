"""State the main error source of a pipeline, in a sentence.

Errors of independent parts add as squares. What a part contributes is the root of the squares'
difference between the chain as it is and the chain with that part perfect; of extractor, model
and number of poses, between steps of the chain in which all else is perfect.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from benchmark.error_budget.variants import SINGLE

Row = Mapping[str, Any]

#: Ratio of the RMS of unit 0 to its bound up to which no error source is named.
NEAR = 2.0

#: Every part, in the order of ties, with what it is called.
PARTS: Mapping[str, str] = {
    "lamp": "the lamp of the calibration bench",
    "calibration_noise": "noise of the calibration readings",
    "noise": "noise of the readings",
    "references": "noise of the dark and flat readings",
    "fixed_pattern": "the fixed pattern of detector elements and mask",
    "surroundings": "the orbit (Earth light, drift, ageing)",
    "poses": "the number of calibration poses",
    "extractor": "the extractor's bias",
    "model": "a model that does not describe the sensor fully",
    "method": "extractor and model together",
}
_WITHOUT: Mapping[str, str] = {
    "lamp": "with an even, steady lamp",
    "calibration_noise": "with a noise-free calibration",
    "noise": "with noise-free readings",
    "references": "with the unit's true dark signals and gains",
    "fixed_pattern": "with identical detector elements and the mask as drawn",
    "surroundings": "without Earth light, drift and ageing",
}


@dataclass(frozen=True)
class MainErrorSource:
    """Main error source of a pipeline.

    `parts_deg` is what each part contributes, root mean square; parts that were not measured are
    left out. Near its bound is what is within `NEAR` of it.
    """

    is_near_bound: bool
    parts_deg: Mapping[str, float]
    leading_part: str
    sentence: str


def bound_of(row: Row) -> float:
    """Return the bound a pipeline is held against, degrees.

    For a unit known by its dark and flat readings; for a known unit where there are none.
    """
    unit = row["bound_unit_deg"]
    return float(row["bound_deg"] if unit is None else unit)


def verdict(row: Row) -> MainErrorSource:
    """Judge a row of `benchmark.error_budget.table`."""
    parts = contributions(row)
    leading = max(parts, key=lambda part: parts[part])
    ratio = row["rms_deg"] / bound_of(row)
    said = f"`{row['dataset']}`: the RMS of {row['extractor']} + {row['model']} on unit 0 is "
    said += f"{degrees(row['rms_deg'])}, {times(ratio)} its bound"
    if ratio <= NEAR:
        return MainErrorSource(True, parts, leading, f"{said}.")
    said += f"{_judged(row)}; {_measured(row, leading)}. {_blame(row, parts, leading)}."
    return MainErrorSource(False, parts, leading, said)


def contributions(row: Row) -> dict[str, float]:
    """Return what each part that was measured contributes to the error, root mean square."""
    error = {name.removesuffix("_deg"): row[name] for name in row if name.endswith("_deg")}
    whole = error["as_is"]
    found = {
        part: _root(whole, error[part])
        for part in SINGLE
        if error[part] is not None and whole is not None
    }
    rest, dense = error["perfect"], error["perfect_dense"]
    if rest is None:
        return found
    if dense is not None:
        found["poses"] = _root(rest, dense)
        rest = min(rest, dense)
    places = error["places"] if dense is None else error["places_dense"]
    if places is None:
        return {**found, "method": rest}
    model = min(places, rest)
    return {**found, "extractor": _root(rest, model), "model": model}


def degrees(angle: float) -> str:
    """Say an angle with two digits; what is below a millionth of a degree is none."""
    if angle < 1e-6:
        return "less than 1e-6 deg"
    digits = 1 - math.floor(math.log10(angle))
    return f"{angle:.{max(digits, 0)}f} deg"


def times(ratio: float) -> str:
    """Say a ratio with two digits, or whole."""
    return f"{ratio:.0f} times" if ratio >= 9.95 else f"{ratio:.1f} times"


def _root(whole: float, part: float) -> float:
    return math.sqrt(max(whole**2 - part**2, 0.0))


def _measured(row: Row, part: str) -> str:
    """Say what error is left with a part made perfect."""
    if part in _WITHOUT:
        return f"{_WITHOUT[part]} it is {_against(row, part)}"
    said = f"with calibration, unit and readings perfect it is {_against(row, 'perfect')}"
    if part == "extractor":
        return f"{said}, with the true spot positions {degrees(row['places_deg'])}"
    if row["places_deg"] is not None and part == "model":
        return f"{said}, with the true spot positions {_against(row, 'places')}"
    if row["perfect_dense_deg"] is not None:
        return f"{said}, fitted to the test poses as well {degrees(row['perfect_dense_deg'])}"
    return said


def _against(row: Row, variant: str) -> str:
    error = row[f"{variant}_deg"]
    return f"{degrees(error)} ({times(error / bound_of(row))})"


def _blame(row: Row, parts: Mapping[str, float], part: str) -> str:
    most = parts[part] ** 2 > 0.5 * row["as_is_deg"] ** 2
    ratio = parts[part] / bound_of(row)
    name = PARTS[part]
    if part == "noise" and ratio > NEAR:
        name = f"noise, {times(ratio)} what the bound allows (the extractor does not use all light)"
    return f"{'Main' if most else 'Largest'} error source: {name}"


def _judged(row: Row) -> str:
    if row["judged"] >= 0.99 * row["answered"]:
        return ""
    return f" (below, over {row['judged']} of its {row['answered']} answers)"

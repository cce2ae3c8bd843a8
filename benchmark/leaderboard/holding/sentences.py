"""What a row of the table says in words: the part of the chain that holds a pipeline back.

Errors of independent parts add as squares. What a part contributes is the root of the squares'
difference between the chain as it is and the chain with that part perfect; of extractor, model
and number of poses, between steps of the chain in which all else is perfect.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from benchmark.leaderboard.holding.measure import SINGLE

Row = Mapping[str, Any]

#: A pipeline this close to its bound is not held back by anything.
NEAR = 1.5

#: Every part, in the order of ties, with what it is called.
PARTS: Mapping[str, str] = {
    "reference": "the calibration's own reference",
    "lamp": "the lamp of the calibration",
    "calibration_noise": "noise of the calibration's readings",
    "noise": "noise of the readings",
    "fixed_pattern": "the fixed pattern",
    "surroundings": "what changes in orbit",
    "poses": "the distance between the calibration's poses",
    "extractor": "the extractor's systematic error",
    "model": "the model",
}
_WITHOUT: Mapping[str, str] = {
    "reference": "told the calibration's directions rightly it errs by",
    "lamp": "calibrated before an even, steady lamp it errs by",
    "calibration_noise": "calibrated without noise it errs by",
    "noise": "read without noise it errs by",
    "fixed_pattern": "on a unit whose elements are alike it errs by",
    "surroundings": "without light from the Earth, drift and ageing it errs by",
}


@dataclass(frozen=True)
class Verdict:
    """What holds one pipeline back.

    Attributes
    ----------
    near
        Whether it is within `NEAR` of its bound.
    parts_deg
        What each part contributes, root mean square; parts that were not measured are left out.
    leading
        The part that contributes most.
    sentence
        In words, with the numbers.
    """

    near: bool
    parts_deg: Mapping[str, float]
    leading: str
    sentence: str


def verdict(row: Row) -> Verdict:
    """Judge a row of `benchmark.leaderboard.holding.table`."""
    parts = contributions(row)
    ranked = sorted(parts, key=lambda part: -parts[part])
    ratio = row["rms_deg"] / row["bound_deg"]
    said = f"`{row['dataset']}`: {row['extractor']} + {row['model']} errs by "
    said += f"{degrees(row['rms_deg'])}, {times(ratio)} its bound"
    if ratio <= NEAR:
        return Verdict(True, parts, ranked[0], f"{said}: within {NEAR:g} of it.")
    measured, after = _measured(row, ranked[0])
    said += f"{_judged(row)}; {measured}: {_blame(row, parts, ranked[0])}."
    if after is not None and after > NEAR * row["bound_deg"] and len(ranked) > 1:
        second = ranked[1]
        said += f" Next comes {PARTS[second]}, {degrees(parts[second])}."
    return Verdict(False, parts, ranked[0], said)


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
        return {**found, "model": rest}
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


def _measured(row: Row, part: str) -> tuple[str, float | None]:
    """Say what was measured of a part, and what error is left without it; None where all is."""
    bound = row["bound_deg"]
    if part in _WITHOUT:
        left = row[f"{part}_deg"]
        return f"{_WITHOUT[part]} {degrees(left)} ({times(left / bound)})", left
    rest = row["perfect_deg"]
    still = "even" if rest > row["as_is_deg"] else "still"
    said = f"with calibration, unit and readings perfect it {still} errs by "
    said += f"{degrees(rest)} ({times(rest / bound)}), "
    dense = row["perfect_dense_deg"]
    if part == "poses":
        return f"{said}fitted to the test poses as well by {degrees(dense)}", dense
    if part == "extractor":
        places = row["places_deg"]
        return f"{said}with the spots' true places by {degrees(places)}", places
    if row["places_deg"] is not None:
        return f"{said}with the spots' true places still by {degrees(row['places_deg'])}", None
    if dense is not None:
        return f"{said}fitted to the test poses as well by {degrees(dense)}", None
    return said.removesuffix(", "), None


def _blame(row: Row, parts: Mapping[str, float], part: str) -> str:
    most = parts[part] ** 2 > 0.5 * row["as_is_deg"] ** 2
    if part == "noise" and parts[part] > NEAR * row["bound_deg"]:
        name = f"noise, {times(parts[part] / row['bound_deg'])} what the bound allows, "
        name += "by an extractor that does not use all light"
    else:
        name = PARTS[part]
    return f"{name} holds it back" + ("" if most else " most")


def _judged(row: Row) -> str:
    if row["judged"] >= 0.99 * row["answered"]:
        return ""
    return f" (below, over {row['judged']} of its {row['answered']} answers)"

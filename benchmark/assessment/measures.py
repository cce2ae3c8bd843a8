"""The quantities of the assessment's definitions, computed from stored rows.

Each function takes the rows of one implementation and returns (value, where measured) for every
series that has the sweep; NaN where the method does not do it at all, which scores 0. Where there
is nothing to compute from, `Unmeasured` says why.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from benchmark.assessment.definitions import (
    BLOOMING_DATASET,
    CONDITION,
    DETECTOR_GROUPS,
    FOUND,
    MASK_GROUPS,
)

Row = Mapping[str, Any]
Values = list[tuple[float, str]]
#: Rows of one sweep of one series by point.
Points = Mapping[str, Row]

_NOISE_TIMES_BOUND = 3.0
_LEVELS = (10.0, 200.0)


class Unmeasured(ValueError):  # noqa: N818 - a state, not a mistake
    """Nothing stored to compute a quantity from; the message says why."""


def _series(rows: Sequence[Row], sweep: str) -> Iterator[tuple[str, Points]]:
    """Give each series that has a sweep, with its points; Unmeasured where none has."""
    found: dict[str, dict[str, Row]] = {}
    for row in rows:
        if row["sweep"] == sweep and row["n"]:  # without samples: the design was refused
            found.setdefault(row["series"], {})[row["point"]] = row
    if not found:
        refusals = [f"{r['series'] or 'any series'}: {r['reason']}" for r in rows if not r["sweep"]]
        why = f" ({'; '.join(refusals)})" if refusals else ""
        measured = "no reference feature of its kind has" if rows else "nothing is stored of"
        raise Unmeasured(f"{measured} the sweep `{sweep}`{why}")
    yield from found.items()


def _good(row: Row | None) -> bool:
    """Say whether enough was found for an error to mean something."""
    return row is not None and row["rms"] is not None and row["found_fraction"] >= FOUND


def _ratio(sweep: str, changed: str, plain: str, rows: Sequence[Row]) -> Values:
    """Return the rms error at one point over that at another."""
    return [
        (
            points[changed]["rms"] / points[plain]["rms"]
            if _good(points.get(changed)) and _good(points.get(plain))
            else math.nan,
            series,
        )
        for series, points in _series(rows, sweep)
    ]


def _profile(rows: Sequence[Row]) -> Values:
    found: Values = []
    for series, points in _series(rows, "profile"):
        if all(_good(points.get(name)) for name in ("flat", "gaussian")):
            ratio = points["flat"]["over_bound"] / points["gaussian"]["over_bound"]
            found.append((max(ratio, 1.0 / ratio), series))
        else:
            found.append((math.nan, series))
    return found


def _features(rows: Sequence[Row]) -> Values:
    if rows and not any(row["sweep"] == "features" for row in rows):
        refused = any(
            row["series"] in ("grid", "slits") and row["status"] == "refused" for row in rows
        )
        if refused:
            return [(0.0, "refuses several features")]
    found: Values = []
    for series, points in _series(rows, "features"):
        ordered = sorted(points.values(), key=lambda row: row["value"])
        one, most = ordered[0], ordered[-1]
        if one["value"] != 1.0:
            continue  # does not read a single feature: no gain to speak of
        if len(ordered) > 1 and one["rms"] and _good(most):
            ideal = math.sqrt(most["value"] / one["value"])
            found.append((one["rms"] / most["rms"] / ideal, series))
        else:
            found.append((math.nan, series))
    if not found:
        raise Unmeasured("does not read a single feature, so that no gain can be told")
    return found


def _tracking(rows: Sequence[Row]) -> Values:
    return [
        (row["kept_fraction"] if row["kept_fraction"] is not None else math.nan, series)
        for series, points in _series(rows, "tracking")
        for row in points.values()
    ]


def _resolution(rows: Sequence[Row]) -> Values:
    found: Values = []
    for series, points in _series(rows, "size"):
        if all(_good(row) for row in points.values()):
            size = np.array([row["value"] for row in points.values()])
            error = np.array([row["rms"] for row in points.values()])
            slope = np.polyfit(np.log(size), np.log(error / size), 1)[0]
            found.append((float(slope), series))
        else:
            found.append((math.nan, series))
    return found


def _sub_pixel(rows: Sequence[Row]) -> Values:
    return [
        (
            math.sqrt(np.mean([row["rms"] ** 2 for row in points.values()]))
            if all(_good(row) for row in points.values())
            else math.nan,
            series,
        )
        for series, points in _series(rows, "phase")
    ]


def _precision(rows: Sequence[Row]) -> Values:
    found: Values = []
    for series, points in _series(rows, "reference"):
        row = points.get(series)  # the disc's other reference set is the profile's business
        found.append((row["over_bound"] if row and _good(row) else math.nan, series))
    return found


def _robust(rows: Sequence[Row]) -> Values:
    found: Values = []
    for series, points in _series(rows, "noise"):
        lowest = math.nan
        start = 50.0 if series != "disc" else 43.4  # the reference setting's own
        for row in sorted(points.values(), key=lambda one: -one["value"]):
            if row["value"] > start * 1.2:
                continue
            if not (_good(row) and row["over_bound"] <= _NOISE_TIMES_BOUND):
                break
            lowest = row["value"]
        found.append((lowest, series))
    return found


def _level(rows: Sequence[Row]) -> Values:
    found: Values = []
    for series, points in _series(rows, "noise"):
        chosen = [r for r in points.values() if _LEVELS[0] <= r["value"] <= _LEVELS[1]]
        ratios = [row["over_bound"] for row in chosen if _good(row)]
        complete = len(ratios) == len(chosen) > 1
        found.append((max(ratios) / min(ratios) if complete else math.nan, series))
    return found


SWEPT: Mapping[str, Callable[[Sequence[Row]], Values]] = {
    "No pre-processing": partial(_ratio, "pedestal", "0.5", "0"),
    "Feature profile agnostic": _profile,
    "Multi-feature": _features,
    "Feature tracking": _tracking,
    "Resolution scaling": _resolution,
    "Sub-pixel resolution": _sub_pixel,
    "High precision": _precision,
    "Feature location agnostic": partial(_ratio, "location", "anywhere", "middle"),
    "Robust to noise": _robust,
    "Noise level agnostic": _level,
    "Robust to missing features": partial(_ratio, "missing", "0.2", "0"),
}


def _applies(wanted: Callable[[str, str, str], bool], rows: Sequence[Row]) -> Values:
    """Return the smallest rms error over datasets; NaN where the method reads none of them."""
    if not rows:
        raise Unmeasured("no published score")
    good = [
        (row["rms_deg"], f"{row['dataset']} with {row['model']}")
        for row in rows
        if row["condition"] == CONDITION
        and row["status"] == "ok"
        and row["rms_deg"] is not None
        and row["availability"] is not None
        and row["availability"] >= FOUND
        and wanted(row["dataset"], row["mask"], row["detector"])
    ]
    return [min(good)] if good else [(math.nan, "")]


def _mask(group: str) -> Callable[[Sequence[Row]], Values]:
    named = frozenset().union(*MASK_GROUPS.values())
    members = MASK_GROUPS.get(group)
    return partial(_applies, lambda _d, mask, _t: mask in members if members else mask not in named)


def _detector(group: str) -> Callable[[Sequence[Row]], Values]:
    named = frozenset().union(*DETECTOR_GROUPS.values())
    members = DETECTOR_GROUPS.get(group)
    return partial(_applies, lambda _d, _m, kind: kind in members if members else kind not in named)


SCORED: Mapping[str, Callable[[Sequence[Row]], Values]] = {
    **{name: _mask(name) for name in ("Pinhole Mask", "Slit Mask", "Other Mask")},
    **{name: _detector(name) for name in ("CMOS Detector", "CCD Detector", "Other Detector")},
    "Blooming features": partial(_applies, lambda name, _m, _t: name == BLOOMING_DATASET),
}

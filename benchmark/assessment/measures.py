"""The quantities of the assessment's definitions, computed from stored rows.

Each function takes the rows of one implementation and returns a quantity for every series that has
the sweep; NaN, with the reason, where the method was run and does not do it, which scores 0. Where
there is nothing to compute from, `NotMeasuredError` says why.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from benchmark.assessment.definitions import (
    BLOOMING_DATASET,
    CONDITION,
    DETECTOR_GROUPS,
    FOUND,
    MASK_GROUPS,
)

Row = Mapping[str, Any]
#: Rows of one sweep of one series by point.
Points = Mapping[str, Row]

_NOISE_TIMES_BOUND = 3.0
_LEVELS = (10.0, 200.0)


class Quantity(NamedTuple):
    """A measured number; NaN where the method was run and does not do it.

    In the unit of its definition, with the series or data set it comes from and what a NaN stands
    for.
    """

    value: float
    where: str
    why: str = ""


Values = list[Quantity]


class NotMeasuredError(ValueError):
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
        raise NotMeasuredError(f"{measured} the sweep `{sweep}`{why}")
    yield from found.items()


def _each(sweep: str, of: Callable[[str, Points], Quantity], rows: Sequence[Row]) -> Values:
    """Return the quantity of each series that has it; Unmeasured where none has."""
    found: Values = []
    reasons = []
    for series, points in _series(rows, sweep):
        try:
            found.append(of(series, points))
        except NotMeasuredError as reason:
            reasons.append(f"{series}: {reason}")
    if not found:
        raise NotMeasuredError("; ".join(reasons))
    return found


def _lacking(row: Row) -> str:
    """Say why a row's error means nothing, or empty."""
    at = f"{row['sweep']} `{row['point']}`"
    if row["status"] != "ok":
        return f"{row['status']} at {at}: {row['reason']}"
    if row["rms"] is None or row["found_fraction"] < FOUND:
        return f"{row['found_fraction'] or 0.0:.0%} found at {at}"
    return ""


def _quantity(
    series: str, points: Points, names: Sequence[str], compute: Callable[..., float]
) -> Quantity:
    """Compute from the rows of named points; NaN where one of them has no error to speak of."""
    if absent := [name for name in names if name not in points]:
        raise NotMeasuredError(
            f"its design is refused at {', '.join(f'`{name}`' for name in absent)}"
        )
    rows = [points[name] for name in names]
    if why := next(filter(None, map(_lacking, rows)), ""):
        return Quantity(math.nan, series, why)
    return Quantity(compute(*rows), series)


def _error(row: Row, key: str) -> float:
    if row[key] is None:
        raise NotMeasuredError(f"no bound at {row['sweep']} `{row['point']}`")
    return float(row[key])


def _growth(key: str, plain: str, changed: str, series: str, points: Points) -> Quantity:
    """Return an error (`rms` or `over_bound`) at one point over that at another."""
    return _quantity(series, points, (plain, changed), lambda p, c: _error(c, key) / _error(p, key))


def _spread(key: str, names: Sequence[str], series: str, points: Points) -> Quantity:
    """Return the largest over the smallest error at the named points."""

    def spread(*rows: Row) -> float:
        errors = [_error(row, key) for row in rows]
        return max(errors) / min(errors)

    return _quantity(series, points, names, spread)


def _noise_levels(series: str, points: Points) -> Quantity:
    names = [name for name, r in points.items() if _LEVELS[0] <= r["value"] <= _LEVELS[1]]
    if len(names) < 2:
        raise NotMeasuredError("fewer than two noise levels to compare")
    return _spread("rms", names, series, points)


def _features(rows: Sequence[Row]) -> Values:
    if rows and not any(row["sweep"] == "features" for row in rows):
        refused = next(
            (r for r in rows if r["series"] in ("grid", "slits") and r["status"] == "refused"), None
        )
        if refused:
            return [Quantity(0.0, "refuses several features", refused["reason"])]
    found: Values = []
    for series, points in _series(rows, "features"):
        ordered = sorted(points.values(), key=lambda row: row["value"])
        one, most = ordered[0], ordered[-1]
        if one["value"] != 1.0:
            continue  # does not read a single feature: no gain to speak of
        why = "refuses more than one feature" if one is most else _lacking(most)
        if why or not one["rms"]:
            found.append(Quantity(math.nan, series, why or _lacking(one)))
            continue
        # the gain over independent features, of which n are root of n times as precise as one
        ideal = math.sqrt(most["value"] / one["value"])
        found.append(Quantity(one["rms"] / most["rms"] / ideal, series))
    if not found:
        raise NotMeasuredError("does not read a single feature, so that no gain can be determined")
    return found


def _tracking(series: str, points: Points) -> Quantity:
    (row,) = points.values()
    if row["kept_fraction"] is None:
        return Quantity(math.nan, series, _lacking(row) or "no position to compare")
    return Quantity(row["kept_fraction"], series)


def _resolution(series: str, points: Points) -> Quantity:
    def slope(*rows: Row) -> float:
        size = np.array([row["value"] for row in rows])
        error = np.array([row["rms"] for row in rows])
        return float(np.polyfit(np.log(size), np.log(error / size), 1)[0])

    return _quantity(series, points, list(points), slope)


def _sub_pixel(series: str, points: Points) -> Quantity:
    return _quantity(
        series,
        points,
        list(points),
        lambda *rows: math.sqrt(np.mean([row["rms"] ** 2 for row in rows])),
    )


def _precision(series: str, points: Points) -> Quantity:
    # the point of the series' own name: the disc's other reference set is the profile's business
    return _quantity(series, points, (series,), lambda row: float(row["over_bound"]))


def _robust(series: str, points: Points) -> Quantity:
    start = 50.0 if series != "disc" else 43.4  # the reference setting's own
    lowest, why = math.nan, "no level at or below the reference setting"
    for row in sorted(points.values(), key=lambda one: -one["value"]):
        if row["value"] > start * 1.2:
            continue
        if failure := _lacking(row):
            why = failure
            break
        if row["over_bound"] > _NOISE_TIMES_BOUND:
            why = f"{row['over_bound']:.3g} times the bound at peak SNR {row['value']:g} already"
            break
        lowest = row["value"]
    return Quantity(lowest, series, why if math.isnan(lowest) else "")


SWEPT: Mapping[str, Callable[[Sequence[Row]], Values]] = {
    "Feature profile agnostic": partial(
        _each, "profile", partial(_spread, "over_bound", ("flat", "gaussian"))
    ),
    "Multi-feature": _features,
    "Feature tracking": partial(_each, "tracking", _tracking),
    "Resolution scaling": partial(_each, "size", _resolution),
    "Sub-pixel resolution": partial(_each, "phase", _sub_pixel),
    "High precision": partial(_each, "reference", _precision),
    "Feature location agnostic": partial(
        _each, "location", partial(_growth, "over_bound", "middle", "anywhere")
    ),
    "Robust to noise": partial(_each, "noise", _robust),
    "Noise level agnostic": partial(_each, "noise", _noise_levels),
    "Robust to missing features": partial(_each, "missing", partial(_growth, "rms", "0", "0.2")),
}


def _applies(wanted: Callable[[str, str, str], bool], rows: Sequence[Row]) -> Values:
    """Return the smallest rms error over datasets; NaN where the method answers too seldom."""
    if not rows:
        raise NotMeasuredError("no published score")
    tried = [
        row
        for row in rows
        if row["condition"] == CONDITION and wanted(row["dataset"], row["mask"], row["detector"])
    ]
    if not tried:
        raise NotMeasuredError("no data set of this kind is one the method reads")
    answered = [row for row in tried if row["status"] == "ok" and row["availability"] is not None]
    if not answered:
        row = tried[0]
        raise NotMeasuredError(
            f"{row['dataset']} with {row['model']}: {row['status']}, {row['reason']}"
        )
    good = [row for row in answered if row["rms_deg"] is not None and row["availability"] >= FOUND]
    if good:
        best = min(good, key=lambda row: (row["rms_deg"], row["dataset"], row["model"]))
        return [Quantity(best["rms_deg"], f"{best['dataset']} with {best['model']}")]
    most = max(answered, key=lambda row: float(row["availability"]))
    where = f"{most['dataset']} with {most['model']}"
    return [Quantity(math.nan, where, f"answers {most['availability']:.0%} of the Suns at most")]


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

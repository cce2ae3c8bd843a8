"""Data sets beside built sensors: published figures, ours, and what explains a difference.

Accuracy stands beside the error of the best pipeline on the nominal condition, calibrated on the
data set's standard bench as built sensors are on theirs; precision beside its repeatability.
Accuracies are compared as root mean squares: three sigma and largest errors over three, unspecified
ones as they are. A sensor of a narrower field is compared over its field.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from benchmark.datasets import get, names, study_names
from benchmark.datasets.realism import HardwareMatch, figures, hardware_matches
from benchmark.metrics.ranking import order
from benchmark.metrics.rings import EDGES_DEG, field_error
from survey_data.hardware import Hardware
from survey_data.reported import reported_accuracies
from survey_data.sources import source_named

Row = Mapping[str, Any]

#: A difference by more than this factor wants a sentence.
FACTOR = 2.0
#: A sensor's field is narrower where it ends so far within the data set's.
_NARROWER_DEG = 5.0


def realism(
    rows: Iterable[Row],
    nominal: Mapping[str, str],
    known: Mapping[str, HardwareMatch] | None = None,
) -> list[dict[str, Any]]:
    """Set each data set beside the sensors that it stands for.

    `rows` are of `Store.rows`, `nominal` is the condition compared, by data set. Of each standard
    data set of the table, by name, ``sensors`` have ``accuracy_ratio`` (our error over their
    accuracy) and ``precision_ratio`` beside their figures; the data set's own ratios are 1 within
    the range of its sensors' and else those of the nearest. Numbers are None where one of the two
    is unknown. ``unexplained`` says whether a ratio is beyond `FACTOR` and no sentence says why.
    """
    best: dict[str, Row] = {}
    for row in rows:
        name = row["dataset"]
        compared = row["condition"] == nominal.get(name) and row["unit"] == 0
        if compared and row["rms_deg"] is not None and _before(row, best.get(name)):
            best[name] = row
    every = hardware_matches() if known is None else known
    compared_names = sorted(every.keys() - frozenset(study_names()))
    return [_beside(every[name], best.get(name)) for name in compared_names]


def _before(row: Row, other: Row | None) -> bool:
    place = (row["extractor"], row["model"])
    return other is None or order(row, place) < order(other, (other["extractor"], other["model"]))


def _beside(match: HardwareMatch, row: Row | None) -> dict[str, Any]:
    sensors = [_compare(sensor, row) for sensor in match.sensors]
    accuracy = nearest_ratio(sensor["accuracy_ratio"] for sensor in sensors)
    precision = nearest_ratio(sensor["precision_ratio"] for sensor in sensors)
    ours = {name: None if row is None else row[name] for name in _OURS}
    differs = any(
        ratio is not None and not 1.0 / FACTOR <= ratio <= FACTOR for ratio in (accuracy, precision)
    )
    return {
        "dataset": match.dataset,
        "idealisation": match.idealisation or None,
        **ours,
        "accuracy_ratio": accuracy,
        "precision_ratio": precision,
        "sentence": match.sentence or None,
        "unexplained": differs and not match.sentence,
        "sensors": sensors,
    }


_OURS = ("extractor", "model", "rms_deg", "bound_deg", "repeatability_deg", "half_fov_deg")


def _compare(sensor: Hardware, row: Row | None) -> dict[str, Any]:
    ours = None if row is None else _error(sensor, row)
    theirs = _accuracy_rms_deg(sensor)
    repeated = None if row is None else row["repeatability_deg"]
    return {
        **figures(sensor),
        "source_name": source_named(sensor.source).name,
        "accuracy_rms_deg": theirs,
        "our_rms_deg": ours,
        "accuracy_ratio": _over(ours, theirs),
        "precision_ratio": _over(repeated, sensor.precision_deg),
    }


def _accuracy_rms_deg(sensor: Hardware) -> float | None:
    """Return the published accuracy as a root mean square, by the rule of its kind."""
    if sensor.accuracy_deg is None:
        return None
    return reported_accuracies("accuracy", sensor.accuracy_deg, sensor.accuracy_kind).rms_deg


def _error(sensor: Hardware, row: Row) -> float | None:
    """Return our error on a bench, over the sensor's field where that is the narrower one."""
    own = _own_error(sensor, row)
    if own is None or row["dataset"] not in names():
        return own
    return math.hypot(own, get(row["dataset"]).reference_error_deg(row["condition"]))


def _own_error(sensor: Hardware, row: Row) -> float | None:
    """Return our own error over the sensor's field where that is narrower, else over ours."""
    error: float | None = row["rms_deg"]
    own = row["half_fov_deg"]
    if sensor.fov_full_deg is None:
        return error
    half = sensor.fov_full_deg / 2.0
    if half > (180.0 if own is None else own) - _NARROWER_DEG:
        return error
    within = [edge for edge in EDGES_DEG[1:] if edge <= half]
    inner = field_error(row, within[-1]) if within else None
    return error if inner is None else inner


def nearest_ratio(ratios: Iterable[float | None]) -> float | None:
    """Return 1 where ratios lie on both sides of it, else the nearest to 1; None for none."""
    known = [ratio for ratio in ratios if ratio is not None]
    if not known:
        return None
    if min(known) <= 1.0 <= max(known):
        return 1.0
    pick: Callable[[list[float]], float] = min if min(known) > 1.0 else max
    return pick(known)


def _over(ours: float | None, theirs: float | None) -> float | None:
    if ours is None or theirs is None or theirs <= 0 or not math.isfinite(ours):
        return None
    return ours / theirs

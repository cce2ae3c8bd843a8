"""What one worker does: draw a point's observations, extract with every method, compare."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Extractor, Floats, UnusableDataError
from algorithms.pipeline import check_features
from algorithms.threads import one_thread
from benchmark.metrics.separation import store
from benchmark.results.row_file import Row
from benchmark.sweeps.plan import SERIES
from benchmark.sweeps.points import Point
from benchmark.sweeps.record import NUMBERS
from benchmark.synthetic_features.series import KEPT_PX, WRONG_PX, Sample, Series, SeriesPoint


@dataclass(frozen=True)
class SweepTask:
    """What sees the observations of one point.

    Extractors by point, all of the same series and setting (None where nothing is measured), and
    why others are refused.
    """

    extractors: Mapping[Point, type[Extractor]]
    setting: SeriesPoint | None
    refused: Mapping[Point, str]


def measure(task: SweepTask) -> list[tuple[Point, Row]]:
    """Measure methods at one point, each on the same observations."""
    rows = [
        (point, _row(point, None, task.extractors[point]) | {"reason": reason})
        for point, reason in task.refused.items()
    ]
    if task.setting is None:
        return rows
    asked = [point for point in task.extractors if point not in task.refused]
    series = SERIES[asked[0].series]
    with one_thread():
        drawn = series.draw(task.setting)
        for point in asked:
            row = _measure(series, drawn, point, task.setting, task.extractors[point])
            rows.append((point, row))
    return rows


def _measure(
    series: Series, drawn: Sample, point: Point, setting: SeriesPoint, extractor: type[Extractor]
) -> Row:
    row = _row(point, setting, extractor)
    try:
        method = extractor.for_sensor(series.geometry(setting))
        # a method with a memory of frames is run with it where there is a sequence
        extract: Callable[..., Floats] = method.extract
        if setting.tracking:
            extract = getattr(method, "track", extract)
        observations = drawn.observations.copy()
        features = check_features(method, extract(observations), len(observations))
        estimates = series.estimates(features)
    except UnusableDataError as error:
        return row | {"status": "refused", "reason": _reason(error)}
    except Exception as error:  # noqa: BLE001 - any other error is reported with its name
        return row | {"status": "failed", "reason": _reason(error)}
    return row | {"status": "ok"} | _numbers(estimates, drawn, series.unit)


def _numbers(estimates: Floats, drawn: Sample, unit: str) -> Row:
    """Return the metrics of estimates (N, K); those of an axis are over two, whatever K.

    Every answer where there is no truth is wrong.
    """
    found = np.isfinite(estimates).all(axis=1)
    errors, bound = estimates - drawn.truth, drawn.bound
    off = np.sqrt(np.sum(errors**2, axis=1))
    wrong = float((found & ~(off <= WRONG_PX)).mean()) if unit == "px" else np.nan
    good = errors[np.isfinite(errors).all(axis=1)]
    squared = np.sum(good**2, axis=1)
    rms = float(np.sqrt(squared.mean() / 2.0)) if len(good) else np.nan
    bias = float(np.sqrt(np.sum(good.mean(axis=0) ** 2) / 2.0)) if len(good) else np.nan
    kept = float((squared <= KEPT_PX**2).sum() / len(errors)) if unit == "px" else np.nan
    values = (found.mean(), kept, wrong, rms, bias, bound, rms / bound)
    return {name: store(float(v)) for name, v in zip(NUMBERS, values, strict=True)}


def _row(point: Point, setting: SeriesPoint | None, extractor: type[Extractor]) -> Row:
    series = SERIES.get(point.series)
    return {
        "series": point.series,
        "sweep": point.sweep,
        "point": point.point,
        "extractor": extractor.about.name,
        "status": "refused",
        "value": setting.value if setting else None,
        "n": setting.frames if setting else 0,
        "unit": series.unit if series else "",
        **dict.fromkeys(NUMBERS),
        "reason": "",
        "extractor_taxonomy": extractor.about.taxonomy,
        "extractor_version": extractor.about.version,
    }


def _reason(error: Exception) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())}"

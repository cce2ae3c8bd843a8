"""What one worker does: draw a point's observations, extract with every method, compare."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from algorithms.contract import Extractor, Floats, UnusableDataError
from algorithms.pipeline import checked
from benchmark.metrics.score import stored
from benchmark.results.store import SWEPT
from benchmark.running.threads import one_thread
from benchmark.sweeps.plan import SERIES, Point
from benchmark.synthetic_features.series import KEPT_PX, WRONG_PX, Drawn, Series, Setting

Row = dict[str, Any]


def refused_row(point: Point, extractor: type[Extractor], reason: str) -> Row:
    """Return the row of a series that a method is not measured on."""
    return _row(point, None, extractor) | {"reason": reason}


def measure(work: Sequence[tuple[Point, Setting, type[Extractor]]]) -> list[Row]:
    """Measure methods at one point: all of `work` is of the same series and setting."""
    (first, setting, _), *_ = work
    series = SERIES[first.series]
    with one_thread():
        drawn = series.draw(setting)
        return [_measured(series, drawn, *one) for one in work]


def _measured(
    series: Series, drawn: Drawn, point: Point, setting: Setting, extractor: type[Extractor]
) -> Row:
    row = _row(point, setting, extractor)
    try:
        method = extractor.for_sensor(series.geometry(setting))
        # a method with a memory of frames is run with it where there is a sequence
        extract: Callable[..., Floats] = method.extract
        if setting.tracking:
            extract = getattr(method, "track", extract)
        observations = drawn.observations.copy()
        features = checked(method, extract(observations), len(observations))
        estimates = series.estimates(features)
    except UnusableDataError as error:
        return row | {"status": "refused", "reason": _reason(error)}
    except Exception as error:  # noqa: BLE001 - any other error is told with its name
        return row | {"status": "failed", "reason": _reason(error)}
    return row | {"status": "ok"} | _numbers(estimates, drawn, series.unit)


def _numbers(estimates: Floats, drawn: Drawn, unit: str) -> Row:
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
    return {name: stored(float(v)) for name, v in zip(SWEPT, values, strict=True)}


def _row(point: Point, setting: Setting | None, extractor: type[Extractor]) -> Row:
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
        **dict.fromkeys(SWEPT),
        "reason": "",
    }


def _reason(error: Exception) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())}"

"""What one worker does: draw a point's observations, extract with every method, compare."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import cache
from typing import Any

import numpy as np

from algorithms.contract import Extractor, Floats
from benchmark.content_key import digest, implementation_key, seed
from benchmark.content_key_closure import closure_digest
from benchmark.reference_series import KEPT_PX, Drawn, Series, Setting
from benchmark.runner_timing import one_thread
from benchmark.scoring import stored
from benchmark.sweep_plan import SERIES, Point

Row = dict[str, Any]

#: Layout of a row of sweeps.jsonl; raised when a field changes its meaning.
SWEEP_VERSION = 1
#: Numbers of a row, in order.
METRICS = ("found_fraction", "kept_fraction", "rms", "bias", "bound", "over_bound")

_code = cache(closure_digest)


def key_of(point: Point, setting: Setting | None, extractor: type[Extractor], reason: str) -> str:
    """Digest of everything a row depends on: series, setting, code and parameters."""
    if setting is None:
        return digest({"version": SWEEP_VERSION, "point": str(point), "reason": reason})
    series = SERIES[point.series]
    geometry = series.geometry(setting)
    return digest(
        {
            "version": SWEEP_VERSION,
            "series": series.name,
            "setting": asdict(setting),
            "code": _code(type(series).__module__),
            "extractor": implementation_key(
                extractor, lambda: extractor.for_sensor(geometry), _code
            ),
        }
    )


def refused_row(point: Point, extractor: type[Extractor], reason: str) -> Row:
    """Return the row of a series that a method is not measured on."""
    return _row(point, None, extractor, key_of(point, None, extractor, reason)) | {"reason": reason}


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
    row = _row(point, setting, extractor, key_of(point, setting, extractor, ""))
    try:
        _seed_opencv(seed(*str(point).split("/")))
        method = extractor.for_sensor(series.geometry(setting))
        # a method with a memory of frames is run with it where there is a sequence
        extract: Callable[..., Floats] = method.extract
        if setting.tracking:
            extract = getattr(method, "track", extract)
        features = extract(drawn.observations.copy())
        errors = series.estimates(features) - drawn.truth
    except ValueError as error:  # the contract's word for observations it cannot work on
        return row | {"status": "refused", "reason": _reason(error)}
    except Exception as error:  # noqa: BLE001 - any other error is told with its name
        return row | {"status": "failed", "reason": _reason(error)}
    return row | {"status": "ok"} | _numbers(errors, drawn.bound, series.unit)


def _numbers(errors: Floats, bound: float, unit: str) -> Row:
    """Return the metrics of errors (N, K); those of an axis are over two, whatever K."""
    found = np.isfinite(errors).all(axis=1)
    good = errors[found]
    squared = np.sum(good**2, axis=1)
    rms = float(np.sqrt(squared.mean() / 2.0)) if len(good) else np.nan
    bias = float(np.sqrt(np.sum(good.mean(axis=0) ** 2) / 2.0)) if len(good) else np.nan
    kept = float((squared <= KEPT_PX**2).sum() / len(errors)) if unit == "px" else np.nan
    values = (found.mean(), kept, rms, bias, bound, rms / bound)
    return {name: stored(float(v)) for name, v in zip(METRICS, values, strict=True)}


def _row(point: Point, setting: Setting | None, extractor: type[Extractor], key: str) -> Row:
    series = SERIES.get(point.series)
    return {
        "sweep_version": SWEEP_VERSION,
        "key": key,
        "series": point.series,
        "sweep": point.sweep,
        "point": point.point,
        "value": setting.value if setting else None,
        "extractor": extractor.name,
        "extractor_taxonomy": extractor.taxonomy,
        "extractor_version": extractor.version,
        "status": "refused",
        "reason": "",
        "n": setting.frames if setting else 0,
        "unit": series.unit if series else "",
        **dict.fromkeys(METRICS),
    }


def _reason(error: Exception) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split())}"


def _seed_opencv(value: int) -> None:
    import cv2  # noqa: PLC0415 - only the process that measures needs OpenCV

    cv2.setRNGSeed(value)

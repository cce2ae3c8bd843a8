"""What stands beside an own error on a board: the error on a calibration bench, and twins."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from benchmark.contract import ON_BENCH, Cell
from benchmark.metrics.score import METRICS
from benchmark.metrics.separation import store

Row = Mapping[str, Any]

#: Draws on which a measured error on a bench rests at least.
_FEWEST_UNITS = 10


def on_bench(rows: Iterable[Row]) -> dict[Cell, float]:
    """Return the root mean square error on drawn benches by pipeline, pooled over units.

    By the cell of the standard unit under the first condition; pipelines that were calibrated on
    benches on too few units are left out.
    """
    squares: dict[Cell, list[float]] = {}
    for row in rows:
        if row["condition"] == ON_BENCH and row["rms_all_answers_deg"] is not None:
            cell = Cell(row["dataset"], "nominal", row["extractor"], row["model"])
            squares.setdefault(cell, []).append(row["rms_all_answers_deg"] ** 2)
    return {
        cell: math.sqrt(math.fsum(found) / len(found))
        for cell, found in squares.items()
        if len(found) >= _FEWEST_UNITS
    }


def expected_on_bench(
    own_error_deg: float | None, bench_deg: float | None, measured_deg: float | None
) -> dict[str, Any]:
    """Return ``on_bench_deg`` and ``on_bench_basis`` of a pipeline.

    Where it was not measured on drawn benches it is the root of the squares of the own error and of
    the bench's: what a model that follows its calibration cannot know.
    """
    if measured_deg is not None:
        return {"on_bench_deg": store(measured_deg), "on_bench_basis": "measured"}
    if own_error_deg is None or bench_deg is None:
        return {"on_bench_deg": None, "on_bench_basis": None}
    return {
        "on_bench_deg": store(math.hypot(own_error_deg, bench_deg)),
        "on_bench_basis": "estimated",
    }


def twins_of(rows: Iterable[Row]) -> dict[tuple[str, str, str], str]:
    """Return the pipelines whose numbers are those of another throughout.

    By extractor, model and data set: the first pipeline of the same extractor with the same numbers
    under every condition and on every unit that both were scored on, as ``extractor + model``.
    Pipelines without an error have no twin.
    """
    scores: dict[
        tuple[str, str], dict[tuple[str, str], dict[tuple[str, int], tuple[Any, ...]]]
    ] = {}
    for row in rows:
        place = row["dataset"], row["extractor"]
        numbers = tuple(row[name] for name in METRICS)
        if row["rms_all_answers_deg"] is not None:
            of_model = scores.setdefault(place, {}).setdefault((row["extractor"], row["model"]), {})
            of_model[row["condition"], row["unit"]] = numbers
    found = {}
    for (dataset, _), models in scores.items():
        first: list[tuple[str, str]] = []
        for pipeline in sorted(models):
            mine = models[pipeline]
            twin = next((one for one in first if _same(models[one], mine)), None)
            if twin is None:
                first.append(pipeline)
            else:
                found[*pipeline, dataset] = " + ".join(twin)
    return found


def _same(one: Mapping[Any, Any], other: Mapping[Any, Any]) -> bool:
    shared = one.keys() & other.keys()
    return bool(shared) and all(one[place] == other[place] for place in shared)

"""The leaderboard: every pipeline on every dataset and condition, against the bound.

A board lists the best pipeline of each extractor first, which is what an engineer compares, and the
others behind; both by rank. All of it follows from stored scores: `build` renders nothing and gives
the same for the same rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import Any

from benchmark.contract import ON_BENCH, Cell
from benchmark.datasets import get, names
from benchmark.datasets.pins import Pin, Place
from benchmark.datasets.realism import hardware_match
from benchmark.leaderboard.scope import BEHIND, UNITS, Studied, studies_of_pipelines
from benchmark.metrics.ranking import RankedBoard, order, rank_board, spreads
from benchmark.metrics.rings import EDGES_DEG, field_error, widest_field
from benchmark.metrics.score import METRIC_VERSION, METRICS, is_available
from benchmark.metrics.separation import store
from benchmark.results.components import SCHEMA_VERSION
from benchmark.results.store import Store
from benchmark.results.times import Times
from benchmark.sweeps import record as sweeps

Row = Mapping[str, Any]

NOMINAL = "nominal"
#: An error that no board shows unasked.
HOPELESS_DEG = 10.0
_NOT_TIMED = Times()


def build(
    rows: Iterable[Row],
    times: Times = _NOT_TIMED,
    swept: Iterable[Row] = (),
    studied: Studied | None = None,
    pins: Mapping[Place, Pin] | None = None,
) -> dict[str, Any]:
    """Rank stored rows within each dataset and condition.

    Parameters
    ----------
    rows
        Rows of all units, as `Store.rows(unit=None)` gives them.
    times
        Of the pipelines; none by default.
    swept
        Rows of sweeps as `benchmark.sweeps.record.swept` gives them.
    studied
        Mapped studies by the pipelines they used (`scope.studies_of_pipelines`); none by default.
    pins
        Pinned data, which say what a board states once; none by default.

    Returns
    -------
    dict
        ``schema``, ``metric_version``, ``units`` (how many leading pipelines are scored on),
        ``timed_on`` (the machine of the times, null for none), ``sweeps`` (as given) and
        ``datasets``: each with ``name``, ``version``, ``detector``,
        ``mask``, ``idealisation`` (why it stands for no built sensor, null where it does),
        ``in_orbit`` (whether its samples are of a flight), ``height_mm`` (of mask or lens over the
        detector, null where there is none),
        ``conditions`` (the nominal one first), what its first condition's board states once
        (``smallest_ratio`` that it tells apart, ``quoted_deg`` of its leader on units that did not
        choose it, ``references`` used, ``bench_deg`` and ``bench_aligned_deg`` that a calibration
        bench adds, ``controls``, ``folded``: how many rows are far behind) and ``rows``. A row is
        the score row of the standard unit with ``rank`` (null where there is no error), ``group``
        (1 for what is not distinguished from the leader), ``tied`` (whether others share the rank),
        ``best_of_extractor`` (whether no other pipeline of its extractor ranks before it there),
        ``own_error_deg`` (geometric mean over units of the error over all answers), ``own_se`` (its
        relative standard error), the errors of all units ``unit_rms_deg`` and their range
        ``low_deg`` to ``high_deg`` (null where one unit is scored), ``on_bench_deg`` and
        ``on_bench_basis`` (measured on drawn benches, or estimated), ``twin_of`` (a pipeline with
        the same numbers throughout), ``folded``, ``studies`` (keys of those that used it on such a
        sensor) and times.
    """
    every = list(rows)
    spread, benches = spreads(every), on_bench(every)
    twins = twins_of(every)
    standard = [row for row in every if row["unit"] == 0 and row["condition"] != ON_BENCH]
    standard.sort(key=_order)
    datasets = []
    for name, of_dataset in groupby(standard, key=lambda row: row["dataset"]):
        listed: list[dict[str, Any]] = []
        conditions: list[str] = []
        facts: dict[str, Any] = {}
        for condition, group in groupby(of_dataset, key=lambda row: row["condition"]):
            board = list(group)
            known = [spread[_cell(row)] for row in board]
            found = rank_board(board, known)
            pin = (pins or {}).get((name, condition, "test"))
            bench_deg = None if pin is None or conditions else pin.bench_deg
            ranked = [
                {
                    "rank": found.places[at].rank,
                    "group": found.places[at].group,
                    "tied": found.places[at].tied,
                    **board[at],
                    "own_error_deg": known[at].own_error_deg,
                    "own_se": known[at].own_se,
                    "studies": list((studied or {}).get(_used(board[at]), ())),
                    "unit_rms_deg": list(known[at].errors_deg),
                    "low_deg": known[at].low_deg,
                    "high_deg": known[at].high_deg,
                    **expected_on_bench(
                        known[at].own_error_deg, bench_deg, benches.get(_cell(board[at]))
                    ),
                    "twin_of": twins.get((*_used(board[at])[2:], name)),
                    **times.columns_of(name, *_used(board[at])[2:]),
                }
                for at in found.order
            ]
            folded = _with_folded(ranked)
            if not conditions:
                facts = _facts(name, found, pin, folded)
            conditions.append(condition)
            listed += best_of_extractors_first(folded)
        datasets.append(
            {
                "name": name,
                "version": listed[0]["dataset_version"],
                "detector": listed[0]["detector"],
                "mask": listed[0]["mask"],
                "idealisation": hardware_match(name).idealisation or None,
                "in_orbit": _is_in_orbit(name),
                "height_mm": get(name).geometry.focal_length_mm if name in names() else None,
                "conditions": conditions,
                **facts,
                "rows": listed,
            }
        )
    return {
        "schema": SCHEMA_VERSION,
        "metric_version": METRIC_VERSION,
        "units": UNITS,
        "datasets": datasets,
        "timed_on": times.machine.model_dump() if times.machine else None,
        "sweeps": list(swept),
    }


def _is_in_orbit(name: str) -> bool:
    """Say whether the samples of a data set are of a flight already."""
    return name in names() and bool(get(name).context_columns)


def _facts(name: str, found: RankedBoard, pin: Pin | None, rows: Sequence[Row]) -> dict[str, Any]:
    """Return what the board of a data set's first condition states once."""
    from benchmark.datasets.corrected import references_used  # noqa: PLC0415 - loads Numba

    controls = {"oracle": "oracle_deg", "boresight": "boresight_deg"}
    return {
        "smallest_ratio": found.smallest_ratio,
        "quoted_deg": found.quoted_deg,
        "references": references_used(get(name)) if name in names() else None,
        "bench_deg": None if pin is None else pin.bench_deg,
        "bench_aligned_deg": None if pin is None else pin.bench_aligned_deg,
        "bound_unit_deg": None if pin is None else pin.bound_unit_deg,
        "controls": [
            {"name": control, "rms_deg": None if pin is None else getattr(pin, column)}
            for control, column in controls.items()
        ],
        "folded": sum(row["folded"] for row in rows),
    }


def _with_folded(ranked: Sequence[Row]) -> list[dict[str, Any]]:
    """Say of each ranked row of a board whether it is too far behind to be shown unasked."""
    first = next((row["own_error_deg"] for row in ranked if row["own_error_deg"]), None)
    return [
        {
            **row,
            "folded": row["own_error_deg"] is None
            or row["own_error_deg"] > HOPELESS_DEG
            or (first is not None and row["own_error_deg"] > BEHIND * first),
        }
        for row in ranked
    ]


def board_of(store: Store, times: Times = _NOT_TIMED) -> dict[str, Any]:
    """Build the leaderboard of a store, with the studies that used its pipelines.

    StoreError, ComponentsError for a file that cannot be read.
    """
    rows = store.rows(unit=None)
    return build(rows, times, sweeps.swept(store.directory), studies_of_pipelines(), store.pins())


def best_of_extractors_first(ranked: Iterable[Row]) -> list[dict[str, Any]]:
    """Order the rows of one data set and condition as a board lists them.

    First those that rank before all others of their extractor, marked ``best_of_extractor``.
    """
    seen: set[str] = set()
    first: list[dict[str, Any]] = []
    behind: list[dict[str, Any]] = []
    for row in ranked:
        best = row["rank"] is not None and row["extractor"] not in seen
        seen.add(row["extractor"])
        (first if best else behind).append({**row, "best_of_extractor": best})
    return [*first, *behind]


def at_field(rows: Iterable[Row], half_angle_deg: int) -> list[dict[str, Any]]:
    """Rank rows of a leaderboard by their error over a cone about the boresight.

    Rows get ``field_deg`` (the half angle) and ``field_rms_deg``
    (`benchmark.metrics.rings.field_error`), and ranks by it within each dataset and condition.
    Ranks are not shared: rings have no spread. Rows without an error over the field come last, and
    a sensor has none over a wider field than its own: its outermost ring lies in the corners.
    ValueError for an angle that is no ring's edge.
    """
    judged = [
        {
            **row,
            "field_deg": half_angle_deg,
            "field_rms_deg": (
                field_error(row, half_angle_deg) if half_angle_deg <= _field(row) else None
            ),
            "tied": False,
        }
        for row in rows
    ]
    judged.sort(key=lambda row: (*_board(row), *_by_field(row)))
    return _rank(judged, "field_rms_deg")


def within_error(rows: Iterable[Row], largest_deg: float) -> list[dict[str, Any]]:
    """Rank rows of a leaderboard by the field in which their error stays within a limit.

    Rows get ``widest_field_deg`` (half angle of the widest cone about the boresight in whose every
    ring it does, `benchmark.metrics.rings.widest_field`, as far as the sensor's own field goes)
    and ranks by it within each dataset and condition, the smaller error first among equals. Ranks
    are not shared. Rows without such a field, and pipelines that do not answer often enough, come
    last and have no rank.
    """
    judged = [
        {
            **row,
            "widest_field_deg": _kept_field(row, largest_deg),
            "tied": False,
        }
        for row in rows
    ]
    judged.sort(key=lambda row: (*_board(row), -(row["widest_field_deg"] or 0), *_by_error(row)))
    return _rank(judged, "widest_field_deg")


def _rank(judged: Iterable[Row], by: str) -> list[dict[str, Any]]:
    """Rank sorted rows within each board, none without a value of `by`."""
    listed: list[dict[str, Any]] = []
    for _, group in groupby(judged, key=_board):
        listed += best_of_extractors_first(
            {**row, "rank": place if row[by] is not None else None}
            for place, row in enumerate(group, start=1)
        )
    return listed


def _field(row: Row) -> float:
    """Half the field of view that a row's sensor has all around, degrees."""
    half: float | None = row["half_fov_deg"]
    return EDGES_DEG[-1] if half is None else half


def _kept_field(row: Row, largest_deg: float) -> int | None:
    widest = widest_field(row, largest_deg) if is_available(row) else None
    reached = [edge for edge in EDGES_DEG[1:] if edge <= min(widest or 0, _field(row))]
    return max(reached, default=None)


def _by_field(row: Row) -> tuple[Any, ...]:
    return order(
        {**row, "rms_all_answers_deg": row["field_rms_deg"]}, (row["extractor"], row["model"])
    )


def _by_error(row: Row) -> tuple[Any, ...]:
    return order(row, (row["extractor"], row["model"]))


def _order(row: Row) -> tuple[Any, ...]:
    return (*_board(row), *_by_error(row))


def _board(row: Row) -> tuple[str, bool, str]:
    return row["dataset"], row["condition"] != NOMINAL, row["condition"]


def _cell(row: Row) -> Cell:
    return Cell(row["dataset"], row["condition"], row["extractor"], row["model"])


def _used(row: Row) -> tuple[str, str, str, str]:
    return row["detector"], row["mask"], row["extractor"], row["model"]


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

"""The leaderboard: every pipeline on every dataset and condition, against the bound.

A board lists the best pipeline of each extractor first, which is what an engineer compares, and the
others behind; both by rank. All of it follows from stored scores: `build` renders nothing and gives
the same for the same rows.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import groupby
from typing import Any

from benchmark.contract import Cell
from benchmark.datasets.realism import standing
from benchmark.leaderboard.ranking import order, ranks, spreads
from benchmark.leaderboard.scope import UNITS, Studied, studies_of_pipelines
from benchmark.metrics.rings import EDGES_DEG, field_error, widest_field
from benchmark.metrics.score import METRIC_VERSION, is_available
from benchmark.results.components import SCHEMA_VERSION
from benchmark.results.store import Store

Row = Mapping[str, Any]
#: Times of one pipeline on a machine, by (dataset, extractor, model).
Times = Mapping[tuple[str, str, str], Mapping[str, float | None]]

NOMINAL = "nominal"

UNTIMED: Mapping[str, float | None] = {"latency_us": None, "time_ratio": None}


def build(
    rows: Iterable[Row],
    times: Times | None = None,
    swept: Iterable[Row] = (),
    studied: Studied | None = None,
) -> dict[str, Any]:
    """Rank stored rows within each dataset and condition.

    Parameters
    ----------
    rows
        Rows of all units, as `Store.rows(unit=None)` gives them.
    times
        Of this machine; none by default.
    swept
        Rows of sweeps as `Store.swept` gives them.
    studied
        Mapped studies by the pipelines they used (`scope.studies_of_pipelines`); none by default.

    Returns
    -------
    dict
        ``schema``, ``metric_version``, ``units`` (how many leading pipelines are scored on),
        ``sweeps`` (as given) and ``datasets``: each with ``name``, ``version``, ``detector``,
        ``mask``, ``idealisation`` (why it stands for no built sensor, null where it does),
        ``conditions`` (the nominal one first) and ``rows``. A row is the score row of
        the standard unit with ``rank`` (null where there is no error), ``tied`` (whether others
        share it), ``best_of_extractor`` (whether no other pipeline of its extractor ranks before
        it there), ``studies`` (keys of those that used it on such a sensor), the errors of all
        units ``unit_rms_deg`` and their range ``low_deg`` to ``high_deg`` (null where one unit is
        scored), and times.
    """
    every = list(rows)
    spread = spreads(every)
    standard = sorted((row for row in every if row["unit"] == 0), key=_order)
    datasets = []
    for name, of_dataset in groupby(standard, key=lambda row: row["dataset"]):
        listed: list[dict[str, Any]] = []
        conditions = []
        for condition, group in groupby(of_dataset, key=lambda row: row["condition"]):
            conditions.append(condition)
            board = list(group)
            ranked: list[dict[str, Any]] = []
            found = [spread.get(_cell(row)) for row in board]
            for row, known, (rank, tied) in zip(board, found, ranks(board, found), strict=True):
                errors = list(known.errors_deg) if known else None
                complete = known is not None and None not in known.errors_deg
                ranked.append(
                    {
                        "rank": rank,
                        "tied": tied,
                        **row,
                        "studies": list((studied or {}).get(_used(row), ())),
                        "unit_rms_deg": errors,
                        "low_deg": known.low_deg if known and complete else None,
                        "high_deg": known.high_deg if known and complete else None,
                        **_times(row, times),
                    }
                )
            listed += best_of_extractors_first(ranked)
        datasets.append(
            {
                "name": name,
                "version": listed[0]["dataset_version"],
                "detector": listed[0]["detector"],
                "mask": listed[0]["mask"],
                "idealisation": standing(name).idealisation or None,
                "conditions": conditions,
                "rows": listed,
            }
        )
    return {
        "schema": SCHEMA_VERSION,
        "metric_version": METRIC_VERSION,
        "units": UNITS,
        "datasets": datasets,
        "sweeps": list(swept),
    }


def board_of(store: Store, times: Times | None = None) -> dict[str, Any]:
    """Build the leaderboard of a store, with the studies that used its pipelines.

    Raises
    ------
    StoreError, ComponentsError
        For a file that cannot be read.
    """
    return build(store.rows(unit=None), times, store.swept(), studies_of_pipelines())


def best_of_extractors_first(ranked: Iterable[Row]) -> list[dict[str, Any]]:
    """Order the rows of one data set and condition as a board lists them.

    Parameters
    ----------
    ranked
        Rows with ``rank``, best first.

    Returns
    -------
    list of dict
        The rows with ``best_of_extractor``: first those that rank before all others of their
        extractor, then the others, each part as it was.
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

    Raises
    ------
    ValueError
        For an angle that is no ring's edge.
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
    return _ranked(judged, "field_rms_deg")


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
    return _ranked(judged, "widest_field_deg")


def _ranked(judged: Iterable[Row], by: str) -> list[dict[str, Any]]:
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
    return order({**row, "rms_deg": row["field_rms_deg"]}, (row["extractor"], row["model"]))


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


def _times(row: Row, times: Times | None) -> Mapping[str, float | None]:
    known = (times or {}).get((row["dataset"], row["extractor"], row["model"]), UNTIMED)
    return {name: known.get(name) for name in UNTIMED}

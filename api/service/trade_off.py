"""The trade-off: errors of pipelines, or of built sensors, against what they cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

from api.figures.trade_off import AXES, trade_off_figure
from api.schema.measured_figures import OF_PRODUCTS, TradeOff, TradeOffQuery, TradeOffRow
from api.schema.table import columns_of
from api.service.documents import Document
from api.service.figures import measured_document
from api.service.knowledge import Knowledge
from api.service.pagination import narrow
from api.service.problems import Problem, Violation
from benchmark.contract import FLIGHT
from benchmark.leaderboard.frontier import frontier
from registry.design_table import design_table
from registry.reports import Report
from survey_data.nearest import nearest_name
from survey_data.products import built_sensors

Row = Mapping[str, Any]

#: Full field of view of a sensor that is made for all directions.
_EVERYWHERE_DEG = 360.0
_FILTERS = ("detector", "mask", "dataset", "extractor", "model")
#: Costs that reports can be compared by.
_OF_REPORTS = ("field", *OF_PRODUCTS)


def trade_off(known: Knowledge, query: TradeOffQuery) -> Document:
    """Return errors against a cost, and which pipelines are on the frontier.

    All pipelines with 95 % availability are judged. Those far behind on their board are listed only
    if they are on the frontier, not separable from it, or named by `select`. CSV: a row per
    pipeline, or per report.
    """
    level = query.level or ("reported" if query.across in OF_PRODUCTS else "flight")
    allowed = _OF_REPORTS if level == "reported" else ("field", "height", "poses", "latency")
    if query.across not in allowed:
        expected = f"one of {', '.join(allowed)} with level={level}"
        _refuse("across", query.across, expected, None)
    every = _reports(known) if level == "reported" else _pipelines(known, level)
    narrowed = list({row["name"]: row for row in narrow(every, query, _FILTERS)}.values())
    names = {row["name"] for row in narrowed}
    for name in query.select:
        if name not in names:
            _refuse("select", name, "a row's name", nearest_name(name, sorted(names)))
    column = AXES[query.across][0]
    there = [row for row in narrowed if row[column] is not None]
    rows = [
        {**row, "status": status, "selected": row["name"] in query.select}
        for row, status in zip(there, _status(there, query.across), strict=True)
    ]
    shown = [
        row
        for row in rows
        if row["selected"] or not row["folded"] or row["status"] in ("frontier", "not separable")
    ]
    shown.sort(key=lambda row: (row[column], row["error_deg"], row["name"]))
    machine = known.measurements.times.machine
    counted: Any = {
        "timed_on": machine.processor if machine else None,
        "left_out": len(narrowed) - len(there),
        "folded": len(rows) - len(shown),
    }
    items = [{name: row[name] for name in columns_of(TradeOffRow)} for row in shown]
    figure = trade_off_figure(items, query.across, level, **counted)
    return measured_document(figure, TradeOff, **counted)


def _status(rows: Sequence[Row], across: str) -> list[Any]:
    """Return where rows stand; a wider field is better, of all else less is."""
    sign = -1.0 if across == "field" else 1.0
    return frontier(
        [row["error_deg"] for row in rows],
        [sign * row[AXES[across][0]] for row in rows],
        [row["units"] for row in rows],
    )


def _refuse(parameter: str, value: str, expected: str, nearest: str | None) -> None:
    raise Problem(422, "invalid-value", errors=[Violation(parameter, value, expected, nearest)])


@lru_cache(4)
def _pipelines(known: Knowledge, level: str) -> list[dict[str, Any]]:
    """Return every pipeline with an error at a level and 95 % availability, twins aside."""
    under: dict[tuple[str, str, str], Row] = {}
    for board in known.measurements.leaderboard["datasets"]:
        aloft = level == "own" or board["in_orbit"]
        condition = board["conditions"][0] if aloft else FLIGHT
        for row in board["rows"]:
            if row["condition"] == condition and not row["twin_of"]:
                under[row["dataset"], row["extractor"], row["model"]] = row
    found = []
    for one in known.measured_pipelines.at("own" if level == "own" else "flight").rows:
        place = (one.dataset, one.extractor, one.model)
        error, row = one.nominal.rms_deg, under.get(place)
        if row is None or not error or not one.nominal.is_available:
            continue
        half = one.half_fov_deg
        found.append(
            {
                "name": ":".join(place),
                **{name: getattr(one, name) for name in _FILTERS},
                "error_deg": error,
                **{name: row[name] for name in ("low_deg", "high_deg", "bound_deg")},
                "field_deg": None if half is None else min(2 * half, _EVERYWHERE_DEG),
                "height_mm": one.height_mm,
                "poses": known.measurements.curve_of.get(place, {}).get("needed_poses"),
                "latency_us": one.latency_us,
                **dict.fromkeys(("power_mw", "mass_g")),
                "units": row["unit_rms_deg"],
                "folded": row["folded"],
            }
        )
    return found


def _reports(known: Knowledge) -> list[dict[str, Any]]:
    """Return every report of an accuracy, of a study once for each of its architectures."""
    table = design_table(known.facts, known.measured_pipelines)
    places = (table.places[at].architecture for at in table.report_place.tolist())
    return [
        {
            **dict.fromkeys(columns_of(TradeOffRow)),
            "name": report.key if report.kind == "study" else report.name,
            "detector": detector,
            "mask": mask,
            "error_deg": float(f"{report.rms_deg:.4g}"),
            "field_deg": report.fov_deg,
            "power_mw": _stated(report, "power_mw"),
            "mass_g": _stated(report, "mass_g"),
            "units": (),
            "folded": False,
        }
        for report, (detector, mask) in zip(table.reports, places, strict=True)
        if report.rms_deg is not None
    ]


def _stated(report: Report, figure: str) -> float | None:
    """Return a figure that is stated of the sensor itself, not of others of its family."""
    rows = [one for one in built_sensors().values() if report.key in (one.id, one.study)]
    values = {value for one in rows if (value := getattr(one, figure)) is not None}
    return values.pop() if len(values) == 1 else None

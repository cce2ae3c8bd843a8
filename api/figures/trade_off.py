"""The trade-off: error against field, height, poses, time, power or mass, with the frontier."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from api.addresses import architecture_page, dataset_page
from api.figures.figure import Figure
from api.figures.specification import HOVER, TEXT, UNKNOWN, axis, colour, faint, mark, specification
from api.schema.measured_figures import TradeOffRow
from api.schema.table import columns_of
from benchmark.leaderboard.summaries import digits

NAME = "trade-off"
TITLE = "Error against cost"
AXES: Mapping[str, tuple[str, str, str]] = {
    "field": ("field_deg", "full field of view", "deg"),
    "height": ("height_mm", "height of mask or lens", "mm"),
    "poses": ("poses", "calibration poses needed", "poses"),
    "latency": ("latency_us", "time per reading", "us"),
    "power": ("power_mw", "power", "mW"),
    "mass": ("mass_g", "mass", "g"),
}
"""What errors are set against: column, words, unit."""
ERRORS = {"flight": "error in flight", "own": "own error", "reported": "reported accuracy as RMS"}
_LINEAR = {"field", "power"}  # a short range, or one with 0
_LOG = {"type": "log", "dtick": 1, "exponentformat": "none"}
_LOOKS = {
    "untested": ("behind, too few units to test", "circle-open", faint(UNKNOWN, 0.6)),
    "dominated": ("dominated", "circle", faint(colour(0), 0.5)),
    "not separable": ("not separable from the frontier", "square", colour(1)),
    "frontier": ("frontier", "diamond", colour(3)),
}
Row = Mapping[str, Any]


def trade_off_figure(
    rows: Sequence[dict[str, Any]],
    across: str,
    level: str,
    *,
    timed_on: str | None = None,
    left_out: int = 0,
    folded: int = 0,
) -> Figure:
    """Return the figure of rows of the trade-off.

    Parameters
    ----------
    rows : as `TradeOffRow`
    across, level : of `AXES` and `ERRORS`
    timed_on : processor of the running times
    left_out, folded : rows without a value across, and those far behind
    """
    _, words, unit = AXES[across]
    what = "studies and built sensors" if level == "reported" else "pipelines"
    better = "larger" if across == "field" else "smaller"
    error = f"{ERRORS[level][:1].upper()}{ERRORS[level][1:]}"
    plotly = specification(
        list(_traces(rows, across)),
        height=520,
        narrowest=480,
        xaxis=axis(f"{words.capitalize()}, {unit}", **(_LOG if across not in _LINEAR else {})),
        yaxis=axis(f"{error}, deg", **_LOG),
    )
    return Figure(
        name=NAME,
        title=TITLE,
        caption=f"{error} against {words} of {what}; {better} is better. On the frontier are those "
        "that none beats in both."
        + ("" if level == "reported" else " Whiskers: smallest and largest sensor unit."),
        text=tuple(_text(rows, across, level, timed_on, left_out, folded)),
        columns=columns_of(TradeOffRow),
        rows=tuple(rows),
        plotly=plotly,
        options={"across": across, "level": level},
    )


def page_of(row: Row) -> str:
    """Return the address that a row leads to: its data set, or its architecture."""
    if row["dataset"]:
        return dataset_page(row["dataset"])
    return architecture_page(row["detector"], row["mask"])


def _traces(rows: Sequence[Row], across: str) -> Iterator[dict[str, Any]]:
    for status, (said, symbol, tone) in _LOOKS.items():
        name = (
            "behind" if status == "untested" and not any(row["dataset"] for row in rows) else said
        )
        marks = [row for row in rows if row["status"] == status]
        trace = _trace(marks, across, name, {"symbol": symbol, "size": 8, "color": tone})
        if status == "frontier":
            shape = "vh" if across == "field" else "hv"
            trace |= {
                "mode": "lines+markers",
                "line": {"shape": shape, "width": 1.5, "color": tone},
            }
        ends = [(row["error_deg"], row["low_deg"], row["high_deg"]) for row in marks]
        interval = {
            "array": [0.0 if high is None else max(high - error, 0.0) for error, _, high in ends],
            "arrayminus": [0.0 if low is None else max(error - low, 0.0) for error, low, _ in ends],
        }
        bars = {"type": "data", "thickness": 0.8, "width": 0, "color": faint(UNKNOWN, 0.6)}
        yield {**trace, "error_y": {**bars, **interval}}
    if chosen := [row for row in rows if row["selected"]]:
        look = {"symbol": "circle-open", "size": 18, "color": TEXT, "line": {"width": 2}}
        yield _trace(chosen, across, "selected", look)


def _trace(rows: Sequence[Row], across: str, name: str, look: Mapping[str, Any]) -> dict[str, Any]:
    column, _, unit = AXES[across]
    return {
        "type": "scatter",
        "mode": "markers",
        "name": name,
        "x": [row[column] for row in rows],
        "y": [row["error_deg"] for row in rows],
        "customdata": [
            mark(
                f"{row['name']} ({row['detector']} + {row['mask']}): {digits(row['error_deg'])} "
                f"deg, {row[column]:.4g} {unit}; {row['status']}",
                page_of(row),
            )
            for row in rows
        ],
        "hovertemplate": HOVER,
        "marker": dict(look),
    }


def _text(  # noqa: PLR0917 - what a sentence each says
    rows: Sequence[Row], across: str, level: str, timed_on: str | None, left_out: int, folded: int
) -> Iterator[str]:
    column, words, unit = AXES[across]
    of = {status: [row for row in rows if row["status"] == status] for status in _LOOKS}
    what = "Reported sensors" if level == "reported" else "Pipelines"
    if not rows:
        yield f"{what} with an error and a known {words}: none."
        return
    tested = (
        f", {len(of['not separable'])} not separable from it by the paired test over units, "
        f"{len(of['dominated'])} dominated, {len(of['untested'])} behind it with too few units "
        "to test"
    )
    yield (
        f"{what}: {len(rows)}, of which {len(of['frontier'])} on the frontier"
        f"{'' if level == 'reported' else tested}."
    )
    ends = sorted(of["frontier"], key=lambda row: row["error_deg"])
    start, end = (
        f"{row['name']} ({digits(row['error_deg'])} deg at {row[column]:.4g} {unit})"
        for row in (ends[0], ends[-1])
    )
    yield f"The frontier runs from {start} to {end}." if start != end else f"It is {start}."
    if folded:
        yield f"{what} not drawn, as they are far behind on their board: {folded}."
    if left_out:
        yield f"{what} left out, as their {words} is not known: {left_out}."
    if across == "latency" and timed_on:
        yield f"Times were measured on {timed_on}."

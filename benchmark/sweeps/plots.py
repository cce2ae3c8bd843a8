"""Pictures of error against noise, feature size and phase: a panel a method, with its bound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Any

from benchmark.panels import (
    BLUE,
    FAINT,
    INK,
    VERMILION,
    annotate,
    bound_style,
    dots,
    panel_figure,
    rule,
)
from benchmark.plot_style import svg
from benchmark.sweeps.plan import SERIES
from benchmark.synthetic_features.series import SWEEPS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

Row = Mapping[str, Any]

#: Sweeps that are drawn; a phase is no ratio, so its axis is linear.
DRAWN = ("noise", "size", "phase")
_LINEAR = frozenset({"phase"})

_SIZE_IN = (2.9, 2.4)
_ERROR, _BOUND = BLUE, VERMILION
_WIDTH = 1.6


def picture(rows: Sequence[Row], sweep: str) -> str:
    """Draw one sweep of every method as SVG: error (line and dots) and bound (dashed) by panel.

    Dots are hollow where less than 90 % are found; an error of zero has no place on the axis.
    ValueError for a sweep that is not drawn.
    """
    about = f"Error against {SWEEPS[sweep]} of every method, with its bound"
    return svg(lambda: figure(rows, sweep), about)


def figure(rows: Sequence[Row], sweep: str) -> Figure:
    """Draw the same as a figure of Matplotlib."""
    if sweep not in DRAWN:
        raise ValueError(f"sweep must be one of {', '.join(DRAWN)}; got {sweep!r}")
    drawn = [row for row in rows if row["sweep"] == sweep and row["value"] is not None]
    order = [*SERIES]
    drawn.sort(key=lambda row: (order.index(row["series"]), row["extractor"], row["value"]))
    by_panel = groupby(drawn, key=lambda row: (row["series"], row["extractor"]))
    heights: dict[str, list[float]] = {}
    for row in drawn:
        heights.setdefault(row["series"], []).extend(filter(None, (row["rms"], row["bound"])))
    return panel_figure(
        [list(group) for _, group in by_panel],
        lambda axes, panel: _fill(axes, panel, heights[panel[0]["series"]]),
        size=_SIZE_IN,
        title=f"Error against {SWEEPS[sweep]}",
        explained=f"across: {SWEEPS[sweep]}; upwards: rms error of one coordinate, in the unit "
        "named",
        legend=_legend(),
    )


def _fill(axes: Axes, rows: Sequence[Row], heights: Sequence[float]) -> None:
    """Draw a method's rows of one sweep, as high as all errors and bounds of the series."""
    first = rows[0]
    taxonomy = "" if first["extractor_taxonomy"] == "None" else f"{first['extractor_taxonomy']}, "
    annotate(axes, first["extractor"], (0, 19), size=11.5, weight="bold", color=INK)
    about = f"{taxonomy}{first['series']} ({first['unit']})"
    annotate(axes, about, (0, 7), size=10, color=FAINT)
    axes.set_yscale("log")
    if heights:
        axes.set_ylim(min(heights) / 2.0, max(heights) * 2.0)
    if first["sweep"] not in _LINEAR:
        axes.set_xscale("log")
    places = [row["value"] for row in rows]
    shown = places[:: 1 + len(places) // 5]
    axes.set_xticks(shown, [f"{place:g}" for place in shown])
    rule(axes, axes.get_yticks().tolist())
    _curve(axes, places, [row["bound"] for row in rows], **bound_style(_BOUND, _WIDTH))
    errors = [row["rms"] for row in rows]
    if not any(errors):
        annotate(axes, "nothing found", (20, -40), size=10, color=FAINT)
    _curve(axes, places, errors, color=_ERROR, linewidth=_WIDTH)
    complete = [(row["found_fraction"] or 0.0) >= 0.9 for row in rows]
    for whole in (True, False):
        chosen = [
            error if found is whole else None for error, found in zip(errors, complete, strict=True)
        ]
        _curve(axes, places, chosen, **_dots(whole=whole), linewidth=_WIDTH)


def _curve(
    axes: Axes, places: Sequence[float], values: Sequence[float | None], **style: Any
) -> None:
    points = [(place, v) for place, v in zip(places, values, strict=True) if v]
    if points:
        axes.plot(*zip(*points, strict=True), clip_on=False, **style)


def _dots(*, whole: bool) -> dict[str, Any]:
    return dots(_ERROR, 5.2, edge=1.0, hollow=not whole)


def _legend() -> list[Line2D]:
    from matplotlib.lines import Line2D  # noqa: PLC0415 - a second that only pictures need

    error = {**_dots(whole=True), "linestyle": "-", "color": _ERROR, "linewidth": _WIDTH}
    return [
        Line2D([], [], label="rms error of one coordinate", **error),
        Line2D([], [], label="less than 90 % found", **_dots(whole=False)),
        Line2D([], [], label="Cramer-Rao bound", **bound_style(_BOUND, _WIDTH)),
    ]

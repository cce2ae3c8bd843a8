"""Picture of the error budgets: each leader's own error, what each part adds, and the bound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from benchmark.error_budget.sentences import PARTS, bound_of, contributions, times, verdict
from benchmark.panels import BLUE, FAINT, GRID, INK, VERMILION, dots, panel_figure, rule
from benchmark.plot_style import svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

Row = Mapping[str, Any]

_ABOUT = "What each part of the chain adds to the own error of each data set's leader"
_DOT = 5.6
_TICK: dict[str, Any] = {"color": INK, "marker": "|", "ms": 10, "mew": 1.6, "ls": ""}
_SMALL: dict[str, Any] = {"color": FAINT, "marker": "o", "ms": 3.2, "mew": 0, "ls": ""}
#: Contributions so many times below the bound are left out.
_BELOW = 10.0


def picture(rows: Sequence[Row]) -> str:
    """Draw the budgets as SVG, a line a data set."""
    return svg(partial(figure, rows), _ABOUT)


def figure(rows: Sequence[Row]) -> Figure:
    """Draw the same as a figure of Matplotlib."""
    return panel_figure(
        [rows] if rows else [],
        _fill,
        size=(12.5, 0.23 * len(rows)),
        columns=1,
        margins=(2.3, 3.4),
        title="Error budget of every data set's leader",
        explained="across: degrees; RMS of unit 0, its bound, and what each part "
        "contributes (root mean square); the largest part is named",
        legend=_legend(),
    )


def _fill(axes: Axes, rows: Sequence[Row]) -> None:
    axes.set_xscale("log")
    axes.set_ylim(len(rows) - 0.5, -0.5)
    own, bounds = [row["rms_deg"] for row in rows], [bound_of(row) for row in rows]
    axes.set_xlim(min(bounds) / _BELOW, 1.5 * max(own))
    rule(axes, [])
    axes.hlines(range(len(rows)), *axes.get_xlim(), color=GRID, lw=1, zorder=0.5)
    axes.set_yticks(range(len(rows)), [row["dataset"] for row in rows])
    least = axes.get_xlim()[0]
    for at, row in enumerate(rows):
        found, parts = verdict(row), contributions(row)
        shown = [error for part, error in parts.items() if part != found.leading_part]
        seen = [error for error in shown if error >= least]
        axes.plot(seen, [at] * len(seen), **_SMALL)
        if parts[found.leading_part] >= least:
            axes.plot(
                [parts[found.leading_part]], [at], **dots(VERMILION, 8.6, edge=1.4, hollow=True)
            )
        text = f"{times(row['rms_deg'] / bound_of(row))} the bound"
        axes.annotate(
            text if found.is_near_bound else PARTS[found.leading_part],
            (1, at),
            (8, 0),
            xycoords=("axes fraction", "data"),
            textcoords="offset points",
            va="center",
            size=9.5,
            color=FAINT if found.is_near_bound else INK,
        )
    axes.plot(bounds, range(len(rows)), zorder=3, **_TICK)
    axes.plot(own, range(len(rows)), zorder=3, **dots(BLUE, _DOT))


def _legend() -> list[Line2D]:
    from matplotlib.lines import Line2D  # noqa: PLC0415 - a second that only pictures need

    return [
        Line2D([], [], label="RMS of unit 0", **dots(BLUE, _DOT)),
        Line2D([], [], label="Cramer-Rao bound", **_TICK),
        Line2D([], [], label="largest part", **dots(VERMILION, 8.6, edge=1.4, hollow=True)),
        Line2D([], [], label="other parts", **_SMALL),
    ]

"""Picture of the learning curves: a panel a data set, its leaders' errors against their poses."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, Any

from benchmark.panels import (
    BLUE,
    FAINT,
    GREEN,
    INK,
    PURPLE,
    VERMILION,
    annotate,
    bound_style,
    dots,
    panel_figure,
    rule,
)
from benchmark.plot_style import svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

Row = Mapping[str, Any]

_ABOUT = "Own error of each data set's leaders against the poses that calibrate them"
_SIZE_IN = (3.3, 3.1)
#: Where names begin, points from the axes.
_LEFT = -38
_PLACES = (BLUE, VERMILION, GREEN)
_BENCH_DASHES = (0, (6, 2, 1, 2))
_DOT = 6.6
#: Share of the test split below which a curve is dotted.
_ANSWERED = 0.95
#: An axis ends so many times above the highest floor, and shows a bound so many below the lowest.
_ABOVE, _BELOW = 40.0, 12.0
#: Errors so many times above the picture are left out of it.
_AWAY = 3.0


def picture(rows: Sequence[Row]) -> str:
    """Draw the curves as SVG, a panel a data set."""
    return svg(lambda: figure(rows), _ABOUT)


def figure(rows: Sequence[Row]) -> Figure:
    """Draw the same as a figure of Matplotlib."""
    return panel_figure(
        [list(group) for _, group in groupby(rows, key=lambda r: r["dataset"])],
        _fill,
        size=_SIZE_IN,
        title="Own error against calibration poses, leaders of every data set",
        explained="across: calibration poses with true directions; upwards: rms error over the "
        "test split, degrees; line: median of the draws on two units, band: least to largest",
        legend=_legend(),
    )


def _fill(axes: Axes, leaders: Sequence[Row]) -> None:
    annotate(axes, leaders[0]["dataset"], (_LEFT, 49), size=11.5, weight="bold", color=INK)
    low, high = _limits(leaders)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(3.6, leaders[0]["poses"] * 1.12)
    axes.set_ylim(low, high)
    places = [p for p in (5, 20, 100, 500, 2000) if p <= leaders[0]["poses"]]
    axes.set_xticks(places, [str(p) for p in places])
    rule(axes, axes.get_yticks().tolist())
    _bound(axes, leaders[0], low)
    bench = leaders[0]["bench_deg"]
    if bench and low <= bench <= high:
        axes.plot(axes.get_xlim(), [bench] * 2, color=PURPLE, lw=1.1, ls=_BENCH_DASHES, zorder=1)
    for row, colour in zip(leaders, _PLACES, strict=False):
        end = row["points"][-1]["middle_deg"]
        away = f" ({end:.2g} deg, above)" if end and end > high else ""
        label = f"{row['extractor']} + {row['model']}{away}"
        annotate(axes, label, (_LEFT, 37 - 11.5 * (row["place"] - 1)), size=9.5, color=colour)
        _curve(axes, row, colour, high)


def _bound(axes: Axes, row: Row, low: float) -> None:
    if row["bound_deg"] >= low:
        ends = axes.get_xlim()
        axes.plot(ends, [row["bound_deg"]] * 2, zorder=1, **bound_style(INK, 1.1))
        return
    axes.annotate(
        f"bound {row['bound_deg']:.2g} deg, below",
        (1, 0),
        (0, 4),
        xycoords="axes fraction",
        textcoords="offset points",
        ha="right",
        size=8.5,
        color=FAINT,
    )


def _curve(axes: Axes, row: Row, colour: str, high: float) -> None:
    """Draw one leader's curve; where its poses were refused there is a gap.

    And where its errors are far above the picture, of which a band would leave a loose wedge. The
    first leader lies above the others.
    """
    points = row["points"]
    above = 2.0 - 0.1 * row["place"]
    poses = [point["poses"] for point in points]
    middle, least, largest = (
        [
            point[name] if 0.0 < (point["middle_deg"] or 0.0) <= _AWAY * high else math.nan
            for point in points
        ]
        for name in ("middle_deg", "least_deg", "largest_deg")
    )
    axes.fill_between(poses, least, largest, color=colour, alpha=0.13, lw=0, zorder=1.5)
    answered = [(point["availability"] or 0.0) >= _ANSWERED for point in points]
    # a line of the curve is solid where both of its ends are answered
    rare = _broken(middle, [not (x and y) for x, y in pairwise(answered)])
    often = _broken(middle, [x and y for x, y in pairwise(answered)])
    for (numbers, heights), style in ((rare, (0, (1, 1.4))), (often, "-")):
        places = [math.nan if number is None else poses[number] for number in numbers]
        axes.plot(places, heights, color=colour, lw=1.5, ls=style, zorder=above)
    for point in points:
        if point["poses"] == row["needed_poses"]:
            axes.plot(
                [point["poses"]], [point["middle_deg"]], zorder=above + 1.0, **dots(colour, _DOT)
            )


def _broken(
    heights: Sequence[float], shown: Sequence[bool]
) -> tuple[list[int | None], list[float]]:
    """Return places and heights of one broken line: of the steps that are shown, with gaps."""
    places: list[int | None] = []
    for number, wanted in enumerate(shown):
        if wanted:
            places += [number + 1] if places[-1:] == [number] else [None, number, number + 1]
    return places, [math.nan if place is None else heights[place] for place in places]


def _limits(leaders: Sequence[Row]) -> tuple[float, float]:
    """Return where the axis begins and ends: floors and what lies near, not the first poses."""
    ends = [row["points"][-1]["middle_deg"] for row in leaders]
    known = [end for end in ends if end]
    if not known:
        return 0.01, 1.0
    points = [point for row in leaders for point in row["points"] if point["middle_deg"]]
    least = min(point["least_deg"] for point in points)
    # a leader far behind the first one may run out of the picture
    top = min(_ABOVE * min(known), 2.0 * max(point["largest_deg"] for point in points))
    bound = leaders[0]["bound_deg"]
    least = max(least, min(known) / 3.0)
    low = min(least, bound) if bound >= min(known) / _BELOW else least
    return low / 1.5, max(top, 3.0 * low)


def _legend() -> list[Line2D]:
    from matplotlib.lines import Line2D  # noqa: PLC0415 - a second that only pictures need

    rare: dict[str, Any] = {"color": FAINT, "lw": 1.5, "ls": (0, (1, 1.4))}
    return [
        *(
            Line2D([], [], color=colour, lw=1.5, label=label)
            for colour, label in zip(_PLACES, ("first", "second", "third model"), strict=True)
        ),
        Line2D([], [], label="less than 95 % answered", **rare),
        Line2D([], [], label="poses needed to be within 10 % of the floor", **dots(FAINT, _DOT)),
        Line2D([], [], label="Cramer-Rao bound", **bound_style(INK, 1.1)),
        Line2D([], [], color=PURPLE, lw=1.1, ls=_BENCH_DASHES, label="error a bench adds"),
    ]

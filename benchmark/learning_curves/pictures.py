"""Picture of the learning curves: a panel a data set, its leaders' errors against their poses."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import groupby, pairwise
from typing import TYPE_CHECKING, Any

from benchmark.plot_style import svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Row = Mapping[str, Any]

_ABOUT = "Own error of each data set's leaders against the poses that calibrate them"
_COLUMNS = 5
#: Points: a panel with its names and ticks, the same around its axes, and the whole picture's rim.
_WIDTH, _HEIGHT = 236, 224
_LEFT, _RIGHT, _TOP, _BOTTOM = 44, 12, 66, 30
_MARGIN, _HEAD, _FOOT = 12, 78, 22
#: Three that every kind of colour vision tells apart (Okabe and Ito), and dark to light greys.
_PLACES = ("#0072b2", "#d55e00", "#009e73")
_INK, _FAINT, _GRID, _BENCH = "#1a1d21", "#5c6570", "#e3e7eb", "#cc79a7"
_BENCH_DASHES = (0, (6, 2, 1, 2))
#: Share of the test split below which a curve is dotted.
_ANSWERED = 0.95
#: An axis ends so many times above the highest floor, and shows a bound so many below the lowest.
_ABOVE, _BELOW = 40.0, 12.0
#: Errors so many times above the picture are left out of it.
_AWAY = 3.0


def picture(rows: Sequence[Row]) -> str:
    """Draw the curves as SVG, a panel a data set.

    Parameters
    ----------
    rows
        As `benchmark.learning_curves.record.published_curves` gives them.
    """
    return svg(lambda: figure(rows), _ABOUT)


def figure(rows: Sequence[Row]) -> Figure:
    """Draw the same as a figure of Matplotlib."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

    panels = [(name, list(group)) for name, group in groupby(rows, key=lambda r: r["dataset"])]
    width = 2 * _MARGIN + _COLUMNS * _WIDTH
    height = _HEAD + max(1, math.ceil(len(panels) / _COLUMNS)) * _HEIGHT + _FOOT
    drawn = Figure(figsize=(width / 72, height / 72), dpi=72, facecolor="white")
    place: dict[str, Any] = {"ha": "left", "va": "baseline"}
    left = _MARGIN / width
    title = "Own error against calibration poses, leaders of every data set"
    drawn.text(left, 1 - 22 / height, title, size=15, weight="bold", color=_INK, **place)
    said = (
        "across: calibration poses with true directions; upwards: rms error over the test split, "
        "degrees; line: median of the draws on two units, band: least to largest"
    )
    drawn.text(left, 1 - 39 / height, said, size=10, color=_FAINT, **place)
    _legend(drawn, (left, 1 - 49 / height))
    for number, (name, leaders) in enumerate(panels):
        column, line = number % _COLUMNS, number // _COLUMNS
        axes = drawn.add_axes(
            (
                (_MARGIN + column * _WIDTH + _LEFT) / width,
                1 - (_HEAD + (line + 1) * _HEIGHT - _BOTTOM) / height,
                (_WIDTH - _LEFT - _RIGHT) / width,
                (_HEIGHT - _TOP - _BOTTOM) / height,
            )
        )
        _fill(axes, name, leaders)
    if not panels:
        drawn.text(left, 1 - 90 / height, "nothing is stored", size=11, color=_FAINT, **place)
    return drawn


def _fill(axes: Axes, name: str, leaders: Sequence[Row]) -> None:
    said: dict[str, Any] = {
        "xycoords": "axes fraction",
        "textcoords": "offset points",
        "ha": "left",
    }
    axes.annotate(name, (0, 1), (-_LEFT + 6, 49), size=11.5, weight="bold", color=_INK, **said)
    low, high = _limits(leaders)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(3.6, leaders[0]["poses"] * 1.12)
    axes.set_ylim(low, high)
    exponents = [e for e in range(-7, 4) if low <= 10.0**e <= high]
    heights = [10.0**e for e in exponents]
    if len(heights) < 2:
        heights = sorted(
            step * 10.0**e
            for e in range(-7, 4)
            for step in (1, 2, 5)
            if low <= step * 10.0**e <= high
        )
    axes.set_yticks(heights, [f"{value:g}" for value in heights])
    places = [p for p in (5, 20, 100, 500, 2000) if p <= leaders[0]["poses"]]
    axes.set_xticks(places, [str(p) for p in places])
    axes.minorticks_off()
    axes.tick_params(labelsize=9.5, labelcolor=_FAINT, color=_FAINT, length=3)
    axes.tick_params(axis="y", left=False)
    # all rules as one broken line: a grid's would be half of the file
    rules = [value for height in heights for value in (height, height, math.nan)]
    ends = [0.0, 1.0, math.nan] * len(heights)
    axes.plot(ends, rules, transform=axes.get_yaxis_transform(), color=_GRID, lw=1, zorder=0.5)
    axes.spines[["left", "right", "top"]].set_visible(False)
    axes.spines["bottom"].set_color(_FAINT)
    axes.patch.set_visible(False)
    _bound(axes, leaders[0], low)
    bench = leaders[0]["bench_deg"]
    if bench and low <= bench <= high:
        axes.plot(axes.get_xlim(), [bench] * 2, color=_BENCH, lw=1.1, ls=_BENCH_DASHES, zorder=1)
    for row, colour in zip(leaders, _PLACES, strict=False):
        end = row["points"][-1]["middle_deg"]
        away = f" ({end:.2g} deg, above)" if end and end > high else ""
        label = f"{row['extractor']} + {row['model']}{away}"
        above = (-_LEFT + 6, 37 - 11.5 * (row["place"] - 1))
        axes.annotate(label, (0, 1), above, size=9.5, color=colour, **said)
        _curve(axes, row, colour, high)


def _bound(axes: Axes, row: Row, low: float) -> None:
    if row["bound_deg"] >= low:
        ends = axes.get_xlim()
        axes.plot(ends, [row["bound_deg"]] * 2, color=_INK, lw=1.1, ls=(0, (3, 2)), zorder=1)
        return
    axes.annotate(
        f"bound {row['bound_deg']:.2g} deg, below",
        (1, 0),
        (0, 4),
        xycoords="axes fraction",
        textcoords="offset points",
        ha="right",
        size=8.5,
        color=_FAINT,
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
            axes.plot([point["poses"]], [point["middle_deg"]], zorder=above + 1.0, **_dots(colour))


def _broken(
    heights: Sequence[float], shown: Sequence[bool]
) -> tuple[list[int | None], list[float]]:
    """Return places and heights of one broken line: of the steps that are shown, with gaps."""
    places: list[int | None] = []
    for number, wanted in enumerate(shown):
        if wanted:
            places += [number + 1] if places[-1:] == [number] else [None, number, number + 1]
    return places, [math.nan if place is None else heights[place] for place in places]


def _dots(colour: str) -> dict[str, Any]:
    return {
        "linestyle": "none",
        "marker": "o",
        "markersize": 6.6,
        "markeredgewidth": 0.0,
        "markeredgecolor": colour,
        "markerfacecolor": colour,
    }


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


def _legend(drawn: Figure, corner: tuple[float, float]) -> None:
    from matplotlib.lines import Line2D  # noqa: PLC0415 - see `figure`

    rare: dict[str, Any] = {"color": _FAINT, "lw": 1.5, "ls": (0, (1, 1.4))}
    entries = [
        *(
            Line2D([], [], color=colour, lw=1.5, label=label)
            for colour, label in zip(_PLACES, ("first", "second", "third model"), strict=True)
        ),
        Line2D([], [], label="less than 95 % answered", **rare),
        Line2D([], [], label="poses needed to be within 10 % of the floor", **_dots(_FAINT)),
        Line2D([], [], color=_INK, lw=1.1, ls=(0, (3, 2)), label="Cramer-Rao bound"),
        Line2D([], [], color=_BENCH, lw=1.1, ls=_BENCH_DASHES, label="error a bench adds"),
    ]
    drawn.legend(
        handles=entries,
        loc="upper left",
        bbox_to_anchor=corner,
        ncols=len(entries),
        fontsize=11,
        labelcolor=_FAINT,
        frameon=False,
        borderpad=0,
        borderaxespad=0,
        handlelength=2.0,
        columnspacing=2.0,
    )

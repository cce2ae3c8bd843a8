"""Picture of the lasers: what share each sensor's residual notices, by level and false alarms."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from benchmark.panels import BLUE, FAINT, GREEN, PURPLE, VERMILION, panel_figure, rule
from benchmark.plot_style import svg
from benchmark.spoofing.measure import RATES, SUNS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Row = Mapping[str, Any]
Fill = Callable[["Axes", Row], None]

#: Shares drawn against the laser's level: column, label, colour, line.
_LINES = (
    ("deceived", "believed: off by more than ten own errors, no flag", VERMILION, "--"),
    ("pattern", "noticed by the pattern's residual", BLUE, "-"),
    ("agreement", "noticed by a cube of photodiodes beside it", GREEN, "-"),
)
_LEVELS = dict(zip(SUNS, (FAINT, GREEN, BLUE, PURPLE, VERMILION), strict=True))


def levels(rows: Sequence[Row]) -> str:
    """Draw by the laser's level, as SVG, who believes it and what notices."""
    title = "A laser beside the Sun: shares of readings that believe it and that notice it"
    said = "across: signal of the laser over the Sun's; noticed at one false alarm in 10,000"
    legend = [(label, colour, style) for _, label, colour, style in _LINES]
    return _drawn(rows, _by_level, title, said, legend)


def curves(rows: Sequence[Row]) -> str:
    """Draw by the rate of false alarms, as SVG, what share the residual notices."""
    title = "A laser beside the Sun: share of readings that the pattern's residual notices"
    legend = [(f"{suns:g} Suns", colour, "-") for suns, colour in _LEVELS.items()]
    said = "across: false alarms a clean reading, residual alone"
    return _drawn(rows, _by_rate, title, said, legend)


def _drawn(
    rows: Sequence[Row], fill: Fill, title: str, said: str, legend: Sequence[tuple[str, str, str]]
) -> str:
    from matplotlib.lines import Line2D  # noqa: PLC0415 - a second that only pictures need

    figure = partial(
        panel_figure,
        rows,
        fill,
        size=(3.3, 2.7),
        columns=4,
        title=title,
        explained=said,
        legend=[Line2D([], [], label=of, color=c, ls=ls, lw=1.8) for of, c, ls in legend],
    )
    return svg(figure, title)


def _axes(axes: Axes, row: Row, places: Sequence[float]) -> list[Row]:
    """Style a panel, and return what came of lasers beside the Sun."""
    axes.set_title(f"{row['dataset']}, {row['extractor']}", size=10, loc="left")
    axes.set_xscale("log")
    axes.set_xlim(0.8 * min(places), 1.25 * max(places))
    axes.set_ylim(-0.03, 1.05)
    axes.set_xticks(places, [f"{place:g}" for place in places])
    rule(axes, [0.0, 0.5, 1.0])
    return [one for one in row["levels"] if one["sun"]]


def _by_level(axes: Axes, row: Row) -> None:
    found = _axes(axes, row, SUNS)
    for name, _, colour, style in _LINES:
        places = []
        for one in found:
            of = one["readings"] if name == "deceived" else one["turned"]
            count = one["deceived"] if name == "deceived" else one["noticed"].get(name)
            if of and count is not None:
                places.append((one["suns"], count / of))
        if places:
            axes.plot(*zip(*places, strict=True), color=colour, ls=style, lw=1.8)


def _by_rate(axes: Axes, row: Row) -> None:
    for one in _axes(axes, row, RATES):
        if one["turned"]:
            shares = [count / one["turned"] for count in one["curve"]]
            axes.plot(RATES, shares, color=_LEVELS[one["suns"]], lw=1.8)

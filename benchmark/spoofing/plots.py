"""Picture of the lasers: what share each sensor's residual notices, by level and false alarms."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from benchmark.panels import BLUE, FAINT, GREEN, VERMILION, panel_figure, rule
from benchmark.plot_style import svg
from benchmark.spoofing.measure import DECIDING, RATES
from benchmark.spoofing.record import level_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

Row = Mapping[str, Any]

_ABOUT = "Share of lasers that each sensor's tests notice, by the laser's level"
_LINES = (
    ("deceived", "believed: off by more than ten own errors, no flag", VERMILION, "--"),
    ("pattern", "noticed by the pattern's residual", BLUE, "-"),
    ("agreement", "noticed by a cube of photodiodes beside it", GREEN, "-"),
)


def picture(rows: Sequence[Row]) -> str:
    """Draw the record as SVG, a panel a sensor and pipeline."""
    return svg(partial(figure, rows), _ABOUT)


def figure(rows: Sequence[Row]) -> Figure:
    """Draw the same as a figure of Matplotlib."""
    return panel_figure(
        list(rows),
        _fill,
        size=(3.3, 2.7),
        columns=4,
        title="A laser beside the Sun: believed, and noticed",
        explained="across: signal of the laser over the Sun's; up: share of the readings that it "
        "turns away; noticed at one false alarm in 10,000. Dots: the residual at 1 Sun and one "
        f"false alarm in {', '.join(f'{1 / rate:,.0f}' for rate in RATES[:3])}",
        legend=_legend(),
    )


def _fill(axes: Axes, row: Row) -> None:
    levels = [one for one in row["levels"] if one["sun"]]
    across = [one["suns"] for one in levels]
    axes.set_title(f"{row['dataset']}, {row['extractor']}", size=10, loc="left")
    axes.set_xscale("log")
    axes.set_xlim(0.08, 12.5)
    axes.set_ylim(-0.03, 1.05)
    rule(axes, [0.0, 0.5, 1.0])
    axes.set_xticks(across, [f"{suns:g}" for suns in across])
    axes.minorticks_off()
    for name, _, colour, style in _LINES:
        shares = [share for one in levels if (share := _share(one, name)) is not None]
        if len(shares) == len(levels):
            axes.plot(across, shares, color=colour, ls=style, lw=1.8)
    one = level_of(row, DECIDING)
    if one["turned"]:
        seen = [count / one["turned"] for count in one["curve"][:3]]
        axes.plot([DECIDING] * 3, seen, color=FAINT, marker="o", ms=3.5, ls="")


def _share(level: Row, name: str) -> float | None:
    if name == "deceived":
        return float(level["deceived"] / level["readings"])
    if name not in level["noticed"]:
        return None
    return float(level["noticed"][name] / max(level["turned"], 1))


def _legend() -> list[Line2D]:
    from matplotlib.lines import Line2D  # noqa: PLC0415 - a second that only pictures need

    return [
        Line2D([], [], label=label, color=colour, ls=style, lw=1.8)
        for _, label, colour, style in _LINES
    ]

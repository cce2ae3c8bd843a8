"""Pictures of many panels that are read alike: a grid of axes, one legend above all."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

T = TypeVar("T")

#: Colours that every kind of colour vision tells apart (Okabe and Ito).
BLUE, VERMILION, GREEN, PURPLE = "#0072b2", "#d55e00", "#009e73", "#cc79a7"
#: Dark to light greys.
INK, FAINT, GRID = "#1a1d21", "#5c6570", "#e3e7eb"
_DASHED = (0, (3, 2))
#: Inches above all panels, and below.
_HEAD, _FOOT = 1.1, 0.5


def panel_figure(
    panels: Sequence[T],
    fill: Callable[[Axes, T], None],
    *,
    size: tuple[float, float],
    title: str,
    explained: str,
    legend: Sequence[Line2D],
    columns: int = 5,
    margins: tuple[float, float] = (0.6, 0.15),
) -> Figure:
    """Draw panels row by row, each of a size in inches, below a title and a legend.

    `margins` are inches left and right of all panels.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

    rows = max(1, math.ceil(len(panels) / columns))
    width, height = columns * size[0], rows * size[1] + _HEAD + _FOOT
    drawn = Figure(figsize=(width, height), facecolor="white")
    left = 0.15 / width
    drawn.text(left, 1 - 0.35 / height, title, size=15, weight="bold", color=INK)
    drawn.text(left, 1 - 0.6 / height, explained, size=10, color=FAINT)
    drawn.legend(
        handles=legend,
        loc="upper left",
        bbox_to_anchor=(0, 1 - 0.65 / height),
        ncols=len(legend),
        fontsize=11,
        labelcolor=FAINT,
        frameon=False,
    )
    if not panels:
        drawn.text(left, 0.5, "nothing is stored", size=11, color=FAINT)
        return drawn
    grid = drawn.subplots(rows, columns, squeeze=False)
    drawn.subplots_adjust(
        left=margins[0] / width,
        right=1 - margins[1] / width,
        bottom=_FOOT / height,
        top=1 - (_HEAD + 0.35 * size[1]) / height if columns > 1 else 1 - _HEAD / height,
        wspace=0.28,
        hspace=0.75,
    )
    for number, axes in enumerate(grid.flat):
        if number < len(panels):
            fill(axes, panels[number])
        else:
            axes.set_axis_off()
    return drawn


def rule(axes: Axes, heights: Sequence[float]) -> None:
    """Style a panel's axes and rule it at heights."""
    axes.minorticks_off()
    axes.tick_params(labelsize=9.5, labelcolor=FAINT, color=FAINT, length=3)
    axes.tick_params(axis="y", left=False)
    # all rules as one broken line: a grid's would be half of the file
    rules = [value for height in heights for value in (height, height, math.nan)]
    ends = [0.0, 1.0, math.nan] * len(heights)
    axes.plot(
        ends, rules, transform=axes.get_yaxis_transform(), color=GRID, linewidth=1, zorder=0.5
    )
    axes.spines[["left", "right", "top"]].set_visible(False)
    axes.spines["bottom"].set_color(FAINT)
    axes.patch.set_visible(False)


def annotate(axes: Axes, text: str, offset: tuple[float, float], **style: Any) -> None:
    """Write above a panel's upper left corner, `offset` points from it."""
    axes.annotate(
        text,
        (0, 1),
        offset,
        xycoords="axes fraction",
        textcoords="offset points",
        ha="left",
        **style,
    )


def dots(colour: str, size: float, *, edge: float = 0.0, hollow: bool = False) -> dict[str, Any]:
    """Return the style of points without a line."""
    return {
        "linestyle": "none",
        "marker": "o",
        "markersize": size,
        "markeredgewidth": edge,
        "markeredgecolor": colour,
        "markerfacecolor": "white" if hollow else colour,
    }


def bound_style(colour: str, width: float) -> dict[str, Any]:
    """Return the style of a bound."""
    return {"color": colour, "linestyle": _DASHED, "linewidth": width}

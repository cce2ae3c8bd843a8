"""Pictures of many panels that are read alike: a grid of axes, one legend above all."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
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
_MARGIN = 12


@dataclass(frozen=True)
class Layout:
    """Sizes in points.

    Attributes
    ----------
    width, height
        Of a panel with its names and ticks.
    left, right, top, bottom
        Around the axes of a panel.
    head, foot
        Above and below all panels.
    explained
        From the top down to the explanation, or from the foot up where it is negative.
    legend
        From the top down to the legend.
    columns
        Number of panels side by side.
    """

    width: int
    height: int
    left: int
    right: int
    top: int
    bottom: int
    head: int
    foot: int
    explained: int
    legend: int
    columns: int = 5


def panel_figure(
    layout: Layout,
    panels: Sequence[T],
    fill: Callable[[Axes, T], None],
    *,
    title: str,
    explained: str,
    legend: Sequence[Line2D],
    handle: float,
) -> Figure:
    """Draw panels row by row below a title.

    Parameters
    ----------
    layout
        Sizes.
    panels
        What each panel shows.
    fill
        Draws one of them into its axes.
    title, explained
        Text above all, and what is across and upwards.
    legend
        Entries.
    handle
        Length of a line in the legend, in font sizes.
    """
    from matplotlib.figure import Figure  # noqa: PLC0415 - a second that only pictures need

    width = 2 * _MARGIN + layout.columns * layout.width
    height = layout.head + max(1, math.ceil(len(panels) / layout.columns)) * layout.height
    height += layout.foot
    drawn = Figure(figsize=(width / 72, height / 72), dpi=72, facecolor="white")
    place: dict[str, Any] = {"ha": "left", "va": "baseline"}
    left = _MARGIN / width
    drawn.text(left, 1 - 22 / height, title, size=15, weight="bold", color=INK, **place)
    down = layout.explained / height
    drawn.text(left, 1 - down if down > 0 else -down, explained, size=10, color=FAINT, **place)
    drawn.legend(
        handles=legend,
        loc="upper left",
        bbox_to_anchor=(left, 1 - layout.legend / height),
        ncols=len(legend),
        fontsize=11,
        labelcolor=FAINT,
        frameon=False,
        borderpad=0,
        borderaxespad=0,
        handlelength=handle,
        columnspacing=2.0,
    )
    for number, panel in enumerate(panels):
        column, line = number % layout.columns, number // layout.columns
        axes = drawn.add_axes(
            (
                (_MARGIN + column * layout.width + layout.left) / width,
                1 - (layout.head + (line + 1) * layout.height - layout.bottom) / height,
                (layout.width - layout.left - layout.right) / width,
                (layout.height - layout.top - layout.bottom) / height,
            )
        )
        fill(axes, panel)
    if not panels:
        at = 1 - (layout.head + 12) / height
        drawn.text(left, at, "nothing is stored", size=11, color=FAINT, **place)
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

"""Picture of the network under faults: errors and answers of both over each fault's strength."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from benchmark.learned_faults.curves import Row, curve
from benchmark.panels import BLUE, FAINT, VERMILION, panel_figure, rule
from benchmark.plot_style import svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_WAYS = (("classical", "best pipeline", BLUE), ("network", "sparse network", VERMILION))
#: Of each row of panels: what it shows, and members of the record as lines.
_SHOWN: Sequence[tuple[str, Sequence[tuple[str, str]]]] = (
    ("error of answers, deg", (("rms_deg", "-"), ("median_deg", ":"))),
    ("share answered", (("answered", "-"),)),
    ("share of wrong answers", (("far", "-"), ("wrong", ":"))),
)
#: What strengths are of, by fault.
_UNITS = {"laser": "light, Suns", "hidden holes": "share of holes", "glare": "mean light, Suns"}


def curves(rows: Sequence[Row]) -> str:
    """Draw errors, answers and wrong ones over the strength of each fault, as SVG."""
    from matplotlib.lines import Line2D  # noqa: PLC0415 - a second that only pictures need

    title = "A coded mask under faults: sparse network and best pipeline"
    figure = partial(
        panel_figure,
        [(shown, row) for shown in _SHOWN for row in rows],
        _fill,
        size=(3.5, 2.5),
        columns=max(len(rows), 1),
        title=title,
        explained="errors: root mean square, dotted the median, of answers without a flag; wrong: "
        "off by more than 1 deg, dotted by more than ten own clean errors",
        legend=[Line2D([], [], label=label, color=colour) for _, label, colour in _WAYS],
    )
    return svg(figure, title)


def _fill(axes: Axes, panel: tuple[tuple[str, Sequence[tuple[str, str]]], Any]) -> None:
    (shown, members), row = panel
    axes.set_title(f"{row['fault']}: {shown}", size=10, loc="left")
    at = range(len(row["strengths"]))
    for way, _, colour in _WAYS:
        for member, style in members:
            found = [float("nan") if y is None else y for y in curve(row, way, member)]
            axes.plot(at, found, style, color=colour, marker="o", ms=3.5, lw=1.6)
    axes.set_xticks(at, [f"{strength:g}" for strength in row["strengths"]])
    axes.set_xlabel(_UNITS[row["fault"]], size=9.5, color=FAINT)
    if members[0][0] == "rms_deg":
        axes.set_yscale("log")
        axes.set_ylim(1e-4, 100.0)
        axes.set_yticks([1e-4, 1e-2, 1.0, 100.0], ["0.0001", "0.01", "1", "100"])
        rule(axes, [1e-4, 1e-2, 1.0, 100.0])
    else:
        axes.set_ylim(-0.03, 1.03)
        axes.set_yticks([0.0, 0.5, 1.0], ["0", "0.5", "1"])
        rule(axes, [0.0, 0.5, 1.0])
    axes.set_xlim(-0.3, len(row["strengths"]) - 0.7)

"""Picture of the networks: each way's error over the bound, by data set and unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from benchmark.panels import BLUE, FAINT, GREEN, VERMILION, panel_figure, rule
from benchmark.plot_style import svg

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Row = Mapping[str, Any]

#: Ways of reading in the order they are drawn: member, label, colour.
_WAYS = (
    ("classical", "best pipeline", BLUE),
    ("centroid", "centroid", FAINT),
    ("seed", "network", VERMILION),
    ("alone", "network without calibration", GREEN),
    ("tuned", "network, calibrated", VERMILION),
)


def errors(rows: Sequence[Row]) -> str:
    """Draw errors over the bound, as SVG: a dot a unit, a column of dots a way of reading."""
    from matplotlib.lines import Line2D  # noqa: PLC0415 - a second that only pictures need

    title = "Networks that read frames: error over the bound"
    figure = partial(
        panel_figure,
        rows,
        _fill,
        size=(3.3, 2.7),
        columns=3,
        title=title,
        explained="a dot is a unit of the sensor, or a training seed on it; 1 is the bound",
        legend=[
            Line2D([], [], label=label, color=colour, marker="o", ls="")
            for label, colour in dict.fromkeys((label, colour) for _, label, colour in _WAYS[:4])
        ],
    )
    return svg(figure, title)


def _fill(axes: Axes, row: Row) -> None:
    axes.set_title(f"{row['dataset']}, {row['network']}", size=10, loc="left")
    axes.set_yscale("log")
    for at, (way, errors_deg) in enumerate(row["errors_deg"].items()):
        colour = next(colour for name, _, colour in _WAYS if way.startswith(name))
        seen = [error / row["bound_deg"] for error in errors_deg if error is not None]
        axes.plot([at] * len(seen), seen, "o", color=colour, ms=4, alpha=0.7)
    axes.set_xticks(range(len(row["errors_deg"])), list(row["errors_deg"]), rotation=20)
    axes.set_ylim(0.8, 600.0)
    axes.set_yticks([1.0, 10.0, 100.0], ["1", "10", "100"])
    rule(axes, [1.0, 10.0, 100.0])
    axes.set_xlim(-0.5, len(row["errors_deg"]) - 0.5)

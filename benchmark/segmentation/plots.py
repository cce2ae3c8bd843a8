"""Picture of the masks: right and wrong answers of each method, fault by fault."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from benchmark.panels import BLUE, FAINT, GREEN, VERMILION, panel_figure, rule
from benchmark.plot_style import svg
from benchmark.segmentation.frames import FAULTS, UNANSWERABLE
from benchmark.segmentation.worth import fault_of, leaders, member, pooled

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_FAMILIES = (
    ("thresholds, templates, extractors", BLUE),
    ("the same under the U-Net's mask", GREEN),
)


def worths(rows: Sequence[Any]) -> str:
    """Draw the shares of right and wrong answers under every fault, as SVG."""
    from matplotlib.lines import Line2D  # noqa: PLC0415 - a second that only pictures need

    title = "The Sun's image under faults: answers of thresholds and of a U-Net's masks"
    shown = [*_FAMILIES, ("wrong without a flag", VERMILION)]
    figure = partial(
        panel_figure,
        rows,
        _board,
        size=(10.5, 2.3),
        columns=1,
        title=title,
        explained="up: share of right answers, down: of wrong ones; of each family the method "
        "worth most on other units; without one Sun the leading extractor",
        legend=[Line2D([], [], label=label, color=colour, lw=6) for label, colour in shown],
        margins=(0.6, 0.15),
    )
    return svg(figure, title)


def _board(axes: Axes, row: Any) -> None:
    names = list(FAULTS)
    axes.set_title(row["dataset"], size=10, loc="right")
    rule(axes, [-1.0, 0.0, 1.0])
    axes.set_ylim(-1.05, 1.05)
    for at, name in enumerate(names):
        fault = fault_of(row, name)
        shown = leaders(row, fault)
        if name not in UNANSWERABLE:
            chosen = [member(row, fault, learned=learned)["method"] for learned in (False, True)]
            by = {one["method"]: one for one in pooled(row, fault)}
            shown = [by[one] for one in chosen]
        for place, one, (_, colour) in zip((-0.2, 0.2), shown, _FAMILIES, strict=True):
            axes.bar(at + place, one["right"] / one["frames"], 0.36, color=colour)
            wrong = -one["wrong"] / one["frames"]
            axes.bar(at + place, wrong, 0.36, color=VERMILION, ec=colour, lw=1.5)
    axes.set_xticks(range(len(names)), names, color=FAINT)

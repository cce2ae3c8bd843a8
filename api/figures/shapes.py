"""A Sankey diagram and a sunburst of a Plotly specification, drawn by Matplotlib."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle, Wedge
from matplotlib.path import Path

from api.figures.plots import paint
from api.figures.specification import MUTED, SURFACE, TEXT

_LETTER = 6.6  # mean width of a letter of a label, px


def sankey(figure: Figure, plotly: Mapping[str, Any]) -> None:
    """Draw nodes where they are placed, and bands as wide as their values."""
    (trace,), layout = plotly["data"], plotly["layout"]
    axes, width, height = _canvas(figure, layout)
    node, link = trace["node"], trace["link"]
    places = list(zip(node["x"], node["y"], strict=True))
    ends = list(zip(link["source"], link["target"], link["value"], strict=True))
    amount = [
        max(sum(v for s, _, v in ends if s == at), sum(v for _, t, v in ends if t == at))
        for at in range(len(places))
    ]
    unit = pixels_of_unit(
        [(x, amount[at]) for at, (x, _) in enumerate(places)], height, node["pad"]
    )
    thick = node["thickness"]
    left = [min(max(x * width - thick / 2, 0), width - thick) for x, _ in places]
    top = [y * height - unit * amount[at] / 2 for at, (_, y) in enumerate(places)]
    for letter, which in (("out", 0), ("into", 1)):
        used = list(top)
        # bands leave and reach a node in the order of their other ends
        for at in sorted(range(len(ends)), key=lambda k: places[ends[k][1 - which]][1]):
            mine = ends[at][which]
            link.setdefault(letter, {})[at] = used[mine] + unit * ends[at][2] / 2
            used[mine] += unit * ends[at][2]
    for at, (source, target, value) in enumerate(ends):
        x0, x1, half = left[source] + thick, left[target], unit * value / 2
        y0, y1, middle = (
            link["out"][at],
            link["into"][at],
            (left[source] + thick + left[target]) / 2,
        )
        upper = [(x0, y0 - half), (middle, y0 - half), (middle, y1 - half), (x1, y1 - half)]
        lower = [(x1, y1 + half), (middle, y1 + half), (middle, y0 + half), (x0, y0 + half)]
        codes = [Path.MOVETO, *[Path.CURVE4] * 3, Path.LINETO, *[Path.CURVE4] * 3]
        band = Path([*upper, *lower], codes)
        axes.add_patch(PathPatch(band, facecolor=paint(link["color"][at]), linewidth=0))
    for at, label in enumerate(node["label"]):
        box = (left[at], top[at]), thick, max(unit * amount[at], 1)
        axes.add_patch(Rectangle(*box, facecolor=paint(node["color"][at]), linewidth=0))
        last = places[at][0] > 0.99
        x, side = (left[at] - 4, "right") if last else (left[at] + thick + 4, "left")
        axes.text(x, places[at][1] * height, label, ha=side, va="center")
    for note in layout.get("annotations", ()):
        side = {0: "left", 1: "right"}.get(note["x"], "center")
        axes.text(note["x"] * width, -6, note["text"], ha=side, va="bottom", color=MUTED)


def pixels_of_unit(nodes: Sequence[tuple[float, float]], height: float, pad: float) -> float:
    """Return the height of a unit: the fullest column takes all of it.

    Parameters
    ----------
    nodes : (column, amount) of each
    height, pad : of the diagram, and between nodes, px
    """
    columns: dict[float, list[float]] = {}
    for column, amount in nodes:
        columns.setdefault(column, []).append(amount)
    return min((height - pad * (len(of) - 1)) / sum(of) for of in columns.values())


def sunburst(figure: Figure, plotly: Mapping[str, Any]) -> None:
    """Draw rings; what lies outside a part divides it, the largest first."""
    (trace,), layout = plotly["data"], plotly["layout"]
    axes, width, height = _canvas(figure, layout)
    inside: dict[str, list[int]] = {}
    for at, parent in enumerate(trace["parents"]):
        inside.setdefault(parent, []).append(at)
    parent_of = dict(zip(trace["ids"], trace["parents"], strict=True))
    rings = max(_depth(one, parent_of) for one in trace["ids"])
    step = min(width, height) / 2 / (rings + 0.6)
    centre = (width / 2, height / 2)

    def ring(parent: str, start: float, turn: float, depth: int) -> None:
        """Draw the parts of a parent, counterclockwise; angles in degrees."""
        parts = sorted(inside.get(parent, ()), key=lambda at: -trace["values"][at])
        whole = sum(trace["values"][at] for at in parts)
        for at in parts:
            span = turn * trace["values"][at] / whole
            inner, outer = step * (0.6 + depth), step * (1.6 + depth)
            face = paint(trace["marker"]["colors"][at])
            wedge = Wedge(centre, outer, -start - span, -start, width=step, facecolor=face)
            wedge.set(edgecolor=SURFACE, linewidth=1)
            axes.add_patch(wedge)
            _label(axes, trace["labels"][at], centre, (inner, outer), (start, span))
            ring(trace["ids"][at], start, span, depth + 1)
            start += span

    ring("", 0.0, 360.0, 0)


def _depth(part: str, parent_of: Mapping[str, str]) -> int:
    return 1 + _depth(parent_of[part], parent_of) if part else 0


def _label(
    axes: Axes,
    text: str,
    centre: tuple[float, float],
    radii: tuple[float, float],
    arc: tuple[float, float],
) -> None:
    """Write along the radius where there is room, as much of the text as fits."""
    (inner, outer), (start, span) = radii, arc
    middle = start + span / 2
    radius = (inner + outer) / 2
    if np.radians(span) * radius < 12:
        return
    size = min(11.0, max(8.0, 11 * (outer - inner - 6) / _LETTER / len(text)))
    room = int((outer - inner - 6) / _LETTER * 11 / size)
    shown = text if len(text) <= room else f"{text[: room - 1]}…"
    at = np.radians(middle)
    turned = middle if np.cos(at) >= 0 else middle + 180
    axes.text(centre[0] + radius * np.cos(at), centre[1] - radius * np.sin(at), shown, ha="center",
              va="center", rotation=turned, rotation_mode="anchor", fontsize=size,
              color=TEXT)  # fmt: skip


def _canvas(figure: Figure, layout: Mapping[str, Any]) -> tuple[Axes, float, float]:
    """Return axes in px from the upper left corner inside the margins, and their size."""
    width, height = (size * 72 for size in figure.get_size_inches())
    margin = layout["margin"]
    across, down = width - margin["l"] - margin["r"], height - margin["t"] - margin["b"]
    place = (margin["l"] / width, margin["b"] / height, across / width, down / height)
    axes = figure.add_axes(place)
    axes.set(xlim=(0, across), ylim=(down, 0))
    axes.axis("off")
    return axes, across, down


TYPES: Mapping[str, Callable[[Figure, Mapping[str, Any]], None]] = {
    "sankey": sankey,
    "sunburst": sunburst,
}

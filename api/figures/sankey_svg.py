"""Sankey diagrams as SVG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from api.figures import svg
from api.figures.ordering import order
from api.figures.sankey_layout import NODE_WIDTH, PlacedLink, PlacedNode, sankey_layout
from api.figures.svg import BODY, SMALL, Drawing, number

THINNEST = 0.8  # band, px
EMPTY = "No study meets the filters at two neighbouring levels."


@dataclass(frozen=True)
class Mark:
    """What a mark says when it is pointed at, and where it leads."""

    title: str
    href: str | None


@dataclass(frozen=True)
class SankeyMarks:
    """What is drawn: node ids by column, values of links, labels (name, count), colours 1 to 8."""

    columns: Sequence[Sequence[str]]
    values: Mapping[tuple[str, str], float]
    labels: Mapping[str, tuple[str, str]]
    colours: Mapping[str, int]
    headings: Sequence[str]
    pinned: Sequence[int]
    nodes: Mapping[str, Mark]
    bands: Mapping[tuple[str, str], Mark]


def draw_sankey(marks: SankeyMarks, width: float) -> Drawing:
    """Return a drawing of `width` px: bands below, then nodes, labels in front."""
    if not marks.values:
        return Drawing(width, 40, svg.text(0, 20, svg.fit(EMPTY, width), "quiet"))
    columns = order(marks.columns, marks.values, marks.pinned)
    most = max(len(column) for column in columns)
    laid = sankey_layout(
        columns,
        marks.values,
        marks.labels,
        marks.headings,
        width=width,
        flow_height=(250.0 if width > 500 else 200.0) + 12.0 * most,
    )
    size = BODY if width > 500 else SMALL
    widest_first = sorted(laid.links, key=lambda link: -link.width)
    body = [_band(link, marks) for link in widest_first]
    body += [_node(node, marks) for node in laid.nodes]
    body += [_label(node, size) for node in laid.nodes]
    body += [
        svg.text(head.x, head.y, head.text, "heading", size=size, bold=True)
        for head in laid.headings
    ]
    return Drawing(width, laid.height, "".join(body))


def _band(link: PlacedLink, marks: SankeyMarks) -> str:
    half = max(link.width, THINNEST) / 2
    bend = (link.x0 + link.x1) / 2
    # A band of one width in height, not a thick stroke: where it bends hard a stroke would bulge.
    ends = [number(y) for y in (link.y0 - half, link.y1 - half, link.y1 + half, link.y0 + half)]
    x0, x, x1 = number(link.x0), number(bend), number(link.x1)
    d = (
        f"M{x0} {ends[0]}C{x} {ends[0]} {x} {ends[1]} {x1} {ends[1]}"
        f"V{ends[2]}C{x} {ends[2]} {x} {ends[3]} {x0} {ends[3]}Z"
    )
    label = marks.bands[link.source, link.target]
    shape = svg.path(d, f"band c{marks.colours[link.source]}")
    return svg.mark(label.title, label.href, shape, reached=False)


def _node(node: PlacedNode, marks: SankeyMarks) -> str:
    label = marks.nodes[node.id]
    shape = svg.rectangle(
        node.x, node.y, NODE_WIDTH, node.height, f"node c{marks.colours[node.id]}"
    )
    return svg.mark(label.title, label.href, shape)


def _label(node: PlacedNode, size: float) -> str:
    return svg.text(
        node.label_x,
        node.middle,
        node.label.lines,
        size=size,
        anchor="end" if node.outward else "start",
        tail=f" {node.label.tail}",
    )

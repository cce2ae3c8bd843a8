"""Where the nodes, links and labels of a Sankey diagram stand: columns in which nothing overlaps.

Every node has a slot as high as the greater of itself and its label, and slots of a column are
stacked with a gap. Outer labels stand outside of the first and the last column, the others right
of their nodes, in front of the links, where the columns are far enough apart for them. A chain
that is too wide is drawn in several panels, of which each goes on with the level at which the one
before ended.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from api.figures.lettering import line_height, text_width, wrap
from api.figures.ordering import Links
from api.figures.svg import BODY, SMALL

NODE_WIDTH = 12.0
LABEL_GAP = 6.0  # between a node and its label
SLOT_GAP = 4.0  # between slots, at least
WIDEST_GAP = 30.0  # between slots of a column that is shorter than the highest
LEAST_FLOW = 40.0  # of links that are seen between columns
THINNEST = 2.0  # node
HEADING = 30.0  # height of the row of headings
PANEL_GAP = 26.0


@dataclass(frozen=True)
class Label:
    """What is written at a node: its lines, and the end of the last that is its count."""

    lines: tuple[str, ...]
    tail: str
    width: float
    height: float


@dataclass(frozen=True)
class PlacedNode:
    """A node: top left corner and size, and where its label is anchored."""

    id: str
    x: float
    y: float
    height: float
    label: Label
    label_x: float
    outward: bool  # the label ends at label_x, left of the node

    @property
    def middle(self) -> float:
        """Height of the node's middle."""
        return self.y + self.height / 2


@dataclass(frozen=True)
class PlacedLink:
    """A band: the middle of its ends, and its width."""

    source: str
    target: str
    x0: float
    y0: float
    x1: float
    y1: float
    width: float


@dataclass(frozen=True)
class ColumnHeading:
    """Heading of a column."""

    x: float
    y: float
    text: str


@dataclass(frozen=True)
class Layout:
    """All that is drawn of a flow."""

    width: float
    height: float
    nodes: tuple[PlacedNode, ...]
    links: tuple[PlacedLink, ...]
    headings: tuple[ColumnHeading, ...]


@dataclass(frozen=True)
class _Extent:
    """Of a column: what its labels and its heading need left and right of the nodes' left edge."""

    left: float
    right: float


def sankey_layout(
    columns: Sequence[Sequence[str]],
    links: Links,
    labels: Mapping[str, tuple[str, str]],
    headings: Sequence[str],
    *,
    width: float,
    flow_height: float,
) -> Layout:
    """Lay a flow out.

    Parameters
    ----------
    columns : node ids, column by column (two or more), each from top to bottom
    links : (source, target) in neighbouring columns -> value, positive
    labels : node id -> its name and its count
    headings : of the columns
    width : of the drawing, px
    flow_height : of all flow of the fullest column together, px

    Returns
    -------
    Layout
        Its height follows from the slots.
    """
    size = BODY if width > 500 else SMALL
    # Two columns of labels, their nodes and what is seen of the links have room in any case.
    widest = min(190.0, (width - LEAST_FLOW - 2 * (NODE_WIDTH + LABEL_GAP)) / 2)
    written = {node: _label(*labels[node], widest, size) for column in columns for node in column}
    titled = NODE_WIDTH + LABEL_GAP + widest
    heads = tuple(wrap(text, titled, size, 1, bold=True)[0] for text in headings)
    weights = [_weights(columns, links, at) for at in range(len(columns))]
    fullest = max((sum(column.values()) for column in weights), default=0.0)
    scale = flow_height / fullest if fullest else 0.0

    nodes: list[PlacedNode] = []
    bands: list[PlacedLink] = []
    titles: list[ColumnHeading] = []
    top = 0.0
    for first, last in _panels(columns, written, heads, width, size):
        inside = slice(first, last + 1)
        extents = _extents(columns[inside], written, heads[inside], size)
        xs = _spread(extents, width)
        panel = _stack(columns[inside], links, written, xs, top=top + HEADING, scale=scale)
        nodes += panel
        bands += _bands(columns[inside], links, panel, scale)
        for at, x in enumerate(xs):
            start = x - extents[at].left if at == 0 else x
            titles.append(ColumnHeading(start, top + HEADING / 2, heads[first + at]))
        low = max((_bottom(node) for node in panel), default=top + HEADING)
        top = low + PANEL_GAP
    return Layout(width, top - PANEL_GAP + 4, tuple(nodes), tuple(bands), tuple(titles))


def _label(name: str, count: str, widest: float, size: float) -> Label:
    """Return a label in at most two lines, the count always whole at its end."""
    lines = wrap(f"{name} {count}", widest, size)
    if not lines[-1].endswith(f" {count}") and lines[-1] != count:
        room = widest - text_width(f" {count}", size)
        lines = wrap(name, room, size)
        lines = (*lines[:-1], f"{lines[-1]} {count}")
    width = max(text_width(line, size) for line in lines)
    return Label(lines, count, width, len(lines) * line_height(size))


def _weights(columns: Sequence[Sequence[str]], links: Links, at: int) -> dict[str, float]:
    """Return what goes through each node of a column: the greater of what comes in and goes out."""
    into = dict.fromkeys(columns[at], 0.0)
    out = dict.fromkeys(columns[at], 0.0)
    before = set(columns[at - 1]) if at > 0 else set()
    after = set(columns[at + 1]) if at + 1 < len(columns) else set()
    for (source, target), value in links.items():
        if target in into and source in before:
            into[target] += value
        if source in out and target in after:
            out[source] += value
    return {node: max(into[node], out[node]) for node in columns[at]}


def _extents(
    columns: Sequence[Sequence[str]],
    written: Mapping[str, Label],
    heads: Sequence[str],
    size: float,
) -> list[_Extent]:
    found = []
    for at, (column, head) in enumerate(zip(columns, heads, strict=True)):
        label = LABEL_GAP + max((written[node].width for node in column), default=0.0)
        titled = text_width(head, size, bold=True)
        if at == 0:
            found.append(_Extent(label, max(NODE_WIDTH, titled - label)))
        else:
            found.append(_Extent(0.0, max(NODE_WIDTH + label, titled)))
    return found


def _needed(extents: Sequence[_Extent]) -> float:
    return (
        extents[0].left
        + sum(extent.right + LEAST_FLOW for extent in extents[:-1])
        + extents[-1].right
    )


def _panels(
    columns: Sequence[Sequence[str]],
    written: Mapping[str, Label],
    heads: Sequence[str],
    width: float,
    size: float,
) -> list[tuple[int, int]]:
    """Return first and last column of each panel, as many columns in one as have room."""
    found = []
    first = 0
    while first < len(columns) - 1:
        last = first + 1
        while last + 1 < len(columns):
            wider = slice(first, last + 2)
            if _needed(_extents(columns[wider], written, heads[wider], size)) > width:
                break
            last += 1
        found.append((first, last))
        first = last
    return found


def _spread(extents: Sequence[_Extent], width: float) -> list[float]:
    """Return the left edge of each column's nodes; what room is left widens the flows alike."""
    spare = max(0.0, width - _needed(extents)) / (len(extents) - 1)
    xs = [extents[0].left]
    for extent in extents[:-1]:
        xs.append(xs[-1] + extent.right + LEAST_FLOW + spare)
    return xs


def _stack(
    columns: Sequence[Sequence[str]],
    links: Links,
    written: Mapping[str, Label],
    xs: Sequence[float],
    *,
    top: float,
    scale: float,
) -> list[PlacedNode]:
    """Return the nodes of a panel, each column as high as the highest where gaps allow it."""
    heights = []
    for at in range(len(columns)):
        weights = _weights(columns, links, at)
        heights.append({node: max(weights[node] * scale, THINNEST) for node in columns[at]})
    slots = [
        {node: max(height, written[node].height) for node, height in column.items()}
        for column in heights
    ]
    full = max(sum(column.values()) + SLOT_GAP * (len(column) - 1) for column in slots)
    found = []
    for at, column in enumerate(columns):
        total = sum(slots[at].values())
        between = max(len(column) - 1, 1)
        gap = min(max((full - total) / between, SLOT_GAP), WIDEST_GAP)
        y = top + max(0.0, full - total - gap * (len(column) - 1)) / 2
        for node in column:
            height, slot = heights[at][node], slots[at][node]
            outward = at == 0
            label_x = xs[at] - LABEL_GAP if outward else xs[at] + NODE_WIDTH + LABEL_GAP
            middle = y + slot / 2
            found.append(
                PlacedNode(
                    *(node, xs[at], middle - height / 2, height, written[node], label_x, outward)
                )
            )
            y += slot + gap
    return found


def _bands(
    columns: Sequence[Sequence[str]], links: Links, panel: Sequence[PlacedNode], scale: float
) -> list[PlacedLink]:
    """Return the links of a panel, at each node in the order of their other ends."""
    placed = {node.id: node for node in panel}
    column_of = {node: at for at, column in enumerate(columns) for node in column}
    drawn = [
        (source, target, value * scale)
        for (source, target), value in links.items()
        if source in column_of
        and target in column_of
        and column_of[target] == column_of[source] + 1
    ]
    start = _ends(drawn, placed, 0)
    end = _ends(drawn, placed, 1)
    return [
        PlacedLink(
            source,
            target,
            placed[source].x + NODE_WIDTH,
            start[source, target],
            placed[target].x,
            end[source, target],
            width,
        )
        for source, target, width in drawn
    ]


def _ends(
    drawn: Sequence[tuple[str, str, float]], placed: Mapping[str, PlacedNode], side: int
) -> dict[tuple[str, str], float]:
    """Return the height of the links' ends at their sources (side 0) or targets (1)."""
    at_node: dict[str, list[tuple[tuple[str, str], float]]] = {}
    for source, target, width in drawn:
        at_node.setdefault((source, target)[side], []).append(((source, target), width))
    found = {}
    for node, links in at_node.items():
        links.sort(key=lambda link: placed[link[0][1 - side]].middle)
        y = placed[node].middle - sum(width for _, width in links) / 2
        for ends, width in links:
            found[ends] = y + width / 2
            y += width
    return found


def _bottom(node: PlacedNode) -> float:
    return max(node.y + node.height, node.middle + node.label.height / 2)

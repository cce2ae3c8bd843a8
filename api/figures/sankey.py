"""A Sankey diagram as a Plotly specification: nodes in columns, placed so that few bands cross."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from api.figures.specification import HOVER, MUTED, Plotly, faint, specification

PAD, THICKNESS = 17, 14
"""Between nodes of a column, which leaves room for a label, and width of a node, px."""
_BAND, _LIT = 0.32, 0.7  # how much a band hides of what lies below it
_WIDER = 0.3  # how much wider the last gap between columns is
_MARGIN = {"l": 4, "r": 4, "t": 28, "b": 8}


@dataclass(frozen=True)
class Stage:
    """A node: its column from the left, label, colour, and mark (`specification.mark`)."""

    id: str
    column: int
    label: str
    colour: str
    mark: Mapping[str, Any]


@dataclass(frozen=True)
class Band:
    """A link between nodes of neighbouring columns, as wide as its value."""

    source: str
    target: str
    value: float
    mark: Mapping[str, Any]


def sankey(
    stages: Sequence[Stage],
    bands: Sequence[Band],
    headings: Sequence[str],
    pinned: Collection[int] = (),
) -> Plotly:
    """Return the diagram of nodes that have a band.

    Parameters
    ----------
    stages, bands : nodes, each column from top to bottom, and links
    headings : of the columns
    pinned : columns whose order stays as it is given
    """
    linked = {end for band in bands for end in (band.source, band.target)}
    nodes = [stage for stage in stages if stage.id in linked]
    columns = [[n.id for n in nodes if n.column == at] for at in range(len(headings))]
    values = {(band.source, band.target): band.value for band in bands}
    rows = max(map(len, columns), default=0)
    height = max(320, 90 + (PAD + 13) * rows)
    places = _places(order(columns, values, pinned), values, height - _MARGIN["t"] - _MARGIN["b"])
    number = {node.id: at for at, node in enumerate(nodes)}
    tone = {node.id: node.colour for node in nodes}
    last = len(headings) - 1
    # the last column's labels stand left of it, beside those of the column before
    across = [at / (last + _WIDER) for at in range(last)] + [1.0]
    trace = {
        "type": "sankey",
        "arrangement": "fixed",
        "node": {
            "label": [node.label for node in nodes],
            "color": [node.colour for node in nodes],
            # Plotly takes 0 for no place
            "x": [min(max(across[node.column], 0.001), 0.999) for node in nodes],
            "y": [places[node.id] for node in nodes],
            "customdata": [node.mark for node in nodes],
            "hovertemplate": HOVER,
            "line": {"width": 0},
            "pad": PAD,
            "thickness": THICKNESS,
        },
        "link": {
            "source": [number[band.source] for band in bands],
            "target": [number[band.target] for band in bands],
            "value": [band.value for band in bands],
            "color": [faint(tone[band.source], _BAND) for band in bands],
            "hovercolor": [faint(tone[band.source], _LIT) for band in bands],
            "customdata": [band.mark for band in bands],
            "hovertemplate": HOVER,
        },
    }
    notes = [
        {
            "text": heading,
            "x": across[at],
            "y": 1,
            "xref": "paper",
            "yref": "paper",
            "xanchor": {0: "left", last: "right"}.get(at, "center"),
            "yanchor": "bottom",
            "showarrow": False,
            "font": {"color": MUTED},
            "yshift": 4,
        }
        for at, heading in enumerate(headings)
    ]
    return specification(
        [trace] if bands else [],
        height=height,
        narrowest=150 + 170 * last,
        margin=_MARGIN,
        annotations=notes if bands else [],
    )


def _places(
    columns: Sequence[Sequence[str]], values: Mapping[tuple[str, str], float], height: float
) -> dict[str, float]:
    """Return the middle of each node as a share of the height, columns centred."""
    amount = {
        node: max(
            sum(value for (source, _), value in values.items() if source == node),
            sum(value for (_, target), value in values.items() if target == node),
        )
        for column in columns
        for node in column
    }
    filled = [column for column in columns if column]
    unit = min(
        (
            (height - PAD * (len(column) - 1)) / sum(amount[node] for node in column)
            for column in filled
        ),
        default=1.0,
    )
    places = {}
    for column in filled:
        used = unit * sum(amount[node] for node in column)
        gap = min(3 * PAD, (height - used) / (len(column) - 1)) if len(column) > 1 else 0.0
        y = (height - used - gap * (len(column) - 1)) / 2
        for node in column:
            places[node] = (y + unit * amount[node] / 2) / height
            y += unit * amount[node] + gap
    return places


Links = Mapping[tuple[str, str], float]
Columns = Sequence[Sequence[str]]

SWEEPS = 8


def crossings(columns: Columns, links: Links) -> float:
    """Return the sum over pairs of crossing links of the product of their values.

    Parameters
    ----------
    columns : node ids, column by column, each from top to bottom
    links : (source, target) in neighbouring columns -> value
    """
    place = {node: at for column in columns for at, node in enumerate(column)}
    total = 0.0
    for column, following in itertools.pairwise(columns):
        sources, targets = set(column), set(following)
        drawn = sorted(
            (place[source], place[target], value)
            for (source, target), value in links.items()
            if source in sources and target in targets
        )
        total += sum(
            value * other
            for at, (source, target, value) in enumerate(drawn)
            for further, aim, other in drawn[at + 1 :]
            if further > source and aim < target
        )
    return total


def order(
    columns: Columns, links: Links, pinned: Collection[int] = ()
) -> tuple[tuple[str, ...], ...]:
    """Return the columns with their nodes in an order of few crossings.

    Parameters
    ----------
    columns, links : as in `crossings`
    pinned : indices of columns whose order stays as it is given
    """
    best = current = tuple(tuple(column) for column in columns)
    fewest = crossings(best, links)
    into: dict[str, list[tuple[str, float]]] = {}
    out: dict[str, list[tuple[str, float]]] = {}
    for (source, target), value in links.items():
        out.setdefault(source, []).append((target, value))
        into.setdefault(target, []).append((source, value))
    for sweep in range(SWEEPS):
        forth = sweep % 2 == 0
        current = _sweep(current, into if forth else out, pinned, forth=forth)
        found = crossings(current, links)
        if found < fewest:
            best, fewest = current, found
    return best


def _sweep(
    columns: tuple[tuple[str, ...], ...],
    linked: Mapping[str, Sequence[tuple[str, float]]],
    pinned: Collection[int],
    *,
    forth: bool,
) -> tuple[tuple[str, ...], ...]:
    """Return the columns after one sweep; `linked` are the neighbours on the side it comes from."""
    found = list(columns)
    order = range(1, len(columns)) if forth else range(len(columns) - 2, -1, -1)
    for at in order:
        if at in pinned:
            continue
        beside = found[at - 1] if forth else found[at + 1]
        # Relative places, so that columns of different lengths are comparable.
        place = {node: (rank + 0.5) / len(beside) for rank, node in enumerate(beside)}
        own = {node: (rank + 0.5) / len(found[at]) for rank, node in enumerate(found[at])}
        mean = {node: _barycentre(linked.get(node, ()), place, own[node]) for node in found[at]}
        found[at] = tuple(sorted(found[at], key=lambda node: (mean[node], own[node])))
    return tuple(found)


def _barycentre(
    neighbours: Sequence[tuple[str, float]], place: Mapping[str, float], own: float
) -> float:
    weight = sum(value for node, value in neighbours if node in place)
    if weight == 0:
        return own
    return sum(place[node] * value for node, value in neighbours if node in place) / weight

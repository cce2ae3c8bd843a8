"""Order of the nodes of a layered flow so that few of its links cross.

Barycentres (Sugiyama, Tagawa and Toda 1981), swept forth and back: each node goes to the weighted
mean place of those it is linked to. The best order met is kept, so that no sweep makes it worse.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence

Links = Mapping[tuple[str, str], float]
Columns = Sequence[Sequence[str]]

SWEEPS = 8


def crossings(columns: Columns, links: Links) -> float:
    """Return the sum over pairs of crossing links of the product of their values.

    `columns`: node ids, column by column, each from top to bottom. `links`: (source, target) in
    neighbouring columns -> value.
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

    `columns`, `links`: as in `crossings`. `pinned`: indices of columns whose order stays as it is
    given.
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

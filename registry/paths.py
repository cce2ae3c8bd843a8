"""The table of paths: every task > detector > mask > model > extractor that studies took.

Built once from the facts. Study sets are integers, one bit a study.
"""

from __future__ import annotations

import itertools
import weakref
from collections.abc import Iterator

from registry.designs import Design
from registry.flows import LeftOut
from registry.studies import Facts, Study

PATH_LEVELS = ("task", "detector", "mask", "model", "extractor")


class PathTable:
    """Paths and study sets of some facts.

    A path exists if one study has all five of its values, on a sensor that it can have had; what a
    study only compared is none of its values here. A study without a value at one of the levels is
    on none and stands in ``left_out``.
    """

    def __init__(self, facts: Facts) -> None:
        self.taxonomy = facts.taxonomy
        self.keys = facts.keys
        took: dict[tuple[str, ...], int] = {}
        missing: dict[str, list[str]] = {}
        for at, study in enumerate(facts.studies.values()):
            bit = 1 << at
            for level in PATH_LEVELS:
                if not study.of(level):
                    missing.setdefault(level, []).append(study.key)
            for path in _paths_of(study):
                took[path] = took.get(path, 0) | bit
        order = [{v: i for i, v in enumerate(self.taxonomy.values(a))} for a in PATH_LEVELS]
        self.paths: tuple[tuple[str, ...], ...] = tuple(
            sorted(took, key=lambda path: [order[i][v] for i, v in enumerate(path)])
        )
        self.sets = tuple(took[path] for path in self.paths)
        self._on: dict[tuple[str, str, str], list[int]] = {}
        for at, (_, detector, mask, _, extractor) in enumerate(self.paths):
            self._on.setdefault((detector, mask, extractor), []).append(at)
        self._lay_out(order)
        self.left_out = tuple(
            LeftOut(lv, tuple(missing[lv])) for lv in PATH_LEVELS if lv in missing
        )

    def _lay_out(self, order: list[dict[str, int]]) -> None:
        """Give every node and link of the paths a number, in chart order."""
        nodes = sorted(
            {(at, value) for path in self.paths for at, value in enumerate(path)},
            key=lambda node: (node[0], order[node[0]][node[1]]),
        )
        links = sorted(
            {
                (at, *step)
                for path in self.paths
                for at, step in enumerate(itertools.pairwise(path))
            },
            key=lambda link: (link[0], order[link[0]][link[1]], order[link[0] + 1][link[2]]),
        )
        self.nodes = [
            (PATH_LEVELS[at], value, self.taxonomy.name(PATH_LEVELS[at], value))
            for at, value in nodes
        ]
        self.links = [
            (f"{PATH_LEVELS[at]}:{source}", f"{PATH_LEVELS[at + 1]}:{target}")
            for at, source, target in links
        ]
        node_at = {node: i for i, node in enumerate(nodes)}
        link_at = {link: i for i, link in enumerate(links)}
        self.nodes_on = [[node_at[node] for node in enumerate(path)] for path in self.paths]
        self.links_on = [
            [link_at[at, *step] for at, step in enumerate(itertools.pairwise(path))]
            for path in self.paths
        ]

    def of(self, design: Design) -> tuple[int, ...]:
        """Return the paths that lead to a design."""
        kinds = self.taxonomy.kinds
        return tuple(
            at
            for at in self._on.get((*design.architecture, design.extractor), ())
            if not set(kinds("model", self.paths[at][3])).isdisjoint(design.stages)
        )


def _paths_of(study: Study) -> Iterator[tuple[str, ...]]:
    """Give every path of a study: what it stands for, on the sensors that it can have had."""
    for path in itertools.product(*(study.has_value(level) for level in PATH_LEVELS)):
        if study.has_sensor(dict(zip(PATH_LEVELS, path, strict=True))):
            yield path


_TABLES: weakref.WeakKeyDictionary[Facts, PathTable] = weakref.WeakKeyDictionary()


def path_table(facts: Facts) -> PathTable:
    """Return the path table of these facts, built at the first call."""
    table = _TABLES.get(facts)
    if table is None:
        table = _TABLES[facts] = PathTable(facts)
    return table


def positions(bits: int) -> Iterator[int]:
    """Yield the positions of the set bits, lowest first."""
    while bits:
        lowest = bits & -bits
        yield lowest.bit_length() - 1
        bits ^= lowest

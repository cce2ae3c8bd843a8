"""The table of paths: every task > detector > mask > model > extractor that studies took.

Built once from the facts. Study sets are integers, one bit a study.
"""

from __future__ import annotations

import itertools
import weakref
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple, TypeVar

from registry.designs import Design
from registry.flows import LeftOut, Link, Node
from registry.judging import Question
from registry.ranking import Place
from registry.studies import Facts, Study

PATH_LEVELS = ("task", "detector", "mask", "model", "extractor")

_MOST_KEPT = 4096

Key = TypeVar("Key")
Made = TypeVar("Made")


class StudyPath(NamedTuple):
    """A path that studies behind an answer took; ``studies`` are those that meet it."""

    task: str
    detector: str
    mask: str
    model: str
    extractor: str
    studies: tuple[str, ...]

    def to_dict(self) -> dict[str, object]:
        """Return the path as in the HTTP answer."""
        return {**self._asdict(), "studies": list(self.studies)}


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
        # Paths of a design, found when it is first asked for.
        self._paths_of: weakref.WeakKeyDictionary[Design, tuple[int, ...]] = (
            weakref.WeakKeyDictionary()
        )
        self._lay_out(order)
        self.left_out = tuple(
            LeftOut(lv, tuple(missing[lv])) for lv in PATH_LEVELS if lv in missing
        )
        self._keys_of: dict[int, tuple[str, ...]] = {}
        self._nodes_of: dict[tuple[int, int], Node] = {}
        self._links_of: dict[tuple[int, int], Link] = {}

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

    def studies(self, bits: int) -> tuple[str, ...]:
        """Return the keys of a study set."""
        found = self._keys_of.get(bits)
        if found is None:
            found = tuple(self.keys[at] for at in positions(bits))
            _keep(self._keys_of, bits, found)
        return found

    def node(self, at: int, bits: int) -> Node:
        """Return node number `at` with the studies it has."""
        found = self._nodes_of.get((at, bits))
        if found is None:
            level, value, name = self.nodes[at]
            keys = self.studies(bits)
            found = Node(f"{level}:{value}", level, value, name, len(keys), keys)
            _keep(self._nodes_of, (at, bits), found)
        return found

    def link(self, at: int, bits: int) -> Link:
        """Return link number `at` with the studies it has."""
        found = self._links_of.get((at, bits))
        if found is None:
            keys = self.studies(bits)
            found = Link(*self.links[at], len(keys), keys)
            _keep(self._links_of, (at, bits), found)
        return found

    def taken(self, question: Question, places: Iterable[Place]) -> dict[int, int]:
        """Return the paths that lead to the designs of an answer, each with its studies (bits).

        A study counts that meets what is asked; where a design is not measured, one whose stated
        numbers keep the limits.
        """
        include, exclude = question.asked.include, question.asked.exclude
        tasks = set(include.get("task", self.taxonomy.values("task")))
        tasks -= set(exclude.get("task", ()))
        found: dict[int, int] = {}
        for place, designs in places:
            for kept in designs:
                if not kept.design.taken:
                    continue
                meeting = place.studies if kept.row else place.stated
                for at in self._of(kept.design):
                    studies = self.sets[at] & meeting
                    if studies and self.paths[at][0] in tasks:
                        found[at] = found.get(at, 0) | studies
        return found

    def _of(self, design: Design) -> tuple[int, ...]:
        found = self._paths_of.get(design)
        if found is None:
            on = self._on.get((*design.architecture, design.extractor), ())
            kinds = self.taxonomy.kinds
            found = self._paths_of[design] = tuple(
                at
                for at in on
                if not set(kinds("model", self.paths[at][3])).isdisjoint(design.stages)
            )
        return found

    def study_paths(self, taken: Mapping[int, int]) -> tuple[StudyPath, ...]:
        """Return paths with their studies, in the order of the taxonomy."""
        return tuple(
            StudyPath(task, detector, mask, model, extractor, self.studies(taken[at]))
            for at in sorted(taken)
            for task, detector, mask, model, extractor in (self.paths[at],)
        )

    def narrowed(self, taken: Mapping[int, int]) -> tuple[tuple[Node, ...], tuple[Link, ...]]:
        """Return nodes and links of paths, with the studies that took them."""
        node_bits = [0] * len(self.nodes)
        link_bits = [0] * len(self.links)
        for at, studies in taken.items():
            for node in self.nodes_on[at]:
                node_bits[node] |= studies
            for link in self.links_on[at]:
                link_bits[link] |= studies
        return (
            tuple(self.node(at, bits) for at, bits in enumerate(node_bits) if bits),
            tuple(self.link(at, bits) for at, bits in enumerate(link_bits) if bits),
        )


def _paths_of(study: Study) -> Iterator[tuple[str, ...]]:
    """Give every path of a study: what it stands for, on the sensors that it can have had."""
    for path in itertools.product(*(study.supported(level) for level in PATH_LEVELS)):
        if study.has_sensor(dict(zip(PATH_LEVELS, path, strict=True))):
            yield path


_TABLES: weakref.WeakKeyDictionary[Facts, PathTable] = weakref.WeakKeyDictionary()


def path_table(facts: Facts) -> PathTable:
    """Return the path table of these facts, built at the first call."""
    table = _TABLES.get(facts)
    if table is None:
        table = _TABLES[facts] = PathTable(facts)
    return table


def _keep(kept: dict[Key, Made], key: Key, made: Made) -> None:
    """Keep what was made for the next question, without ever keeping much."""
    if len(kept) >= _MOST_KEPT:
        kept.clear()
    kept[key] = made


def positions(bits: int) -> Iterator[int]:
    """Yield the positions of the set bits, lowest first."""
    while bits:
        lowest = bits & -bits
        yield lowest.bit_length() - 1
        bits ^= lowest

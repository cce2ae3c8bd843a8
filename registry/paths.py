"""The table of paths: every task > detector > mask > model > extractor that studies took.

Built once from the facts. Study sets are integers, one bit a study, so that meeting a requirement
is an intersection and a count.
"""

from __future__ import annotations

import itertools
import math
import weakref
from collections.abc import Iterable, Iterator
from typing import NamedTuple, TypeVar

from registry.flows import LeftOut, Link, Node
from registry.measured import Measured, Measurements, Route
from registry.requirements import LIMITS, Requirements
from registry.studies import Facts, Study
from registry.taxonomy import ATTRIBUTES

PATH_LEVELS = ("task", "detector", "mask", "model", "extractor")
STUDY_ATTRIBUTES = tuple(a for a in ATTRIBUTES if a not in PATH_LEVELS)

_MOST_KEPT = 4096

Key = TypeVar("Key")
Made = TypeVar("Made")


class Answer(NamedTuple):
    """One path that meets the requirements, its studies as bits, and on what evidence.

    ``architecture``, ``with_model`` and ``studies`` are the studies that took the path as far as
    its mask, its model, and all along, each less those that do not meet the requirements;
    ``backing`` is the product of their numbers.
    """

    path: int
    architecture: int
    with_model: int
    studies: int
    backing: int
    measured: Measured | None
    basis: tuple[tuple[str, str], ...]  # (limit, "measured" | "stated")


class PathTable:
    """Paths and study sets of some facts.

    A path exists if one study has all five of its values, on a sensor that it can have had; what a
    study only compared is none of its values here. A study without a value at one of the levels is
    on none and stands in ``left_out``.
    """

    def __init__(self, facts: Facts) -> None:
        self.taxonomy = facts.taxonomy
        self.keys = facts.keys
        self.everyone = (1 << len(self.keys)) - 1
        self.having: dict[tuple[str, str], int] = {}
        took: dict[tuple[str, ...], int] = {}
        missing: dict[str, list[str]] = {}
        self.numbers: dict[str, tuple[float | None, ...]] = {
            "max_error_deg": tuple(s.number("accuracy_deg") for s in facts.studies.values()),
            "min_fov_deg": tuple(s.number("fov_deg") for s in facts.studies.values()),
            "max_latency_us": (None,) * len(self.keys),  # no study's latency is in the mapping
        }
        for at, study in enumerate(facts.studies.values()):
            bit = 1 << at
            for attribute in ATTRIBUTES:
                for value in study.of(attribute):
                    self.having[attribute, value] = self.having.get((attribute, value), 0) | bit
            for level in PATH_LEVELS:
                if not study.of(level):
                    missing.setdefault(level, []).append(study.key)
            for path in _paths_of(study):
                for end in range(3, len(PATH_LEVELS) + 1):
                    took[path[:end]] = took.get(path[:end], 0) | bit
        order = [{v: i for i, v in enumerate(self.taxonomy.values(a))} for a in PATH_LEVELS]
        self.paths: tuple[tuple[str, ...], ...] = tuple(
            sorted(
                (path for path in took if len(path) == len(PATH_LEVELS)),
                key=lambda path: [order[i][v] for i, v in enumerate(path)],
            )
        )
        self.all_paths = (1 << len(self.paths)) - 1
        self.sets = [(took[p[:3]], took[p[:4]], took[p]) for p in self.paths]
        self.routes: list[Route] = [(p[1], p[2], p[4], p[3]) for p in self.paths]
        self._lay_out(order)
        self.through: dict[tuple[str, str], int] = {}
        for at, path in enumerate(self.paths):
            for step in zip(PATH_LEVELS, path, strict=True):
                self.through[step] = self.through.get(step, 0) | 1 << at
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

    def meeting(self, requirements: Requirements, measurements: Measurements) -> list[Answer]:
        """Return the paths that meet `requirements`, in taxonomy order.

        A limit is judged on the path's measured rows; on the studies' stated numbers for what no
        row measures. What is neither measured nor stated does not meet a limit.
        """
        studies = self.meeting_studies(requirements)
        limits = [
            (name, bound) for name in LIMITS if (bound := requirements.limit(name)) is not None
        ]
        stated = {name: self.stated_within(name, bound) for name, bound in limits}
        answers = []
        for at in positions(self.meeting_paths(requirements)):
            architecture, with_model, taken = self.sets[at]
            if not taken & studies:
                continue
            for row in measurements.on(self.routes[at]) or (None,):
                kept = studies
                basis: list[tuple[str, str]] = []
                for name, bound in limits:
                    number = None if row is None else measured_number(name, row)
                    if number is None:
                        kept &= stated[name]
                        basis.append((name, "stated"))
                    elif within(name, number, bound):
                        basis.append((name, "measured"))
                    else:
                        kept = 0
                        break
                if taken & kept:
                    sets = (architecture & kept, with_model & kept, taken & kept)
                    backing = sets[0].bit_count() * sets[1].bit_count() * sets[2].bit_count()
                    answers.append(Answer(at, *sets, backing, row, tuple(basis)))
                    break
        return answers

    def meeting_paths(self, requirements: Requirements) -> int:
        """Return the paths (bits) whose own values are asked for and not excluded."""
        kept = self.all_paths
        for attribute in PATH_LEVELS:
            if attribute in requirements.include:
                kept &= self.any_path(attribute, requirements.include[attribute])
            if attribute in requirements.exclude:
                kept &= ~self.any_path(attribute, requirements.exclude[attribute])
        return kept

    def meeting_studies(self, requirements: Requirements) -> int:
        """Return the studies (bits) whose error and accuracy are asked for and not excluded."""
        kept = self.everyone
        for attribute in STUDY_ATTRIBUTES:
            if attribute in requirements.include:
                kept &= self.any_study(attribute, requirements.include[attribute])
            if attribute in requirements.exclude:
                kept &= ~self.any_study(attribute, requirements.exclude[attribute])
        return kept

    def any_path(self, attribute: str, values: Iterable[str]) -> int:
        """Return the paths (bits) through one of the values or their kinds."""
        found = 0
        for value in values:
            for kind in self.taxonomy.kinds(attribute, value):
                found |= self.through.get((attribute, kind), 0)
        return found

    def any_study(self, attribute: str, values: Iterable[str]) -> int:
        """Return the studies (bits) having one of the values or their kinds."""
        found = 0
        for value in values:
            for kind in self.taxonomy.kinds(attribute, value):
                found |= self.having.get((attribute, kind), 0)
        return found

    def stated_within(self, limit: str, bound: float) -> int:
        """Return the studies (bits) whose stated number keeps a limit."""
        found = 0
        for at, number in enumerate(self.numbers[limit]):
            if number is not None and within(limit, number, bound):
                found |= 1 << at
        return found


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


def measured_number(limit: str, row: Measured) -> float | None:
    """Return what a row measured of the quantity a limit is about.

    Of a pipeline that does not answer often enough the error keeps no limit: it is infinite.
    """
    if limit == "max_error_deg":
        return row.rms_deg if row.available else math.inf
    if limit == "min_fov_deg":
        return None if row.half_fov_deg is None else 2 * row.half_fov_deg
    return row.latency_us


def within(limit: str, number: float, bound: float) -> bool:
    """Return whether a number keeps a limit; a bound itself does."""
    return number >= bound if limit.startswith("min_") else number <= bound

"""The paths behind an answer as columns: which are taken, by which studies, all at once.

Only who answers imports this module: it needs NumPy.
"""

from __future__ import annotations

import itertools
import weakref
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from registry.design_columns import DesignColumns, design_columns
from registry.designs import DesignTable
from registry.kept_answers import KeptAnswers
from registry.paths import PathTable, path_table
from registry.ranked_designs import RankedDesigns, RankedPlace

Words = NDArray[np.uint64]

Sets = Sequence[bytes]
"""Sets of studies, each behind the position of its path, node or link, in `POSITION_BYTES`."""

POSITION_BYTES = 8

#: Sets of designs whose paths are kept, of some 600 bytes each.
MOST_SETS = 4096


class PathColumns:
    """The paths of a table as they belong to the designs of another.

    What an answer tells of paths, nodes and links it tells of studies: those of a path, and those
    of all paths through a node or along a link. They are found together, as sets one after
    another: paths in the order of the taxonomy, nodes in chart order, links in chart order.

    Parameters
    ----------
    table : the paths
    columns : the designs
    """

    def __init__(self, table: PathTable, columns: DesignColumns) -> None:
        self.columns = columns
        self._size = len(table.paths)
        self._bytes = self._size // 8 + 1
        self._studies = columns.words_of(table.sets)
        self._among: KeptAnswers[Words] = KeptAnswers()
        # Of each design the paths (bits) that lead to it: in the first half of a row where it is
        # measured, in the second where it is not.
        leading = (
            sum(1 << at for at in (table.of(design) if design.taken else ()))
            << (0 if design.rows else 8 * self._bytes)
            for design in columns.designs
        )
        data = b"".join(paths.to_bytes(2 * self._bytes, "little") for paths in leading)
        self._of_design = np.frombuffer(data, np.uint8).reshape(-1, 2 * self._bytes)
        self._leading: KeptAnswers[tuple[int, int]] = KeptAnswers(MOST_SETS)
        self._of_task: dict[str, int] = {}
        for at, path in enumerate(table.paths):
            self._of_task[path[0]] = self._of_task.get(path[0], 0) | 1 << at
        kinds = ([[at] for at in range(self._size)], table.nodes_on, table.links_on)
        steps = [_paths_by_step(kind) for kind in kinds]
        self._paths = np.array([at for kind in steps for step in kind for at in step], int)
        lengths = [len(step) for kind in steps for step in kind]
        self._starts = np.array([0, *itertools.accumulate(lengths)][:-1], int)
        self._firsts = np.cumsum([len(kind) for kind in steps])[:-1]
        # Sets as they are told: each behind its position among those of its kind.
        self._told = np.zeros((len(lengths), 1 + columns.words), "<u8")
        self._told[:, 0] = np.concatenate([np.arange(len(kind)) for kind in steps])

    def taken(self, ranked: RankedDesigns) -> Taken:
        """Return the paths that lead to the designs of an answer, their nodes and their links.

        A study counts that meets what is asked; where a design is not measured, one whose stated
        numbers keep the limits.
        """
        question, leading = ranked.question, self._leading
        by_row = by_study = 0
        for place in ranked.places:
            led = leading.find(place.meeting) or leading.keep(place.meeting, self._led(place))
            by_row |= led[0]
            by_study |= led[1]
        among = self._of_tasks(question.asked.include, question.asked.exclude)
        every, stated = question.studies, question.all_stated
        if stated == every:
            studies = self._standing_on((by_row | by_study) & among, every)
        else:
            studies = self._standing_on(by_row & among, every)
            studies |= self._standing_on(by_study & among, stated)
        return self._present(studies)

    def _led(self, place: RankedPlace) -> tuple[int, int]:
        """Return the paths (bits) that lead to its measured designs, and those to the others."""
        found = np.bitwise_or.reduce(self._of_design[place.designs], axis=0).tobytes()
        by_row, by_study = found[: self._bytes], found[self._bytes :]
        return int.from_bytes(by_row, "little"), int.from_bytes(by_study, "little")

    def _of_tasks(
        self, include: Mapping[str, Iterable[str]], exclude: Mapping[str, Iterable[str]]
    ) -> int:
        """Return the paths (bits) from a task that is asked for."""
        tasks = set(include.get("task", self._of_task)) - set(exclude.get("task", ()))
        found = 0
        for task in tasks & self._of_task.keys():
            found |= self._of_task[task]
        return found

    def _standing_on(self, paths: int, among: int) -> Words:
        """Return the studies on each path, of some paths (bits) and of some studies (bits)."""
        studies = self._among.get(among, lambda: self._studies & self.columns.words_of([among]))
        data = np.frombuffer(paths.to_bytes(self._bytes, "little"), np.uint8)
        flags = np.unpackbits(data, count=self._size, bitorder="little").view(bool)
        return np.where(flags, studies, 0)

    def _present(self, studies: Words) -> Taken:
        """Return the sets that are not empty; `studies` is of paths, shape (words, paths)."""
        if not self._size:
            return Taken((), (), ())
        words = np.bitwise_or.reduceat(studies.take(self._paths, axis=1), self._starts, axis=1)
        at = np.bitwise_or.reduce(words, axis=0).nonzero()[0]
        rows = self._told.take(at, axis=0)
        rows[:, 1:] = words.take(at, axis=1).T
        sets = rows.view(f"V{rows.itemsize * rows.shape[1]}").ravel().tolist()
        first_node, first_link = at.searchsorted(self._firsts).tolist()
        return Taken(sets[:first_node], sets[first_node:first_link], sets[first_link:])


@dataclass(frozen=True)
class Taken:
    """The paths behind an answer with the studies that took them, and their nodes and links.

    Attributes
    ----------
    paths : in the order of the taxonomy
    nodes, links : in chart order
    """

    paths: Sets
    nodes: Sets
    links: Sets


def unpacked(sets: Sets) -> Iterator[tuple[int, int]]:
    """Yield the positions of sets, each with its studies (bits)."""
    for packed in sets:
        position, studies = packed[:POSITION_BYTES], packed[POSITION_BYTES:]
        yield int.from_bytes(position, "little"), int.from_bytes(studies, "little")


def _paths_by_step(steps_of_paths: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the paths of each step; every step is on one at least."""
    found: dict[int, list[int]] = {}
    for path, steps in enumerate(steps_of_paths):
        for step in steps:
            found.setdefault(step, []).append(path)
    return [found[step] for step in sorted(found)]


_COLUMNS: weakref.WeakKeyDictionary[DesignTable, PathColumns] = weakref.WeakKeyDictionary()


def path_columns(table: DesignTable) -> PathColumns:
    """Return the paths of the facts of a table of designs, laid out at the first call."""
    found = _COLUMNS.get(table)
    if found is None:
        found = _COLUMNS[table] = PathColumns(path_table(table.facts), design_columns(table))
    return found

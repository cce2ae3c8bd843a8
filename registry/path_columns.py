"""The paths behind an answer as columns: which are taken, by which studies, all at once.

Only who answers imports this module: it needs NumPy.
"""

from __future__ import annotations

import itertools
import weakref
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from registry.design_columns import WORD_BITS, DesignColumns, design_columns
from registry.designs import DesignTable
from registry.paths import PathTable, path_table
from registry.ranked_designs import RankedDesigns

Words = NDArray[np.uint64]
Positions = NDArray[np.int64]

Sets = Sequence[tuple[int, bytes]]
"""Positions, each with a set of studies as bytes, the lowest first."""


@dataclass(frozen=True)
class _Steps:
    """Which paths make up each node, or each link, in chart order: `paths` from `starts` on."""

    paths: Positions
    starts: Positions


class PathColumns:
    """The paths of a table as they belong to the designs of another.

    Parameters
    ----------
    table : the paths
    columns : the designs
    """

    def __init__(self, table: PathTable, columns: DesignColumns) -> None:
        self.table = table
        self.columns = columns
        self._sets = columns.words_of(table.sets)
        words = len(table.paths) // WORD_BITS + 1
        data = b"".join(
            sum(1 << at for at in (table.of(design) if design.taken else ())).to_bytes(
                8 * words, "little"
            )
            for design in columns.designs
        )
        self._of_design = np.frombuffer(data, "<u8").reshape(-1, words)
        self._tasks: dict[str, NDArray[np.bool_]] = {}
        for at, path in enumerate(table.paths):
            self._tasks.setdefault(path[0], np.zeros(len(table.paths), bool))[at] = True
        self._nodes = _steps(table.nodes_on)
        self._links = _steps(table.links_on)

    def taken(self, ranked: RankedDesigns) -> Taken:
        """Return the paths that lead to the designs of an answer.

        A study counts that meets what is asked; where a design is not measured, one whose stated
        numbers keep the limits.
        """
        question, columns = ranked.question, self.columns
        measured = columns.measured[ranked.at]
        by_row = self._leading_to(ranked.at[measured])
        by_study = self._leading_to(ranked.at[~measured])
        among = self._of_tasks(question.asked.include, question.asked.exclude)
        if among is not None:
            by_row, by_study = by_row & among, by_study & among
        studies = self._sets & np.where(by_row, columns.words_of([question.studies]), 0)
        studies |= self._sets & np.where(by_study, columns.words_of([question.all_stated]), 0)
        return Taken(self, studies)

    def _leading_to(self, designs: Positions) -> NDArray[np.bool_]:
        leading = np.bitwise_or.reduce(self._of_design[designs], axis=0)
        size = len(self.table.paths)
        return np.unpackbits(leading.view(np.uint8), count=size, bitorder="little").view(bool)

    def _of_tasks(
        self, include: Mapping[str, Iterable[str]], exclude: Mapping[str, Iterable[str]]
    ) -> NDArray[np.bool_] | None:
        if "task" not in include and "task" not in exclude:
            return None
        tasks = set(include.get("task", self._tasks)) - set(exclude.get("task", ()))
        found = np.zeros(len(self.table.paths), bool)
        for task in tasks & self._tasks.keys():
            found |= self._tasks[task]
        return found

    @property
    def nodes(self) -> _Steps:
        """Paths by node."""
        return self._nodes

    @property
    def links(self) -> _Steps:
        """Paths by link."""
        return self._links


class Taken:
    """The paths behind an answer with the studies that took them, and their nodes and links."""

    def __init__(self, columns: PathColumns, studies: Words) -> None:
        self._columns = columns
        self._studies = studies

    @cached_property
    def paths(self) -> Sets:
        """Paths, in the order of the taxonomy."""
        return _present(self._studies)

    @cached_property
    def nodes(self) -> Sets:
        """Nodes, in chart order."""
        return self._along(self._columns.nodes)

    @cached_property
    def links(self) -> Sets:
        """Links, in chart order."""
        return self._along(self._columns.links)

    def _along(self, steps: _Steps) -> Sets:
        if not len(steps.starts):
            return ()
        studies = np.bitwise_or.reduceat(self._studies[:, steps.paths], steps.starts, axis=1)
        return _present(studies)


def _present(studies: Words) -> Sets:
    """Return the sets that are not empty, with their positions; `studies` is (words, sets)."""
    at = np.flatnonzero(studies.any(axis=0))
    rows = np.ascontiguousarray(studies[:, at].T)
    sets = rows.view(f"V{8 * rows.shape[1]}").ravel()
    return list(zip(at.tolist(), sets.tolist(), strict=True))


def _steps(steps_of_paths: Sequence[Sequence[int]]) -> _Steps:
    """Return the paths by step; every step is on one at least."""
    pairs = sorted((step, path) for path, steps in enumerate(steps_of_paths) for step in steps)
    starts = [0, *itertools.accumulate(len(list(same)) for _, same in _grouped(pairs))]
    return _Steps(np.array([path for _, path in pairs], int), np.array(starts[:-1], int))


def _grouped(pairs: Sequence[tuple[int, int]]) -> Iterable[tuple[int, Iterable[tuple[int, int]]]]:
    return itertools.groupby(pairs, key=lambda pair: pair[0])


_COLUMNS: weakref.WeakKeyDictionary[DesignTable, PathColumns] = weakref.WeakKeyDictionary()


def path_columns(table: DesignTable) -> PathColumns:
    """Return the paths of the facts of a table of designs, laid out at the first call."""
    found = _COLUMNS.get(table)
    if found is None:
        found = _COLUMNS[table] = PathColumns(path_table(table.facts), design_columns(table))
    return found

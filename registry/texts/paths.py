"""The paths behind an answer as JSON: which studies took which, their nodes and their links."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache, reduce
from itertools import compress
from operator import or_

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from registry.answer import Answer
from registry.design_arrays import DesignArrays, Words
from registry.paths import PATH_LEVELS, PathTable
from registry.pipelines import begins

#: Sets of paths whose whole text is kept, some 25 kB each, and sets of studies that took them.
MOST_SETS = 256
#: Texts of single paths, nodes and links that are kept.
MOST_TEXTS = 24576


class PathTexts:
    """Paths, nodes and links as JSON.

    Paths are in the order of the taxonomy, nodes and links in chart order. Sets of paths are
    integers, one bit a path.

    Parameters
    ----------
    table : the paths
    arrays : the designs
    studies_text : writes the keys of studies (bits), with commas between them
    """

    def __init__(
        self, table: PathTable, arrays: DesignArrays, studies_text: Callable[[int], bytes]
    ) -> None:
        taken = [(bool(d.rows), at, table.of(d)) for at, d in enumerate(arrays.designs) if d.users]
        # Measured designs and others: their positions, and the paths that lead to each.
        self._leading = [
            (
                np.array([at for has, at, _ in taken if has == measured], int),
                [sum(1 << path for path in paths) for has, _, paths in taken if has == measured],
            )
            for measured in (True, False)
        ]
        self._of_task: dict[str, int] = {}
        for at, (task, *_) in enumerate(table.paths):
            self._of_task[task] = self._of_task.get(task, 0) | 1 << at
        self._words_of = arrays.words_of
        self._studies = arrays.words_of(table.sets)
        # A place of the three lists is a path, a node or a link; all have the studies of paths.
        begun = [
            *((dict(zip(PATH_LEVELS, path, strict=True)), b"") for path in table.paths),
            *(
                (
                    {"id": f"{level}:{value}", "level": level, "value": value, "name": name},
                    b',"count":%d',
                )
                for level, value, name in table.nodes
            ),
            *(
                ({"source": source, "target": target}, b',"value":%d')
                for source, target in table.links
            ),
        ]
        self._firsts = np.cumsum((len(table.paths), len(table.nodes)))
        nodes_from, links_from = self._firsts.tolist()
        on = zip(table.nodes_on, table.links_on, strict=True)
        pairs = sorted(
            (place, path)
            for path, (nodes, links) in enumerate(on)
            for place in (path, *(nodes_from + n for n in nodes), *(links_from + n for n in links))
        )
        places, self._members = np.array(pairs, int).reshape(-1, 2).T
        self._starts = np.flatnonzero(begins(places))
        self._one = _KeptTexts([(to_json(m)[:-1], count) for m, count in begun], studies_text)
        self._taken = lru_cache(MOST_SETS)(self._taken_by)
        self._all = lru_cache(MOST_SETS)(self._all_text)

    def text(self, answer: Answer) -> bytes:
        """Return the paths to the designs of an answer, their nodes and links, as three lists.

        A study counts that meets what is asked; where a design is not measured, one whose stated
        numbers keep the limits. The name of the first list and the end of the last are left out.
        """
        question = answer.question
        asked, designs = question.requirements, question.matching_designs
        among = self._from_tasks(asked.include.get("task"), asked.exclude.get("task", ()))
        measured, others = (
            among & reduce(or_, compress(paths, designs[at].tolist()), 0)
            for at, paths in self._leading
        )
        stated = question.studies_within_limits if others else 0
        return self._all(measured, question.studies, others, stated)

    def _from_tasks(self, include: Iterable[str] | None, exclude: Iterable[str]) -> int:
        """Return the paths from a task that is asked for; None asks for every one."""
        tasks = set(self._of_task if include is None else include).difference(exclude)
        return sum(self._of_task.get(task, 0) for task in tasks)

    def _all_text(self, measured: int, studies: int, others: int, stated: int) -> bytes:
        """Return the text of paths of which some studies count, and others of which others do."""
        paths = self._taken(studies) * self._flags(measured)
        if others:
            paths |= self._taken(stated) * self._flags(others)
        if not len(self._starts):
            return b'],"nodes":[],"links":['
        words = np.bitwise_or.reduceat(paths.take(self._members, axis=1), self._starts, axis=1)
        at = np.bitwise_or.reduce(words, axis=0).nonzero()[0]
        packed = np.empty((len(at), 1 + len(words)), "<u8")
        packed[:, 0] = at
        packed[:, 1:] = words.take(at, axis=1).T
        keys: list[bytes] = packed.view(f"V{8 * packed.shape[1]}").ravel().tolist()
        node, link = at.searchsorted(self._firsts).tolist()
        return b'%b],"nodes":[%b],"links":[%b' % tuple(
            b",".join(map(self._one.__getitem__, part))
            for part in (keys[:node], keys[node:link], keys[link:])
        )

    def _taken_by(self, studies: int) -> Words:
        """Return those of some studies (bits) that took each path, shape (words, paths)."""
        found: Words = self._studies & self._words_of([studies])
        return found

    def _flags(self, paths: int) -> NDArray[np.uint8]:
        """Return 1 for each of some paths (bits), and 0 for the others."""
        size = self._studies.shape[1]
        bits = np.frombuffer(paths.to_bytes(size // 8 + 1, "little"), np.uint8)
        return np.unpackbits(bits, count=size, bitorder="little")


class _KeptTexts(dict[bytes, bytes]):
    """Texts by number and studies, packed as words, each written when it is first asked for.

    All are dropped when there are too many. A dictionary finds the hundreds of an answer in a third
    of the time of a cached function.

    Parameters
    ----------
    begun : text of each number without its studies, and of how many they are
    studies_text : writes the keys of studies
    """

    def __init__(
        self, begun: Sequence[tuple[bytes, bytes]], studies_text: Callable[[int], bytes]
    ) -> None:
        super().__init__()
        self._begun = begun
        self._studies = studies_text

    def __missing__(self, packed: bytes) -> bytes:
        if len(self) >= MOST_TEXTS:
            self.clear()
        at, studies = int.from_bytes(packed[:8], "little"), int.from_bytes(packed[8:], "little")
        begun, count = self._begun[at]
        counted = count % studies.bit_count() if count else b""
        text = self[packed] = b'%b%b,"studies":[%b]}' % (begun, counted, self._studies(studies))
        return text

"""The paths behind an answer: which studies took which, all paths at once.

Needs NumPy, so that only modules that answer questions import it.
"""

from __future__ import annotations

import itertools
import weakref
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from registry.answer import Answer
from registry.design_arrays import WORD_BITS, DesignArrays, design_arrays
from registry.designs import DesignTable
from registry.paths import PATH_LEVELS, PathTable, path_table

Flags = NDArray[np.bool_]
Words = NDArray[np.uint64]

#: Sets of studies whose paths are kept, some 10 kB each.
MOST_SETS = 256
#: Texts of paths, nodes and links that are kept of each kind.
MOST_TEXTS = 8192
_POSITION_BYTES = 8


class StudySets(NamedTuple):
    """Paths behind an answer, their nodes and their links, with the studies of each.

    Each set is packed: the position of its path, node or link, and the studies as bits
    (`unpack`). Paths are in the order of the taxonomy, nodes and links in chart order.
    """

    paths: Sequence[bytes]
    nodes: Sequence[bytes]
    links: Sequence[bytes]


class PathArrays:
    """The paths of facts as they belong to designs.

    Parameters
    ----------
    table : the paths
    arrays : the designs
    """

    def __init__(self, table: PathTable, arrays: DesignArrays) -> None:
        self.arrays = arrays
        self._size = len(table.paths)
        self._of_tasks = lru_cache(MOST_SETS)(self._from_tasks)
        self._among = lru_cache(MOST_SETS)(self._studies_among)
        self._sets = lru_cache(MOST_SETS)(self._present)
        self._studies = arrays.words_of(table.sets)
        # Paths that lead to each design, as bits.
        leading = [sum(1 << at for at in table.of(d)) if d.users else 0 for d in arrays.designs]
        size = 8 * (self._size // WORD_BITS + 1)
        data = b"".join(paths.to_bytes(size, "little") for paths in leading)
        words = np.frombuffer(data, "<u8").reshape(len(leading), size // 8)
        self._leading = np.ascontiguousarray(words.T)
        self._of_task: dict[str, Flags] = {}
        for at, (task, *_) in enumerate(table.paths):
            self._of_task.setdefault(task, np.zeros(self._size, bool))[at] = True
        kinds = ([[at] for at in range(self._size)], table.nodes_on, table.links_on)
        steps = [_paths_by_step(kind) for kind in kinds]
        self._paths = np.array([at for kind in steps for step in kind for at in step], int)
        lengths = [len(step) for kind in steps for step in kind]
        self._starts = np.array([0, *itertools.accumulate(lengths)][:-1], int)
        self._firsts = np.cumsum([len(kind) for kind in steps])[:-1]
        self._packed = np.zeros((len(lengths), 1 + arrays.words), "<u8")
        self._packed[:, 0] = np.concatenate([np.arange(len(kind)) for kind in steps])

    def sets(self, answer: Answer) -> StudySets:
        """Return the paths that lead to the designs of an answer, their nodes and their links.

        A study counts that meets what is asked; where a design is not measured, one whose stated
        numbers keep the limits.
        """
        if not self._size:
            return StudySets((), (), ())
        question, measured = answer.question, self.arrays.is_measured
        include, exclude = question.requirements.include, question.requirements.exclude
        among = self._of_tasks(include.get("task"), exclude.get("task", ()))
        if question.studies == question.studies_within_limits:
            designs = question.matching_designs[None]
            studies: tuple[int, ...] = (question.studies,)
        else:
            designs = question.matching_designs & np.stack((measured, ~measured))
            studies = (question.studies, question.studies_within_limits)
        led = self._led_to(designs) & among
        return self._sets(tuple(zip(map(bytes, led), studies, strict=True)))

    def _led_to(self, designs: Flags) -> Flags:
        """Return the paths that lead to one of some designs, of which each row is flags."""
        leading = np.where(designs[:, None], self._leading, 0)
        found = np.bitwise_or.reduce(leading, axis=2).view(np.uint8)
        return np.unpackbits(found, axis=1, count=self._size, bitorder="little").view(bool)

    def _from_tasks(self, include: tuple[str, ...] | None, exclude: tuple[str, ...]) -> Flags:
        """Return the paths from a task that is asked for; None asks for every one."""
        tasks = set(self._of_task if include is None else include) - set(exclude)
        found = np.zeros(self._size, bool)
        for task in tasks & self._of_task.keys():
            found |= self._of_task[task]
        return found

    def _studies_among(self, studies: int) -> Words:
        """Return those of some studies (bits) that took each path."""
        return self._studies & self.arrays.words_of([studies])

    def _present(self, led: tuple[tuple[bytes, int], ...]) -> StudySets:
        """Return the sets that are not empty.

        Parameters
        ----------
        led : flags of the paths that designs lead to, and the studies (bits) that count on them
        """
        found = [self._among(of) * np.frombuffer(flags, bool) for flags, of in led]
        studies = np.bitwise_or.reduce(found, axis=0)
        words = np.bitwise_or.reduceat(studies.take(self._paths, axis=1), self._starts, axis=1)
        at = np.bitwise_or.reduce(words, axis=0).nonzero()[0]
        rows = self._packed.take(at, axis=0)
        rows[:, 1:] = words.take(at, axis=1).T
        sets = rows.view(f"V{rows.itemsize * rows.shape[1]}").ravel().tolist()
        first_node, first_link = at.searchsorted(self._firsts).tolist()
        parts = (sets[:first_node], sets[first_node:first_link], sets[first_link:])
        return StudySets(*map(tuple, parts))


class PathTexts:
    """Paths, nodes and links as JSON.

    Parameters
    ----------
    table : the paths
    studies_text : writes the keys of studies (bits), with commas between them
    """

    def __init__(self, table: PathTable, studies_text: Callable[[int], bytes]) -> None:
        self._studies = studies_text
        paths = [_begun(zip(PATH_LEVELS, path, strict=True)) for path in table.paths]
        nodes = [
            _begun({"id": f"{level}:{value}", "level": level, "value": value, "name": name}.items())
            for level, value, name in table.nodes
        ]
        links = [
            _begun({"source": source, "target": target}.items()) for source, target in table.links
        ]
        self._kinds = (
            _KeptTexts(partial(self._text, paths, b"")),
            _KeptTexts(partial(self._text, nodes, b',"count":%d')),
            _KeptTexts(partial(self._text, links, b',"value":%d')),
        )
        self.text = lru_cache(MOST_SETS)(self._all)

    def _all(self, sets: StudySets) -> bytes:
        """Return the three lists but for the name of the first and the end of the last."""
        texts = (
            b",".join(map(kept.__getitem__, packed))
            for kept, packed in zip(self._kinds, sets, strict=True)
        )
        return b'%b],"nodes":[%b],"links":[%b' % tuple(texts)

    def _text(self, begun: Sequence[bytes], count: bytes, packed: bytes) -> bytes:
        at, studies = unpack(packed)
        counted = count % studies.bit_count() if count else b""
        return b'%b%b,"studies":[%b]}' % (begun[at], counted, self._studies(studies))


class _KeptTexts(dict[bytes, bytes]):
    """Texts of packed sets, each written when it is first asked for; dropped when too many.

    A dictionary finds the hundreds of an answer in a third of the time of a cached function.
    """

    def __init__(self, write: Callable[[bytes], bytes]) -> None:
        super().__init__()
        self._write = write

    def __missing__(self, packed: bytes) -> bytes:
        if len(self) >= MOST_TEXTS:
            self.clear()
        text = self[packed] = self._write(packed)
        return text


def _begun(members: Iterable[tuple[str, str]]) -> bytes:
    """Return an object in JSON without its end."""
    return to_json(dict(members))[:-1]


def unpack(packed: bytes) -> tuple[int, int]:
    """Return the position that a packed set is of, and its studies (bits)."""
    position, studies = packed[:_POSITION_BYTES], packed[_POSITION_BYTES:]
    return int.from_bytes(position, "little"), int.from_bytes(studies, "little")


def _paths_by_step(steps_of_paths: Sequence[Sequence[int]]) -> list[list[int]]:
    """Return the paths of each step; every step is on one at least."""
    found: dict[int, list[int]] = {}
    for path, steps in enumerate(steps_of_paths):
        for step in steps:
            found.setdefault(step, []).append(path)
    return [found[step] for step in sorted(found)]


_ARRAYS: weakref.WeakKeyDictionary[DesignTable, PathArrays] = weakref.WeakKeyDictionary()


def path_arrays(table: DesignTable) -> PathArrays:
    """Return the paths of the facts of a table of designs, made at the first call."""
    found = _ARRAYS.get(table)
    if found is None:
        found = _ARRAYS[table] = PathArrays(path_table(table.facts), design_arrays(table))
    return found

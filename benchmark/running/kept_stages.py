"""What each stage of a cell is kept by: data, features and predictions, so that none is made twice.

A key is of the digests of all that the stage and those before it depend on. What is kept changes no
number: a stage that is read is bit for bit the one that was made.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmark.contract import Cell
from benchmark.results.components import Components
from benchmark.results.stage_files import StageFiles, limit_bytes

#: Of data: directions, bounds and what else scores need; and the observations with them.
TRUTH, DATA = "truth", "data"
FEATURES, PREDICTIONS = "features", "predictions"


@dataclass(frozen=True)
class KeptStages:
    """Stages kept beside stores, by what they are made with.

    `files` is where they are put, `others` where they are read, too; `components` are digests of
    the code and parameters as they are.
    """

    files: StageFiles
    components: Components
    others: tuple[StageFiles, ...] = ()

    @classmethod
    def beside(
        cls, directory: Path, components: Components, others: Iterable[Path] = ()
    ) -> KeptStages | None:
        """Return what is kept in a store's working directory; None where nothing is to be.

        `others` are working directories of stores that are looked at, too.
        """
        limit = limit_bytes()
        if not limit:
            return None
        folders = [(one / "stages").absolute() for one in (directory, *others)]
        files, *more = (StageFiles(folder, limit) for folder in folders)
        return cls(files, components, tuple(more))

    def get(self, stage: str, cell: Cell) -> Any:
        """Return a stage of a cell; None where it is not kept."""
        key = self.key(stage, cell)
        found = (files.get(key) for files in self._all())
        return next((one for one in found if one is not None), None)

    def put(self, stage: str, cell: Cell, value: Any) -> None:
        """Keep a stage of a cell."""
        self.files.put(self.key(stage, cell), value)

    def keys(self) -> set[str]:
        """Return the keys of all that is kept."""
        return set().union(*(files.keys() for files in self._all()))

    def _all(self) -> tuple[StageFiles, ...]:
        return (self.files, *self.others)

    def key(self, stage: str, cell: Cell) -> str:
        """Name all that a stage of a cell depends on, in one word."""
        condition = cell.condition
        if stage != PREDICTIONS:
            condition = self.components.condition_read(cell.dataset, condition)
        said = [stage, cell.dataset, condition, str(cell.unit)]
        said.append(self.components.stage_key(_STAGE_OF.get(stage, stage), cell))
        return hashlib.sha256("\n".join(said).encode()).hexdigest()[:40]


_STAGE_OF = {TRUTH: DATA}


@dataclass(frozen=True)
class StageCounts:
    """How much is to be done for some cells: where a stage is kept, none before it is.

    Data sets to generate under a condition by a unit each, what extractors are to look at of them,
    models to fit, and scores to compute: of all cells.
    """

    data: int
    features: int
    predictions: int
    scores: int


def count_stages(
    cells: Iterable[Cell], components: Components, kept: KeptStages | None
) -> StageCounts:
    """Count what is to be done for cells of these components, with what is kept of them."""
    there = set() if kept is None else kept.keys()
    data: set[tuple[str, str, int]] = set()
    features: set[tuple[str, str, int, str]] = set()
    predictions = scores = 0
    for cell in cells:
        scores += 1
        read = components.condition_read(cell.dataset, cell.condition)
        place = (cell.dataset, read, cell.unit)
        has = {
            stage: kept is not None and bool(there) and kept.key(stage, cell) in there
            for stage in (TRUTH, DATA, FEATURES, PREDICTIONS)
        }
        if not has[TRUTH]:
            data.add(place)
        if has[PREDICTIONS]:
            continue
        predictions += 1
        if not has[FEATURES]:
            features.add((*place, cell.extractor))
            if not has[DATA]:
                data.add(place)
    return StageCounts(len(data), len(features), predictions, scores)

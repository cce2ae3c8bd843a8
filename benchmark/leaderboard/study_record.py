"""The record of the sensors of single studies: their pipelines by the rules of the leaderboard.

Every pipeline of the studies that such a data set follows is scored on it as on a board that holds
nothing else (`benchmark.leaderboard.scope`).
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from benchmark.contract import Cell
from benchmark.leaderboard import check as checking
from benchmark.leaderboard import scope
from benchmark.leaderboard.check import Difference
from benchmark.leaderboard.update import measure_scope
from benchmark.plan.combinations import study_plans
from benchmark.plan.parts import Parts, study_parts
from benchmark.plan.shown import data_sets
from benchmark.progress import ProgressCallback
from benchmark.results.store import PUBLISHED_STUDIES, Store
from benchmark.running.runner import Summary
from registry.resolution import resolve
from registry.studies import facts

Row = Mapping[str, Any]
#: Data set, extractor and model.
_Run = tuple[str, str, str]


def runs(parts: Parts) -> frozenset[_Run]:
    """Return the pipelines of studies on their own sensors: data set, extractor and model."""
    own, shown, known = study_plans(parts=parts), data_sets(parts=parts), facts("all")
    return frozenset(
        (dataset, pipeline.extractor, pipeline.model)
        for study in own
        for pipeline in resolve(study, {}, own=own, data_sets=shown, facts=known).pipelines
        for dataset in pipeline.datasets
    )


def first(parts: Parts) -> list[Cell]:
    """List what is scored before anything is known, in order (`scope.first`)."""
    used = runs(parts)
    return [cell for cell in scope.first(parts) if _run(cell) in used]


def published_scope(scores: Mapping[Cell, Row], parts: Parts) -> frozenset[Cell]:
    """Return everything that the record holds, given the scores it has."""
    used = runs(parts)
    return frozenset((*first(parts), *_followers(scores, parts, used)))


def _followers(scores: Mapping[Cell, Row], parts: Parts, used: frozenset[_Run]) -> list[Cell]:
    own = {cell: row for cell, row in scores.items() if _run(cell) in used}
    studied = [
        (preset.detector, preset.mask, extractor, model)
        for dataset, extractor, model in used
        if (preset := parts.presets.get(dataset)) is not None
    ]
    return scope.followers(own, parts, studied)


def _run(cell: Cell) -> _Run:
    return cell.dataset, cell.extractor, cell.model


def update(
    directory: Path | str = PUBLISHED_STUDIES,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    parts: Parts | None = None,
) -> Summary:
    """Measure what is missing or out of date, drop what is no longer planned, write the record.

    Parameters and errors as `benchmark.leaderboard.update.update`.
    """
    started = time.perf_counter()
    known, store = parts or study_parts(), Store(directory)
    choose = partial(_followers, used=runs(known))
    return measure_scope(
        store, known, first(known), choose, started, workers=workers, progress=progress
    )


def check(
    directory: Path | str = PUBLISHED_STUDIES,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    stored_only: bool = False,
    parts: Parts | None = None,
) -> list[Difference]:
    """Compare the record with what it follows from; an empty list is a pass.

    With this machine's kernels. Parameters and errors as `benchmark.leaderboard.check.check`.
    """
    store, known = Store(directory), parts or study_parts()
    wanted = published_scope(store.scores(), known)
    found = list(checking.differences_of_files(store, known, wanted))
    if stored_only:
        return found
    measure = partial(update, workers=workers, progress=progress, parts=known)
    return [*found, *checking.measured_again(store, measure)]

"""One algorithm on the board of one data set, beside what the record has there.

Only pipelines with the algorithm are measured, into a working store. All of them are scored on the
standard unit; the best one also on the other units and the drawn benches that the rule of the board
(`benchmark.leaderboard.scope`) gives it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmark.contract import ON_BENCH, Cell, UnknownNameError
from benchmark.leaderboard import scope
from benchmark.leaderboard.board import Row, build
from benchmark.metrics.ranking import order
from benchmark.plan.combinations import cells, list_exclusions
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import ProgressCallback
from benchmark.results.store import Store
from benchmark.running.runner import run, stale


class UnfitError(LookupError):
    """No pipeline with the algorithm fits the data set; the message says why."""


@dataclass(frozen=True)
class Ranking:
    """The board of a data set's first condition with one algorithm on it.

    The board is as `benchmark.leaderboard.board.build` gives it; `pipelines` are extractor and
    model of each with the algorithm, `measured` counts cells measured now, and `scope` says on
    which units and benches these pipelines were scored.
    """

    board: Mapping[str, Any]
    pipelines: frozenset[tuple[str, str]]
    measured: int
    scope: str

    @property
    def rows(self) -> Sequence[Row]:
        """Rows of the board, the best pipeline of each extractor first."""
        (dataset,) = self.board["datasets"]
        rows: Sequence[Row] = dataset["rows"]
        return rows

    def has(self, row: Row) -> bool:
        """Say whether a row of the board is of the algorithm."""
        return (row["extractor"], row["model"]) in self.pipelines


def rank(
    name: str,
    dataset: str,
    record: Store,
    work: Store,
    *,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    parts: Parts | None = None,
) -> Ranking:
    """Score the pipelines with one algorithm and rank them among those of the record.

    `name` is an extractor, a model or a compensation, `dataset` the board's. Nothing is written to
    `record`; new scores go to `work`, and what it holds of the code as it is, is not measured
    again. Other parameters as `benchmark.running.runner.run`. UnknownNameError for a name that is
    not found, UnfitError where no pipeline with the algorithm fits the data set.
    """
    known = parts or installed_parts()
    known = Parts({dataset: known.preset(dataset)}, known.extractors, known.models)
    condition = known.presets[dataset].conditions[0]
    own = _own_cells(name, dataset, condition, known)
    published = record.scores()
    old = [cell for cell in published if _of_board(cell, dataset, condition)]
    pipelines = frozenset((cell.extractor, cell.model) for cell in own)
    # An algorithm of the record that has not changed keeps all its scores.
    mine = [cell for cell in old if (cell.extractor, cell.model) in pipelines]
    kept = set(mine) - set(stale(mine, record, parts=known))

    measured = 0

    def score(wanted: Sequence[Cell]) -> dict[Cell, Any]:
        nonlocal measured
        missing = [cell for cell in wanted if cell not in kept]
        if missing:
            summary = run(missing, work, workers, progress, parts=known, others=[record])
            measured += summary.computed
        there = work.scores()
        return {cell: published[cell] if cell in kept else there[cell] for cell in wanted}

    scores = score(own)
    best = min(own, key=lambda cell: order(scores[cell], cell))
    others = {cell: published[cell] for cell in old if cell not in mine}
    chosen = [
        cell
        for cell in scope.followers({**others, **scores}, known, studied=())
        if (cell.extractor, cell.model) == (best.extractor, best.model)
        and _of_board(cell, dataset, condition)
    ]
    score(chosen)
    wanted = {*own, *chosen}
    rows = [
        *_rows(record, (set(old) - set(mine)) | kept),
        *_rows(work, wanted - kept),
    ]
    board = build(rows, studied=scope.studies_of_pipelines(), pins=record.pins())
    return Ranking(board, pipelines, measured, _scope(len(own), best, chosen))


def _own_cells(name: str, dataset: str, condition: str, parts: Parts) -> list[Cell]:
    """List the pipelines with an algorithm, on the standard unit under the first condition."""
    models = [model for model in parts.models if name in model.split(" + ")]
    if name in parts.extractors:
        found = cells(dataset, condition, name, None, parts=parts)
        refused = list_exclusions(dataset, name, None, parts=parts)
    elif models:
        found = cells(dataset, condition, None, models, parts=parts)
        refused = list_exclusions(dataset, None, models, parts=parts)
    else:
        stages = {stage for model in parts.models for stage in model.split(" + ")}
        raise UnknownNameError("algorithm", name, {*parts.extractors, *stages})
    if not found:
        reason = refused[0].reason if refused else "no pipeline has it"
        raise UnfitError(f"{name} does not fit {dataset}: {reason}")
    return found


def _of_board(cell: Cell, dataset: str, condition: str) -> bool:
    return cell.dataset == dataset and cell.condition in {condition, ON_BENCH}


def _rows(store: Store, wanted: Collection[Cell]) -> list[Row]:
    return [row for row in store.rows(unit=None) if _cell(row) in wanted] if wanted else []


def _cell(row: Row) -> Cell:
    return Cell(row["dataset"], row["condition"], row["extractor"], row["model"], row["unit"])


def _scope(count: int, best: Cell, chosen: Sequence[Cell]) -> str:
    """Say on which units and benches the pipelines of the algorithm were scored."""
    pipeline = f"{best.extractor} + {best.model}"
    units = 1 + sum(cell.condition == best.condition for cell in chosen)
    benches = sum(cell.condition == ON_BENCH for cell in chosen)
    said = "its pipeline" if count == 1 else f"its {count} pipelines"
    if units == 1:
        return (
            f"Scored here: {said} on the standard unit. The board's rule scores further units only "
            f"of the {scope.MOST} pipelines nearest to the first that err up to {scope.CLOSE:g} "
            f"times as much, and of the {scope.MOST} nearest of the others up to {scope.BEHIND:g} "
            "times."
        )
    drawn = f" and drawn benches of {benches} units" if benches else ""
    others = "" if count == 1 else "; the others on the standard unit only"
    return f"Scored here: {pipeline} on {units} units{drawn}, as the board's rule has it{others}."

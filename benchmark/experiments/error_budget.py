"""Errors of each data set's leading pipeline with one part of the chain made perfect at a time."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import geometric_mean
from typing import Any

from algorithms.chain import Scored
from algorithms.contract import Extractor
from benchmark.contract import Cell
from benchmark.datasets.preset import Preset
from benchmark.error_budget import plots
from benchmark.error_budget.measure import score_variants
from benchmark.error_budget.record import RECORD, SCORE
from benchmark.metrics.ranking import order
from benchmark.metrics.separation import store
from benchmark.results.components import current
from benchmark.results.digests import short_digest
from benchmark.results.modules import modules_digest
from benchmark.results.row_file import Row
from benchmark.results.store import Store
from benchmark.running.experiment import RecordedExperiment

#: What measures the variants of a chain, with the data and methods that it is handed.
_CODE = "benchmark.error_budget.measure"
#: Less is none: another machine's rounding, and where iterations stop.
_NOTHING_DEG = 1e-6
#: Data set, extractor, model.
_Place = tuple[str, str, str]


@dataclass(frozen=True)
class BudgetTask:
    """A score of the standard unit, with the data set and the pipeline that it is of."""

    score: Mapping[str, Any]
    preset: Preset
    extractor: type[Extractor]
    model: Scored


class ErrorBudget(RecordedExperiment[str]):
    """Error of each data set's best pipeline with one part of the chain made perfect at a time."""

    name = "error_budget"
    title = "Error budget"
    record = RECORD

    @cached_property
    def leader_rows(self) -> dict[str, Row]:
        """Scores by data set."""
        first = {name: preset.conditions[0] for name, preset in self.parts.presets.items()}
        return leaders(Store(self.directory).rows(unit=None), first)

    def keys(self) -> Mapping[str, str]:
        """Digest the code, the score, and the data set, extractor and model of each."""
        cells = [
            Cell(name, row["condition"], row["extractor"], row["model"])
            for name, row in self.leader_rows.items()
        ]
        components, code = current(self.parts.only(cells)), modules_digest(_CODE)
        return {
            cell.dataset: short_digest(
                [
                    code,
                    *(self.leader_rows[cell.dataset][column] for column in SCORE),
                    components.digest("datasets", cell.dataset),
                    components.digest("extractors", cell.extractor),
                    components.digest("models", cell.model),
                ]
            )
            for cell in cells
        }

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        """Draw error, bound and contributions of every leader."""
        return {"error-budget.svg": lambda: plots.picture(self.rows())}

    def tasks(self, cells: Sequence[str]) -> Iterator[BudgetTask]:
        """Make a task of each data set."""
        for name in cells:
            score = self.leader_rows[name]
            yield BudgetTask(
                score,
                self.parts.preset(name),
                self.parts.extractor(score["extractor"]),
                self.parts.model(score["model"]),
            )

    @staticmethod
    def measure(task: BudgetTask) -> list[tuple[str, Row]]:
        """Measure every variant of the chain (`benchmark.error_budget.variants`)."""
        score = task.score
        found = score_variants(
            task.preset,
            score["condition"],
            task.extractor,
            task.model,
            all_observable=score["n_observable"] == score["n_test"],
        )
        row = {
            **{name: score[name] for name in ("dataset", *SCORE)},
            "answered": round(score["availability"] * score["n_observable"]),
            "judged": found.judged,
            **{f"{name}_deg": _stored(error) for name, error in found.errors_deg.items()},
        }
        return [(score["dataset"], row)]


def leaders(scores: Iterable[Mapping[str, Any]], conditions: Mapping[str, str]) -> dict[str, Row]:
    """Return of each data set the score, on the standard unit, of the pipeline that leads it.

    By the geometric mean of its errors over the units that it was scored on.
    """
    errors: dict[_Place, list[float | None]] = {}
    standard: dict[_Place, Row] = {}
    for row in scores:
        place = row["dataset"], row["extractor"], row["model"]
        if row["condition"] == conditions.get(row["dataset"]):
            errors.setdefault(place, []).append(row["rms_all_answers_deg"])
            if row["unit"] == 0 and row["rms_deg"] is not None:
                standard[place] = dict(row)
    best: dict[str, tuple[Any, Row]] = {}
    for (name, *pipeline), row in standard.items():
        own = _own_deg(errors[name, pipeline[0], pipeline[1]])
        place_of = order({**row, "rms_all_answers_deg": own}, pipeline)
        if name not in best or place_of < best[name][0]:
            best[name] = place_of, row
    return {name: best[name][1] for name in sorted(best)}


def _own_deg(errors: Collection[float | None]) -> float | None:
    known = [error for error in errors if error is not None and error > 0]
    return geometric_mean(known) if len(known) == len(errors) else None


def _stored(error: float | None) -> float | None:
    if error is None:
        return None
    return store(error) if error > _NOTHING_DEG else 0.0

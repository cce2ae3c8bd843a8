"""How far the best method of a study is behind the best one measured, both calibrated."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from algorithms.calibration.drawn import DrawnModel
from algorithms.chain import Chain
from benchmark.contract import Cell
from benchmark.leaderboard.board import NOMINAL
from benchmark.leaderboard.findings.finding import Estimate, Finding, number
from benchmark.leaderboard.findings.record import FindingsRecord
from registry.catalogue import catalogue
from registry.resolution import Resolution
from registry.studies import METHODS

#: Times the error over observable samples above which an error is mostly that of false detections.
PENALTY = 2.0
#: What a method rests on that is not the study's: memory, or a choice of ours.
_NOT_THE_STUDYS = frozenset({"recalled", "defaulted"})


@dataclass(frozen=True)
class Use:
    """A pipeline of a study on a data set, as the registry maps it."""

    study: str
    cell: Cell
    chosen: bool


def methods(record: FindingsRecord, resolutions: Mapping[str, Resolution]) -> Finding:
    """Compare the best method of each study with the best one measured on the same data set.

    Pipelines that several studies share count once.
    """
    uses = [use for use in _uses(resolutions) if use.cell in record.rows]
    left_out = [_without(set(resolutions) - {use.study for use in uses}, "without a score")]
    for keep, said in _steps(record):
        kept = [use for use in uses if keep(use)]
        left_out.append(_without({use.study for use in uses} - {use.study for use in kept}, said))
        uses = kept
    best = _best_of_studies(record, uses)
    users: dict[Cell, list[str]] = {}
    for study, cell in sorted(best.items()):
        users.setdefault(cell, []).append(study)
    pairs = tuple(_pair(record, cell, users[cell]) for cell in sorted(users))
    one = f"pipelines of {len(best)} studies"
    own = Estimate.median("ratio of own errors", [pair["ratio"] for pair in pairs], one)
    bench = Estimate.median(
        "ratio of errors on the standard bench", [pair["bench_ratio"] for pair in pairs], one
    )
    return Finding(
        "methods",
        f"A calibrated method of a study has {number(own.value)} times the own error of the best "
        f"one, and {number(bench.value)} times its error on a bench.",
        f"Median of {own.n} pipelines that {len(best)} studies used, each against the best one "
        f"measured on the same data set; 95 % interval {own.interval} with true directions, "
        f"{bench.interval} with the error of the standard bench in both.",
        (own, bench),
        tuple(filter(None, left_out)),
        pairs,
    )


def _uses(resolutions: Mapping[str, Resolution]) -> Iterator[Use]:
    for study, found in resolutions.items():
        for pipeline in found.pipelines:
            chosen = any(pipeline.basis[part] in _NOT_THE_STUDYS for part in METHODS)
            for dataset in dict.fromkeys(setting.dataset for setting in pipeline.settings):
                cell = Cell(dataset, NOMINAL, pipeline.extractor, pipeline.model)
                yield Use(study, cell, chosen)


def _steps(record: FindingsRecord) -> tuple[tuple[Callable[[Use], bool], str], ...]:
    """Return what a use has to be, and how those are called that are not, in order."""

    def honest(use: Use) -> bool:
        row = record.rows[use.cell]
        return bool(row["rms_all_answers_deg"] <= PENALTY * row["rms_deg"])

    return (
        (honest, "whose error is mostly that of false detections"),
        (lambda use: not use.chosen, "whose extractor or model we chose"),
        (lambda use: not is_drawn(use.cell.model), "whose model has no fitted constant"),
    )


def is_drawn(model: str) -> bool:
    """Return whether a model takes all its constants from the drawing."""
    scored = catalogue().models[model]
    last = scored.model if isinstance(scored, Chain) else scored
    return issubclass(last, DrawnModel)


def _without(studies: set[str], said: str) -> str:
    named = f" ({', '.join(sorted(studies))})" if len(studies) <= 3 else ""
    noun = "study" if len(studies) == 1 else "studies"
    return f"{len(studies)} {noun} {said}{named}" if studies else ""


def _best_of_studies(record: FindingsRecord, uses: list[Use]) -> Mapping[str, Cell]:
    """Return the pipeline of each study that is nearest to the best on its data set."""
    found: dict[str, tuple[float, Cell]] = {}
    for use in uses:
        place = record.ratio(use.cell, record.best[use.cell.dataset]), use.cell
        found[use.study] = min(found.get(use.study, place), place)
    return {study: cell for study, (_, cell) in found.items()}


def _pair(record: FindingsRecord, cell: Cell, studies: list[str]) -> dict[str, Any]:
    best, bench = record.best[cell.dataset], record.bench_deg[cell.dataset]
    return {
        "dataset": cell.dataset,
        "extractor": cell.extractor,
        "model": cell.model,
        "studies": studies,
        "own_error_deg": record.own_error_deg(cell),
        "best_extractor": best.extractor,
        "best_model": best.model,
        "best_own_error_deg": record.own_error_deg(best),
        "bench_deg": bench,
        "ratio": record.ratio(cell, best),
        "bench_ratio": record.ratio(cell, best, (bench, bench)),
    }

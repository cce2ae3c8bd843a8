"""The table of what holds each data set's best pipeline back: kept beside this module, renewed."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from contextlib import closing
from pathlib import Path
from statistics import geometric_mean
from typing import Any, cast

from benchmark.datasets.preset import Preset
from benchmark.leaderboard.holding.variants import VARIANTS
from benchmark.leaderboard.ranking import order
from benchmark.metrics.score import stored
from benchmark.plan.parts import Parts
from benchmark.progress import ProgressCallback, silent
from benchmark.results.tables import (
    Reader,
    Row,
    StoreError,
    count,
    read,
    size,
    text_of,
    word,
)
from files.atomic import replace_file
from files.locks import lock_or_refuse

PATH = Path(__file__).with_name("held_back.csv")

#: Which score the row is of, as the record has it.
_SCORE = ("condition", "extractor", "model", "rms_deg", "bound_deg", "bound_unit_deg")
#: Data set, extractor, model.
Place = tuple[str, str, str]
_COLUMNS: Mapping[str, Reader] = {
    "dataset": word,
    "condition": word,
    "extractor": word,
    "model": word,
    "rms_deg": size,
    "bound_deg": size,
    "bound_unit_deg": size,
    "answered": count,
    "judged": count,
    **{f"{name}_deg": size for name in VARIANTS},
}


def rows(path: Path = PATH) -> dict[str, Row]:
    """Return the table by data set; StoreError for a line that is none."""
    found: dict[str, Row] = {}
    for line, row in read(path, _COLUMNS):
        if found.setdefault(row["dataset"], row) is not row:
            raise StoreError(f"{path}, line {line}: {row['dataset']} is there twice")
    return found


def leaders(scores: Iterable[Mapping[str, Any]], conditions: Mapping[str, str]) -> dict[str, Row]:
    """Return of each data set the score, on the standard unit, of the pipeline that leads it.

    By the geometric mean of its errors over the units that it was scored on.

    Parameters
    ----------
    scores
        Rows of all units, as `Store.rows` gives them.
    conditions
        The condition by data set.
    """
    errors: dict[Place, list[float | None]] = {}
    standard: dict[Place, Row] = {}
    for row in scores:
        place = row["dataset"], row["extractor"], row["model"]
        if row["condition"] == conditions.get(row["dataset"]):
            errors.setdefault(place, []).append(row["charged_deg"])
            if row["unit"] == 0 and row["rms_deg"] is not None:
                standard[place] = dict(row)
    best: dict[str, tuple[Any, Row]] = {}
    for (name, *pipeline), row in standard.items():
        own = _own_deg(errors[name, pipeline[0], pipeline[1]])
        place_of = order({**row, "charged_deg": own}, pipeline)
        if name not in best or place_of < best[name][0]:
            best[name] = place_of, row
    return {name: best[name][1] for name in sorted(best)}


def _own_deg(errors: Collection[float | None]) -> float | None:
    known = [error for error in errors if error is not None and error > 0]
    return geometric_mean(known) if len(known) == len(errors) else None


def behind(known: Mapping[str, Row], leading: Mapping[str, Row]) -> list[str]:
    """Name the data sets whose row is not of the score that leads now."""
    return [
        name
        for name, score in leading.items()
        if name not in known or any(known[name][column] != score[column] for column in _SCORE)
    ]


def renew(
    leading: Mapping[str, Row],
    parts: Parts,
    *,
    only: Collection[str] | None = None,
    path: Path = PATH,
    workers: int = 1,
    progress: ProgressCallback = silent,
) -> list[str]:
    """Measure what is behind, or the data sets named; return their names.

    The table is written after each, so that a call that is broken off is gone on with. Rows of
    data sets that nothing leads any more are dropped.

    Raises
    ------
    ValueError
        For less than one worker.
    LockedError
        When another process renews the table.
    """
    from benchmark.running.workers import as_completed  # noqa: PLC0415 - loads Numba

    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    with lock_or_refuse(path):
        known = {name: row for name, row in rows(path).items() if name in leading}
        wanted = [n for n in leading if n in only] if only is not None else behind(known, leading)
        progress(0, len(wanted), "")
        tasks = [(leading[name], parts) for name in wanted]
        with closing(as_completed(_measured, tasks, workers if len(tasks) > 1 else 1)) as found:
            for done, row in enumerate(found, start=1):
                known[row["dataset"]] = row
                replace_file(path, text_of(list(_COLUMNS), [known[n] for n in sorted(known)]))
                progress(done, len(wanted), row["dataset"])
    return wanted


def _measured(task: tuple[Mapping[str, Any], Parts]) -> Row:
    return measured(*task)


def measured(score: Mapping[str, Any], parts: Parts) -> Row:
    """Return the row of one score, measured now."""
    from benchmark.leaderboard.holding.measure import held  # noqa: PLC0415 - loads Numba

    found = held(
        cast("Preset", parts.preset(score["dataset"])),
        score["condition"],
        parts.extractor(score["extractor"]),
        parts.model(score["model"]),
        all_observable=score["n_observable"] == score["n_test"],
    )
    errors = {f"{name}_deg": _stored(error) for name, error in found.errors_deg.items()}
    told = {name: score[name] for name in ("dataset", *_SCORE)}
    answered = round(score["availability"] * score["n_observable"])
    return {**told, "answered": answered, "judged": found.judged, **errors}


#: Less is none: another machine's rounding, and where iterations stop.
_NOTHING_DEG = 1e-6


def _stored(error: float | None) -> float | None:
    if error is None:
        return None
    return stored(error) if error > _NOTHING_DEG else 0.0

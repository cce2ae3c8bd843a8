"""The table of what holds each data set's best pipeline back: kept beside this module, renewed."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any, cast

from benchmark.datasets.preset import Preset
from benchmark.leaderboard.holding.measure import VARIANTS, held
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
from survey_data.locks import held_alone
from survey_data.whole_files import replace_file

PATH = Path(__file__).with_name("held_back.csv")

#: Which score the row is of, as the record has it.
_SCORE = ("condition", "extractor", "model", "rms_deg", "bound_deg")
_COLUMNS: Mapping[str, Reader] = {
    "dataset": word,
    "condition": word,
    "extractor": word,
    "model": word,
    "rms_deg": size,
    "bound_deg": size,
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
    """Return of each data set the score that ranks first under one condition.

    Parameters
    ----------
    scores
        Rows as `Store.rows` gives them.
    conditions
        The condition by data set.
    """
    best: dict[str, tuple[Any, Row]] = {}
    for row in scores:
        name = row["dataset"]
        if row["condition"] != conditions.get(name) or row["unit"] or row["rms_deg"] is None:
            continue
        place = order(row, (row["extractor"], row["model"]))
        if name not in best or place < best[name][0]:
            best[name] = place, dict(row)
    return {name: best[name][1] for name in sorted(best)}


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
    progress: ProgressCallback = silent,
) -> list[str]:
    """Measure what is behind, or the data sets named; return their names.

    The table is written after each, so that a call that is broken off is gone on with. Rows of
    data sets that nothing leads any more are dropped.

    Raises
    ------
    HeldError
        When another process renews the table.
    """
    with held_alone(path):
        known = {name: row for name, row in rows(path).items() if name in leading}
        wanted = [n for n in leading if n in only] if only is not None else behind(known, leading)
        for done, name in enumerate(wanted):
            progress(done, len(wanted), name)
            known[name] = measured(leading[name], parts)
            replace_file(path, text_of(list(_COLUMNS), [known[n] for n in sorted(known)]))
    progress(len(wanted), len(wanted), "")
    return wanted


def measured(score: Mapping[str, Any], parts: Parts) -> Row:
    """Return the row of one score, measured now."""
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

"""The leaderboard: every pipeline on every dataset and condition, best first, against the bound.

All of it follows from the stored scores and times: `build` and `write` render nothing and give the
same bytes for the same rows. `check` (see `benchmark.leaderboard_check`) says where the committed
files are not what they should be.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace as replace_fields
from itertools import groupby
from pathlib import Path
from typing import Any

from benchmark import data_pins, sweeps
from benchmark.content_key import SCHEMA_VERSION, Specifications
from benchmark.leaderboard_check import Difference, check
from benchmark.leaderboard_formats import FORMATS
from benchmark.plan import cells
from benchmark.plan_parts import Parts
from benchmark.runner import Summary, run
from benchmark.runner_progress import ProgressCallback
from benchmark.scoring import METRIC_VERSION
from benchmark.store import PUBLISHED, Row, Store, cell_of, collector_paused, replace

__all__ = ["Difference", "build", "check", "update", "write"]


def build(
    rows: Iterable[Row], runs: Mapping[str, Row], swept: Iterable[Row] = ()
) -> dict[str, Any]:
    """Rank stored rows within each dataset and condition.

    Parameters
    ----------
    rows
        Score rows as `Store.rows` gives them.
    runs
        Times by key as `Store.runs` gives them; only their ratio to the reference is shown.
    swept
        Rows of sweeps as `benchmark.sweeps.read` gives them.

    Returns
    -------
    dict
        ``schema``, ``metric_version``, ``sweeps`` (as given) and ``datasets``: each with
        ``name``, ``version``, ``detector``, ``mask``, ``conditions`` and ``rows``. A row is the
        score row with ``rank`` (by rms error; null where there is none) and ``time_ratio``.
    """
    ranked = sorted(rows, key=_order)
    datasets = []
    for name, of_dataset in groupby(ranked, key=lambda row: row["dataset"]):
        listed = []
        conditions = []
        for condition, group in groupby(of_dataset, key=lambda row: row["condition"]):
            conditions.append(condition)
            for place, row in enumerate(group, start=1):
                rank = place if row["rms_deg"] is not None else None
                ratio = runs.get(row["key"], {}).get("time_ratio")
                listed.append({"rank": rank, **row, "time_ratio": ratio})
        datasets.append(
            {
                "name": name,
                "version": listed[0]["dataset_version"],
                "detector": listed[0]["detector"],
                "mask": listed[0]["mask"],
                "conditions": conditions,
                "rows": listed,
            }
        )
    return {
        "schema": SCHEMA_VERSION,
        "metric_version": METRIC_VERSION,
        "datasets": datasets,
        "sweeps": list(swept),
    }


def files(store: Store) -> dict[str, str]:
    """Make the text of every leaderboard file from what a store holds."""
    with collector_paused():
        board = build(store.rows(), store.runs(), sweeps.read(store.directory))
        return {name: form.render(board) for name, form in FORMATS.items()}


def write(directory: Path | str = PUBLISHED) -> list[Path]:
    """Derive the leaderboard files from the results beside them; returns those that changed."""
    store = Store(directory)
    changed = []
    for name, text in files(store).items():
        path = store.directory / name
        if replace(path, text):
            changed.append(path)
    return changed


def update(
    directory: Path | str = PUBLISHED,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    scheduler: str | None = None,
    parts: Parts | None = None,
) -> Summary:
    """Measure what is missing or out of date, drop what is no longer planned, write the files.

    Every dataset's data are pinned, whether anything can be measured on them or not, and every
    extractor is measured on the reference features (`benchmark.sweeps`).

    Parameters and errors as `benchmark.runner.run`.
    """
    specifications = Specifications()
    summary = run(
        cells(parts=parts),
        Store(directory),
        workers,
        progress,
        scheduler=scheduler,
        only_these=True,
        parts=parts,
        specifications=specifications,
    )
    pinned = data_pins.update(
        Store(directory), workers, progress, parts=parts, specifications=specifications
    )
    swept = sweeps.update(
        directory, workers, progress, extractors=parts.extractors if parts else None
    )
    write(directory)
    failed = (f"sweep {point} failed: {reason}" for point, reason in swept.failed)
    return replace_fields(summary, warnings=(*summary.warnings, *pinned.warnings, *failed))


def _order(row: Row) -> tuple[object, ...]:
    rms = row["rms_deg"]
    return (row["dataset"], row["condition"], rms is None, rms or 0.0, cell_of(row))

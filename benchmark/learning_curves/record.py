"""The published learning curves: one file, a line a pipeline, with a digest of what it is of."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchmark.learning_curves.leaders import Leader
from benchmark.learning_curves.reading import CurveRow, Row, summary
from benchmark.results.row_file import RowFile
from benchmark.results.store import PUBLISHED


def leader_of(row: Row) -> Leader:
    """Return the pipeline that a row is of."""
    names = ("dataset", "place", "condition", "extractor", "model")
    return Leader(**{name: row[name] for name in names})


RECORD = RowFile("curves.json", "curves", 2, leader_of, CurveRow)


def published_curves(directory: Path | str = PUBLISHED) -> list[dict[str, Any]]:
    """Return stored rows as they are shown (`reading.summary`), without digests, in order."""
    return [
        {name: value for name, value in summary(row).items() if name != "key"}
        for row in RECORD.read(directory).values()
    ]

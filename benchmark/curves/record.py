"""The published learning curves: one file, a line a pipeline, with a digest of what it is of."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from benchmark.canonical import digest
from benchmark.curves.leaders import Leader
from benchmark.curves.reading import Row, require_row, summary
from benchmark.results import recorded
from benchmark.results.components import Components
from benchmark.results.digests import modules_digest
from benchmark.results.store import PUBLISHED
from benchmark.results.tables import StoreError
from files.reading import FileRefusedError
from files.strict_json import read_json, require_members

NAME = "curves.json"
#: Layout of the file; raised when a member changes its meaning.
SCHEMA_VERSION = 2

#: Modules between data and methods, and what is kept of a curve.
_CODE = (
    "algorithms.kernels.reference_correction",
    "algorithms.pipeline",
    "algorithms.references",
    "benchmark.curves.draws",
    "benchmark.curves.floor",
    "benchmark.curves.measure",
    "benchmark.curves.outcome",
    "benchmark.datasets.corrected",
    "benchmark.datasets.features",
    "benchmark.metrics.score",
)
_DIGITS = 16


class CurvesError(StoreError):
    """The file of learning curves cannot be read; the message names it."""


def code_digest() -> str:
    """Digest of the code that makes curves of data and methods."""
    return modules_digest(*_CODE)


def key_of(leader: Leader, components: Components, code: str) -> str:
    """Everything a pipeline's curve depends on, in one word.

    Parameters
    ----------
    leader
        The pipeline.
    components
        As the code now is.
    code
        `code_digest`.

    Raises
    ------
    ComponentsError
        Where the components lack one that the pipeline is of.
    """
    parts = (
        code,
        leader.condition,
        components.digest("datasets", leader.dataset),
        components.digest("extractors", leader.extractor),
        components.digest("models", leader.model),
    )
    return digest(list(parts))[:_DIGITS]


def read(directory: Path | str = PUBLISHED) -> dict[Leader, Row]:
    """Return stored rows by pipeline, sorted; none where there is no file.

    Raises
    ------
    CurvesError
        For a file that is none of learning curves, or of another layout.
    """
    path = Path(directory) / NAME
    try:
        held = require_members(read_json(path), path, {"schema": int, "curves": list})
        if held["schema"] != SCHEMA_VERSION:
            raise CurvesError(f"{path}: expected schema {SCHEMA_VERSION}, got {held['schema']!r}")
        found: dict[Leader, Row] = {}
        for number, row in enumerate(held["curves"], start=1):
            require_row(path, number, row)
            if _leader(row) in found:
                raise CurvesError(f"{path}, curve {number}: {_leader(row)} is there twice")
            found[_leader(row)] = row
    except FileNotFoundError:
        return {}
    except FileRefusedError as error:
        raise CurvesError(str(error)) from error
    return {leader: found[leader] for leader in sorted(found)}


def shown(directory: Path | str = PUBLISHED) -> list[dict[str, Any]]:
    """Return stored rows as they are shown (`reading.summary`), without digests, in order."""
    return [
        {name: value for name, value in summary(row).items() if name != "key"}
        for row in read(directory).values()
    ]


def write(rows: Iterable[Row], directory: Path | str = PUBLISHED) -> bool:
    """Write the file, whole or not at all; True when it changed."""
    sorted_rows = sorted(rows, key=_leader)
    lines = ",\n".join(
        json.dumps(row, allow_nan=False, separators=(",", ":")) for row in sorted_rows
    )
    text = f'{{"schema":{SCHEMA_VERSION},"curves":[\n{lines}\n]}}\n'
    return recorded.write(Path(directory), {NAME: text})


def stale(
    stored: Mapping[Leader, Row], wanted: Iterable[Leader], components: Components
) -> Iterator[tuple[Leader, str]]:
    """Yield what is not as code, data and board are, and why, sorted.

    Parameters
    ----------
    stored
        Rows as `read` gives them.
    wanted
        The leaders of the board.
    components
        As the code now is.
    """
    expected = set(wanted)
    code = code_digest()
    for leader in sorted(stored.keys() | expected):
        if leader not in expected:
            yield leader, "no longer leads"
        elif leader not in stored:
            yield leader, "absent"
        elif stored[leader]["key"] != key_of(leader, components, code):
            yield leader, "of other code or data"


def _leader(row: Mapping[str, Any]) -> Leader:
    names = ("dataset", "place", "condition", "extractor", "model")
    return Leader(**{name: row[name] for name in names})

"""What recommendations need of the measurements, kept between calls of the command line.

To make it, every implementation and data set is imported and every score read, which takes longer
than to answer. It is kept in the working store with a digest of all it is made from - code, scores,
times - and is made anew where that has changed. It may be deleted at any time.
"""

from __future__ import annotations

import gc
import hashlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import fields
from pathlib import Path
from typing import Any

from pydantic_core import from_json, to_json

from api.cli.working import working_directory
from files.atomic import replace_file
from registry.measured_pipelines import MeasuredPipeline, Measurements, Score

FILE = "prepared-measurements.json"

_ROOT = Path(__file__).resolve().parents[2]
_PUBLISHED = _ROOT / "benchmark" / "published"
#: Python files that make it, and what they read.
_CODE = ("algorithms", "benchmark", "files", "registry", "survey_data")
_MAKERS = ("api/http/measurements.py", "api/cli/prepared_measurements.py")
_READ = ("components.json", "pins.csv", "scores/*.csv", "times*")

_SCORE = tuple(field.name for field in fields(Score))
_MEASURED = tuple(field.name for field in fields(MeasuredPipeline))


def measure() -> Measurements:
    """Return what is measured of every pipeline, times included."""
    path, key = working_directory() / FILE, digest()
    gc.disable()  # it would walk all that is read again and again, of which nothing goes
    try:
        rows = _keep(path, key)
        if rows is None:
            rows = _made()
            with suppress(OSError):  # no room, or not ours to write: then it is made at every call
                replace_file(path, to_json({"key": key, "rows": list(map(_plain, rows))}).decode())
        return Measurements(rows)
    finally:
        gc.enable()


def digest() -> str:
    """Return the digest of all that it is made from."""
    found = hashlib.blake2b(digest_size=16)
    for path in _sources():
        content = path.read_bytes()
        found.update(f"{path.name} {len(content)}\n".encode())
        found.update(content)
    return found.hexdigest()


def _sources() -> Iterator[Path]:
    for package in _CODE:
        yield from sorted((_ROOT / package).rglob("*.py"))
    yield from (_ROOT / name for name in _MAKERS)
    for pattern in _READ:
        yield from sorted(_PUBLISHED.glob(pattern))


def _made() -> list[MeasuredPipeline]:
    from api.http.measurements import Measurements as Published  # noqa: PLC0415 - slow, see above

    return Published().pipelines


def _keep(path: Path, key: str) -> list[MeasuredPipeline] | None:
    try:
        document = from_json(path.read_bytes())
        return [_row(row) for row in document["rows"]] if document["key"] == key else None
    except (OSError, ValueError, TypeError, KeyError):
        return None  # none yet, or not what was written


def _plain(row: MeasuredPipeline) -> dict[str, Any]:
    return {
        **{name: getattr(row, name) for name in _MEASURED},
        "nominal": _numbers(row.nominal),
        "hazards": {name: list(map(_numbers, scores)) for name, scores in row.hazards.items()},
    }


def _numbers(score: Score) -> list[Any]:
    return [getattr(score, name) for name in _SCORE]


def _row(row: Mapping[str, Any]) -> MeasuredPipeline:
    return MeasuredPipeline(
        **{
            **row,
            "stages": tuple(row["stages"]),
            **{name: tuple(row[name]) for name in ("unit_own_deg", "unit_ratios", "needs")},
            "nominal": _score(row["nominal"]),
            "hazards": {name: tuple(map(_score, found)) for name, found in row["hazards"].items()},
        }
    )


def _score(numbers: list[Any]) -> Score:
    named = dict(zip(_SCORE, numbers, strict=True))
    return Score(**{**named, "cones": tuple(map(tuple, named["cones"]))})

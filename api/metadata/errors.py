"""Errors sample by sample in the bundle: the published files, as they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from api.metadata.fields import fields
from api.schema.samples import SampleError
from benchmark.results.samples import COLUMNS, CONDITION, DIRECTION_COLUMNS, datasets, path_of

FOLDER = "benchmark"

#: Columns of the errors and of the directions, in words.
ERRORS = fields(SampleError, tuple(COLUMNS))
DIRECTIONS = fields(SampleError, tuple(DIRECTION_COLUMNS))


def write_errors(bundle: Path, published: Path) -> list[dict[str, str]]:
    """Copy the errors of every data set and its directions; return a row for each file."""
    rows = []
    for name in datasets(published):
        described = (
            {
                "name": f"errors-{name}",
                "title": f"{name}: errors sample by sample",
                "description": "Error of every pipeline on every test sample, condition "
                f"{CONDITION}. {_said(ERRORS)}",
                "path": path_of(name),
            },
            {
                "name": f"directions-{name}",
                "title": f"{name}: directions of the samples",
                "description": f"The test samples that errors-{name} is of. {_said(DIRECTIONS)}",
                "path": path_of(name, directions=True),
            },
        )
        for one in described:
            target = bundle / FOLDER / one["path"]
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes((published / one["path"]).read_bytes())
            rows.append({**one, "path": f"{FOLDER}/{one['path']}"})
    return rows


def _said(described: Sequence[Mapping[str, Any]]) -> str:
    return " ".join(f"{field['name']}: {field['description']}" for field in described)

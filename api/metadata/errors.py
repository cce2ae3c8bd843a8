"""Errors sample by sample in the bundle: the published files, as they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from api.metadata.fields import fields
from api.schema.samples import SampleError
from benchmark.results.samples import (
    COLUMNS,
    CONDITION,
    DIRECTION_COLUMNS,
    OUTCOMES,
    datasets,
    path_of,
)

FOLDER = "benchmark"

Fields = tuple[dict[str, Any], ...]


def _fields(columns: Sequence[str], **constraints: Mapping[str, Any]) -> Fields:
    """Describe columns of the files; only numbers may be NaN."""
    required = [name for name in columns if name not in ("error_deg", "bound_deg")]
    made = fields(SampleError, columns, required)
    return tuple(
        {**one, "constraints": {**one.get("constraints", {}), **constraints.get(one["name"], {})}}
        for one in made
    )


#: Columns of the errors and of the directions, in words.
ERRORS: Fields = _fields(
    tuple(COLUMNS), error_deg={"minimum": 0, "maximum": 180}, outcome={"enum": list(OUTCOMES)}
)
DIRECTIONS: Fields = _fields(tuple(DIRECTION_COLUMNS))


def write_errors(bundle: Path, published: Path) -> list[dict[str, str]]:
    """Copy the errors of every data set and its directions; return a row for each file.

    Parameters
    ----------
    bundle : its directory
    published : directory of the published results
    """
    rows = []
    for name in datasets(published):
        for described in (_errors(name), _directions(name)):
            target = bundle / FOLDER / described["path"]
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes((published / described["path"]).read_bytes())
            rows.append({**described, "path": f"{FOLDER}/{described['path']}"})
    return rows


def _errors(name: str) -> dict[str, str]:
    return {
        "name": f"errors-{name}",
        "title": f"{name}: errors sample by sample",
        "description": "Error of every pipeline on every test sample, condition "
        f"{CONDITION}. {_said(ERRORS)}",
        "path": path_of(name),
    }


def _directions(name: str) -> dict[str, str]:
    return {
        "name": f"directions-{name}",
        "title": f"{name}: directions of the samples",
        "description": f"The test samples that errors-{name} is of. {_said(DIRECTIONS)}",
        "path": path_of(name, directions=True),
    }


def _said(fields: Fields) -> str:
    return " ".join(f"{field['name']}: {field['description']}" for field in fields)


#: By kind of file: its path, with DATASET in place of a name, its title and its schema.
KINDS: Mapping[str, tuple[str, str, Mapping[str, Any]]] = {
    "errors": (
        f"{FOLDER}/{path_of('DATASET')}",
        "Errors sample by sample, a file each data set",
        {"fields": ERRORS, "primaryKey": ("extractor", "model", "unit", "sample")},
    ),
    "directions": (
        f"{FOLDER}/{path_of('DATASET', directions=True)}",
        "Directions of the samples, a file each data set",
        {"fields": DIRECTIONS, "primaryKey": ("sample",)},
    ),
}

"""Errors sample by sample in the bundle: the published files, as they are."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from benchmark.results.samples import CONDITION, DOUBTS, datasets, path_of

FOLDER = "benchmark"

Fields = tuple[dict[str, Any], ...]


def _field(name: str, kind: str, description: str, **constraints: Any) -> dict[str, Any]:
    return {"name": name, "type": kind, "description": description, "constraints": constraints}


#: Columns of the errors and of the directions, in words.
ERRORS: Fields = (
    _field("extractor", "string", "Extractor, by its name.", required=True),
    _field("model", "string", "Model, by its name.", required=True),
    _field("unit", "integer", "Sensor unit; 0 is the standard unit.", required=True),
    _field("sample", "integer", "Number of the test sample, from 0.", required=True),
    _field(
        "error_deg",
        "number",
        "Angle between answer and truth in degrees, to a part in 2,000; NaN: no answer.",
        minimum=0,
        maximum=180,
    ),
    _field(
        "doubt",
        "integer",
        "; ".join(f"{code}: {meaning}" for code, meaning in DOUBTS.items()) + ".",
        required=True,
        enum=list(DOUBTS),
    ),
)
DIRECTIONS: Fields = (
    _field("sample", "integer", "Number of the test sample, from 0.", required=True),
    *(
        _field(f"sun_{axis}", "number", f"True unit vector to the Sun, {axis}.", required=True)
        for axis in "xyz"
    ),
    _field("observable", "boolean", "Whether the readings contain the direction.", required=True),
    _field("bound_deg", "number", "Cramer-Rao bound in degrees, of unit 0; NaN: none."),
)


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

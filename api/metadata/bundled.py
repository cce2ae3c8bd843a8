"""What the deposit's bundle holds, as Croissant describes it: a document each in `croissant/`.

The record, the survey's facts, and each data set with its errors, directions and samples. Tables
are read from Parquet, whose columns have types; paths start at the document's folder.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import Any

from api.metadata.croissant import (
    PARQUET,
    DatasetDescription,
    Entity,
    croissant,
    file_object,
    record_set,
)
from api.metadata.identity import Identity
from api.metadata.served import SUBJECTS, of_dataset, of_record, tables_of_samples
from benchmark import datasets
from benchmark.datasets.export import read_card
from benchmark.results import samples
from files.checksums import contents

FOLDER = "croissant"
RECORD, SURVEY = "record", "survey"
_FRAMES = "frames"
_MEDIA_TYPES = {".npz": "application/zip", ".json": "application/json", ".csv": "text/csv"}
_SAID = {
    "card.json": "What the arrays are, and all that they depend on.",
    "calibration": "Samples to calibrate with.",
    "test": "Samples to test with.",
    "repeat": "Samples of poses held still, for repeatability.",
    "references": "Flat and dark readings.",
}


def documents(bundle: Path, who: Identity, descriptor: Mapping[str, Any]) -> dict[str, Any]:
    """Return Croissant documents by their path in the bundle.

    Parameters
    ----------
    bundle : its directory, with tables, Parquet and samples written
    who : made it
    descriptor : its datapackage.json
    """
    tables = {
        folder: [
            one
            for one in descriptor["resources"]
            if one.get("type") == "table" and one["path"].startswith(f"{folder}/")
        ]
        for folder in ("benchmark", "survey")
    }
    facts = DatasetDescription(
        f"{who.title}: facts of the survey",
        "What a survey of sun sensors says of each mapped study, with the evidence of every value.",
        None,
        who.version,
        (*SUBJECTS, "survey", "literature"),
        "CC-BY-4.0",
    )
    found = {
        RECORD: _of_tables(bundle, of_record(who, None), who, tables["benchmark"]),
        SURVEY: _of_tables(bundle, facts, who, tables["survey"]),
    }
    found |= {
        name: _of_dataset(bundle, name, who) for name in datasets.names() if _has(bundle, name)
    }
    return {f"{FOLDER}/{name}.json": document for name, document in found.items()}


def _of_tables(
    bundle: Path, what: DatasetDescription, who: Identity, resources: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    files, tables = [], []
    for one in resources:
        file = _file(bundle, f"parquet/{one['name']}.parquet", PARQUET, one["title"])
        fields = one["schema"]["fields"]
        columns = [(f["name"], f["type"], f.get("description", f["name"])) for f in fields]
        key = one["schema"].get("primaryKey", ())
        key = (key,) if isinstance(key, str) else key
        files.append(file)
        tables.append(record_set(one["name"], file["name"], one["description"], columns, key))
    return croissant(what, who, files, tables)


def _has(bundle: Path, name: str) -> bool:
    return (bundle / _errors(name)).is_file() or (bundle / _FRAMES / name).is_dir()


def _errors(name: str, *, directions: bool = False) -> str:
    return f"benchmark/{samples.path_of(name, directions=directions)}"


def _of_dataset(bundle: Path, name: str, who: Identity) -> dict[str, Any]:
    preset = datasets.get(name)
    card = {
        **{key: getattr(preset, key) for key in ("name", "version", "detector", "mask")},
        "observation": str(preset.observation),
        "description": preset.description,
    }
    files = [*_files_of_samples(bundle, name)]
    tables = [
        _table_of_samples(bundle, name, file)
        for file in files
        if file["encodingFormat"] == "text/csv"
    ]
    if (bundle / _errors(name)).is_file():
        described = [
            _file(bundle, _errors(name), PARQUET, "Errors sample by sample."),
            _file(bundle, _errors(name, directions=True), PARQUET, "Directions of the samples."),
        ]
        tables = [*tables_of_samples(*(file["name"] for file in described)), *tables]
        files = [*described, *files]
    return croissant(of_dataset(card, None), who, files, tables)


def _files_of_samples(bundle: Path, name: str) -> Iterator[Entity]:
    folder = bundle / _FRAMES / name
    if not folder.is_dir():
        return
    for part in contents(folder):
        path = PurePosixPath(part)
        said = _SAID.get(part) or _SAID.get(path.stem)
        if said and path.suffix in _MEDIA_TYPES:
            kind = (_MEDIA_TYPES[path.suffix],)
            yield _file(bundle, f"{_FRAMES}/{name}/{part}", kind, said)


def _table_of_samples(bundle: Path, name: str, file: Entity) -> Entity:
    """Return what the CSV of a split holds; its columns are parts of the arrays of the card."""
    meanings = read_card(bundle / _FRAMES / name)["arrays"]
    with (bundle / file["name"]).open(encoding="utf-8", newline="") as lines:
        rows = csv.reader(lines)
        header, first = next(rows), next(rows)
    columns = []
    for column, cell in zip(header, first, strict=True):
        array, _, _ = column.rpartition("_")
        array = "observations" if array == "signal" else array
        meaning = meanings.get(column) or meanings.get(array) or column
        columns.append((column, "boolean" if cell in {"True", "False"} else "number", meaning))
    split = PurePosixPath(file["name"]).stem
    return record_set(split, file["name"], f"A sample of the {split} split.", columns)


def _file(bundle: Path, path: str, media_types: tuple[str, ...], said: str) -> Entity:
    return file_object(path, f"../{path}", media_types, said, (bundle / path).read_bytes())

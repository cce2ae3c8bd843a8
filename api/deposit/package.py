"""The bundle's datapackage.json (Data Package v2): the survey's tables and the measured ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from api.deposit.deposit_tables import MeasuredTable
from api.metadata.citation import Author
from api.metadata.identity import Identity
from files.checksums import sha256

DESCRIPTOR = "datapackage.json"
NAME = "sun-sensor-atlas"
PROFILE = "https://datapackage.org/profiles/2.0/datapackage.json"
CC_BY = {
    "name": "CC-BY-4.0",
    "path": "https://creativecommons.org/licenses/by/4.0/",
    "title": "Creative Commons Attribution 4.0 International",
}
MIT = {"name": "MIT", "path": "https://opensource.org/license/mit", "title": "MIT License"}


def package(
    directory: Path,
    identity: Identity,
    survey: Mapping[str, Any],
    measured: Sequence[MeasuredTable],
    exported: Sequence[Mapping[str, Any]] = (),
    *,
    errors: Sequence[Mapping[str, str]] = (),
    code: str | None = None,
) -> dict[str, Any]:
    """Describe the tables and samples that lie in `directory`.

    Parameters
    ----------
    directory : the bundle, its tables already written to survey/ and benchmark/
    identity : of the project
    survey : the survey's own descriptor, paths relative to its directory
    measured : the measured tables
    exported : of each file of samples dataset, condition, split, file, samples
    errors : of each file of errors name, title, description, path
    code : path of the archive of the code
    """
    resources = [
        _locate(directory, f"survey/{resource['path']}", {**resource, "licenses": [CC_BY]})
        for resource in survey["resources"]
    ]
    resources += [
        _locate(
            directory,
            f"benchmark/{table.name}.csv",
            {
                "name": table.name,
                "type": "table",
                "title": table.title,
                "description": table.description,
                "format": "csv",
                "mediatype": "text/csv",
                "encoding": "utf-8",
                "schema": dict(table.schema),
                "licenses": [MIT],
            },
        )
        for table in measured
    ]
    resources += [_of_samples(directory, row) for row in exported]
    resources += [_of_errors(directory, row) for row in errors]
    resources += [] if code is None else [_of_code(directory, code)]
    return {
        "$schema": PROFILE,
        "name": NAME,
        "title": identity.title,
        "description": identity.summary,
        "version": identity.version,
        "created": f"{identity.released.isoformat()}T00:00:00Z",
        "licenses": [CC_BY, MIT],
        "contributors": [
            *(_contributor(author) for author in identity.authors),
            *(c for c in survey.get("contributors", ()) if c["roles"] != ["compiler"]),
        ],
        "sources": survey.get("sources", []),
        "keywords": survey.get("keywords", []),
        "resources": resources,
    }


def _contributor(author: Author) -> dict[str, Any]:
    return {
        "title": author.title,
        **({"path": f"https://orcid.org/{author.orcid}"} if author.orcid else {}),
        **({"organization": author.affiliation} if author.affiliation else {}),
        "roles": ["author"],
    }


def _of_samples(directory: Path, row: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "name": f"frames-{row['dataset']}-{row['split']}",
        "title": f"{row['dataset']}, {row['condition']}, {row['split']}",
        "description": f"All {row['samples']} samples; what the arrays are stands in card.json of "
        "the data set.",
        "path": row["file"],
        "format": "npz",
        "mediatype": "application/zip",
        "licenses": [MIT],
        **_digest(directory / row["file"]),
    }


def _of_errors(directory: Path, row: Mapping[str, str]) -> dict[str, Any]:
    return {
        **row,
        # As the media type has it: frictionless takes "parquet" for a table, reads every row of it
        # for minutes, and then counts no bytes.
        "format": "vnd.apache.parquet",
        "mediatype": "application/vnd.apache.parquet",
        "licenses": [MIT],
        **_digest(directory / row["path"]),
    }


def _of_code(directory: Path, path: str) -> dict[str, Any]:
    return {
        "name": "code",
        "title": "Code as an archive",
        "description": "Source distribution of the version that made this bundle, with its lock "
        "file; `rescore.py` installs it and measures scores again.",
        "path": path,
        "format": "tar.gz",
        "mediatype": "application/gzip",
        "licenses": [MIT],
        **_digest(directory / path),
    }


def _digest(file: Path) -> dict[str, Any]:
    return {"bytes": file.stat().st_size, "hash": f"sha256:{sha256(file)}"}


def _locate(directory: Path, path: str, resource: Mapping[str, Any]) -> dict[str, Any]:
    file = directory / path
    described = {**resource, "path": path, **_digest(file)}
    schema = described.pop("schema")
    return {**described, "schema": schema}

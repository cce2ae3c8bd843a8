"""The bundle's datapackage.json (Data Package v2): the survey's tables and the measured ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from api.deposit.identity import Identity
from api.deposit.tables import MeasuredTable
from benchmark.datasets.checksums import sha256

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
) -> dict[str, Any]:
    """Describe the tables that lie in `directory`.

    Parameters
    ----------
    directory : the bundle, its tables already written to survey/ and benchmark/
    identity : of the project
    survey : the survey's own descriptor, paths relative to its directory
    measured : the measured tables
    """
    resources = [
        _located(directory, f"survey/{resource['path']}", {**resource, "licenses": [CC_BY]})
        for resource in survey["resources"]
    ]
    resources += [
        _located(
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
    return {
        "$schema": PROFILE,
        "name": NAME,
        "title": identity.title,
        "description": identity.summary,
        "version": identity.version,
        "created": f"{identity.released.isoformat()}T00:00:00Z",
        "licenses": [CC_BY, MIT],
        "contributors": survey.get("contributors")
        or [{"title": author, "roles": ["author"]} for author in identity.authors],
        "sources": survey.get("sources", []),
        "keywords": survey.get("keywords", []),
        "resources": resources,
    }


def _located(directory: Path, path: str, resource: Mapping[str, Any]) -> dict[str, Any]:
    file = directory / path
    described = {
        **resource,
        "path": path,
        "bytes": file.stat().st_size,
        "hash": f"sha256:{sha256(file)}",
    }
    schema = described.pop("schema")
    return {**described, "schema": schema}

"""The bundle's datapackage.json (Data Package v2), the licence of each file, and the zip."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping, Sequence
from datetime import date
from pathlib import Path
from typing import Any

from api.deposit.deposit_tables import MeasuredTable
from api.metadata.citation import Author
from api.metadata.identity import Identity
from files.checksums import contents, sha256

DESCRIPTOR = "datapackage.json"
NAME = "sun-sensor-atlas"
PROFILE = "https://datapackage.org/profiles/2.0/datapackage.json"
CC_BY = {
    "name": "CC-BY-4.0",
    "path": "https://creativecommons.org/licenses/by/4.0/",
    "title": "Creative Commons Attribution 4.0 International",
}
MIT = {"name": "MIT", "path": "https://opensource.org/license/mit", "title": "MIT License"}
BIBLIOGRAPHY = "bibliography"
"""Folder of the references."""
FACTS = ("survey", BIBLIOGRAPHY)
"""Folders of facts, which are under CC BY 4.0; all else is under MIT."""
_UNIX, _PLAIN_FILE = 3, 0o100644 << 16


def terms(name: str) -> str:
    """Return the SPDX identifier of the licence of a file, by its path in the bundle."""
    return "CC-BY-4.0" if name.partition("/")[0] in FACTS and "/" in name else "MIT"


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

    def located(path: str, described: Mapping[str, Any], licence: Any = MIT) -> dict[str, Any]:
        file = directory / path
        digest = {"bytes": file.stat().st_size, "hash": f"sha256:{sha256(file)}"}
        schema = {"schema": described["schema"]} if "schema" in described else {}
        return {**described, "path": path, "licenses": [licence], **digest, **schema}

    resources = [
        *(located(f"survey/{one['path']}", one, CC_BY) for one in survey["resources"]),
        *(located(f"benchmark/{table.name}.csv", _of_table(table)) for table in measured),
        *(located(row["file"], _of_samples(row)) for row in exported),
        # Format as the media type has it: frictionless takes "parquet" for a table, reads every
        # row of it for minutes, and then counts no bytes.
        *(
            located(
                row["path"],
                {
                    **row,
                    "format": "vnd.apache.parquet",
                    "mediatype": "application/vnd.apache.parquet",
                },
            )
            for row in errors
        ),
    ]
    if code is not None:
        resources.append(located(code, _CODE))
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


def pack(bundle: Path, target: Path, top: str, released: date) -> None:
    """Pack a bundle as a zip, the same bytes each time with one zlib.

    Parameters
    ----------
    bundle : its directory
    target : the zip to write
    top : the one directory in the zip, which holds all
    released : date of every entry
    """
    moment = (released.year, released.month, released.day, 0, 0, 0)
    with zipfile.ZipFile(target, "w") as archive:
        for name in contents(bundle):
            entry = zipfile.ZipInfo(f"{top}/{name}", moment)
            entry.create_system = _UNIX  # on every machine, for the permissions below
            entry.external_attr = _PLAIN_FILE
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, (bundle / name).read_bytes(), compresslevel=9)


_CODE = {
    "name": "code",
    "title": "Code as an archive",
    "description": "Source distribution of the version that made this bundle, with its lock "
    "file; `rescore.py` installs it and measures scores again.",
    "format": "tar.gz",
    "mediatype": "application/gzip",
}


def _contributor(author: Author) -> dict[str, Any]:
    return {
        "title": author.title,
        **({"path": f"https://orcid.org/{author.orcid}"} if author.orcid else {}),
        **({"organization": author.affiliation} if author.affiliation else {}),
        "roles": ["author"],
    }


def _of_table(table: MeasuredTable) -> dict[str, Any]:
    return {
        "name": table.name,
        "type": "table",
        "title": table.title,
        "description": table.description,
        "format": "csv",
        "mediatype": "text/csv",
        "encoding": "utf-8",
        "schema": dict(table.schema),
    }


def _of_samples(row: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "name": f"frames-{row['dataset']}-{row['split']}",
        "title": f"{row['dataset']}, {row['condition']}, {row['split']}",
        "description": f"All {row['samples']} samples; what the arrays are stands in card.json of "
        "the data set.",
        "format": "npz",
        "mediatype": "application/zip",
    }

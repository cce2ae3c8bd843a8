"""The bundle's RO-Crate 1.1 metadata: the same files in the words of schema.org."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from api.deposit.identity import Identity

CRATE = "ro-crate-metadata.json"
_MEDIA_TYPES = {
    ".csv": "text/csv",
    ".json": "application/json",
    ".md": "text/markdown",
    ".cff": "application/yaml",
    "": "text/plain",
    ".txt": "text/plain",
}
_LICENCES = {
    "MIT": ("https://spdx.org/licenses/MIT", "MIT License"),
    "CC-BY-4.0": (
        "https://creativecommons.org/licenses/by/4.0/",
        "Creative Commons Attribution 4.0 International",
    ),
}


def crate(
    identity: Identity,
    files: Mapping[str, int],
    descriptions: Mapping[str, tuple[str, str]],
    licence_of: Mapping[str, str],
    keywords: Sequence[str],
) -> dict[str, Any]:
    """Describe the bundle.

    Parameters
    ----------
    identity : of the project
    files : size in bytes by path, every file of the bundle but this one and the checksums
    descriptions : (name, description) by path, where there is one
    licence_of : "MIT" or "CC-BY-4.0" by path, where a file has its own
    keywords : of the bundle
    """
    authors = [
        {"@id": f"#author-{number}", "@type": "Organization", "name": name}
        for number, name in enumerate(identity.authors, start=1)
    ]
    licences = [
        {"@id": address, "@type": "CreativeWork", "name": name, "identifier": short}
        for short, (address, name) in _LICENCES.items()
    ]
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": identity.title,
        "description": identity.summary,
        "version": identity.version,
        "datePublished": identity.released.isoformat(),
        "license": [_reference(licence) for licence in licences],
        "author": [_reference(author) for author in authors],
        "keywords": ", ".join(keywords),
        "hasPart": [{"@id": path} for path in sorted(files)],
    }
    descriptor = {
        "@id": CRATE,
        "@type": "CreativeWork",
        "conformsTo": {"@id": "https://w3id.org/ro/crate/1.1"},
        "about": {"@id": "./"},
    }
    parts = [
        _file(path, size, descriptions.get(path), licence_of.get(path))
        for path, size in sorted(files.items())
    ]
    return {
        "@context": "https://w3id.org/ro/crate/1.1/context",
        "@graph": [descriptor, root, *parts, *authors, *licences],
    }


def _reference(entity: Mapping[str, Any]) -> dict[str, str]:
    return {"@id": entity["@id"]}


def _file(
    path: str, size: int, described: tuple[str, str] | None, licence: str | None
) -> dict[str, Any]:
    name = path.rpartition("/")[2]
    suffix = f".{name.rpartition('.')[2]}" if "." in name else ""
    entity: dict[str, Any] = {
        "@id": path,
        "@type": "File",
        "name": described[0] if described else name,
        "encodingFormat": _MEDIA_TYPES[suffix],
        "contentSize": str(size),
    }
    if described:
        entity["description"] = described[1]
    if licence is not None:
        entity["license"] = {"@id": _LICENCES[licence][0]}
    return entity

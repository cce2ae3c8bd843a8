"""The bundle's RO-Crate 1.2 metadata: the same files in the words of schema.org."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any
from urllib.parse import quote

from api.metadata.citation import Author
from api.metadata.identity import Identity

CRATE = "ro-crate-metadata.json"
VERSION = "1.2"
SPECIFICATION = f"https://w3id.org/ro/crate/{VERSION}"
_MEDIA_TYPES = {
    "": "text/plain",
    ".bib": "application/x-bibtex",
    ".cff": "application/yaml",
    ".csv": "text/csv",
    ".gz": "application/gzip",
    ".json": "application/json",
    ".md": "text/markdown",
    ".npz": "application/zip",
    ".parquet": "application/vnd.apache.parquet",
    ".png": "image/png",
    ".py": "text/x-python",
    ".ris": "application/x-research-info-systems",
    ".sqlite": "application/vnd.sqlite3",
    ".txt": "text/plain",
}
#: Names of files that no table's description gives one.
_NAMES = {
    "card.json": "Card of a data set: what the arrays are",
    "calibration.npz": "Samples to calibrate with",
    "test.npz": "Samples to test with",
    "repeat.npz": "Samples of poses held still",
    "references.npz": "Flat and dark readings",
}
_LICENCES = {
    "MIT": ("https://spdx.org/licenses/MIT", "MIT License"),
    "CC-BY-4.0": (
        "https://creativecommons.org/licenses/by/4.0/",
        "Creative Commons Attribution 4.0 International",
    ),
}


_KINDS = {
    "LICENSE": "Terms of use.",
    "CITATION.cff": "How to cite, in the Citation File Format.",
    "codemeta.json": "The software in the words of CodeMeta 3.0.",
    "README.md": "What lies in the bundle, how to read and check it.",
    "datapackage.json": "Types, units, keys and meaning of every column (Data Package v2).",
    "sun-sensor-atlas.sqlite": "Every table in one SQLite file, with keys.",
    "studies.bib": "The identified studies as BibTeX.",
    "unmapped-studies.bib": "The studies the survey does not map as BibTeX.",
    "unmapped-studies.ris": "The studies the survey does not map as RIS.",
    "studies.ris": "The identified studies as RIS.",
    "card.json": "Card",
    "checksums-sha256.txt": "Checksums",
    "preview.png": "Picture",
    "references.npz": "Flat and dark readings",
    "calibration.csv": "Table of the calibration split",
    "test.csv": "Table of the test split",
    "repeat.csv": "Table of the repeat split",
    "rescore.py": "Installs the code and measures scores again from the samples.",
}


def licence_address(licence: str) -> str:
    """Return the identifier of a licence in a crate, by its SPDX identifier."""
    return _LICENCES[licence][0]


def crate(
    identity: Identity,
    files: Mapping[str, tuple[int, str]],
    descriptions: Mapping[str, tuple[str, str]],
    licence_of: Mapping[str, str],
    keywords: Sequence[str],
) -> dict[str, Any]:
    """Describe the bundle.

    Parameters
    ----------
    identity : of the project
    files : size in bytes and SHA-256 by path, every file but this one and the list
        of checksums
    descriptions : (name, description) by path, where there is one
    licence_of : "MIT" or "CC-BY-4.0" by path
    keywords : of the bundle
    """
    authors = [_author(author, n) for n, author in enumerate(identity.authors, start=1)]
    affiliations = {
        author.affiliation: {
            "@id": _affiliation(author.affiliation),
            "@type": "Organization",
            "name": author.affiliation,
        }
        for author in identity.authors
        if author.affiliation
    }
    licences = [
        {
            "@id": address,
            "@type": "CreativeWork",
            "name": name,
            "description": f"{name} ({short})",
            "identifier": short,
        }
        for short, (address, name) in _LICENCES.items()
    ]
    root = {
        "@id": "./",
        "@type": "Dataset",
        "name": identity.title,
        "description": identity.summary,
        "version": identity.version,
        "datePublished": identity.released.isoformat(),
        "license": _one_or_all([_reference(licence) for licence in licences]),
        "author": _one_or_all([_reference(author) for author in authors]),
        "keywords": ", ".join(keywords),
        "hasPart": [{"@id": path} for path in sorted(files)],
    }
    descriptor = {
        "@id": CRATE,
        "@type": "CreativeWork",
        "conformsTo": {"@id": SPECIFICATION},
        "about": {"@id": "./"},
    }
    parts = [
        _file(path, files[path], descriptions.get(path), licence_of[path]) for path in sorted(files)
    ]
    return {
        "@context": f"{SPECIFICATION}/context",
        "@graph": [descriptor, root, *parts, *authors, *affiliations.values(), *licences],
    }


def _reference(entity: Mapping[str, Any]) -> dict[str, str]:
    return {"@id": entity["@id"]}


def _author(author: Author, number: int) -> dict[str, Any]:
    known = f"https://orcid.org/{author.orcid}" if author.orcid else f"#author-{number}"
    if author.name:
        return {"@id": known, "@type": "Organization", "name": author.name}
    entity: dict[str, Any] = {
        "@id": known,
        "@type": "Person",
        "name": author.title,
        "familyName": author.family,
        "givenName": author.given,
    }
    if author.affiliation:
        entity["affiliation"] = {"@id": _affiliation(author.affiliation)}
    return entity


def _affiliation(name: str) -> str:
    return f"#{quote(name.lower().replace(' ', '-'), safe='')}"


def _file(
    path: str, file: tuple[int, str], described: tuple[str, str] | None, licence: str
) -> dict[str, Any]:
    name = path.rpartition("/")[2]
    suffix = f".{name.rpartition('.')[2]}" if "." in name else ""
    entity: dict[str, Any] = {
        "@id": path,
        "@type": "File",
        "name": described[0] if described else _NAMES.get(name, name),
        "encodingFormat": _MEDIA_TYPES[suffix],
        "contentSize": str(file[0]),
        "sha256": file[1],
        "license": {"@id": _LICENCES[licence][0]},
    }
    entity["description"] = described[1] if described else _describe(path)
    return entity


def _describe(path: str) -> str:
    """Say what a file is that is no resource of the data package."""
    folder, _, rest = path.partition("/")
    if folder == "parquet":
        return f"The table {rest.removesuffix('.parquet')} as Parquet."
    if folder == "croissant":
        return f"{rest.removesuffix('.json')} as programs for machine learning load it (Croissant)."
    if folder == "frames":
        dataset, _, name = rest.partition("/")
        kind = _KINDS.get(name.rpartition("/")[2], "Part")
        return f"{kind} of the samples of {dataset}."
    return _KINDS.get(path.rpartition("/")[2], "Part of the bundle.")


def _one_or_all(references: Sequence[dict[str, str]]) -> Any:
    return references[0] if len(references) == 1 else list(references)

"""The bundle's RO-Crate 1.2 metadata: the same files in the words of schema.org."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any
from urllib.parse import quote

from api.deposit.package import CC_BY, terms
from api.metadata.citation import Author
from api.metadata.identity import Identity

CRATE = "ro-crate-metadata.json"
SPECIFICATION = "https://w3id.org/ro/crate/1.2"
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
_LICENCES = {
    "MIT": ("https://spdx.org/licenses/MIT", "MIT License"),
    "CC-BY-4.0": (CC_BY["path"], CC_BY["title"]),
}
#: Files that are no resource of the data package, by their names or folders.
_KINDS = {
    "LICENSE": "Terms of use.",
    "CITATION.cff": "How to cite, in the Citation File Format.",
    "codemeta.json": "The software in the words of CodeMeta 3.0.",
    "README.md": "What lies in the bundle, how to read and check it.",
    "datapackage.json": "Types, units, keys and meaning of every column (Data Package v2).",
    "sun-sensor-atlas.sqlite": "Every table in one SQLite file, with keys.",
    "studies.bib": "The identified studies as BibTeX.",
    "studies.ris": "The identified studies as RIS.",
    "unmapped-studies.bib": "The studies the survey does not map as BibTeX.",
    "unmapped-studies.ris": "The studies the survey does not map as RIS.",
    "card.json": "Card of a data set: what the arrays are.",
    "checksums-sha256.txt": "Checksums.",
    "preview.png": "Picture of samples of a data set.",
    "references.npz": "Flat and dark readings.",
    "references-test.npz": "Flat and dark readings taken again after the calibration.",
    "rescore.py": "Installs the code and measures scores again from the samples.",
    "parquet": "The table as Parquet.",
    "croissant": "As programs for machine learning load it (Croissant).",
    "frames": "Table of a split of the samples.",
}


def crate(
    identity: Identity,
    files: Mapping[str, tuple[int, str]],
    descriptions: Mapping[str, tuple[str, str]],
    keywords: Sequence[str],
) -> dict[str, Any]:
    """Describe the bundle.

    Parameters
    ----------
    identity : of the project
    files : size in bytes and SHA-256 by path, every file but this one and the list
        of checksums
    descriptions : (name, description) by path, where there is one
    keywords : of the bundle
    """
    authors = [_author(author, n) for n, author in enumerate(identity.authors, start=1)]
    affiliations = {
        one["affiliation"]["@id"]: {
            "@id": one["affiliation"]["@id"],
            "@type": "Organization",
            "name": author.affiliation,
        }
        for one, author in zip(authors, identity.authors, strict=True)
        if "affiliation" in one
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
        "license": [{"@id": licence["@id"]} for licence in licences],
        "author": [{"@id": author["@id"]} for author in authors],
        "keywords": ", ".join(keywords),
        "hasPart": [{"@id": path} for path in sorted(files)],
    }
    descriptor = {
        "@id": CRATE,
        "@type": "CreativeWork",
        "conformsTo": {"@id": SPECIFICATION},
        "about": {"@id": "./"},
    }
    parts = [_file(path, *files[path], descriptions.get(path)) for path in sorted(files)]
    return {
        "@context": f"{SPECIFICATION}/context",
        "@graph": [descriptor, root, *parts, *authors, *affiliations.values(), *licences],
    }


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
        named = quote(author.affiliation.lower().replace(" ", "-"), safe="")
        entity["affiliation"] = {"@id": f"#{named}"}
    return entity


def _file(path: str, size: int, digest: str, described: tuple[str, str] | None) -> dict[str, Any]:
    at = PurePosixPath(path)
    said = _KINDS.get(at.name) or _KINDS.get(at.parts[0], "Part of the bundle.")
    name, description = described or (at.name, said)
    return {
        "@id": path,
        "@type": "File",
        "name": name,
        "encodingFormat": _MEDIA_TYPES[at.suffix],
        "contentSize": str(size),
        "sha256": digest,
        "license": {"@id": _LICENCES[terms(path)][0]},
        "description": description,
    }

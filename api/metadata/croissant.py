"""Croissant 1.0 (MLCommons): a data set as programs for machine learning load it.

A document names files with their SHA-256 and what each column of their tables holds. The same
builder describes files that the service serves and files that lie in the deposit's bundle.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from api.metadata.citation import Author
from api.metadata.identity import LICENCES, Identity

CONFORMS_TO = "http://mlcommons.org/croissant/1.0"
#: Types of a Table Schema, and of Arrow, in the words of schema.org.
TYPES: Mapping[str, str] = {
    "string": "sc:Text",
    "integer": "sc:Integer",
    "year": "sc:Integer",
    "number": "sc:Float",
    "boolean": "sc:Boolean",
}
PARQUET = ("application/x-parquet", "application/vnd.apache.parquet")
"""What Croissant calls Parquet, and its registered media type."""

#: The context that the specification asks for, word by word.
CONTEXT = json.loads(Path(__file__).with_name("croissant_context.json").read_text("utf-8"))

Column = tuple[str, str, str]
"""Name, type as a Table Schema calls it, and meaning."""
Entity = dict[str, Any]


def file_object(
    name: str, address: str, media_types: Sequence[str], description: str, content: bytes
) -> Entity:
    """Return a file of a data set.

    Parameters
    ----------
    name : of the file, unique within the data set
    address : where it is: a URL, or a path from the folder of the document
    media_types : the first is the one that Croissant knows
    description : what it holds
    content : its bytes
    """
    return {
        "@type": "cr:FileObject",
        "@id": name,
        "name": name,
        "description": description,
        "contentUrl": address,
        "contentSize": f"{len(content)} B",
        "encodingFormat": media_types[0] if len(media_types) == 1 else list(media_types),
        "sha256": sha256(content).hexdigest(),
    }


def record_set(
    name: str, file: str, description: str, columns: Sequence[Column], key: Sequence[str] = ()
) -> Entity:
    """Return what the rows of a file hold.

    Parameters
    ----------
    name : unique within the data set
    file : name of the file
    description : what a row is
    columns : in order
    key : columns that tell rows apart
    """
    keys = [{"@id": f"{name}/{column}"} for column in key]
    return {
        "@type": "cr:RecordSet",
        "@id": name,
        "name": name,
        "description": description,
        **({"key": keys[0] if len(keys) == 1 else keys} if keys else {}),
        "field": [
            {
                "@type": "cr:Field",
                "@id": f"{name}/{column}",
                "name": column,
                "description": meaning,
                "dataType": TYPES[kind],
                "source": {"fileObject": {"@id": file}, "extract": {"column": column}},
            }
            for column, kind, meaning in columns
        ],
    }


@dataclass(frozen=True)
class DatasetDescription:
    """What a document says of a data set as a whole.

    Attributes
    ----------
    address : of its page; None where it has none, as in a bundle
    version : major.minor.patch
    keywords : words to find it by
    licence : "MIT" or "CC-BY-4.0"
    """

    name: str
    description: str
    address: str | None
    version: str
    keywords: Sequence[str]
    licence: str = "MIT"


def croissant(
    what: DatasetDescription, who: Identity, files: Sequence[Entity], tables: Sequence[Entity]
) -> dict[str, Any]:
    """Return the metadata of a data set as JSON-LD.

    Parameters
    ----------
    what : name, description, version and licence of the data set
    who : project whose authors and date of release are stated
    files : as `file_object` describes them
    tables : in the files, as `record_set` describes them
    """
    return {
        "@context": dict(CONTEXT),
        "@type": "sc:Dataset",
        "conformsTo": CONFORMS_TO,
        "name": what.name,
        "description": what.description,
        **({"url": what.address} if what.address else {}),
        "version": what.version,
        "datePublished": who.released.isoformat(),
        "license": LICENCES[what.licence],
        "creator": [creator(author) for author in who.authors],
        "keywords": list(what.keywords),
        "citeAs": cite_as(what, who),
        "isAccessibleForFree": True,
        "distribution": list(files),
        "recordSet": list(tables),
    }


def creator(author: Author) -> dict[str, Any]:
    """Return an author as schema.org describes a person or an organisation."""
    if author.name:
        return {"@type": "sc:Organization", "name": author.name}
    return {
        "@type": "sc:Person",
        "name": author.title,
        "givenName": author.given,
        "familyName": author.family,
        **({"url": f"https://orcid.org/{author.orcid}"} if author.orcid else {}),
    }


def cite_as(what: DatasetDescription, who: Identity) -> str:
    """Return a BibTeX entry of a data set of a version of the Atlas."""
    key = "".join(c if c.isalnum() else "-" for c in what.name).strip("-").lower()
    names = " and ".join(f"{{{a.name}}}" if a.name else a.sort_name for a in who.authors)
    return (
        f"@misc{{{key}, title = {{{{{what.name}}}}}, author = {{{names}}}, "
        f"year = {{{who.released.year}}}, version = {{{what.version}}}, "
        f"note = {{{who.title} {who.version}}}}}"
    )

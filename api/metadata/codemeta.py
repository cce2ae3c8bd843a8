"""codemeta.json (CodeMeta 3.0), made of CITATION.cff so that the two cannot differ.

CITATION.cff is the one file a person fills in; `make docs` writes codemeta.json beside it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import yaml

from api.metadata.citation import authors, persistent

CONTEXT = "https://w3id.org/codemeta/3.0"
NAME = "codemeta.json"
_SPDX = "https://spdx.org/licenses/"


def codemeta(citation: str) -> dict[str, Any]:
    """Return the metadata of the software.

    Raises
    ------
    CitationError
        As `api.metadata.citation.authors`.
    """
    people = authors(citation, "CITATION.cff")
    cited: Mapping[str, Any] = yaml.safe_load(citation)
    licences = cited.get("license", [])
    licences = [licences] if isinstance(licences, str) else list(licences)
    given = {
        "@context": CONTEXT,
        "@type": "SoftwareSourceCode",
        "identifier": persistent(citation),
        "name": cited.get("title"),
        "description": " ".join(str(cited.get("abstract") or "").split()),
        "version": _text(cited.get("version")),
        "datePublished": _text(cited.get("date-released")),
        "license": [f"{_SPDX}{licence}" for licence in licences],
        "author": [one.to_dict() for one in people],
        "keywords": list(cited.get("keywords", ())),
        "codeRepository": cited.get("repository-code"),
        "url": cited.get("url"),
        "programmingLanguage": {"@type": "ComputerLanguage", "name": "Python"},
        "applicationCategory": "Science",
    }
    return {name: value for name, value in given.items() if value not in (None, [], "")}


def codemeta_text(citation: str) -> str:
    """Return `codemeta` as the file has it."""
    return json.dumps(codemeta(citation), indent=2, ensure_ascii=False) + "\n"


def _text(value: Any) -> str | None:
    return None if value is None else str(value)

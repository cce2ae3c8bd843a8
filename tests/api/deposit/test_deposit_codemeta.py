"""codemeta.json and CITATION.cff say the same: one is made of the other."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import yaml

from api.metadata.codemeta import NAME, codemeta

ROOT = Path(__file__).resolve().parents[3]
#: By Citation File Format: in CodeMeta (https://codemeta.github.io/crosswalk/).
SAME = {
    "title": "name",
    "version": "version",
    "date-released": "datePublished",
    "keywords": "keywords",
    "repository-code": "codeRepository",
    "url": "url",
}


def test_the_two_agree() -> None:
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    cited, made = yaml.safe_load(citation), codemeta(citation)
    for theirs, ours in SAME.items():
        expected = cited.get(theirs)
        expected = str(expected) if isinstance(expected, float) else expected
        assert made.get(ours) == expected, ours
    assert made["description"] == " ".join(cited["abstract"].split())
    licences = [cited["license"]] if isinstance(cited["license"], str) else cited["license"]
    assert made["license"] == [f"https://spdx.org/licenses/{licence}" for licence in licences]
    assert len(made["author"]) == len(cited["authors"])
    assert made["@context"] == "https://w3id.org/codemeta/3.0"


def test_the_file_of_the_repository_is_of_this_citation_and_version() -> None:
    file = json.loads((ROOT / NAME).read_text("utf-8"))
    assert file == codemeta((ROOT / "CITATION.cff").read_text("utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert file["version"] == project["version"]
    assert file["keywords"] == project["keywords"]

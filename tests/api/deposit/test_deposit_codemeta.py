"""codemeta.json and CITATION.cff say the same: one is made of the other."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import pytest
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
PUBLISHED = """\
cff-version: 1.2.0
message: Cite it.
type: software
title: "Atlas: of Suns"
abstract: >-
  Two
  lines.
authors:
  - family-names: Sommer
    given-names: Ada
    name-particle: von
    orcid: https://orcid.org/0009-0000-0012-3455
    affiliation: Institute of Light
  - name: The others
version: 1.10
date-released: "2027-01-31"
license: MIT
doi: 10.5281/zenodo.1234
repository-code: https://code.example/atlas
"""


def documents(citation: str) -> tuple[dict[str, Any], dict[str, Any]]:
    return yaml.safe_load(citation), codemeta(citation)


@pytest.mark.parametrize("citation", [(ROOT / "CITATION.cff").read_text("utf-8"), PUBLISHED])
def test_the_two_agree(citation: str) -> None:
    cited, made = documents(citation)
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

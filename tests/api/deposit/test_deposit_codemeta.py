"""codemeta.json is what CITATION.cff makes, and is of this version."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

from api.metadata.codemeta import NAME, codemeta

ROOT = Path(__file__).resolve().parents[3]


def test_the_file_of_the_repository_is_of_this_citation_and_version() -> None:
    file = json.loads((ROOT / NAME).read_text("utf-8"))
    assert file == codemeta((ROOT / "CITATION.cff").read_text("utf-8"))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert file["version"] == project["version"]
    assert file["keywords"] == project["keywords"]

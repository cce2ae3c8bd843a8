"""Croissant documents of the bundle, read by MLCommons' own library."""

from __future__ import annotations

from pathlib import Path

import mlcroissant
import pytest

from api.deposit.bundle import Bundle
from api.metadata.codemeta import NAME, codemeta_text
from api.metadata.identity import identity

pytestmark = pytest.mark.slow


def read(path: Path) -> mlcroissant.Dataset:
    """Read and validate a document; errors raise, and there are no warnings."""
    found = mlcroissant.Dataset(jsonld=str(path))
    issues = found.metadata.ctx.issues
    assert (issues.errors, issues.warnings) == (set(), set())
    return found


def records(dataset: mlcroissant.Dataset, table: str) -> list[dict[str, object]]:
    found = list(dataset.records(record_set=table))
    return [{k.removeprefix(f"{table}/"): v for k, v in row.items()} for row in found]


# the library warns of packages that it reads other formats with
@pytest.mark.filterwarnings("ignore::Warning:mlcroissant", "ignore::Warning:rdflib")
def test_the_survey_s_none_is_a_value_and_unknown_is_none(built: Bundle) -> None:
    rows = records(read(built.directory / "croissant" / "survey.json"), "attributes")
    values = {(r["study"].decode(), r["attribute"].decode()): r["value"] for r in rows}
    assert values["Coutinho2022", "model"] == b"None"
    assert None in values.values()


def test_the_bundle_has_codemeta_of_the_code_it_comes_of(built: Bundle) -> None:
    assert (built.directory / NAME).read_text("utf-8") == codemeta_text(identity().citation)

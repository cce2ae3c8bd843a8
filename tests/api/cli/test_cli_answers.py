"""`sunatlas studies` and `dataset`: the same answers in every format."""

import csv
import io
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import survey_data
from api.cli.command_line import app
from registry.fidelity.grading import GRADES, tally_text

OURS = Path(survey_data.__file__).parent


def sunatlas(*arguments):
    return CliRunner().invoke(app, list(map(str, arguments)), catch_exceptions=False)


def answer(*arguments):
    shown = sunatlas(*arguments, "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    return json.loads(shown.stdout)


def table(*arguments):
    shown = sunatlas(*arguments, "--format", "csv")
    assert shown.exit_code == 0, shown.stderr
    return list(csv.DictReader(io.StringIO(shown.stdout)))


def studies_with(attribute, value):
    with (OURS / "attributes.csv").open(encoding="utf-8", newline="") as file:
        return {
            row["study"]
            for row in csv.DictReader(file)
            if (row["attribute"], row["value"]) == (attribute, value)
        }


def test_studies_lists_129_with_the_grade_of_each():
    listed = answer("studies")
    assert len({study["key"] for study in listed}) == len(listed) == 129
    assert {study["state"] for study in listed} <= {"complete", "partial", "none"}
    assert [row["key"] for row in table("studies")] == [study["key"] for study in listed]
    assert [row["state"] for row in table("studies")] == [study["state"] for study in listed]
    assert {study["grade"] for study in listed} <= set(GRADES)
    assert [row["grade"] for row in table("studies")] == [study["grade"] for study in listed]
    counted = tally_text(study["grade"] for study in listed)
    assert sunatlas("studies").stdout.startswith(f"129 studies: {counted}")


@pytest.mark.parametrize("attribute", ["model", "extractor"])
def test_a_filter_takes_what_tables_print_for_none(attribute):
    value = table("studies", "--model", "None", "--extractor", "BCTM")[0]["model"]
    found = {s["key"] for s in answer("studies", f"--{attribute}", value)}
    assert found == studies_with(attribute, "None")


def test_one_study_is_shown_with_basis_pipelines_and_gaps():
    study = answer("studies", "Chang2008")
    assert study["key"] == "Chang2008"
    assert all(cell["basis"] for cell in study["attributes"])
    assert study["pipelines"]
    shown = sunatlas("studies", "Chang2008").stdout
    for gap in study["gaps"]:
        assert gap["reason"].split()[0] in shown
    assert len(table("studies", "Chang2008")) == len(study["attributes"])

"""`sunatlas studies` takes what its tables print."""

import csv
import io
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import survey_data
from api.cli.command_line import app

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


@pytest.mark.parametrize("attribute", ["model", "extractor"])
def test_a_filter_takes_what_tables_print_for_none(attribute):
    value = table("studies", "--model", "None", "--extractor", "BCTM")[0]["model"]
    found = {s["key"] for s in answer("studies", f"--{attribute}", value)}
    assert found == studies_with(attribute, "None")

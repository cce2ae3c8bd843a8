"""`sunatlas survey add` refuses calls that ask for two things, and replaces no file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from typer.testing import CliRunner

from api.cli.command_line import app
from survey_data.additions.offered import parse_toml

TEMPLATE = """\
key = "Doe2030"
title = "A sun sensor that nobody built"
authors = ["Jane Doe"]
year = 2030
type = "thesis"

[[detector]]
value = "CMSO"
basis = "title"
"""


def add(*arguments: object) -> Any:
    call = ["survey", "add", *map(str, arguments)]
    return CliRunner(env={"COLUMNS": "200"}).invoke(app, call, catch_exceptions=False)


def test_a_template_without_a_file_is_printed(tmp_path: Path) -> None:
    shown = add("--init", "Doe2030")
    assert shown.exit_code == 0, shown.stderr
    stated = parse_toml(shown.stdout, "printed").values
    assert (stated["key"], stated["year"]) == ("Doe2030", 2030)
    path = tmp_path / "new.toml"
    assert f"{path} written: fill it in" in add("--init", "Doe2030", path).stdout
    assert path.read_text() == shown.stdout


def test_faults_are_named_on_stderr_and_in_json_alike(tmp_path: Path) -> None:
    given = tmp_path / "study.toml"
    given.write_text(TEMPLATE)
    shown = add(given, "--format", "json")
    assert shown.exit_code == 1
    document = json.loads(shown.stdout)
    assert document["file"] == "study.toml"
    line = TEMPLATE[: TEMPLATE.index("CMSO")].count("\n") + 1
    told = [(one["line"], one["message"]) for one in document["faults"]]
    assert any(at == line and "did you mean CMOS?" in message for at, message in told)
    places = [("" if at is None else f", line {at}", message) for at, message in told]
    assert shown.stderr.splitlines() == [f"sunatlas: study.toml{at}: {m}" for at, m in places]
    assert add(given).stdout == ""

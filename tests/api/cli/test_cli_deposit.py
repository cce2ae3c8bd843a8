"""`sunatlas deposit`: built and verified from the command line."""

import json

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app


def deposit(*arguments):
    return CliRunner().invoke(app, ["deposit", *map(str, arguments)], catch_exceptions=False)


@pytest.mark.slow
def test_what_is_built_is_verified_and_what_is_damaged_is_not(tmp_path):
    out = tmp_path / "new" / "bundle"
    built = deposit("build", "--out", out, "--format", "json")
    assert built.exit_code == 0, built.stderr
    document = json.loads(built.stdout)
    assert document["directory"] == str(out)
    assert {row["file"] for row in document["files"]} >= {
        *("datapackage.json", "ro-crate-metadata.json", "CITATION.cff", "checksums-sha256.txt"),
        *("survey/studies.csv", "benchmark/leaderboard.csv", "benchmark/scores.csv"),
    }
    assert deposit("verify", out).exit_code == 0
    (out / "README.md").write_text("damaged")
    damaged = deposit("verify", out, "--format", "json")
    assert damaged.exit_code == 1
    assert [row["file"] for row in json.loads(damaged.stdout)] == ["README.md"]


def test_somebody_else_s_directory_is_refused_in_one_line(tmp_path):
    (tmp_path / "thesis.tex").write_text("irreplaceable")
    shown = deposit("build", "--out", tmp_path)
    assert shown.exit_code == 1
    assert shown.stdout == ""
    assert shown.stderr.count("\n") == 1
    assert "thesis.tex" in shown.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]

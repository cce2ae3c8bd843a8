"""`sunatlas deposit`: built and verified from the command line."""

import json
from functools import partial

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from api.deposit import bundle
from benchmark import datasets
from tests.api.deposit import small_bundle


def deposit(*arguments):
    return CliRunner().invoke(app, ["deposit", *map(str, arguments)], catch_exceptions=False)


@pytest.mark.slow
def test_what_is_built_is_verified_and_what_is_damaged_is_not(tmp_path, monkeypatch):
    # All samples take minutes; the release builds them.
    some = partial(bundle.build, frames=("cmos-single-aperture",))
    monkeypatch.setattr(bundle, "build", some)
    out = tmp_path / "new" / "bundle"
    built = deposit("build", "--out", out, "--format", "json")
    assert built.exit_code == 0, built.stderr
    document = json.loads(built.stdout)
    assert document["directory"] == str(out)
    assert {row["file"] for row in document["files"]} >= {
        *("datapackage.json", "ro-crate-metadata.json", "CITATION.cff", "checksums-sha256.txt"),
        *("survey/studies.csv", "benchmark/leaderboard.csv", "benchmark/scores.csv"),
    }
    left_out = {f"frames/{name}" for name in datasets.names()} - {"frames/cmos-single-aperture"}

    def wrong():
        found = deposit("verify", out, "--format", "json")
        assert found.exit_code == 1
        return {row["file"]: row["problem"] for row in json.loads(found.stdout)}

    assert wrong() == dict.fromkeys(left_out, "missing")
    (out / "README.md").write_text("damaged")
    assert wrong().keys() - left_out == {"README.md"}


def test_a_damaged_file_fails_with_its_name(tmp_path):
    bundle = small_bundle.make(tmp_path / "bundle")
    assert deposit("verify", "--alone", bundle).exit_code == 0
    (bundle / "README.md").write_text("damaged")
    shown = deposit("verify", "--alone", bundle, "--format", "json")
    assert shown.exit_code == 1
    assert [row["file"] for row in json.loads(shown.stdout)] == ["README.md"]


@pytest.mark.parametrize(
    ("arguments", "variable"),
    [
        (("upload",), "ZENODO_SANDBOX_TOKEN"),
        (("upload", "--production"), "ZENODO_TOKEN"),
        (("publish", "7"), "ZENODO_SANDBOX_TOKEN"),
        (("publish", "7", "--server", "https://a.example"), "ARCHIVE_TOKEN"),
    ],
)
def test_without_a_token_nobody_is_asked(arguments, variable, monkeypatch):
    for name in ("ZENODO_TOKEN", "ZENODO_SANDBOX_TOKEN", "ARCHIVE_TOKEN"):
        monkeypatch.delenv(name, raising=False)
    shown = deposit(*arguments)
    assert shown.exit_code == 1
    assert shown.stderr.count("\n") == 1
    assert f"as {variable}" in shown.stderr

"""`sunatlas run`: measured once, and read afterwards."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from api.cli import measuring
from api.cli.command_line import app
from api.user_cache import user_cache


def sunatlas(*arguments):
    return CliRunner().invoke(app, list(map(str, arguments)), catch_exceptions=False)


@pytest.fixture
def unpublished(tmp_path, monkeypatch):
    """Nothing is published, and the working store is new."""
    monkeypatch.setattr(measuring, "PUBLISHED", tmp_path / "published")
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path / "working"))
    return tmp_path


@pytest.mark.slow
def test_a_run_that_finds_nothing_published_measures_once(unpublished):
    arguments = ("run", "Allgeier2009", "--condition", "nominal", "--format", "json")
    first = sunatlas(*arguments)
    assert first.exit_code == 0, first.stderr
    measured = json.loads(first.stdout)
    assert measured["sources"]["measured"] == len(measured["scores"]) > 0
    assert measured["sources"]["directory"] == str(unpublished / "working")
    written = {path.stem for path in (unpublished / "working" / "scores").iterdir()}
    assert written == {row["dataset"] for row in measured["scores"]}
    again = json.loads(sunatlas(*arguments).stdout)
    assert again["sources"]["measured"] == 0
    assert again["sources"]["kept"] == len(again["scores"])
    assert again["scores"] == measured["scores"]


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({"SUNATLAS_STORE": "/a"}, Path("/a")),
        ({"XDG_CACHE_HOME": "/c"}, Path("/c/sunatlas")),
        ({"HOME": "/h"}, Path("/h/.cache/sunatlas")),
    ],
)
def test_the_working_store_is_where_it_is_said_to_be(monkeypatch, environment, expected):
    for name in ("SUNATLAS_STORE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert user_cache() == expected

"""`sunatlas recommend` answers fast, from what is kept, and never from what is out of date."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from api.cli import prepared_measurements
from api.cli.working import working_directory
from registry.studies import facts, facts_from
from survey_data import load

ROOT = Path(__file__).resolve().parents[3]
HEAVY = {"numpy", "pandas", "scipy", "cv2", "numba", "fastapi", "plotly", "rich", "algorithms"}


@pytest.fixture(autouse=True)
def _kept_here(tmp_path, monkeypatch):
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path))


@pytest.fixture(scope="module")
def rows(knowledge):
    return knowledge.measurements.pipelines


@pytest.fixture
def made(monkeypatch, rows):
    """Count how often it is made."""
    calls = []

    def make():
        calls.append(None)
        return rows

    monkeypatch.setattr(prepared_measurements, "_made", make)
    return calls


@pytest.mark.slow
def test_what_is_kept_is_what_was_made(made, rows):
    first, again = prepared_measurements.measure(), prepared_measurements.measure()
    assert made == [None]
    assert again.rows == first.rows
    assert {repr(row) for row in again.rows} <= {repr(row) for row in rows}
    assert len(again.rows) > 3000


@pytest.mark.slow
def test_it_is_made_anew_where_what_it_is_made_of_has_changed(made, tmp_path, monkeypatch):
    prepared_measurements.measure()
    other = tmp_path / "published"
    (other / "scores").mkdir(parents=True)
    monkeypatch.setattr(prepared_measurements, "_PUBLISHED", other)
    prepared_measurements.measure()
    for name in ("scores/x.csv", "times.csv"):
        (other / name).write_text("1")
        prepared_measurements.measure()
    prepared_measurements.measure()
    assert len(made) == 4


@pytest.mark.parametrize(
    "content", [pytest.param("", marks=pytest.mark.slow), "{", '{"key": 1}', "[]", "\xff"]
)
def test_a_file_that_is_broken_is_made_anew(made, content):
    path = working_directory() / prepared_measurements.FILE
    path.write_text(content, encoding="latin-1")
    prepared_measurements.measure()
    assert len(made) == 1
    assert json.loads(path.read_text())["key"] == prepared_measurements.digest()


def test_where_nothing_can_be_kept_it_is_made_at_every_call(made, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path / "file" / "below"))
    assert prepared_measurements.measure().rows == prepared_measurements.measure().rows
    assert len(made) == 2


def test_facts_read_as_text_are_those_of_the_frames():
    text, frames = facts(), facts_from(load())
    assert text.studies == frames.studies
    assert text.taxonomy.to_dict() == frames.taxonomy.to_dict()
    assert (text.defaults, text.advice) == (frames.defaults, frames.advice)
    assert text.properties == frames.properties


@pytest.mark.slow
def test_an_answer_from_what_is_kept_imports_nothing_heavy_but_numpy(tmp_path):
    command = [sys.executable, "-X", "importtime", "-m", "api.cli.command_line", "recommend"]
    environment = {**os.environ, "SUNATLAS_STORE": str(tmp_path)}
    shown = [
        subprocess.run(
            command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True
        )
        for _ in range(2)
    ]
    first, again = (
        {line.rpartition("|")[2].strip().partition(".")[0] for line in one.stderr.splitlines()}
        for one in shown
    )
    assert shown[0].stdout == shown[1].stdout
    assert "numpy" in first  # the list is what it is taken for
    assert again & HEAVY == {"numpy"}  # answers are judged as columns

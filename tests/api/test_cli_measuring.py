"""`sunatlas run`, `benchmark` and `leaderboard`: measured once, read afterwards, checked."""

import csv
import io
import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from api.command_line import app
from api.commands import leaderboard, measuring
from benchmark.plan import cells, datasets_for
from benchmark.runner import RunInterruptedError, stale
from benchmark.store import PUBLISHED, Store, cell_of
from registry.catalogue import catalogue
from registry.resolution import resolve

CHEAP = ("--dataset", "pd-maskless-cube", "--condition", "nominal", "--model", "basic")


def sunatlas(*arguments):
    return CliRunner().invoke(app, list(map(str, arguments)), catch_exceptions=False)


@pytest.fixture
def unpublished(tmp_path, monkeypatch):
    """Nothing is published, and the working store is new."""
    monkeypatch.setattr(measuring, "PUBLISHED", tmp_path / "published")
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path / "working"))
    return tmp_path


def test_a_study_s_pipelines_are_scored_against_the_bound_and_its_gaps_listed():
    shown = sunatlas("run", "Chang2008", "--condition", "nominal", "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    found = json.loads(shown.stdout)
    resolution = resolve("Chang2008")
    expected = {
        (name, pipeline.extractor, pipeline.model)
        for pipeline in resolution.pipelines
        for name in datasets_for(pipeline.detector, pipeline.mask)
    }
    assert expected
    scored = {(row["dataset"], row["extractor"], row["model"]) for row in found["scores"]}
    # a variant that reads profiles has nothing to read where a data set gives frames
    planned = {
        (cell.dataset, cell.extractor, cell.model)
        for cell in cells({name for name, _, _ in expected}, "nominal")
    }
    assert scored == expected & planned
    values = catalogue().extractors
    assert {values[extractor].taxonomy for _, extractor, _ in scored} == {
        values[extractor].taxonomy for _, extractor, _ in expected
    }
    for row in found["scores"]:
        assert row["condition"] == "nominal"
        if not row["found_fraction"]:  # nothing found, nothing to compare: TM on the pinhole
            assert row["rms_deg"] is row["bound_deg"] is row["over_bound"] is None
            continue
        assert row["bound_deg"] > 0
        # Root mean squares over the same samples: 6 digits each.
        assert row["over_bound"] == pytest.approx(row["rms_deg"] / row["bound_deg"], rel=1e-4)
    assert {gap["value"] for gap in found["gaps"]} == {
        gap.value
        for gap in resolve("Chang2008", {(p.detector, p.mask) for p in resolution.pipelines}).gaps
    }


def test_a_run_that_finds_nothing_published_measures_once(unpublished):
    arguments = ("run", "Allgeier2009", "--condition", "nominal", "--format", "json")
    first = sunatlas(*arguments)
    assert first.exit_code == 0, first.stderr
    measured = json.loads(first.stdout)
    assert measured["sources"]["measured"] == len(measured["scores"]) > 0
    assert measured["sources"]["directory"] == str(unpublished / "working")
    assert (unpublished / "working" / "scores.jsonl").is_file()
    again = json.loads(sunatlas(*arguments).stdout)
    assert again["sources"]["measured"] == 0
    assert again["sources"]["kept"] == len(again["scores"])
    assert again["scores"] == measured["scores"]


def test_what_is_published_is_read_there():
    found = json.loads(sunatlas("benchmark", *CHEAP, "--format", "json").stdout)
    keys = {row["key"] for row in Store(PUBLISHED).rows()}
    assert found["scores"]
    assert {row["key"] for row in found["scores"]} <= keys
    assert found["sources"]["published"] == len(found["scores"])
    assert found["sources"]["measured"] == 0


def test_the_formats_say_the_same(unpublished):
    store = ("--store", unpublished / "other")
    shown = sunatlas("benchmark", *CHEAP, *store, "--format", "json")
    found = json.loads(shown.stdout)["scores"]
    rows = list(
        csv.DictReader(io.StringIO(sunatlas("benchmark", *CHEAP, *store, "--format", "csv").stdout))
    )
    assert [float(row["rms_deg"]) for row in rows] == [row["rms_deg"] for row in found]
    assert str(unpublished / "other") in shown.stderr
    assert found[0]["extractor"] in sunatlas("benchmark", *CHEAP, *store).stdout


def test_a_study_of_which_nothing_runs_says_why_and_fails(unpublished):
    listed = json.loads(sunatlas("studies", "--state", "none", "--format", "json").stdout)
    shown = sunatlas("run", listed[0]["key"], "--format", "json")
    assert shown.exit_code == 1
    found = json.loads(shown.stdout)
    assert found["scores"] == []
    assert found["gaps"]
    assert "nothing of" in shown.stderr


def test_names_that_go_with_nothing_fail(unpublished):
    shown = sunatlas("benchmark", "--dataset", "pd-maskless-cube", "--extractor", "bctm")
    assert shown.exit_code == 1
    assert "no compatible combination" in shown.stderr


def test_an_unknown_condition_of_a_study_s_data_is_refused():
    shown = sunatlas("run", "Allgeier2009", "--condition", "nominale")
    assert shown.exit_code == 1
    assert "'nominal'" in shown.stderr


def test_ctrl_c_says_what_is_kept(unpublished, monkeypatch):
    def interrupted(*_arguments, **_options):
        raise RunInterruptedError("interrupted with 1 of 2 cells measured")

    monkeypatch.setattr(measuring, "run", interrupted)
    shown = sunatlas("benchmark", *CHEAP)
    assert shown.exit_code == 130
    assert shown.stderr == "sunatlas: interrupted with 1 of 2 cells measured\n"


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
    assert measuring.working_directory() == expected
    assert measuring.working_directory(Path("given")) == Path("given")


# ---- leaderboard


@pytest.fixture
def published(tmp_path, monkeypatch):
    """A copy of the published results, free to be altered."""
    directory = tmp_path / "published"
    shutil.copytree(PUBLISHED, directory, ignore=shutil.ignore_patterns(".sunatlas"))
    monkeypatch.setattr(leaderboard, "PUBLISHED", directory)
    return directory


def test_the_committed_leaderboard_is_what_its_code_gives(published):
    shown = sunatlas("leaderboard", "--check", "--stored")
    assert (shown.exit_code, shown.stdout) == (0, ""), shown.stdout


def test_one_altered_number_is_named_by_its_cell(published):
    path = published / "leaderboard.json"
    board = json.loads(path.read_text("utf-8"))
    row = next(r for r in board["datasets"][0]["rows"] if r["rms_deg"] is not None)
    old = json.dumps(row["rms_deg"])
    text = path.read_text("utf-8")
    at = text.index(f'"rms_deg": {old}', text.index(row["key"]))
    path.write_text(text[:at] + '"rms_deg": 123.456' + text[at + len(f'"rms_deg": {old}') :])
    shown = sunatlas("leaderboard", "--check", "--stored", "--format", "json")
    assert shown.exit_code == 1
    names = ("dataset", "condition", "extractor", "model")
    cell = "/".join([*(row[name] for name in names), "rms_deg"])
    assert json.loads(shown.stdout) == [
        {"file": "leaderboard.json", "cell": cell, "committed": "123.456", "measured": old}
    ]
    assert cell in shown.stderr


def test_an_up_to_date_leaderboard_is_left_as_it_is(published):
    # What failed is tried again, and only that.
    failed = {cell_of(row) for row in Store(published).rows() if row["status"] == "failed"}
    assert set(stale(cells(), Store(published))) <= failed, "run `make leaderboard`"
    before = {path.name: path.read_bytes() for path in published.iterdir() if path.is_file()}
    shown = sunatlas("leaderboard", "--workers", 1, "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    after = {path.name: path.read_bytes() for path in published.iterdir() if path.is_file()}
    assert after == before
    assert f" {len(failed)} measured" in shown.stderr
    assert json.loads(shown.stdout) == json.loads(before["leaderboard.json"])


def test_stored_goes_with_check():
    shown = sunatlas("leaderboard", "--stored")
    assert shown.exit_code == 2
    assert shown.stderr == "sunatlas: --stored goes with --check\n"

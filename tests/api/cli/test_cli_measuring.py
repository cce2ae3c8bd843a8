"""`sunatlas run`, `benchmark` and `leaderboard`: measured once, read afterwards, checked."""

import json
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from api.cli import measuring
from api.cli.command_line import app
from api.cli.commands import leaderboard
from api.user_cache import user_cache
from benchmark.contract import Cell
from benchmark.plan.combinations import scorable_plan
from benchmark.plan.parts import installed_parts
from benchmark.results.store import PUBLISHED, Store
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


@pytest.mark.slow
def test_a_study_s_pipelines_are_scored_against_the_bound_and_its_gaps_listed():
    shown = sunatlas("run", "Chang2008", "--condition", "nominal", "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    found = json.loads(shown.stdout)
    resolution = resolve("Chang2008", scorable_plan())
    expected = {
        (name, pipeline.extractor, pipeline.model)
        for pipeline in resolution.pipelines
        for name in pipeline.datasets
    }
    assert expected
    scored = {(row["dataset"], row["extractor"], row["model"]) for row in found["scores"]}
    assert scored == expected
    values = catalogue().extractors
    assert {values[extractor].about.taxonomy for _, extractor, _ in scored} == {
        values[extractor].about.taxonomy for _, extractor, _ in expected
    }
    for row in found["scores"]:
        assert row["condition"] == "nominal"
        if not row["availability"]:  # nothing found, nothing to compare: TM on the pinhole
            assert row["rms_deg"] is row["bound_deg"] is row["over_bound"] is None
            continue
        assert row["bound_deg"] > 0
        # Root mean squares over the same samples: 5 digits each.
        assert row["over_bound"] == pytest.approx(row["rms_deg"] / row["bound_deg"], rel=1e-4)
    assert found["gaps"] == [gap.to_dict() for gap in resolution.gaps] == []
    assert all(row["assumed"] == [] for row in found["scores"])


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


@pytest.mark.slow
def test_what_is_published_is_read_there():
    found = json.loads(sunatlas("benchmark", *CHEAP, "--format", "json").stdout)
    published = Store(PUBLISHED).scores()
    assert found["scores"]
    for row in found["scores"]:
        cell = Cell(row["dataset"], row["condition"], row["extractor"], row["model"])
        assert {name: row[name] for name in published[cell]} == published[cell]
    assert found["sources"]["published"] == len(found["scores"])
    assert found["sources"]["measured"] == 0


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


# ---- leaderboard


@pytest.fixture
def published(tmp_path, monkeypatch):
    """A copy of the published results, free to be altered."""
    directory = tmp_path / "published"
    shutil.copytree(PUBLISHED, directory, ignore=shutil.ignore_patterns(".sunatlas"))
    monkeypatch.setattr(leaderboard, "PUBLISHED", directory)
    return directory


def listed(*arguments):
    shown = sunatlas("leaderboard", *arguments, "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    return json.loads(shown.stdout)["items"]


def test_the_leaderboard_is_shown_and_nothing_is_measured(tmp_path, monkeypatch):
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path / "working"))
    best = listed("--each")
    assert {row["rank"] for row in best} == {1}
    assert {row["condition"] for row in best} == {"nominal"}
    assert {row["dataset"] for row in best} == set(installed_parts().presets)
    assert all(row["latency_us"] > 0 for row in best)
    whole = listed("--dataset", "ccd-orbit", "--condition", "stable")
    assert {(row["dataset"], row["condition"]) for row in whole} == {("ccd-orbit", "stable")}
    for part in (True, False):
        ranks = [r["rank"] for r in whole if r["rank"] and r["best_of_extractor"] is part]
        assert ranks == sorted(ranks)
    first = [row["best_of_extractor"] for row in whole]
    assert first == sorted(first, reverse=True)
    assert not (tmp_path / "working").exists()


@pytest.mark.slow
def test_the_committed_leaderboard_is_what_its_code_gives(published):
    shown = sunatlas("leaderboard", "--check", "--stored")
    assert (shown.exit_code, shown.stdout) == (0, ""), shown.stdout

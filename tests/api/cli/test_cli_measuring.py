"""`sunatlas run`, `benchmark` and `leaderboard`: measured once, read afterwards, checked."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from api.cli import measuring
from api.cli.command_line import app
from api.user_cache import user_cache
from benchmark.plan.combinations import scorable_plan
from registry.catalogue import catalogue
from registry.resolution import resolve


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

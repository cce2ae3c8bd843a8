"""The committed results: of the code as it is, and in line with what is known of the methods."""

import shutil
from itertools import product

import numpy as np
import pytest

from benchmark import datasets, leaderboard, plan, runner, runner_unit
from benchmark.datasets import Preset
from benchmark.leaderboard_check import compare
from benchmark.plan_parts import installed
from benchmark.store import PUBLISHED, Store

#: Standard errors by which the best of some hundred unbiased scores may fall below the bound.
BY_CHANCE = 4.0


@pytest.fixture(scope="module")
def published():
    return Store()


@pytest.fixture(scope="module")
def fresh(tmp_path_factory):
    """Two datasets measured now; everything else is read from the committed scores."""
    store = Store(tmp_path_factory.mktemp("fresh"))
    wanted = plan.cells("cmos-single-aperture", "low-noise", ["bcm", "bctm"])
    wanted += plan.cells("qpd-single-aperture", ["nominal", "high-noise"])
    wanted += plan.cells("pd-maskless-cube", "cosine", "direct")
    assert runner.run(wanted, store).failed == ()
    return store


def rms(store, **where):
    return {
        (row["extractor"], row["model"]): row["rms_deg"]
        for row in store.query(status="ok", **where)
    }


def beaten(store):
    """Rows that lie below the Cramer-Rao bound by more than chance allows."""
    # a single sample has a ratio but no standard error, and so says nothing here
    scored = [row for row in store.query(status="ok") if row["over_bound_se"] is not None]
    assert scored
    return [
        (row["dataset"], row["condition"], row["extractor"], row["model"], row["over_bound"])
        for row in scored
        if row["over_bound"] + BY_CHANCE * row["over_bound_se"] < 1
    ]


def test_the_committed_files_agree_with_each_other_and_with_the_code(published):
    assert leaderboard.check(stored_only=True) == []
    assert set(plan.cells()) == {
        plan.Cell(row["dataset"], row["condition"], row["extractor"], row["model"])
        for row in published.rows()
    }


def test_no_planned_pipeline_fails(published):
    failed = published.query(status="failed")
    assert [(r["dataset"], r["extractor"], r["model"], r["reason"]) for r in failed] == []


def unreadable():
    """Datasets of which no installed pipeline can measure anything, by the plan's own reasons."""
    parts = installed()
    why_not = {(i.dataset, i.extractor, i.model): i.reason for i in plan.incompatible()}

    def refused(dataset, extractor, model):
        return why_not.get((dataset, extractor, "")) or why_not.get((dataset, extractor, model))

    return {
        dataset
        for dataset in parts.presets
        if all(refused(dataset, *pair) for pair in product(parts.extractors, parts.models))
    }


def test_every_dataset_and_condition_is_scored_that_an_implemented_pipeline_can_read(published):
    """The others are said to be unscored: by the plan with reasons, and by their pins alone."""
    unscored = unreadable()
    places = {(row["dataset"], row["condition"]) for row in published.query(status="ok")}
    presets = [datasets.get(name) for name in datasets.names()]
    assert places == {
        (p.name, condition) for p in presets for condition in p.conditions if p.name not in unscored
    }
    assert not unscored & {row["dataset"] for row in published.rows()}
    assert not unscored & {cell.dataset for cell in plan.cells()}
    assert unscored <= {dataset for dataset, _, _ in published.pins()}


def test_measured_now_is_what_is_committed(published, fresh):
    assert compare(published.rows(), fresh.rows()) == []


def test_bringing_an_up_to_date_leaderboard_up_to_date_renders_nothing(tmp_path, monkeypatch):
    def refuse(*arguments):
        raise AssertionError("a dataset was rendered")

    for path in PUBLISHED.glob("*.*"):
        if path.is_file():
            shutil.copy(path, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    monkeypatch.setattr(Preset, "generate", refuse)
    monkeypatch.setattr(Preset, "bound", refuse)
    assert leaderboard.update(tmp_path).computed == 0
    after = {path.name: path.read_bytes() for path in tmp_path.iterdir() if path.is_file()}
    assert after == before


@pytest.mark.parametrize("source", ["published", "fresh"])
def test_under_low_noise_the_thresholded_centroid_beats_the_plain_one(source, request):
    """Chang2008, He2005. With every model that does not hide the extractor behind its own error:

    the linear one is off by degrees whatever the centroid (tan is no line over 60 degrees).
    """
    store = request.getfixturevalue(source)
    scores = rms(store, dataset="cmos-single-aperture", condition="low-noise")
    models = {model for _, model in scores} - {"linear"}
    assert {"lsq", "spm", "polynomial-1d", "polynomial-2d"} <= models
    assert all(scores["bctm", model] < scores["bcm", model] for model in models), scores


@pytest.mark.parametrize("extractor", ["bctm", "bcm", "ifm", "pm"])
def test_least_squares_beat_the_nominal_projection_once_tilt_and_focal_length_err(
    published, extractor
):
    scores = rms(published, dataset="cmos-single-aperture", condition="misaligned")
    assert scores[extractor, "lsq"] < scores[extractor, "spm"]


@pytest.mark.parametrize("source", ["published", "fresh"])
def test_no_pipeline_beats_the_cramer_rao_bound_beyond_statistical_error(source, request):
    assert beaten(request.getfixturevalue(source)) == []


def test_a_model_that_peeks_at_the_truth_is_caught(tmp_path, monkeypatch):
    """The same question asked of a leak: half of the noise is taken out with the true direction."""
    [cell] = plan.cells("qpd-single-aperture", "high-noise", "voltage-balance", "polynomial-2d")
    model = installed().model("polynomial-2d")
    truth = datasets.get("qpd-single-aperture").generate("high-noise", "test").sun
    honest = model.predict

    def peek(self, features):
        mixed = honest(self, features) + truth
        return mixed / np.linalg.norm(mixed, axis=1, keepdims=True)

    monkeypatch.setattr(model, "predict", peek)
    runner_unit._kept.clear()
    store = Store(tmp_path)
    assert runner.run([cell], store).failed == ()
    assert len(beaten(store)) == 1

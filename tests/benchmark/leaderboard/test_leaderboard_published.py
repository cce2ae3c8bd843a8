"""The committed results: of the code as it is, and in line with what is known of the methods."""

from itertools import groupby

import numpy as np
import pytest

from benchmark import datasets
from benchmark.leaderboard.check import check, compare_scores
from benchmark.plan import combinations as plan
from benchmark.plan.parts import installed_parts
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import condition_data, runner

#: Standard errors by which the best of some hundred unbiased scores may fall below the bound.
BY_CHANCE = 4.0


@pytest.fixture(scope="module")
def published():
    return Store(PUBLISHED)


@pytest.fixture(scope="module")
def fresh(tmp_path_factory):
    """Two datasets measured now; everything else is read from the committed scores."""
    store = Store(tmp_path_factory.mktemp("fresh"))
    wanted = plan.cells("cmos-single-aperture", "low-noise", ["bcm", "bctm"])
    wanted += plan.cells("cmos-single-aperture", "misaligned", models=["lsq", "spm"])
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
    """Rows that lie below their Cramer-Rao bound by more than chance allows; filters, too."""
    # a single sample has a ratio but no standard error, and so says nothing here
    scored = [row for row in store.query(status="ok") if row["over_bound_se"] is not None]
    assert scored
    return [
        (row["dataset"], row["condition"], row["extractor"], row["model"], row["over_bound"])
        for row in scored
        if row["over_bound"] + BY_CHANCE * row["over_bound_se"] < 1
    ]


def files():
    """List what is committed: a runner's progress is not."""
    return [
        path
        for path in PUBLISHED.rglob("*")
        if path.is_file() and ".sunatlas" not in path.relative_to(PUBLISHED).parts
    ]


def test_the_record_is_of_the_code_as_it_is():
    assert check(PUBLISHED, stored_only=True) == []


def test_it_is_small_and_holds_nothing_that_can_be_derived():
    sampled = [path for path in files() if path.parent.name == "samples"]
    assert sum(path.stat().st_size for path in sampled) < 7e6
    assert sum(path.stat().st_size for path in files() if path not in sampled) < 6.5e6
    sets = {cell.dataset for cell in plan.cells()}
    tables = {f"scores/{name}.csv" for name in sets}
    names = {path.relative_to(PUBLISHED).as_posix() for path in files()}
    errors = {f"samples/{name}{kind}.parquet" for name in sets for kind in ("", ".directions")}
    assert names == {
        *tables, *errors, "pins.csv", "sweeps.csv", "sweeps.json", "claims.json", "curves.json",
        "components.json", "error_budget.json", "leaderboard.md", "checksums-sha256.txt",
        "times.csv", "times_machine.json", "equal_height.csv", "equal_height.json",
        "as_sold.csv", "as_sold.json", "spoofing.json", "learned.json", "segmentation.json",
        "learned_faults.json",
    }  # fmt: skip


@pytest.fixture(scope="module")
def boards(published_board):
    """Data set, condition and rows as ranked: the board lists the best of each extractor first."""
    return [
        (dataset["name"], condition, sorted(rows, key=by_rank))
        for dataset in published_board["datasets"]
        for condition, rows in groupby(dataset["rows"], key=lambda row: row["condition"])
    ]


def by_rank(row):
    return row["rank"] is None, row["rank"] or 0, row["rms_deg"] or 0.0


def test_nothing_that_answers_too_seldom_is_before_anything_that_answers(boards):
    for name, condition, rows in boards:
        ranked = [row for row in rows if row["rank"] is not None]
        answering = [(row["availability"] or 0.0) >= 0.95 for row in ranked]
        assert answering == sorted(answering, reverse=True), (name, condition)
        if any(answering):
            assert ranked[0]["availability"] >= 0.95, (name, condition)


def test_no_planned_pipeline_fails(published):
    failed = published.query(status="failed")
    assert [(r["dataset"], r["extractor"], r["model"], r["reason"]) for r in failed] == []


@pytest.mark.slow
def test_measured_now_is_what_is_committed(published, fresh):
    scores = published.scores()
    counts = {place[:2]: pin.n for place, pin in published.pins().items() if place[2] == "test"}
    measured = {cell: row for cell, row in fresh.scores().items() if cell in scores}
    assert len(measured) > 20
    assert compare_scores({cell: scores[cell] for cell in measured}, measured, counts) == []


@pytest.mark.parametrize("source", ["published", pytest.param("fresh", marks=pytest.mark.slow)])
def test_under_low_noise_the_thresholded_centroid_beats_the_plain_one(source, request):
    """Chang2008, He2005. With every model that does not hide the extractor behind its own error:

    the linear one is off by degrees whatever the centroid (tan is no line over 60 degrees). What is
    published has the best model of each at least.
    """
    store = request.getfixturevalue(source)
    scores = rms(store, dataset="cmos-single-aperture", condition="low-noise")
    of = {
        name: {model: error for (extractor, model), error in scores.items() if extractor == name}
        for name in ("bctm", "bcm")
    }
    assert min(of["bctm"].values()) < min(of["bcm"].values())
    both = (of["bctm"].keys() & of["bcm"].keys()) - {"linear"}
    assert source == "published" or {"lsq", "spm", "polynomial-1d", "polynomial-2d"} <= both
    assert all(of["bctm"][model] < of["bcm"][model] for model in both), scores


@pytest.mark.slow
@pytest.mark.parametrize("extractor", ["bctm", "bcm", "ifm", "pm"])
def test_least_squares_beat_the_nominal_projection_once_tilt_and_focal_length_err(fresh, extractor):
    scores = rms(fresh, dataset="cmos-single-aperture", condition="misaligned")
    assert scores[extractor, "lsq"] < scores[extractor, "spm"]


@pytest.mark.parametrize("source", ["published", pytest.param("fresh", marks=pytest.mark.slow)])
def test_no_pipeline_beats_the_cramer_rao_bound_beyond_statistical_error(source, request):
    assert beaten(request.getfixturevalue(source)) == []


@pytest.mark.slow
def test_a_model_that_peeks_at_the_truth_is_caught(tmp_path, monkeypatch):
    """The same question asked of a leak: half of the noise is taken out with the true direction."""
    [cell] = plan.cells("qpd-single-aperture", "high-noise", "voltage-balance", "polynomial-2d")
    model = installed_parts().model("polynomial-2d")
    truth = datasets.get("qpd-single-aperture").generate("high-noise", "test").sun
    honest = model.predict

    def peek(self, features, context=None):
        if len(features) != len(truth):  # the repeated poses
            return honest(self, features, context)
        mixed = honest(self, features, context) + truth
        return mixed / np.linalg.norm(mixed, axis=1, keepdims=True)

    monkeypatch.setattr(model, "predict", peek)
    condition_data.forget()
    store = Store(tmp_path)
    assert runner.run([cell], store).failed == ()
    assert len(beaten(store)) == 1

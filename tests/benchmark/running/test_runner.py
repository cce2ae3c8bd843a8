"""Measuring: the right numbers, the same with any number of workers, never twice."""

import dataclasses
import sys

import fake_atlas
import fake_plan
import numpy as np
import pytest

from benchmark.contract import UnknownNameError
from benchmark.metrics.score import repeatability_deg
from benchmark.plan import combinations as plan
from benchmark.results import samples
from benchmark.results.record import Record
from benchmark.results.store import Store
from benchmark.running import runner

pytestmark = pytest.mark.usefixtures("log")


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "store")


def contents(store):
    return {
        path.relative_to(store.directory): path.read_bytes()
        for path in store.directory.rglob("*")
        if path.is_file() and store.work_directory not in path.parents
    }


def solved(observations):
    vectors = observations @ np.linalg.pinv(fake_atlas.NORMALS).T
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def measure(store, parts=None, **options):
    parts = parts or fake_plan.parts()
    return runner.run(plan.cells(parts=parts), store, parts=parts, **options)


def test_scores_are_the_ones_the_pipeline_gives_and_the_bound_is_respected(store):
    summary = measure(store)
    assert (summary.planned, summary.computed, summary.failed, summary.warnings) == (4, 4, (), ())
    row = store.query(condition="noisy", extractor="fake-currents")[0]
    preset = fake_atlas.Diodes()
    test = preset.generate("noisy", "test")
    error = np.rad2deg(np.arccos(np.sum(solved(test.observations) * test.sun, axis=1)))
    assert row["rms_deg"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-4)
    assert row["bound_deg"] == pytest.approx(
        np.sqrt(np.mean(preset.bound("noisy").angle_deg ** 2)), rel=1e-4
    )
    assert 1 - 4 * row["over_bound_se"] < row["over_bound"] < 1.2
    assert row["n_test"] == row["n_calibration"] == 400
    gaps = store.query(condition="noisy", extractor="fake-gaps")[0]
    assert gaps["availability"] == 0.75


def test_repeatability_is_of_the_answers_to_the_repeated_poses(store):
    """Four diodes and white noise: the spread is the bound itself, and no error of truth enters."""
    measure(store)
    row = store.query(condition="noisy", extractor="fake-currents")[0]
    answers = solved(fake_atlas.Diodes().generate("noisy", "repeat").observations)
    expected = repeatability_deg(answers.reshape(4, 20, 3))
    assert row["repeatability_deg"] == pytest.approx(expected, rel=1e-4)
    assert row["repeatability_deg"] == pytest.approx(row["bound_deg"], rel=0.2)


def test_what_cannot_be_observed_is_left_to_false_suns(store):
    """The first eighth of the test split is dark, three of the repeated poses among it."""
    parts = fake_plan.parts(presets=(fake_atlas.Diodes(dark=0.125),))
    measure(store, parts)
    row = store.query(condition="noisy", extractor="fake-currents")[0]
    assert (row["n_test"], row["n_observable"]) == (400, 350)
    assert (row["availability"], row["false_detection_rate"]) == (1.0, 1.0)
    test = fake_atlas.Diodes().generate("noisy", "test")
    error = np.rad2deg(np.arccos(np.sum(solved(test.observations) * test.sun, axis=1)))[50:]
    assert row["rms_deg"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-4)
    answers = solved(fake_atlas.Diodes().generate("noisy", "repeat").observations)
    held = repeatability_deg(answers.reshape(4, 20, 3)[:, 3:])
    assert row["repeatability_deg"] == pytest.approx(held, rel=1e-4)


def test_other_units_are_measured_by_their_own_light_and_the_standard_unit_s_bound(store, log):
    parts = fake_plan.parts()
    standard = plan.Cell("fake-diodes", "quiet", "fake-currents", "fake-least-squares")
    second = dataclasses.replace(standard, unit=2)
    runner.run([standard, second], store, parts=parts)
    rows = {row["unit"]: row for row in store.rows(unit=None)}
    test = fake_atlas.Diodes(unit=2).generate("quiet", "test")
    error = np.rad2deg(np.arccos(np.sum(solved(test.observations) * test.sun, axis=1)))
    assert rows[2]["rms_deg"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-4)
    assert rows[2]["rms_deg"] != rows[0]["rms_deg"]
    assert rows[2]["bound_deg"] is rows[2]["repeatability_deg"] is None
    assert rows[0]["bound_deg"] > 0
    assert [row["unit"] for row in store.rows()] == [0]
    assert {place[:2] for place in store.pins()} == {("fake-diodes", "quiet")}
    assert not any("repeat unit 2" in line for line in log())


@pytest.mark.parametrize("dark", [0.0, 0.125])
def test_another_unit_judges_what_is_observable_by_the_standard_one(store, log, dark):
    """Its bound is not computed a second time."""
    parts = fake_plan.parts(presets=(fake_atlas.Diodes(dark=dark),))
    standard = plan.Cell("fake-diodes", "quiet", "fake-currents", "fake-least-squares")
    runner.run([standard], store, parts=parts)
    runner.run([dataclasses.replace(standard, unit=1)], store, parts=parts)
    row = store.rows(unit=1)[0]
    assert row["availability"] == 1.0
    assert row["false_detection_rate"] == (1.0 if dark else None)
    assert log().count("bound fake-diodes quiet test") == 1


def test_a_second_run_renders_nothing_and_changes_no_byte(store, log):
    measure(store)
    before, done = contents(store), log()
    assert {str(path) for path in before} == {
        "scores/fake-diodes.csv", "pins.csv", "components.json", "checksums-sha256.txt",
    }  # fmt: skip
    summary = measure(store)
    assert (summary.computed, summary.already_stored) == (0, 4)
    assert log() == done
    assert contents(store) == before


def test_each_split_is_generated_and_extracted_from_once_for_all_models(store, log):
    class Second(fake_atlas.LeastSquares):
        about = dataclasses.replace(fake_atlas.LeastSquares.about, name="fake-second")

    parts = fake_plan.parts(fake_atlas.LeastSquares, Second)
    measure(store, parts)
    assert len(store.rows()) == 8
    generated = [line for line in log() if line.startswith("generate")]
    assert len(generated) == len(set(generated)) == 2 * 3
    extractions = [line for line in log() if line.startswith("extract fake-currents")]
    assert len(extractions) == 2 * 3, "each split once, for two conditions"


def test_an_extractor_or_dataset_that_fails_fails_its_cells_alone(store):
    class Wrong(fake_atlas.Currents):
        def extract(self, observations):
            return np.zeros((len(observations), 2))

    class Empty(fake_atlas.Diodes):
        def generate(self, condition, split, n=None):
            raise OSError("no data today")

    parts = fake_plan.parts(presets=(fake_atlas.Diodes(), Empty(name="fake-empty")))
    parts = dataclasses.replace(parts, extractors={**parts.extractors, "fake-currents": Wrong})
    measure(store, parts)
    reasons = {(r["dataset"], r["extractor"]): r["reason"] for r in store.rows()}
    assert "(400, 4); got float64 (400, 2)" in reasons["fake-diodes", "fake-currents"]
    assert reasons["fake-diodes", "fake-gaps"] == ""
    assert reasons["fake-empty", "fake-gaps"] == "generating data: OSError: no data today"


def test_ctrl_c_keeps_what_is_stored_and_says_so(store, log):
    def interrupt(done, *_):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(runner.RunInterruptedError, match=r"\b2\b.*\b4\b"):
        measure(store, progress=interrupt)
    assert contents(store) == {}, "an interrupted run does not touch the results"
    assert measure(store).already_stored == 2
    assert not Record(store).journal.exists()


def test_dask_without_its_package_is_a_clear_error(store, monkeypatch):
    monkeypatch.delitem(sys.modules, "benchmark.running.cluster", raising=False)
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ImportError, match="distributed"):
        measure(store, scheduler="tcp://127.0.0.1:1")


def test_a_refusal_is_a_result_that_is_kept(store, log):
    """UnusableDataError is the contract's word for data that a model cannot work on."""
    parts = fake_plan.parts(fake_atlas.LeastSquares, fake_atlas.Choosy)
    summary = measure(store, parts)
    assert summary.failed == ()
    refused = store.query(status="refused")
    assert {(row["model"], row["reason"]) for row in refused} == {
        ("fake-choosy", "UnusableDataError: needs other samples")
    }
    assert len(refused) == 4
    assert all(row["rms_deg"] is None for row in refused)
    attempts = log().count("fit fake-choosy")
    assert measure(store, parts).computed == 0
    assert log().count("fit fake-choosy") == attempts


@pytest.mark.parametrize("place", ["fit", "predict"])
def test_any_other_value_error_is_a_failure_and_tried_again(store, log, place):
    """NumPy's LinAlgError is a ValueError; so is what an extractor or `predict` raises."""

    class Sloppy(fake_atlas.Singular):
        def fit(self, features, sun, context=None):
            return super().fit(features, sun) if place == "fit" else self

        def predict(self, features, context=None):
            fake_atlas.log("predict fake-singular")
            raise fake_atlas.UnusableDataError("too late")

    parts = fake_plan.parts(Sloppy)
    said = {
        "fit": "LinAlgError: Singular matrix",
        "predict": "UnusableDataError: too late",
    }[place]
    for times in (1, 2):
        summary = measure(store, parts)
        assert {reason for _, reason in summary.failed} == {said}
        assert log().count(f"{place} fake-singular") == 4 * times
    assert {row["status"] for row in store.rows()} == {"failed"}


@pytest.mark.parametrize("name", ["dataset", "extractor", "model"])
def test_a_cell_of_what_is_not_installed_is_named_before_anything_is_done(name, store):
    known = plan.Cell("fake-diodes", "quiet", "fake-currents", "fake-least-squares")
    wrong = dataclasses.replace(known, **{name: "fake-nothing"})
    assert runner.stale([known], store, parts=fake_plan.parts()) == [known]
    for call in (runner.stale, runner.run):
        with pytest.raises(UnknownNameError, match=f"no {name} named 'fake-nothing'"):
            call([known, wrong], store, parts=fake_plan.parts())
    assert not store.directory.exists()


def test_the_greatest_unit_is_kept_and_one_more_is_refused_before_anything_is_done(store):
    """The column of units is a signed byte, which ends at 127."""
    parts = fake_plan.parts(presets=(fake_atlas.Diodes(conditions=(samples.CONDITION,)),))
    first = plan.Cell("fake-diodes", samples.CONDITION, "fake-currents", "fake-least-squares")
    for unit in (128, -1):
        wrong = dataclasses.replace(first, unit=unit)
        for call in (runner.stale, runner.run):
            with pytest.raises(ValueError, match=rf"unit {unit}: expected a unit from 0 to 127$"):
                call([first, wrong], store, parts=parts)
    assert not store.directory.exists()
    last = dataclasses.replace(first, unit=127)
    runner.run([last], store, parts=parts)
    kept = samples.read_samples("fake-diodes", store.directory)
    assert set(kept["unit"]) == {127}

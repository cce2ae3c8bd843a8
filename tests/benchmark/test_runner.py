"""Measuring: the right numbers, the same with any number of workers, never twice."""

import dataclasses
import sys

import fake_atlas
import fake_plan
import numpy as np
import pytest

from benchmark import plan, runner, runner_unit
from benchmark.runner_backend import DaskMissingError, bundles
from benchmark.runner_progress import silent, terminal_progress
from benchmark.store import Store
from benchmark.store_journal import Journal


@pytest.fixture(autouse=True)
def log(tmp_path, monkeypatch):
    """Lines of what implementations really did, whichever process did it."""
    path = tmp_path / "log.txt"
    monkeypatch.setenv("FAKE_ATLAS_LOG", str(path))
    runner_unit._kept.clear()
    return lambda: path.read_text().splitlines() if path.exists() else []


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "store")


def measure(store, parts=None, **options):
    parts = parts or fake_plan.parts()
    return runner.run(plan.cells(parts=parts), store, parts=parts, **options)


def test_scores_are_the_ones_the_pipeline_gives_and_the_bound_is_respected(store):
    summary = measure(store)
    assert (summary.planned, summary.computed, summary.failed, summary.warnings) == (4, 4, (), ())
    row = store.query(condition="noisy", extractor="fake-currents")[0]
    preset = fake_atlas.Diodes()
    test = preset.generate("noisy", "test")
    predicted = test.observations @ np.linalg.pinv(fake_atlas.NORMALS).T
    predicted /= np.linalg.norm(predicted, axis=1, keepdims=True)
    error = np.rad2deg(np.arccos(np.sum(predicted * test.sun, axis=1)))
    assert row["rms_deg"] == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-5)
    assert row["bound_deg"] == pytest.approx(
        np.sqrt(np.mean(preset.bound("noisy").angle_deg ** 2)), rel=1e-5
    )
    assert 1 - 4 * row["over_bound_se"] < row["over_bound"] < 1.2
    assert row["n_test"] == row["n_calibration"] == 400
    gaps = store.query(condition="noisy", extractor="fake-gaps")[0]
    assert gaps["found_fraction"] == 0.75


def test_one_and_two_workers_give_identical_bytes(store, tmp_path):
    measure(store)
    other = Store(tmp_path / "two")
    measure(other, workers=2)
    assert other.scores_path.read_bytes() == store.scores_path.read_bytes()
    assert other.data_path.read_bytes() == store.data_path.read_bytes()


def test_a_second_run_renders_nothing_and_changes_no_byte(store, log):
    measure(store)
    before = {path: path.read_bytes() for path in store.directory.glob("*.jsonl")}
    assert len(before) == 3
    done = log()
    summary = measure(store)
    assert (summary.computed, summary.already_stored) == (0, 4)
    assert log() == done
    assert {path: path.read_bytes() for path in store.directory.glob("*.jsonl")} == before


def test_each_split_is_generated_and_extracted_from_once_for_all_models(store, log):
    class Second(fake_atlas.LeastSquares):
        name = "fake-second"

    parts = fake_plan.parts(fake_atlas.LeastSquares, Second)
    measure(store, parts)
    assert len(store.rows()) == 8
    assert len([line for line in log() if line.startswith("generate")]) == 4
    extractions = [line for line in log() if line.startswith("extract fake-currents")]
    # calibration once, test up to three times for the best time, for two conditions
    assert len(extractions) <= 2 * (1 + 3)


def test_only_what_changed_is_measured_again(store, log):
    measure(store)
    newer = type("Newer", (fake_atlas.Gaps,), {"version": 2, "__module__": "fake_atlas"})
    parts = fake_plan.parts()
    parts = dataclasses.replace(parts, extractors={**parts.extractors, "fake-gaps": newer})
    assert [
        cell.extractor for cell in runner.stale(plan.cells(parts=parts), store, parts=parts)
    ] == [
        "fake-gaps",
        "fake-gaps",
    ]
    kept = {row["key"] for row in store.query(extractor="fake-currents")}
    summary = measure(store, parts)
    assert summary.computed == 2
    assert kept <= {row["key"] for row in store.rows()}
    assert len(store.rows()) == 4
    assert set(store.runs()) == {row["key"] for row in store.rows()}


def test_changed_data_are_pinned_anew(store):
    measure(store)
    pins = store.pins()
    parts = fake_plan.parts(presets=(dataclasses.replace(fake_atlas.Diodes(), seed=8),))
    assert measure(store, parts).computed == 4
    assert all(store.pins()[place].data_hash != pin.data_hash for place, pin in pins.items())
    hashes = {row["condition"]: row["data_hash"] for row in store.rows()}
    assert len(set(hashes.values())) == 2


def test_data_that_differ_from_their_pin_are_reported_and_recorded(store):
    """As on another processor: same code, other last bits."""
    measure(store)
    pins = [
        dataclasses.replace(pin, data_hash="0" * 32) if pin.split == "test" else pin
        for pin in store.pins().values()
    ]
    measured = {row["condition"]: row["data_hash"] for row in store.rows()}
    store.write([], [], pins)
    summary = measure(store)
    assert len(summary.warnings) == 2
    assert "pinned 00000000" in summary.warnings[0]
    assert {row["condition"]: row["data_hash"] for row in store.rows()} == measured
    assert measure(store).computed == 0, "the pin stays, so the results stay valid"


def test_a_failure_is_a_row_with_its_reason_and_is_tried_again(store, log, monkeypatch):
    parts = fake_plan.parts(fake_atlas.LeastSquares, fake_atlas.Broken, fake_atlas.Unbuildable)
    summary = measure(store, parts)
    reasons = {cell.model: reason for cell, reason in summary.failed}
    assert reasons == {
        "fake-broken": "RuntimeError: gives up always",
        "fake-unbuildable": "RuntimeError: no such sensor",
    }
    failed = store.query(status="failed")
    assert len(failed) == len(summary.failed) == 8
    assert all(row["rms_deg"] is None and row["over_bound"] is None for row in failed)
    assert len(store.query(status="ok")) == 4
    attempts = log().count("fit fake-broken")
    before = store.scores_path.read_bytes()
    assert measure(store, parts).computed == 8
    assert log().count("fit fake-broken") == 2 * attempts
    assert store.scores_path.read_bytes() == before
    monkeypatch.setenv("FAKE_ATLAS_MENDED", "1")
    assert {cell.model for cell, _ in measure(store, parts).failed} == {"fake-unbuildable"}


def test_an_extractor_or_dataset_that_fails_fails_its_cells_alone(store):
    class Wrong(fake_atlas.Currents):
        name = "fake-currents"

        def extract(self, observations):
            return np.zeros((len(observations), 2))

    class Empty(fake_atlas.Diodes):
        def generate(self, condition, split):
            raise OSError("no data today")

    parts = fake_plan.parts(presets=(fake_atlas.Diodes(), Empty(name="fake-empty")))
    parts = dataclasses.replace(parts, extractors={**parts.extractors, "fake-currents": Wrong})
    measure(store, parts)
    reasons = {(r["dataset"], r["extractor"]): r["reason"] for r in store.rows()}
    assert (
        "features of shape (400, 4); got float64 (400, 2)"
        in reasons["fake-diodes", "fake-currents"]
    )
    assert reasons["fake-diodes", "fake-gaps"] == ""
    assert reasons["fake-empty", "fake-gaps"] == "generating data: OSError: no data today"


def test_a_partial_run_keeps_other_results_and_a_full_one_drops_stale_ones(store):
    parts = fake_plan.parts()
    measure(store)
    cells = plan.cells(conditions="quiet", parts=parts)
    runner.run(cells, store, parts=parts)
    assert len(store.rows()) == 4
    runner.run(cells, store, only_these=True, parts=parts)
    assert {row["condition"] for row in store.rows()} == {"quiet"}
    assert {place[1] for place in store.pins()} == {"quiet", "noisy"}, "the data are still there"
    assert set(store.runs()) == {row["key"] for row in store.rows()}


def test_ctrl_c_keeps_what_is_stored_and_says_so(store, log):
    def interrupt(done, total, what):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(runner.RunInterruptedError, match="2 of 4 cells measured; they are kept"):
        measure(store, progress=interrupt)
    assert not store.scores_path.exists(), "an interrupted run does not touch the results"
    assert measure(store).already_stored == 2
    assert not Journal(store).path.exists()


def test_progress_counts_cells_to_the_end(store):
    seen = []
    measure(store, progress=lambda done, total, what: seen.append((done, total)))
    assert seen == [(0, 4), (1, 4), (2, 4), (3, 4), (4, 4)]


def test_the_bar_is_silent_where_standard_error_is_no_terminal(capsys):
    with terminal_progress() as report:
        assert report is silent
        report(1, 2, "x")
    assert capsys.readouterr().err == ""


def test_the_bar_shows_cells_on_a_terminal(monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with terminal_progress() as report:
        report(1, 2, "some dataset")
    assert "1/2" in capsys.readouterr().err


def test_a_run_records_times_place_and_versions_outside_the_key(store):
    measure(store)
    for run in store.runs().values():
        assert run["extract_s"] > 0
        assert run["time_ratio"] > 0
        assert run["latency_us"] == pytest.approx(
            1e6 * (run["extract_s"] + run["predict_s"]) / 400, rel=1e-4
        )
        assert set(run["environment"]["libraries"]) >= {"numpy", "scipy", "joblib"}


def test_units_that_share_samples_go_to_one_worker_four_at_most():
    def unit(name, condition, number):
        return runner_unit.Unit(fake_atlas.Diodes(name=name), condition, number, ())

    units = [unit("a", "x", i) for i in range(6)] + [unit("a", "y", 6), unit("b", "y", 7)]
    grouped = bundles(units)
    assert [[u.extractor for u in bundle] for bundle in grouped] == [[0, 1, 2, 3], [4, 5], [6], [7]]


def test_with_many_datasets_each_is_done_by_one_worker():
    units = [
        runner_unit.Unit(fake_atlas.Diodes(name=name), condition, number, ())
        for name in "abcdefgh"
        for condition in "xy"
        for number in range(6)
    ]
    assert [len(bundle) for bundle in bundles(units, workers=2)] == [12] * 8
    assert max(len(bundle) for bundle in bundles(units, workers=3)) == 4


def test_a_worker_lets_go_of_large_data_before_it_generates_more(monkeypatch):
    preset = fake_atlas.Diodes()
    held = []
    generate = fake_atlas.Diodes.generate

    def watched(self, condition, split):
        held.append(len(runner_unit._kept))
        return generate(self, condition, split)

    monkeypatch.setattr(fake_atlas.Diodes, "generate", watched)
    for limit, expected in ((2**30, [0, 0, 1, 1]), (1000, [0, 0, 0, 0])):
        monkeypatch.setattr(runner_unit, "_KEPT_BYTES", limit)
        runner_unit._kept.clear()
        held.clear()
        for condition in preset.conditions:
            runner_unit.generated_pins(preset, condition)
        assert held == expected


def test_dask_without_its_package_is_a_clear_error(store):
    with pytest.raises(DaskMissingError, match="pip install distributed"):
        measure(store, scheduler="tcp://127.0.0.1:1")


def test_measuring_uses_one_thread_and_restores_the_number_after(store):
    import cv2

    from benchmark.runner_timing import _bundled_blas, one_thread

    before = [library.get() for library in _bundled_blas()]
    with one_thread():
        assert cv2.getNumThreads() == 1
        assert all(library.get() == 1 for library in _bundled_blas())
    assert [library.get() for library in _bundled_blas()] == before


def test_no_workers_is_refused(store):
    with pytest.raises(ValueError, match="at least 1; got 0"):
        measure(store, workers=0)
    assert not store.scores_path.exists()


def test_a_refusal_is_a_result_that_is_kept(store, log):
    """ValueError from `fit` is the contract's word for data a model cannot work on."""
    parts = fake_plan.parts(fake_atlas.LeastSquares, fake_atlas.Choosy)
    summary = measure(store, parts)
    assert summary.failed == ()
    refused = store.query(status="refused")
    assert {(row["model"], row["reason"]) for row in refused} == {
        ("fake-choosy", "ValueError: needs other samples")
    }
    assert len(refused) == 4
    assert all(row["rms_deg"] is None for row in refused)
    attempts = log().count("fit fake-choosy")
    assert measure(store, parts).computed == 0
    assert log().count("fit fake-choosy") == attempts

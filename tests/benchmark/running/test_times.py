"""Times of this machine: of what runs, kept while the code stays, never made up."""

from __future__ import annotations

import csv
import dataclasses

import fake_atlas
import fake_plan
import numpy as np
import pytest

from benchmark.plan.combinations import cells
from benchmark.progress import silent
from benchmark.results.csv_tables import StoreError
from benchmark.running import times

pytestmark = pytest.mark.usefixtures("log")


def parts(*more):
    return fake_plan.parts(fake_atlas.LeastSquares, *more)


def pipelines(known):
    return {(c.dataset, c.extractor, c.model) for c in cells(parts=known)}


def test_every_pipeline_that_runs_is_timed_once(tmp_path, log):
    known = parts()
    count = times.update(tmp_path, silent, parts=known)
    kept = times.times_of_code(tmp_path, known)
    assert set(kept) == pipelines(known)
    assert count == len(kept)
    for time in kept.values():
        assert time.latency_us > 0
        assert time.time_ratio >= time.extract_ratio > 0
    before = log()
    for left in (".times.csv.lock", ".times.csv.999999-0123abcd.sunatlas"):
        (tmp_path / left).touch()  # of a killed process: they go, though nothing is written
    assert times.update(tmp_path, silent, parts=known) == 0
    assert log() == before
    assert {path.name for path in tmp_path.iterdir()} <= {times.TIMES, "log.txt"}
    assert times.times_of_code(tmp_path, known) == kept


def test_what_does_not_run_has_no_time(tmp_path):
    known = parts(fake_atlas.Broken, fake_atlas.Singular)
    times.update(tmp_path, silent, parts=known)
    kept = times.times_of_code(tmp_path, known)
    assert set(kept) == pipelines(known)
    timed = {model for (_, _, model), time in kept.items() if time.latency_us is not None}
    assert timed == {"fake-least-squares"}
    broken = [time for (_, _, model), time in kept.items() if model not in timed]
    assert all(t.latency_us is t.time_ratio is t.extract_ratio is None for t in broken)


def test_only_what_changed_is_timed_again(tmp_path):
    class Newer(fake_atlas.LeastSquares):
        about = dataclasses.replace(fake_atlas.LeastSquares.about, version=2)

    times.update(tmp_path, silent, parts=parts(fake_atlas.Broken))
    newer = fake_plan.parts(Newer, fake_atlas.Broken)
    outdated = {p for p in pipelines(newer) if p[2] == Newer.about.name}
    assert set(times.times_of_code(tmp_path, newer)) == pipelines(newer) - outdated
    assert times.update(tmp_path, silent, parts=newer) == len(outdated) > 0
    assert set(times.times_of_code(tmp_path, newer)) == pipelines(newer)


def test_without_a_file_nothing_is_known_and_a_broken_one_is_named(tmp_path):
    assert times.times_of_code(tmp_path, parts()) == {}
    (tmp_path / times.TIMES).write_text("dataset,extractor\na,b\n")
    with pytest.raises(StoreError, match=r"times\.csv, line 1: expected the columns"):
        times.read_times(tmp_path)


def test_the_file_is_a_plain_table(tmp_path):
    known = parts()
    times.update(tmp_path, silent, parts=known)
    with (tmp_path / times.TIMES).open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {(r["dataset"], r["extractor"], r["model"]) for r in rows} == pipelines(known)


def test_the_reference_sums_every_value_of_an_observation_once():
    frames = np.arange(24, dtype=np.uint16).reshape(2, 3, 4)
    weights = np.linspace(0.0, 1.0, 12)
    np.testing.assert_allclose(
        np.concatenate(times.reference(frames)), frames.reshape(2, 12) @ weights
    )
    events = np.zeros((3, 5), dtype=[("x", np.int16), ("t", np.int64)])
    assert np.concatenate(times.reference(events)).shape == (3,)

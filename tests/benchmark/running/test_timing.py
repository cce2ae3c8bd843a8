"""Times by a clock that tests turn: the best of a few runs, the reference between them."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import fake_atlas
import fake_plan
import numpy as np
import pytest

from benchmark.contract import Cell
from benchmark.progress import silent
from benchmark.results.components import current
from benchmark.running import times, timing


class Clock:
    """A clock that stands still but where it is turned on."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 100.0
        monkeypatch.setattr(timing.time, "perf_counter", lambda: self.now)

    def runs(self, *seconds: float) -> Any:
        """A call that takes so long, and gives which time it is that it was called."""
        left, calls = list(seconds), []

        def call() -> int:
            self.now += left.pop(0)
            calls.append(None)
            return len(calls)

        return call


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    return Clock(monkeypatch)


@pytest.mark.parametrize(
    ("seconds", "reference", "best", "runs"),
    [
        ([0.004, 0.002, 0.003], [0.001, 0.002, 0.0005], (0.002, 0.0005), 3),
        ([0.02, 0.001, 0.001], [0.005, 0.006, 0.001], (0.001, 0.005), 2),  # 0.032 are spent
        ([0.031, 0.001], [0.0, 0.001], (0.031, 0.0), 1),
        ([0.0, 0.001], [0.031, 0.001], (0.0, 0.031), 1),  # the reference's time counts too
        ([0.029, 0.001, 0.1], [0.0, 0.001, 0.1], (0.001, 0.0), 2),
    ],
)
def test_the_best_of_three_runs_counts_or_of_as_many_as_take_little_time(
    clock: Clock, seconds: list[float], reference: list[float], best: Any, runs: int
) -> None:
    result, found = timing.best_of(clock.runs(*seconds), clock.runs(*reference))
    assert result == runs
    assert (found.seconds, found.reference_s) == pytest.approx(best)


def test_a_time_alone_is_the_best_of_three_too(clock: Clock) -> None:
    assert timing.best_time(clock.runs(0.004, 0.002, 0.003)) == (3, pytest.approx(0.002))


def test_ratios_are_of_extraction_and_of_the_whole_to_the_reference(
    clock: Clock, monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    """Extraction 6 ms, prediction 2 ms, the reference 4 ms, for 400 samples."""
    monkeypatch.setattr(times, "reference", lambda observations: clock.runs(0.004)())
    both = fake_plan.parts()
    parts = replace(both, extractors={"fake-currents": both.extractors["fake-currents"]})
    extract, predict = fake_atlas.Currents.extract, fake_atlas.LeastSquares.predict

    def extracted(self: Any, observations: Any) -> Any:
        clock.now += 0.006
        return extract(self, observations)

    def predicted(self: Any, features: Any, context: Any = None) -> Any:
        clock.now += 0.002
        return predict(self, features)

    monkeypatch.setattr(fake_atlas.Currents, "extract", extracted)
    monkeypatch.setattr(fake_atlas.LeastSquares, "predict", predicted)
    times.update(tmp_path, silent, parts=parts)
    time = times.read_times(tmp_path)["fake-diodes", "fake-currents", "fake-least-squares"]
    assert (time.latency_us, time.time_ratio, time.extract_ratio) == (20.0, 2.0, 1.5)
    whole = current(parts).cell_key(Cell(time.dataset, "", time.extractor, time.model))
    assert time.digest == hashlib.sha256(whole.encode()).hexdigest()[:8]


@pytest.mark.parametrize(("value", "kept"), [(0.0012349, 0.00123), (98765.4, 98800.0), (1.0, 1.0)])
def test_times_are_kept_to_three_digits(value: float, kept: float) -> None:
    assert times._round_to(value) == kept


@pytest.mark.parametrize(
    ("values", "batch"),
    [(1, 2**20), (2**17, 8), (2**17 + 1, 8), (2**16, 16), (2**21, 8)],
)
def test_as_many_samples_are_timed_together_as_fill_eight_megabytes(
    values: int, batch: int
) -> None:
    one = SimpleNamespace(observations=np.zeros((1, values), dtype=np.float64))
    asked = []

    def generate(condition: str, split: str, n: int) -> Any:
        asked.append((condition, split, n))
        return one

    assert times._batch(SimpleNamespace(generate=generate), "quiet") == batch  # type: ignore[arg-type]
    assert asked == [("quiet", "test", 1)]


@pytest.mark.parametrize("limit", [1, 12, 13, 25, 10**6])
def test_the_reference_reads_a_part_at_a_time_and_every_sample_once(
    limit: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(times, "_REFERENCE_VALUES", limit)
    frames = np.random.default_rng(1).integers(0, 9, (7, 3, 4)).astype(np.uint16)
    parts: Any = times.reference(frames)
    rows = max(limit // 12, 1)
    assert [len(part) for part in parts] == [min(rows, 7 - k) for k in range(0, 7, rows)]
    weights = np.linspace(0.0, 1.0, 12)
    np.testing.assert_allclose(np.concatenate(parts), frames.reshape(7, 12) @ weights)


def test_a_time_of_other_code_or_of_what_is_gone_is_none_of_this(tmp_path: Any) -> None:
    both = fake_plan.parts(presets=(fake_atlas.Diodes(), fake_atlas.Diodes(name="fake-second")))
    assert times.update(tmp_path, silent, parts=both) == 4
    assert {p[0] for p in times.times_of_code(tmp_path, both)} == {"fake-diodes", "fake-second"}
    one = fake_plan.parts()
    assert {p[0] for p in times.times_of_code(tmp_path, one)} == {"fake-diodes"}
    newer = fake_plan.parts(presets=(fake_atlas.Diodes(seed=8),))
    assert times.times_of_code(tmp_path, newer) == {}
    seen: list[tuple[int, int, str]] = []
    assert times.update(tmp_path, lambda *said: seen.append(said), parts=newer) == 2
    assert seen == [(0, 2, ""), (2, 2, "fake-diodes")]

"""Running times, by a clock that tests turn where a time matters."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import fake_atlas
import fake_plan
import pytest

from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts
from benchmark.progress import silent
from benchmark.results.times import MACHINE, TIMES, read_times
from benchmark.running import times


class Clock:
    """A clock that stands still but where it is turned on."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 100.0
        monkeypatch.setattr(times.time, "process_time", lambda: self.now)

    def runs(self, *seconds: float) -> Any:
        """A call that takes so long, the last of them from then on; gives how often it ran."""
        left, calls = list(seconds), []

        def call() -> int:
            self.now += left.pop(0) if len(left) > 1 else left[0]
            calls.append(None)
            return len(calls)

        return call


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    return Clock(monkeypatch)


def two_sets() -> Parts:
    return fake_plan.parts(presets=(fake_atlas.Diodes(), fake_atlas.Diodes(name="fake-second")))


def pipelines(known: Parts) -> set[tuple[str, str, str]]:
    return {(cell.dataset, cell.extractor, cell.model) for cell in cells(parts=known)}


@pytest.mark.parametrize(
    ("seconds", "best", "runs"),
    [
        ((0.004, 0.002, 0.003), 0.002, 20),
        ((0.04, 0.05), 0.04, 5),  # never fewer
        ((0.01,), 0.01, 10),
        ((5.0,), 5.0, 5),
    ],
)
def test_the_best_run_counts_and_so_does_that_of_the_reference(
    clock: Clock, seconds: tuple[float, ...], best: float, runs: int
) -> None:
    result, found = times.best_of(clock.runs(*seconds), clock.runs(0.002, 0.001, 0.003))
    assert abs(result - runs) <= 1  # sums of floats
    assert found == pytest.approx([best, 0.001])


def test_a_time_is_that_of_a_sample_over_that_of_the_loop(
    clock: Clock, monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    """Extraction 6 ms, prediction 2 ms, loop 0.5 ms, weighted sums 4 ms, for 400 samples."""
    monkeypatch.setattr(times, "weighted_sums", lambda observations: clock.runs(0.004)())
    monkeypatch.setattr(times, "reference_loop", clock.runs(0.0005))
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
    found = read_times(tmp_path)
    place = ("fake-diodes", "fake-currents", "fake-least-squares")
    time = found.rows[place]
    assert (time.ratio, time.extract_ratio) == (8.0 / 0.5 / 400, 1.5)
    assert found.machine is not None
    assert found.machine.loop_us == 500.0
    assert found.latency_us[place] == 20.0


@pytest.mark.usefixtures("log")
def test_what_does_not_run_has_a_row_without_a_time(tmp_path: Any) -> None:
    known = fake_plan.parts(fake_atlas.LeastSquares, fake_atlas.Broken, fake_atlas.Singular)
    assert times.update(tmp_path, silent, parts=known) == len(pipelines(known))
    found = read_times(tmp_path).rows
    assert set(found) == pipelines(known)
    timed = {model for (_, _, model), time in found.items() if time.ratio is not None}
    assert timed == {"fake-least-squares"}
    assert all(time.ratio is None or time.ratio > 0 for time in found.values())
    assert all((t.ratio is None) == (t.extract_ratio is None) for t in found.values())


def test_an_interrupted_call_leaves_whole_data_sets_and_the_next_goes_on(tmp_path: Any) -> None:
    def interrupt(done: int, _total: int, _what: str, _share: float | None = None) -> None:
        if done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        times.update(tmp_path, interrupt, parts=two_sets())
    before = read_times(tmp_path).rows
    assert {place[0] for place in before} == {"fake-diodes"}
    assert times.update(tmp_path, silent, parts=two_sets()) == 2
    after = read_times(tmp_path).rows
    assert set(after) == pipelines(two_sets())
    assert {place: after[place] for place in before} == before
    assert {path.name for path in tmp_path.iterdir()} == {TIMES, MACHINE}


def test_a_time_stays_until_all_are_measured_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    monkeypatch.setattr(times, "_processor", lambda: "first")
    times.update(tmp_path, silent, parts=two_sets())
    newer = fake_plan.parts(presets=(fake_atlas.Diodes(seed=8), fake_atlas.Diodes(name="third")))
    monkeypatch.setattr(times, "_processor", lambda: "second")
    assert times.update(tmp_path, silent, parts=newer) == 2
    found = read_times(tmp_path)
    assert set(found.rows) == pipelines(newer)  # those of what is gone are dropped
    assert found.machine is not None
    assert (found.machine.processor, found.machine.also_on) == ("first", ("second",))
    assert times.update(tmp_path, silent, parts=newer) == 0
    assert times.update(tmp_path, silent, parts=newer, again=True) == 4
    machine = read_times(tmp_path).machine
    assert machine is not None
    assert (machine.processor, machine.also_on) == ("second", ())


def test_the_reference_loop_gives_the_same_number_each_time() -> None:
    assert times.reference_loop() == times.reference_loop() == pytest.approx(2.0)

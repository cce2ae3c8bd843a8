"""Running times, by a clock that tests turn where a time matters."""

from __future__ import annotations

from typing import Any

import fake_atlas
import fake_plan
import pytest

from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts
from benchmark.progress import silent
from benchmark.results.times import read_times
from benchmark.running import times


def pipelines(known: Parts) -> set[tuple[str, str, str]]:
    return {(cell.dataset, cell.extractor, cell.model) for cell in cells(parts=known)}


def test_a_time_is_that_of_a_sample_over_that_of_the_loop(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any
) -> None:
    """Extraction 6 ms, prediction 2 ms, loop 0.5 ms, weighted sums 4 ms, for 400 samples."""
    now = [100.0]

    def takes(seconds: float, call: Any = lambda *_: None) -> Any:
        def taking(*given: Any, **named: Any) -> Any:
            now[0] += seconds
            return call(*given, **named)

        return taking

    monkeypatch.setattr(times, "process_time", lambda: now[0])
    monkeypatch.setattr(times, "weighted_sums", takes(0.004))
    monkeypatch.setattr(times, "reference_loop", takes(0.0005))
    slow = takes(0.006, fake_atlas.Currents.extract)
    monkeypatch.setattr(fake_atlas.Currents, "extract", slow)
    slow = takes(0.002, fake_atlas.LeastSquares.predict)
    monkeypatch.setattr(fake_atlas.LeastSquares, "predict", slow)
    times.update(tmp_path, silent, parts=fake_plan.parts())
    found = read_times(tmp_path)
    place = ("fake-diodes", "fake-currents", "fake-least-squares")
    assert (found.rows[place].ratio, found.rows[place].extract_ratio) == (8.0 / 0.5 / 400, 1.5)
    assert (found.machine and found.machine.loop_us, found.latency_us[place]) == (500.0, 20.0)


@pytest.mark.usefixtures("log")
def test_what_does_not_run_has_a_row_without_a_time(tmp_path: Any) -> None:
    known = fake_plan.parts(fake_atlas.LeastSquares, fake_atlas.Broken, fake_atlas.Singular)
    assert times.update(tmp_path, silent, parts=known) == len(pipelines(known))
    found = read_times(tmp_path).rows
    assert set(found) == pipelines(known)
    assert {place[2] for place, one in found.items() if one.ratio} == {"fake-least-squares"}

"""The published running times: their form, and that they are of every pipeline with a score."""

from __future__ import annotations

import pytest

from benchmark import datasets
from benchmark.results.store import PUBLISHED, Store
from benchmark.results.times import Times, read_times


@pytest.fixture(scope="module")
def published() -> Times:
    return read_times(PUBLISHED)


def test_every_pipeline_with_a_published_score_has_a_time(published: Times) -> None:
    first = {name: datasets.get(name).conditions[0] for name in datasets.names()}
    scored = {
        (row["dataset"], row["extractor"], row["model"])
        for row in Store(PUBLISHED).rows()
        if row["condition"] == first[row["dataset"]] and row["status"] == "ok"
    }
    lacking = [place for place in sorted(scored) if published.latency_us.get(place) is None]
    assert not lacking, f"not timed: {lacking}; `sunatlas leaderboard times`"


def test_times_are_multiples_of_the_loop_of_a_named_machine(published: Times) -> None:
    machine = published.machine
    assert machine is not None
    assert machine.processor
    assert machine.cores == 1
    assert machine.loop_us > 0
    for place, time in published.rows.items():
        if time.ratio is None:
            assert published.latency_us[place] is None
        else:
            assert published.latency_us[place] == pytest.approx(time.ratio * machine.loop_us, 0.006)

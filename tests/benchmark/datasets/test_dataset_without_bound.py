"""A dataset whose bound is not defined is measured like any other; only the bound is missing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fake_atlas import Currents, Diodes, FakeBound, LeastSquares

from benchmark.leaderboard.board import board_of
from benchmark.leaderboard.pages import page
from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts
from benchmark.results.store import Store
from benchmark.running import runner


@dataclass(frozen=True)
class Unbounded(Diodes):
    name: str = "fake-unbounded"
    undefined: float = np.inf
    seen: bool = True
    n: int = 60

    def parameters(self, condition: str) -> dict[str, Any]:
        return {
            **super().parameters(condition), "undefined": repr(self.undefined), "seen": self.seen
        }  # fmt: skip

    def bound(self, condition: str, split: str = "test", n: int | None = None) -> FakeBound:
        count = len(self.truth(condition, split)[:n])
        none = np.full(count, self.undefined)
        return FakeBound(none, np.full(count, self.seen), none)


def measured(directory: Path, preset: Unbounded) -> Store:
    parts = Parts(
        {"fake-unbounded": preset},
        {Currents.about.name: Currents},
        {LeastSquares.about.name: LeastSquares},
    )
    store = Store(directory)
    summary = runner.run(cells(parts=parts), store, parts=parts)
    assert not summary.failed
    assert [row["status"] for row in store.rows()] == ["ok", "ok"]
    return store


@pytest.mark.slow
@pytest.mark.parametrize("undefined", [np.inf, np.nan])
def test_errors_are_scored_and_ranked_and_everything_named_bound_is_null(
    undefined: float, tmp_path: Path
) -> None:
    store = measured(tmp_path, Unbounded(undefined=undefined))
    for row in store.rows():
        assert 0 < row["rms_deg"] < 5
        assert 0 < row["repeatability_deg"] < 5
        names = ("bound_deg", "over_bound", "over_bound_se")
        names += ("bound_unit_deg", "over_bound_unit")
        assert [row[name] for name in names] == [None] * 5
        assert row["availability"] == 1
    assert {pin.bound_deg for pin in store.pins().values()} == {None}
    board = board_of(store)
    assert [row["rank"] for row in board["datasets"][0]["rows"]] == [1, 1]
    assert "| - |" in page(board)


def test_where_nothing_is_observable_there_is_no_error_and_no_rank(tmp_path: Path) -> None:
    """Every answer is a false Sun, and the row says no more."""
    store = measured(tmp_path, Unbounded(seen=False))
    for row in store.rows():
        assert (row["n_observable"], row["false_detection_rate"]) == (0, 1)
        assert [row[f] for f in ("availability", "rms_deg", "repeatability_deg")] == [None] * 3
    board = board_of(store)
    assert [row["rank"] for row in board["datasets"][0]["rows"]] == [None, None]

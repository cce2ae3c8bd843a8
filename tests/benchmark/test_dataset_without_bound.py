"""A dataset whose bound is not defined is measured like any other; only the bound is missing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from fake_atlas import Currents, Diodes, FakeBound, LeastSquares

from benchmark import leaderboard, runner
from benchmark.plan import cells
from benchmark.plan_parts import Parts
from benchmark.store import Store


@dataclass(frozen=True)
class Unbounded(Diodes):
    name: str = "fake-unbounded"
    undefined: float = np.inf
    n: int = 60

    def bound(self, condition: str, split: str = "test") -> FakeBound:
        return FakeBound(np.full(self.n, self.undefined), np.zeros(self.n, dtype=bool))


@pytest.mark.parametrize("undefined", [np.inf, np.nan])
def test_errors_are_scored_and_ranked_and_everything_named_bound_is_null(
    undefined: float, tmp_path: Path
) -> None:
    parts = Parts(
        {"fake-unbounded": Unbounded(undefined=undefined)},
        {Currents.name: Currents},
        {LeastSquares.name: LeastSquares},
    )
    store = Store(tmp_path)
    summary = runner.run(cells(parts=parts), store, parts=parts)
    assert not summary.failed
    rows = store.rows()
    assert [row["status"] for row in rows] == ["ok", "ok"]
    for row in rows:
        assert 0 < row["rms_deg"] < 5
        assert [row[f] for f in ("bound_deg", "over_bound", "over_bound_se")] == [None] * 3
        assert row["observable_fraction"] == 0
    (board,) = leaderboard.build(rows, {})["datasets"]
    assert [row["rank"] for row in board["rows"]] == [1, 1]
    assert leaderboard.write(tmp_path)

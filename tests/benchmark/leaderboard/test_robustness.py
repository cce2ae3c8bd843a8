"""Multiples of the bound pooled over data sets, on boards small enough to pool by hand."""

from __future__ import annotations

import math
from typing import Any

import pytest
from scipy.stats import binomtest

from benchmark.leaderboard.robustness import Duel, Robustness, pairwise


def row(condition: str, extractor: str, model: str, over: float | None, **more: Any) -> Any:
    answered = over is not None
    return {
        "condition": condition,
        "extractor": extractor,
        "model": model,
        "over_bound": over,
        "own_error_deg": over,
        "rms_deg": over,
        "availability": 1.0 if answered else 0.0,
        **more,
    }


def dataset(name: str, *rows: Any) -> dict[str, Any]:
    conditions = list(dict.fromkeys(one["condition"] for one in rows))
    return {"name": name, "conditions": conditions, "rows": list(rows)}


BOARDS = [
    dataset(
        "one",
        row("nominal", "a", "m", 2.0),
        row("nominal", "a", "n", 1.0),
        row("nominal", "b", "m", 4.0),
        row("hot", "a", "m", 3.0),
        row("hot", "a", "n", 9.0),
        row("hot", "b", "m", 6.0),
        row("glare", "a", "m", 5.0),
        row("glare", "b", "m", None),
    ),
    dataset(
        "two",
        row("nominal", "a", "m", 3.0),
        row("nominal", "b", "m", 2.0),
        row("hot", "a", "m", 5.0),
        row("hot", "b", "m", 50.0, availability=0.9),
    ),
    dataset("three", row("nominal", "a", "m", 8.0), row("nominal", "b", "m", 8.1)),
]
FOUND = Robustness(BOARDS, "extractor")


def under(*names: str) -> Any:
    return lambda there: names if set(names) <= set(there) else ()


def test_the_pipeline_is_chosen_under_the_first_condition() -> None:
    assert FOUND.worst("one", "a", ("hot",)) == 9.0  # of n, whose nominal error is the smallest
    assert FOUND.worst("one", "a", ("glare",)) == 5.0  # of m: n was not tested
    assert FOUND.worst("one", "a", ("hot", "glare")) == 5.0
    assert FOUND.worst("two", "a", ("glare",)) is None


def test_cells_are_medians_over_data_sets_that_have_the_condition() -> None:
    nominal = FOUND.pooled(under("nominal"))
    assert (nominal["a"].over_bound, nominal["b"].over_bound) == (3.0, 4.0)
    assert nominal["a"].over_best == 1.0  # 1, 1.5 and 1 times the best
    assert nominal["b"].over_best == pytest.approx(8.1 / 8.0)
    hot = FOUND.pooled(under("hot"))
    assert (hot["a"].datasets, hot["a"].over_bound) == (("one", "two"), 7.0)
    assert (hot["b"].over_bound, hot["b"].answered) == (math.inf, 1)  # 90 % availability on two
    both = FOUND.pooled(under("hot", "glare"))
    assert both["a"].datasets == ("one",)
    assert both["b"].over_bound == math.inf


def test_duels_are_on_boards_that_have_both() -> None:
    duels = FOUND.duels("a", "b")
    assert {(d.dataset, d.condition): d.outcome for d in duels} == {
        ("one", "nominal"): "win",
        ("one", "hot"): "loss",
        ("one", "glare"): "win",
        ("two", "nominal"): "loss",
        ("two", "hot"): "win",
        ("three", "nominal"): "tie",
    }
    assert [d.condition for d in FOUND.duels("a", "b", ["glare"])] == ["glare"]


def test_the_share_of_wins_has_the_interval_of_clopper_and_pearson() -> None:
    duels = [Duel(f"d{n}", "nominal", 1.0, 2.0 if n < 9 else 0.5) for n in range(12)]
    found = pairwise([*duels, Duel("x", "hot", math.inf, math.inf)], "a", "b")
    exact = binomtest(9, 12).proportion_ci(0.95, method="exact")
    assert (found["wins"], found["losses"], found["ties"], found["neither"]) == (9, 3, 0, 1)
    assert (found["share_low"], found["share_high"]) == pytest.approx((exact.low, exact.high))
    assert found["ratio"] == 0.5
    assert found["ratio_low"] == 0.5


def test_the_bootstrap_draws_whole_data_sets() -> None:
    one = [Duel("same", f"c{n}", 1.0 + n, 3.0) for n in range(4)]
    found = pairwise(one, "a")
    assert found["ratio"] == found["ratio_low"] == found["ratio_high"] == pytest.approx(2.5 / 3)
    # of two data sets a draw has one of them alone in half of the cases
    two = pairwise([*one, *(Duel("other", f"c{n}", 9.0, 1.0) for n in range(4))], "a")
    assert (two["ratio_low"], two["ratio_high"]) == (pytest.approx(2.5 / 3), 9.0)


def test_pairs_the_other_way_round_say_the_inverse() -> None:
    duels = [Duel(f"d{n}", "nominal", 1.0 + n, 3.0) for n in range(7)]
    swapped = [Duel(d.dataset, d.condition, 3.0, d.first_over_bound) for d in duels]
    one, other = pairwise(duels, "a"), pairwise(swapped, "a")
    assert (one["wins"], one["ties"], one["losses"]) == (
        other["losses"],
        other["ties"],
        other["wins"],
    )
    assert one["ratio"] is not None
    assert other["ratio"] == pytest.approx(1 / one["ratio"])
    assert one == pairwise(duels, "a")  # the bootstrap is drawn from a named stream
    assert pairwise([], "a")["ratio"] is None

"""Families of methods against each other, on rows that were made up to be told apart or not."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from benchmark import datasets
from benchmark.directions.duels import Duel, duels, verdict
from benchmark.directions.rules import Rule, is_of, rules
from survey_data import load

RULE = Rule("D", "Any", "duel", "?", "model=ann|dnn", "model=!ann|dnn", "mask=Slit", "duel")


def row(dataset: str, model: str, unit: int, error: float, availability: float = 1.0) -> Any:
    return {
        "dataset": dataset,
        "condition": "nominal",
        "extractor": "any",
        "model": model,
        "unit": unit,
        "rms_all_answers_deg": error,
        "availability": availability,
    }


def rows(dataset: str, ratio: float, scatter: float = 0.02, **more: Any) -> list[Any]:
    """Ten units of a network that errs `ratio` times as much as a table, and of a worse table."""
    rng = np.random.default_rng(4)
    found = []
    for unit in range(10):
        error = 0.01 * math.exp(rng.normal(0.0, 0.3))
        found += [
            row(dataset, "lut", unit, error),
            row(dataset, "spm", unit, 2.0 * error),
            row(dataset, "ann", unit, ratio * error * math.exp(rng.normal(0.0, scatter)), **more),
        ]
    return found


@pytest.mark.parametrize(
    ("ratio", "scatter", "outcome"),
    [(0.8, 0.02, "win"), (1.3, 0.02, "loss"), (1.02, 0.001, "tie"), (1.3, 1.0, "tie")],
)
def test_a_family_wins_where_it_errs_less_beyond_the_scatter(ratio, scatter, outcome) -> None:
    (found,) = duels(RULE, rows("pda-slit", ratio, scatter))
    assert (found.first, found.second) == (("any", "ann"), ("any", "lut"))
    assert found.outcome == outcome
    if scatter < 0.1:
        assert found.ratio == pytest.approx(ratio, rel=0.03)


def test_the_best_is_chosen_on_even_units_and_quoted_on_odd_ones() -> None:
    made = [row("pda-slit", "lut", unit, 1.0) for unit in range(10)]
    made += [row("pda-slit", "ann", unit, 1.0 if unit % 2 else 0.1) for unit in range(10)]
    made += [row("pda-slit", "dnn", unit, 0.2 if unit % 2 else 0.5) for unit in range(10)]
    (found,) = duels(RULE, made)
    assert found.first == ("any", "ann")
    assert found.ratio == pytest.approx(1.0)


def test_without_enough_units_or_answers_nobody_meets() -> None:
    assert duels(RULE, [one for one in rows("pda-slit", 0.5) if one["unit"] < 5]) == []
    assert duels(RULE, rows("pda-slit", 0.5, availability=0.9)) == []
    assert duels(RULE, rows("ccd-single-aperture", 0.5)) == [], "no slit"


def test_the_verdict_needs_three_quarters_of_two_data_sets() -> None:
    def some(wins: int, losses: int, ties: int = 0) -> list[Duel]:
        outcomes: Any = ["win"] * wins + ["loss"] * losses + ["tie"] * ties
        return [Duel("a", ("b", "c"), ("d", "e"), 1.0, one) for one in outcomes]

    assert verdict(some(1, 0, 9)) == "open"
    assert verdict(some(2, 0)) == verdict(some(3, 1)) == "pays"
    assert verdict(some(0, 2)) == verdict(some(2, 7)) == "does not pay"
    assert verdict(some(2, 1)) == verdict(some(1, 2)) == "depends on the data set"


def test_the_rules_are_those_of_the_surveys_table_and_name_what_exists() -> None:
    table = load().approaches
    assert [rule.specific for rule in rules().values()] == table["specific"].tolist()
    assert is_of("model=!ann", "any", "optical + lut")
    assert not is_of("model=lut", "any", "optical + lut")
    assert not is_of("model=!lut", "any", "optical + lut")
    for rule in rules().values():
        if rule.kind == "duel":
            assert any(rule.is_on(datasets.get(name)) for name in datasets.names()), rule.id

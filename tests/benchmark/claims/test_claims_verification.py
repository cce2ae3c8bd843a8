"""Outcomes that cannot be of their plan, and forged ones that can, are reported."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from benchmark.claims.experiment import find_experiments
from benchmark.claims.outcomes import RECORD, read_outcomes
from benchmark.claims.rules import claims
from benchmark.experiments import claims as experiment
from benchmark.experiments.claims import Claims
from benchmark.running.experiment import repeat_at_random

QUICK = "C05"


@pytest.fixture
def directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A record of one claim, the only one that there is a digest of code to take of."""
    only = {QUICK: find_experiments()[QUICK]}
    monkeypatch.setattr(experiment, "find_experiments", lambda: only)
    key = Claims(tmp_path).keys()[QUICK]
    RECORD.write({QUICK: {**RECORD.read()[QUICK], "key": key}}, tmp_path)
    return tmp_path


def change(directory: Path, edit: Callable[[Any], object]) -> None:
    rows = RECORD.read(directory)
    edit(rows[QUICK])
    RECORD.write(rows, directory)


def first(document: Any) -> list[float]:
    values: list[float] = next(iter(document["values"].values()))
    return values


def test_every_published_outcome_is_of_its_plan() -> None:
    outcomes = read_outcomes()
    assert len(outcomes) >= 50
    for name, outcome in outcomes.items():
        claim = claims()[name]
        scales = {rule.name: rule.scale for rule in claim.rules}
        assert set(outcome.values) == set(scales) >= set(outcome.second)
        assert bool(outcome.second) == bool(claim.second)
        for rule, numbers in (*outcome.values.items(), *outcome.second.items()):
            assert len(numbers) == claim.trials
            assert scales[rule] == "linear" or not any(number < 0 for number in numbers)
        for line in outcome.lines.values():
            for low, median, high in zip(line.low, line.median, line.high, strict=True):
                assert low <= median <= high or math.isnan(median)


@pytest.mark.slow
def test_a_forged_number_is_found_by_measuring_again_and_no_true_one(directory: Path) -> None:
    change(directory, lambda d: first(d).__setitem__(1, first(d)[1] * 1.001))
    ((cell, text),) = repeat_at_random(Claims(directory), 1, 3)
    assert cell == QUICK
    assert text.startswith("values, ")
    assert "measured again" in text

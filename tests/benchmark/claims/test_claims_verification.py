"""Outcomes that cannot be of their plan, and forged ones that can, are reported."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from benchmark.claims.experiment import find_experiments
from benchmark.claims.ledger import LedgerError, ledger
from benchmark.claims.outcomes import RECORD, contradictions, plan_digest, read_outcomes
from benchmark.claims.rules import claims
from benchmark.experiments import claims as experiment
from benchmark.experiments.claims import Claims
from benchmark.running.experiment import list_due, repeat_at_random

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


def test_no_published_outcome_contradicts_its_plan() -> None:
    found = {
        name: list(contradictions(claims()[name], one)) for name, one in read_outcomes().items()
    }
    assert {name for name, entry in found.items() if entry} == set()
    assert len(found) >= 50


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda d: first(d).pop(), r"values, .*: expected [0-9]+ trials, got"),
        (lambda d: d["values"].update(other=[1.0]), "values: expected those of .*'other'"),
        (lambda d: d["values"].clear(), "values: expected those of"),
        (
            lambda d: next(iter(d["lines"].values()))["median"].__setitem__(0, 1e9),
            "point 1: 1000000000.0 is not between",
        ),
    ],
)
def test_what_cannot_be_is_said_by_check_and_ledger(
    directory: Path, edit: Callable[[Any], object], said: str
) -> None:
    assert QUICK not in dict(list_due(Claims(directory)))
    change(directory, edit)
    with pytest.raises(LedgerError, match=rf"{QUICK}: .*{said}.*measure it again"):
        ledger(directory)
    assert dict(list_due(Claims(directory)))[QUICK]


@pytest.mark.parametrize(
    ("values", "second", "said"),
    [
        ({}, {"before": (1.0,) * 3}, "second, before: expected {trials} trials, got 3"),
        ({}, {"other": (1.0,)}, "second: expected those of before, little; 'other' is not so"),
        ({}, {}, "second: the plan and the outcome differ in whether there is a second method"),
        ({"little": -0.5}, None, "values, little: a statistic averaged by logarithms is never"),
    ],
)
def test_a_second_method_and_logarithms_are_those_of_the_plan(
    values: dict[str, float], second: dict[str, tuple[float, ...]] | None, said: str
) -> None:
    """C04 is checked by a second method, and averages ratios by their logarithms."""
    claim, outcome = claims()["C04"], read_outcomes()["C04"]
    assert outcome.plan == plan_digest(claim)
    changed = {name: (value, *outcome.values[name][1:]) for name, value in values.items()}
    wrong = replace(
        outcome,
        values={**outcome.values, **changed},
        second=outcome.second if second is None else second,
    )
    assert list(contradictions(claim, outcome)) == []
    found = list(contradictions(claim, wrong))
    assert said.format(trials=claim.trials) in found[0]
    assert len(found) == 1


@pytest.mark.slow
def test_a_forged_number_is_found_by_measuring_again_and_no_true_one(directory: Path) -> None:
    change(directory, lambda d: first(d).__setitem__(1, first(d)[1] * 1.001))
    ((cell, text),) = repeat_at_random(Claims(directory), 1, 3)
    assert cell == QUICK
    assert text.startswith("values, ")
    assert "measured again" in text

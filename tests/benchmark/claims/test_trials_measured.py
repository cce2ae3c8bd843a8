"""Every claim's experiment still measures what is published of it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from algorithms.threads import one_thread
from benchmark.claims.experiment import find_experiments
from benchmark.claims.outcomes import outcome_of, read_outcomes
from benchmark.claims.rules import FIRST_TRIAL, claims


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(find_experiments()))
def test_the_first_trial_of_a_claim_measures_what_is_published(name: str) -> None:
    """But for run times, and for last digits that another processor may change."""
    claim, published = replace(claims()[name], trials=1), read_outcomes()[name]
    with one_thread():
        trial = find_experiments()[name].trial(FIRST_TRIAL)
    measured = outcome_of(claim, [trial])
    assert set(measured.lines) == set(published.lines)
    for numbers, before in (
        (measured.values, published.values),
        (measured.second, published.second),
    ):
        assert set(numbers) == set(before)
        for rule in claim.rules:
            if rule.name in numbers and not rule.timed:
                expected = before[rule.name][0]
                assert numbers[rule.name][0] == pytest.approx(expected, rel=1e-3, nan_ok=True)
            elif rule.name in numbers:
                assert numbers[rule.name][0] > 0.0

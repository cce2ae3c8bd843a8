"""Every claim's experiment still measures what is published of it."""

from __future__ import annotations

import importlib
import inspect
import math
import pkgutil
from dataclasses import fields, replace
from typing import Any

import pytest

from algorithms.threads import one_thread
from benchmark.claims.experiment import find_experiments
from benchmark.claims.outcomes import outcome_of, read_outcomes
from benchmark.claims.rules import FIRST_TRIAL, claims
from benchmark.datasets import standard
from benchmark.simulator.light.memory import memory

#: Of which one trial takes below a second.
QUICK = {
    "C04", "C05", "C06", "C08", "C12", "C15", "C17", "C18", "C19", "C20", "C21", "C22", "C23",
    "C27", "C32", "C36", "C37", "C38", "C40", "C41", "C42", "C48", "C49", "C51", "C52", "C55",
}  # fmt: skip
BY_COST = [
    name if name in QUICK else pytest.param(name, marks=pytest.mark.slow)
    for name in sorted(find_experiments())
]


@pytest.mark.parametrize("name", BY_COST)
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


#: Where an experiment's lines are planned: a constant of its module.
PLACES = {
    "C01": "INTERVALS_DEG", "C03": "HALF_FIELDS_DEG", "C07": "SHOWN", "C09": "PARTS",
    "C10": "TIMES", "C11": "GAPS_MM", "C14": "FITTED", "C16": "SHARES", "C26": "REFLECTANCES",
    "C30": "SHARES", "C31": "SLITS", "C34": "HEIGHTS_PX", "C35": "PLACES", "C39": "NUMBERS",
    "C45": "MISSING", "C46": "SHARES", "C47": "SHARES", "C48": "NOISES", "C50": "SHARES",
    "C52": "NOISES", "C53": "PITCHES", "C55": "SEPARATIONS",
}  # fmt: skip


@pytest.mark.parametrize("name", PLACES)
def test_published_lines_are_at_the_places_that_are_planned(name: str) -> None:
    """Of experiments whose trials take longer."""
    module = inspect.getmodule(find_experiments()[name].trial)
    first, *_ = read_outcomes()[name].lines.values()
    assert tuple(getattr(module, PLACES[name])) == tuple(first.x)


def on_few_directions(preset: Any) -> Any:
    """A data set of at most 7 by 7 poses and 40 tests."""
    most = {"steps": 7, "calibration_samples": 40, "test_samples": 40}
    field = preset.directions
    less = {f.name: min(most[f.name], getattr(field, f.name)) for f in fields(field)
            if f.name in most}  # fmt: skip
    return replace(preset, directions=replace(field, **less))


@pytest.mark.parametrize("name", ["C07", "C11", "C13", "C14", "C29", "C31"])
def test_a_trial_on_few_directions_has_every_number_at_every_place(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of experiments whose trials take longer: no published number, but all of them."""
    for module in (importlib.import_module(f"{standard.__name__}.{one.name}")
                   for one in pkgutil.iter_modules(standard.__path__)):  # fmt: skip
        monkeypatch.setattr(module, "PRESET", on_few_directions(module.PRESET))
    claim, published = replace(claims()[name], trials=1), read_outcomes()[name]
    with one_thread():
        found = outcome_of(claim, [find_experiments()[name].trial(FIRST_TRIAL)])
    memory.forget()
    for numbers, before in ((found.values, published.values), (found.second, published.second)):
        assert set(numbers) == set(before)
        assert all(math.isfinite(one) for (one,) in numbers.values())
    assert {line: of.x for line, of in found.lines.items()} == {
        line: of.x for line, of in published.lines.items()
    }
    for of in found.lines.values():
        assert any(error > 0.0 for error in of.median)

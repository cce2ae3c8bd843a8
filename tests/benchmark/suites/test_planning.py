"""What a plan says: which cells, and why."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import fake_atlas
import fake_plan
import pytest

from benchmark.leaderboard.scope import UNITS
from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts
from benchmark.progress import silent
from benchmark.results import components
from benchmark.results.store import Store
from benchmark.running.runner import run
from benchmark.suites.planning import CellPlan, cells_of, plan
from benchmark.suites.selection import suite


def parts(**changes: Any) -> Parts:
    first = fake_atlas.Diodes(n=40)
    second = fake_atlas.Diodes(name="fake-second", n=40, **changes)
    return fake_plan.parts(fake_atlas.LeastSquares, fake_atlas.Broken, presets=(first, second))


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Store:
    """Everything measured, of which what is broken failed."""
    there = Store(tmp_path_factory.mktemp("store"))
    run(cells(parts=parts()), there, progress=silent, parts=parts())
    return there


def why(found: CellPlan) -> dict[tuple[str, ...], set[str]]:
    """Reasons and the data sets, extractors and models of their cells."""
    by_reason: dict[tuple[str, ...], set[str]] = {}
    for cell, reasons in found.missing.items():
        by_reason.setdefault(reasons, set()).update((cell.dataset, cell.extractor, cell.model))
    return by_reason


EXTRACTORS = {"fake-currents", "fake-gaps"}
FINE = [cell for cell in cells(parts=parts()) if cell.model != "fake-broken"]


def test_what_is_measured_is_not_planned_and_what_failed_is(store: Store, tmp_path: Path) -> None:
    for stores in ([store], [Store(tmp_path), store], [store, Store(tmp_path)]):
        assert plan(FINE, stores, parts=parts()).missing == {}
        found = plan(cells(parts=parts()), stores, parts=parts())
        assert set(found.missing.values()) == {("failed",)}
        assert {cell.model for cell in found.missing} == {"fake-broken"}
        assert len(found.missing) == 8


def test_changed_data_are_the_reason_of_their_cells_alone(store: Store) -> None:
    found = plan(FINE, [store], parts=parts(seed=8))
    assert why(found) == {("dataset",): {"fake-second", "fake-least-squares", *EXTRACTORS}}
    assert len(found.missing) == 4


@pytest.mark.parametrize("changed", ["extractor", "model"])
def test_a_changed_method_is_the_reason_of_its_cells_alone(store: Store, changed: str) -> None:
    known = parts()

    class Gaps(fake_atlas.Gaps):
        about = replace(fake_atlas.Gaps.about, version=2)

    class Squares(fake_atlas.LeastSquares):
        about = replace(fake_atlas.LeastSquares.about, version=2)

    now = (
        replace(known, extractors={**known.extractors, "fake-gaps": Gaps})
        if changed == "extractor"
        else replace(known, models={**known.models, "fake-least-squares": Squares})
    )
    found = plan(FINE, [store], parts=now)
    name = "fake-gaps" if changed == "extractor" else "fake-least-squares"
    expected = [cell for cell in FINE if name in (cell.extractor, cell.model)]
    assert found.missing == dict.fromkeys(expected, (changed,))


def test_changed_code_of_a_stage_is_the_reason_of_all(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = components.stage_digests()
    monkeypatch.setattr(components, "stage_digests", lambda *_: {**now, "scores": "0123"})
    found = plan(FINE, [store], parts=parts())
    assert found.missing == dict.fromkeys(FINE, ("code of scores",))
    both = plan(FINE, [store], parts=parts(seed=8)).missing
    assert {cell.dataset for cell, why in both.items() if why == ("dataset", "code of scores")} == {
        "fake-second"
    }


def test_a_suite_follows_from_the_scores_that_any_store_holds(store: Store, tmp_path: Path) -> None:
    standard = suite("standard")
    alone = cells_of(standard, [Store(tmp_path)], parts=parts())
    assert {cell.condition for cell in alone} == {"quiet"}
    followed = cells_of(standard, [Store(tmp_path), store], parts=parts())
    assert set(alone) < set(followed)
    assert {cell.condition for cell in followed} == {"quiet", "noisy", "on-bench"}
    assert {cell.unit for cell in followed} == set(range(UNITS))

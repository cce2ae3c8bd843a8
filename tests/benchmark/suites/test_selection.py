"""What the suites hold: by rule, so that what is new takes its place."""

from __future__ import annotations

import pytest

from algorithms.chain import Chain
from benchmark.contract import Cell, UnknownNameError
from benchmark.plan.parts import installed_parts
from benchmark.results.store import PUBLISHED, Store
from benchmark.suites.selection import SUITES, suite
from registry.studies import facts


@pytest.fixture(scope="module")
def quick() -> list[Cell]:
    return suite("quick").select({}, installed_parts())


def test_quick_meets_every_category_of_models_that_has_one(quick: list[Cell]) -> None:
    taxonomy, models = facts().taxonomy, installed_parts().models

    def category(name: str) -> str:
        model = models[name]
        last = model.model if isinstance(model, Chain) else model
        return taxonomy.category("model", last.about.taxonomy)

    there = {category(name) for name in models}
    assert len(there) >= 6
    assert {category(cell.model) for cell in quick} == there


def test_quick_needs_nothing_that_is_not_published_anyway(quick: list[Cell]) -> None:
    assert set(quick) <= set(Store(PUBLISHED).scores())
    assert {cell.unit for cell in quick} == {0}


def test_an_unknown_suite_is_refused_with_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'quick'"):
        suite("quik")
    assert {one.name: one for one in SUITES.values()} == dict(SUITES)

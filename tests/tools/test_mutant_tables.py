"""The tables of the mutation run are of the tree as it is; the run itself is `make mutants`."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from tools.mutation.groups import GROUPS

ROOT = Path(__file__).parents[2]
SURVIVORS = tomllib.loads((ROOT / "tools/mutation/survivors.toml").read_text())["survivor"]


@pytest.mark.parametrize("name", GROUPS)
def test_every_module_of_a_group_has_tests_that_are_there(name: str) -> None:
    group = GROUPS[name]
    modules = group.modules(ROOT)
    assert modules
    for module in modules:
        tests = group.tests_of(module)
        assert tests
        assert [test for test in tests if not (ROOT / test).is_file()] == [], module
    patterns = {
        pattern for pattern in group.tests for one in modules if one == pattern or "*" in pattern
    }
    assert patterns == set(group.tests), "a pattern that no module fits is out of date"


def test_at_least_300_mutants_are_tried() -> None:
    assert sum(group.mutants for group in GROUPS.values()) >= 300


def test_every_survivor_has_a_reason() -> None:
    for one in SURVIVORS:
        assert set(one) == {"module", "definition", "change", "reason"}
        assert (ROOT / one["module"]).is_file()
        assert len(one["reason"]) > 20

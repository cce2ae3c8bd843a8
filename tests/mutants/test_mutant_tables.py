"""The tables of the mutation run are of the tree as it is; the run itself is `make mutants`."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from tests.mutants.groups import GROUPS

ROOT = Path(__file__).parents[2]
SURVIVORS = tomllib.loads(Path(__file__).with_name("survivors.toml").read_text())["survivor"]


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


@pytest.mark.parametrize("one", SURVIVORS, ids=lambda one: one["module"])
def test_a_survivor_s_reason_is_of_code_that_is_there(one: dict[str, str]) -> None:
    source = (ROOT / one["module"]).read_text()
    lines = {line.strip() for line in source.splitlines()}
    before = [line[1:] for line in one["change"].strip().splitlines() if line.startswith("-")]
    assert before
    assert [line for line in before if line not in lines] == []
    assert len(one["reason"]) > 20
    assert set(one) == {"module", "definition", "change", "reason"}

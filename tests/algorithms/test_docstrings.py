"""Docstrings of everything discovered: sections present and in order, examples that run."""

from __future__ import annotations

import dataclasses
import doctest
import importlib
import inspect
import pkgutil

import pytest
from numpydoc.validate import validate

import algorithms
from algorithms.discovery import (
    discover_compensations,
    discover_extractors,
    discover_models,
)
from algorithms.filtering import filters, hypotheses

IMPLEMENTATIONS = {**discover_extractors(), **discover_compensations(), **discover_models()}
#: Modules whose public functions and classes a user calls.
PUBLIC = (
    "about",
    "angles",
    "calibration.quality",
    "calibration.saving",
    "context",
    "contract",
    "design",
    "inputs",
    "measurement",
    "parameters",
    "pipeline",
)
SECTIONS = ("Notes", "References", "Examples")
#: What numpydoc reports that is not asked for: a "See Also" (SA01).
NOT_ASKED = frozenset({"SA01"})
#: A function's summary may say all there is to it (ES01) and name what it returns, in the plural
#: too (SS05 takes that for a verb); parameters described elsewhere have no type (PR04).
NOT_ASKED_OF_FUNCTIONS = NOT_ASKED | {"ES01", "PR04", "SS05"}


def full_name(member: object) -> str:
    return f"{member.__module__}.{member.__qualname__}"


def complaints(member: object, not_asked: frozenset[str]) -> list[str]:
    found = validate(full_name(member))["errors"]
    return [f"{code}: {said}" for code, said in found if code not in not_asked]


def public_members() -> list[object]:
    members = []
    for name in PUBLIC:
        module = importlib.import_module(f"algorithms.{name}")
        members += [
            member
            for public, member in vars(module).items()
            if not public.startswith("_")
            and (inspect.isfunction(member) or dataclasses.is_dataclass(member))
            and member.__module__ == module.__name__
        ]
    return members


@pytest.mark.parametrize("name", IMPLEMENTATIONS)
def test_an_implementation_is_documented_in_full_and_in_order(name):
    implementation = IMPLEMENTATIONS[name]
    assert complaints(implementation, NOT_ASKED) == []
    lines = inspect.getdoc(implementation).splitlines()
    places = [lines.index(section) for section in SECTIONS]
    assert places == sorted(places)
    references = lines[places[1] : places[2]]
    for cited in (*implementation.about.studies, *implementation.about.labels):
        assert any(cited in line for line in references), f"{cited} is not among the references"


@pytest.mark.parametrize("member", public_members(), ids=full_name)
def test_what_a_user_calls_is_documented_in_full_and_in_order(member):
    assert complaints(member, NOT_ASKED_OF_FUNCTIONS) == []


@pytest.mark.parametrize("name", IMPLEMENTATIONS)
def test_the_examples_of_an_implementation_run_and_show_a_number(name):
    implementation = IMPLEMENTATIONS[name]
    module = importlib.import_module(implementation.__module__)
    finder = doctest.DocTestFinder(recurse=False)
    (example,) = finder.find(implementation, implementation.__name__, globs=dict(vars(module)))
    assert any(any(c.isdigit() for c in part.want) for part in example.examples)
    assert doctest.DocTestRunner().run(example).failed == 0


def test_every_rule_of_update_has_an_example():
    rules = {
        rule
        for module in (filters, hypotheses)
        for rule in vars(module).values()
        if isinstance(rule, type) and hasattr(rule, "update") and not rule.__name__.startswith("_")
    } - {filters.Filter}
    assert len(rules) >= 5
    assert [rule for rule in rules if ">>> " not in rule.__doc__] == []


def test_all_other_examples_run():
    """Those of functions and contracts, as `pytest --doctest-modules algorithms` runs them too."""
    ran = []
    apart = {full_name(implementation) for implementation in IMPLEMENTATIONS.values()}
    for info in pkgutil.walk_packages(algorithms.__path__, "algorithms."):
        if info.name.endswith("_kernel") or info.name.startswith("algorithms.kernels"):
            continue  # compiled loops, which their users' examples run
        for example in doctest.DocTestFinder().find(importlib.import_module(info.name)):
            if example.examples and example.name not in apart:
                assert doctest.DocTestRunner().run(example).failed == 0, example.name
                ran.append(example.name)
    assert {"algorithms.angles.separation_deg", "algorithms.pipeline.Pipeline"} <= set(ran)

"""Discovery finds each implementation once, complains of broken ones, and loads nothing heavy."""

from __future__ import annotations

import re
from types import ModuleType
from typing import Any

import pytest

import algorithms
from algorithms import discovery
from algorithms.compensations.combinations import combinations
from algorithms.contract import Extractor
from algorithms.discovery import (
    discover_chains,
    discover_extractors,
    implementations,
)

GOOD = """
from dataclasses import dataclass
from typing import ClassVar

from algorithms.contract import AboutExtractor, Extractor, FeatureKind, Observation

@dataclass(frozen=True)
class {cls}(Extractor):
    about: ClassVar = AboutExtractor(
        name="{name}",
        taxonomy="BCM",
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    def extract(self, observations):
        return observations
"""


@pytest.fixture
def package(tmp_path, monkeypatch, request):
    """An empty importable package of a name no other test uses."""
    name = f"found_{abs(hash(request.node.name))}"
    folder = tmp_path / name
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    monkeypatch.syspath_prepend(tmp_path)

    def load() -> ModuleType:
        return __import__(name)

    return folder, load


def test_reexported_private_and_unrelated_classes_are_skipped(package):
    folder, load = package
    (folder / "one.py").write_text(GOOD.format(cls="One", name="one"))
    (folder / "again.py").write_text(f"from {folder.name}.one import One\nclass Other: pass\n")
    (folder / "_hidden.py").write_text(GOOD.format(cls="Hidden", name="hidden"))
    (folder / "inner.py").write_text(GOOD.format(cls="_Inner", name="inner"))
    (folder / "family").mkdir()
    (folder / "family" / "__init__.py").write_text("")
    (folder / "family" / "two.py").write_text(GOOD.format(cls="Two", name="two"))
    assert list(implementations(load(), Extractor, "extract")) == ["one", "two"]


def test_two_classes_of_one_name_are_refused(package):
    folder, load = package
    (folder / "one.py").write_text(GOOD.format(cls="One", name="same"))
    (folder / "two.py").write_text(GOOD.format(cls="Two", name="same"))
    with pytest.raises(ValueError, match=r"'same'.*one\.One.*two\.Two"):
        implementations(load(), Extractor, "extract")


@pytest.mark.parametrize(
    ("part", "said"),
    [
        (r"    about: ClassVar = .*?\n    \)\n", r"one\.One lacks about of the Extractor"),
        (r"    def extract.*", r"one\.One lacks extract of the Extractor"),
        (r"        kind=.*?\n", "missing 1 required keyword-only argument: 'kind'"),
    ],
)
def test_what_is_missing_is_named(package, part, said):
    folder, load = package
    text, count = re.subn(part, "", GOOD.format(cls="One", name="one"), flags=re.DOTALL)
    assert count == 1
    (folder / "one.py").write_text(text)
    with pytest.raises(TypeError, match=said):
        implementations(load(), Extractor, "extract")


def test_an_extractor_that_can_be_changed_is_refused(
    package: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, load = package
    text = GOOD.format(cls="One", name="one").replace("(frozen=True)", "")
    (folder / "one.py").write_text(text)
    monkeypatch.setattr(algorithms, "extractors", load())
    with pytest.raises(TypeError, match="extractor one must be a frozen dataclass"):
        discover_extractors()


def test_a_chain_is_planned_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """By what a compensation goes ahead of, or by a study's combination."""
    used = {"optical + lsq": ("He2005",)}
    monkeypatch.setattr(
        discovery, "combinations", lambda stages, models: combinations(stages, models, used)
    )
    with pytest.raises(ValueError, match=r"planned already by .*ahead_of: optical \+ lsq"):
        discover_chains()

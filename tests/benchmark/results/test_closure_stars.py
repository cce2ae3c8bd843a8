"""Digests of code where names come from stars, from patterns, and from classes that data hold."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import pytest
from fake_atlas import Diodes

from benchmark.results.analyses import Analyses
from benchmark.results.closure import Sources, reachable_definitions
from benchmark.results.digests import entries_of


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Return a function that writes modules of a package outside the project."""
    package = tmp_path / "starred_pkg"
    package.mkdir()
    (package / "__init__.py").touch()
    monkeypatch.syspath_prepend(tmp_path)

    def written(**modules: str) -> None:
        for name, text in modules.items():
            (package / f"{name}.py").write_text(text)
        importlib.invalidate_caches()

    return written


def digest(entry: str) -> str:
    return Sources(Analyses()).digest(f"starred_pkg.{entry}")


STAR_OF_MANY = "from math import *\nfrom .near import *\nfrom .far import *\n\n"
STAR_TRIED = "try:\n    from .far import *\nexcept ImportError:\n    value = 0\n\n"
PATTERN = "from .far import value as rest\n\ndef work(x):\n    match x:\n        case "


@pytest.mark.parametrize(
    ("entry", "top"),
    [
        ("top", "from .far import *\n"),
        ("top:work", f"{STAR_TRIED}def work():\n    return value\n"),
        ("top:work", f"{STAR_OF_MANY}def work():\n    return sqrt(value)\n"),
        ("top:work", f"{PATTERN}{{'a': a}}:\n            return rest\n"),
    ],
)
def test_what_a_star_or_a_pattern_leaves_to_a_module_is_followed_there(
    write: Callable[..., None], entry: str, top: str
) -> None:
    write(top=top, far="value = 1\n", near="other = 1\n")
    before = digest(entry)
    write(near="other = 2\n")
    assert digest(entry) == before
    write(far="value = 2\n")
    assert digest(entry) != before


def test_what_a_pattern_binds_is_no_name_of_the_module(write: Callable[..., None]) -> None:
    top = "from .far import value as rest\n\ndef work(x):\n    match x:\n"
    write(
        top=f"{top}        case {{'a': a, **rest}}:\n            return rest\n", far="value = 1\n"
    )
    before = digest("top:work")
    write(far="value = 2\n")
    assert digest("top:work") == before
    assert reachable_definitions("starred_pkg.top:work") == ("starred_pkg.top:work",)


def test_modules_that_take_all_names_of_each_other_come_to_an_end(
    write: Callable[..., None],
) -> None:
    write(
        top="from .mid import *\n\ndef work():\n    return value, missing\n",
        mid="from .top import *\nfrom .far import value\nfrom .gone import *\n",
        far="value = 1\n",
    )
    found = reachable_definitions("starred_pkg.top:work")
    assert found == ("starred_pkg.far:value", "starred_pkg.mid:value", "starred_pkg.top:work")
    before = digest("top:work")
    write(far="value = 2\n")
    assert digest("top:work") != before


@dataclass(frozen=True)
class Passes:
    passes: int = 4


def test_a_class_that_data_hold_is_an_entry_with_those_it_is_derived_from() -> None:
    derived = type("Derived", (Passes,), {"__module__": __name__})
    held = entries_of(replace(Diodes(), repeats=derived))
    assert set(held) >= {"fake_atlas:Diodes", f"{__name__}:Derived", f"{__name__}:Passes"}
    assert entries_of(object()) == ()


def test_stars_in_a_circle_with_a_name_from_beyond_it_come_to_an_end(
    write: Callable[..., None],
) -> None:
    write(
        top="from .mid import *\n\ndef work():\n    return value\n",
        mid="from .side import *\nfrom .far import *\n",
        side="from .top import *\nfrom .far import *\n",
        far="value = 1\n",
    )
    assert "starred_pkg.far:value" in reachable_definitions("starred_pkg.top:work")
    before = digest("top:work")
    write(far="value = 2\n")
    assert digest("top:work") != before

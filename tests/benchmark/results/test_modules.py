"""A digest is of the modules that code imports: of each line that runs, and of no other module."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import fake_atlas
import pytest

from benchmark.plan.parts import installed_parts
from benchmark.results import modules
from benchmark.results.digests import (
    condition_digests,
    method_digest,
    method_modules,
    modules_of,
    series_digest,
    stage_digests,
)
from benchmark.results.modules import STAGES, ModuleError, modules_digest, reached

Write = Callable[[str, str], None]
FILES = {
    "__init__.py": "",
    "top.py": (
        "from __future__ import annotations\n"
        "import os\n"
        "from typing import TYPE_CHECKING\n"
        "from plugin_pkg.deep import leaf\n"
        "from .sibling import value\n"
        "if TYPE_CHECKING:\n    from plugin_pkg.typed import Kind\n"
        "def work():\n    import plugin_pkg.lazy as lazy\n    return lazy.value\n"
    ),
    "sibling.py": "try:\n    from .deep.up import value\nexcept ImportError:\n    value = 0\n",
    "lazy.py": "import api.addresses, files.atomic, benchmark.running.runner\nvalue = 1\n",
    "typed.py": "",
    "unrelated.py": "value = 5\n",
    "deep/__init__.py": "",
    "deep/leaf.py": (
        "from dataclasses import dataclass\n"
        "@dataclass(frozen=True)\nclass Part:\n    passes: int = 4\n"
    ),
    "deep/up.py": "from ..far import *\n",
    "far.py": "value = 3\n",
}
REACHED = ("", ".deep", ".deep.leaf", ".deep.up", ".far", ".lazy", ".sibling", ".top")


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Write]:
    """Writes modules of a package outside the project."""
    monkeypatch.syspath_prepend(tmp_path)
    now = [10**18]

    def to(name: str, text: str) -> None:
        path = tmp_path / "plugin_pkg" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        now[0] += 10**9  # two writes within one tick of the clock would have one time
        os.utime(path, ns=(now[0], now[0]))

    for name, text in FILES.items():
        to(name, text)
    modules.module_path.cache_clear()
    yield to
    modules.module_path.cache_clear()
    for name in [name for name in sys.modules if name.startswith("plugin_pkg")]:
        del sys.modules[name]


def test_every_form_of_import_is_followed_and_what_changes_no_number_is_not(write: Write) -> None:
    assert tuple(reached("plugin_pkg.top")) == tuple(f"plugin_pkg{name}" for name in REACHED)
    before = modules_digest("plugin_pkg.top")
    for name in ("far", "lazy", "unrelated", "typed"):
        write(f"{name}.py", FILES[f"{name}.py"] + "more = 1\n")
        assert (modules_digest("plugin_pkg.top") != before) is (name in ("far", "lazy")), name
        write(f"{name}.py", FILES[f"{name}.py"])
    assert modules_digest("plugin_pkg.top") == before
    with pytest.raises(ModuleError, match=r"no source file found for module 'plugin_pkg\.gone'"):
        modules_digest("plugin_pkg.gone")
    write("far.py", "def f(:\n")
    with pytest.raises(ModuleError, match=r"far\.py cannot be parsed"):
        modules_digest("plugin_pkg.top")


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ('"""Says."""\n\n\ndef f(a, b):\n    """Add."""\n    return a + b  # sum\n', True),
        ("def f(\n    a,\n    b,\n):\n\n    return (\n        a\n        + b\n    )\n", True),
        ("def f(a, b):\n    return a - b\n", False),
        ("def f(b, a):\n    return a + b\n", False),
        ("def f(a, b=0):\n    return a + b\n", False),
        ("def f(a, b):\n    return\n    a + b\n", False),
        ("def f(a, b):\n    1.0\n    return a + b\n", False),
    ],
)
def test_what_only_people_read_is_no_code(write: Write, text: str, same: bool) -> None:
    write("far.py", "def f(a, b):\n    return a + b\n")
    before = modules_digest("plugin_pkg.far")
    write("far.py", text)
    assert (modules_digest("plugin_pkg.far") == before) is same


@pytest.mark.usefixtures("write")
def test_what_is_handed_in_counts_with_its_modules(write: Write) -> None:
    from plugin_pkg.deep.leaf import Part

    for repeats in ({"x": Part()}, [Part()], (1, {"y": ("z", Part())})):
        held: Any = replace(fake_atlas.Diodes(), repeats=repeats)  # type: ignore[arg-type]
        assert set(modules_of(held)) >= {"fake_atlas", "plugin_pkg.deep.leaf"}
    elsewhere: Any = type("Elsewhere", (fake_atlas.Currents,), {"__module__": "plugin_pkg.top"})
    newer = replace(fake_atlas.Currents.about, version=2)
    other: Any = type("Newer", (fake_atlas.Currents,), {"about": newer, "__module__": "fake_atlas"})
    assert method_digest(other) != method_digest(fake_atlas.Currents)
    preset: Any = replace(fake_atlas.Diodes(), repeats=Part())
    makers = (
        lambda: condition_digests(preset),
        lambda: series_digest((Part(),)),
        lambda: method_digest(elsewhere),
    )
    before = [make() for make in makers]
    write("deep/leaf.py", FILES["deep/leaf.py"].replace("4", "5"))
    assert all(one != make() for one, make in zip(before, makers, strict=True))


def test_stages_are_apart_and_methods_reach_their_own_modules() -> None:
    """A metric re-scores, a model refits, an extractor renders nothing."""
    found = {name: set(reached(module)) for name, module in STAGES.items()}
    assert len(set(stage_digests().values())) == len(STAGES)
    assert "benchmark.metrics.score" in found["scores"]
    assert not {"benchmark.metrics.score", STAGES["scores"]} & (
        found["data"] | found["features"] | found["predictions"]
    )
    assert STAGES["predictions"] not in found["data"] | found["features"]
    parts = installed_parts()
    for methods in (parts.extractors, parts.models):
        for method in methods.values():
            names = set(reached(*method_modules(method)))
            assert {name.partition(".")[0] for name in names} == {"algorithms"}
            assert names >= set(method_modules(method))

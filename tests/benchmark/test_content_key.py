"""What changes a key, and what does not."""

import sys
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from types import SimpleNamespace

import fake_atlas
import numpy as np
import pytest

from benchmark import content_key
from benchmark.content_key_closure import ClosureError, closure, closure_digest, syntax_digest


@pytest.fixture
def plug_in(tmp_path, monkeypatch):
    """A package outside the project, with every form of import a closure must follow."""
    package = tmp_path / "plugin_pkg"
    (package / "deep").mkdir(parents=True)
    files = {
        "__init__.py": "from plugin_pkg import unrelated\n",
        "top.py": (
            '"""Top."""\n'
            "import os\n"
            "from plugin_pkg.deep import leaf\n"
            "from .sibling import value\n\n\n"
            "def work():\n"
            '    """Lazy."""\n'
            "    import plugin_pkg.lazy as lazy\n"
            "    return lazy.value + leaf.value + value  # sum\n"
        ),
        "sibling.py": "from .deep.up import value\n",
        "lazy.py": "value = 1\n",
        "unrelated.py": "value = 5\n",
        "deep/__init__.py": "",
        "deep/leaf.py": "value = 2\n",
        "deep/up.py": "from ..far import *\n",
        "far.py": "value = 3\n",
    }
    for name, text in files.items():
        (package / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    yield package
    for name in [name for name in sys.modules if name.startswith("plugin_pkg")]:
        del sys.modules[name]


def rewrite(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_the_closure_follows_absolute_relative_lazy_and_star_imports_and_nothing_else(plug_in):
    names = ("top", "sibling", "lazy", "deep.leaf", "deep.up", "far")
    assert set(closure("plugin_pkg.top")) == {f"plugin_pkg.{name}" for name in names}
    assert "plugin_pkg" not in sys.modules, "a closure is found without importing anything"


def test_comments_docstrings_and_formatting_do_not_change_the_digest(plug_in):
    before = closure_digest("plugin_pkg.top")
    rewrite(plug_in / "top.py", '"""Top."""\n', '"""Other words."""\n\n# and a comment\n')
    rewrite(plug_in / "top.py", "  # sum", "")
    rewrite(plug_in / "top.py", '"""Lazy."""', "'''Lazier.'''")
    rewrite(
        plug_in / "top.py", "lazy.value + leaf.value + value", "(lazy.value\n + leaf.value) + value"
    )
    assert closure_digest("plugin_pkg.top") == before


@pytest.mark.parametrize("file", ["top.py", "sibling.py", "lazy.py", "deep/leaf.py", "far.py"])
def test_any_change_of_code_in_the_closure_changes_the_digest(plug_in, file):
    before = closure_digest("plugin_pkg.top")
    path = plug_in / file
    path.write_text(path.read_text() + "\nadded = 1\n")
    assert closure_digest("plugin_pkg.top") != before


def test_code_outside_the_closure_does_not_change_the_digest(plug_in):
    before = closure_digest("plugin_pkg.top")
    (plug_in / "unrelated.py").write_text("value = 6\n")
    (plug_in / "new.py").write_text("value = 6\n")
    assert closure_digest("plugin_pkg.top") == before


def test_numbers_that_differ_in_type_or_value_are_different_code(tmp_path):
    digests = set()
    for index, text in enumerate(["x = 1", "x = 1.0", "x = '1'", "x = True", "x = 2", "y = 1"]):
        path = tmp_path / f"m{index}.py"
        path.write_text(text)
        digests.add(syntax_digest(path))
    assert len(digests) == 6


def test_a_module_without_source_is_named():
    with pytest.raises(ClosureError, match="nowhere_at_all"):
        closure("nowhere_at_all.module")


class Colour(Enum):
    RED = "red"


@dataclass(frozen=True)
class Inner:
    b: tuple[float, ...] = (1.0,)


def test_canonical_json_has_one_spelling():
    value = {"b": Inner((0.1 + 0.2, np.float32(2.0))), "a": {3, 1}, "c": Colour.RED, "d": None}
    assert content_key.canonical_json(value) == '{"a":[1,3],"b":{"b":[0.3,2.0]},"c":"red","d":null}'
    assert content_key.digest(value) == content_key.digest(dict(reversed(value.items())))


def test_arrays_enter_with_their_type_and_non_finite_numbers_by_name():
    assert content_key.digest(np.array([1, 2])) != content_key.digest(np.array([1.0, 2.0]))
    assert content_key.canonical_json([float("inf"), float("nan")]) == '["inf","nan"]'


def test_a_value_without_spelling_is_refused():
    with pytest.raises(TypeError, match="object has no canonical spelling"):
        content_key.canonical_json({"a": object()})


def test_the_data_hash_sees_every_array_its_shape_and_type_but_not_its_memory_layout():
    sun = np.eye(3)
    frames = np.arange(24, dtype=np.uint16).reshape(3, 2, 4)

    def hashed(observations, sun=sun, origin=None):
        return content_key.samples_hash(
            SimpleNamespace(observations=observations, sun=sun, origin_px=origin)
        )

    base = hashed(frames)
    assert len(base) == 32
    assert hashed(np.asfortranarray(frames)) == base
    assert hashed(frames.astype(">u2")) == base
    others = [
        hashed(frames.reshape(3, 4, 2)),
        hashed(frames.astype(np.int16)),
        hashed(frames, -sun),
        hashed(frames, origin=np.zeros((3, 2))),
        hashed(frames, origin=np.ones((3, 2))),
        hashed(frames + np.uint16(1)),
    ]
    assert len({base, *others}) == 7


def test_a_key_depends_on_each_of_its_parts():
    preset = fake_atlas.Diodes()

    def of(implementation, build):
        key = content_key.implementation_key(implementation, build or implementation)
        return content_key.digest(key)

    def key(*, preset=preset, condition="quiet", data="d", extractor=None, model=None, seed=1):
        return content_key.cell_key(
            content_key.data_specification(preset, condition),
            data,
            of(fake_atlas.Currents, extractor),
            of(fake_atlas.LeastSquares, model),
            seed,
        )

    keys = [
        key(),
        key(preset=replace(preset, version=2)),
        key(preset=replace(preset, seed=8)),
        key(condition="noisy"),
        key(data="e"),
        key(extractor=lambda: fake_atlas.Currents(gain=2.0)),
        key(model=lambda: fake_atlas.LeastSquares(normals=((0.0, 0.0, 1.0),))),
        key(seed=2),
    ]
    assert len(set(keys)) == len(keys)
    assert all(len(key) == 32 for key in keys)
    assert key() == keys[0]


def test_metric_and_harness_versions_are_part_of_the_key(monkeypatch):
    def key():
        return content_key.cell_key("s", "d", "e", "m", 1)

    keys = {key()}
    for name in ("METRIC_VERSION", "HARNESS_VERSION", "SCHEMA_VERSION"):
        monkeypatch.setattr(content_key, name, 99)
        keys.add(key())
    assert len(keys) == 4


def test_seeds_come_from_names():
    assert content_key.seed("a", "bc") != content_key.seed("ab", "c")
    assert 0 <= content_key.seed("a") < 2**31

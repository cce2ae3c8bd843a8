"""What changes a digest, and what does not."""

import os
import sys
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from types import SimpleNamespace

import fake_atlas
import numpy as np
import pytest

from benchmark.canonical import canonical_json, digest
from benchmark.datasets import corrected
from benchmark.datasets.samples import HEAD, head_hash, samples_hash
from benchmark.results.closure import closure_digest
from benchmark.results.definitions import ClosureError, analyse
from benchmark.results.digests import (
    condition_digests,
    entries_of,
    method_digest,
    series_digest,
)


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


def write(path: Path, text: str) -> None:
    """Write a file that is newer than it was, however coarse the file system's clock."""
    before = path.stat().st_mtime_ns if path.exists() else 0
    path.write_text(text)
    after = max(path.stat().st_mtime_ns, before + 1_000_000)
    os.utime(path, ns=(after, after))


def syntax_digest(path: Path) -> str:
    return repr(analyse(path.read_bytes(), str(path)))


def rewrite(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    write(path, text.replace(old, new))


def test_numbers_that_differ_in_type_or_value_are_different_code(tmp_path):
    digests = set()
    for index, text in enumerate(["x = 1", "x = 1.0", "x = '1'", "x = True", "x = 2", "y = 1"]):
        path = tmp_path / f"m{index}.py"
        path.write_text(text)
        digests.add(syntax_digest(path))
    assert len(digests) == 6


DIFFERENT = [
    "def f(a, b):\n    return a + b",
    "def f(a, b):\n    return a - b",
    "def f(b, a):\n    return a + b",
    "def f(a, b=0):\n    return a + b",
    "def f(a, *, b):\n    return a + b",
    "async def f(a, b):\n    return a + b",
    "def f(a, b):\n    return\n    a + b",
    "def f(a, b):\n    if a:\n        b\n    return a + b",
    "def f(a, b):\n    if a:\n        b\n        return a + b",
    "def f(a, b):\n    if a:\n        'no docstring'\n        b\n    return a + b",
    "def f(a, b):\n    return (a, b)",
    "def f(a, b):\n    return [a, b]",
    "def f(a, b):\n    return f'{a}{b}'",
    "def f(a, b):\n    return f'{a!r}{b}'",
    "def f(a, b):\n    return 'a', 'b'",
    "def f(a, b):\n    return 'ab'",
    "def f(a, b):\n    return b'ab'",
    "@g\ndef f(a, b):\n    return a + b",
    "x = 1\n'text'",
]


def test_code_that_does_something_else_has_another_digest(tmp_path):
    """Another branch, another order of arguments, a string that is no docstring."""
    found = set()
    for index, text in enumerate(DIFFERENT):
        (tmp_path / f"m{index}.py").write_text(text + "\n")
        found.add(syntax_digest(tmp_path / f"m{index}.py"))
    assert len(found) == len(DIFFERENT)


@pytest.mark.parametrize(
    "text",
    [
        '"""Says what it does."""\n\n\ndef f(a, b):\n    return a + b\n',
        'def f(a, b):\n    """Add."""\n    return a + b  # the sum\n',
        "def f(\n    a,\n    b,\n):\n\n    return (\n        a\n        + b\n    )\n",
        "# -*- coding: utf-8 -*-\n# of 2024\n\n\ndef f(a,b):\n  return a+b",
        "def f(a, b):\r\n    return a + b\r\n",
    ],
)
def test_what_only_people_read_is_no_code(tmp_path, text):
    (tmp_path / "plain.py").write_text("def f(a, b):\n    return a + b\n")
    (tmp_path / "other.py").write_bytes(text.encode())
    assert syntax_digest(tmp_path / "other.py") == syntax_digest(tmp_path / "plain.py")


def test_a_file_that_is_no_python_is_named(tmp_path):
    (tmp_path / "broken.py").write_text("def f(:\n")
    with pytest.raises(ClosureError, match=r"broken\.py cannot be parsed"):
        syntax_digest(tmp_path / "broken.py")


class Colour(Enum):
    RED = "red"


@dataclass(frozen=True)
class Inner:
    b: tuple[float, ...] = (1.0,)


def test_canonical_json_has_one_spelling():
    value = {"b": Inner((0.1 + 0.2, np.float32(2.0))), "a": {3, 1}, "c": Colour.RED, "d": None}
    assert canonical_json(value) == '{"a":[1,3],"b":{"b":[0.3,2.0]},"c":"red","d":null}'
    assert digest(value) == digest(dict(reversed(value.items())))


def test_arrays_enter_with_their_type_and_non_finite_numbers_by_name():
    assert digest(np.array([1, 2])) != digest(np.array([1.0, 2.0]))
    assert canonical_json([float("inf"), float("nan")]) == '["inf","nan"]'


def test_a_value_without_spelling_is_refused():
    with pytest.raises(TypeError, match="object has no canonical spelling"):
        canonical_json({"a": object()})


def test_the_data_hash_sees_every_array_its_shape_and_type_but_not_its_memory_layout():
    sun = np.eye(3)
    frames = np.arange(24, dtype=np.uint16).reshape(3, 2, 4)

    def hashed(observations, sun=sun, origin=None):
        return samples_hash(SimpleNamespace(observations=observations, sun=sun, origin_px=origin))

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


def samples(count=6, **changed):
    rng = np.random.default_rng(3)
    arrays = {
        "observations": rng.integers(0, 99, (count, 4)),
        "sun": rng.random((count, 3)),
        "origin_px": rng.random((count, 2)),
        "context": {"albedo": rng.random(count)},
    }
    return SimpleNamespace(**{**arrays, **changed})


def test_the_hash_of_the_head_is_that_of_the_first_samples_alone():
    whole = samples()
    cut = {name: getattr(whole, name)[:HEAD] for name in ("observations", "sun", "origin_px")}
    head = SimpleNamespace(**cut, context={"albedo": whole.context["albedo"][:HEAD]})
    assert head_hash(whole) == samples_hash(head) == head_hash(head)
    assert head_hash(whole) != samples_hash(whole)


@pytest.mark.parametrize("name", ["observations", "sun", "origin_px", "context"])
@pytest.mark.parametrize(("place", "in_head"), [(0, True), (HEAD - 1, True), (HEAD, False)])
def test_the_head_sees_its_own_samples_and_the_whole_sees_all(name, place, in_head):
    whole, other = samples(), samples()
    array = other.context["albedo"] if name == "context" else getattr(other, name)
    array[place] += 1
    assert samples_hash(other) != samples_hash(whole)
    assert (head_hash(other) != head_hash(whole)) is in_head


def data_digest(preset) -> str:
    """Of its first condition."""
    return next(iter(condition_digests(preset).values()))


def test_a_condition_s_digest_depends_on_its_own_parameters_and_those_of_its_references(
    monkeypatch,
):
    """Readings are corrected by those of the first condition whose detector is theirs."""
    before = condition_digests(fake_atlas.Diodes())
    assert list(before) == list(fake_atlas.Diodes().conditions) == ["quiet", "noisy"]
    monkeypatch.setattr(corrected, "reference_condition", lambda *_: "quiet")
    before = condition_digests(fake_atlas.Diodes())
    parameters = fake_atlas.Diodes.parameters
    for changed, expected in (("noisy", ["noisy"]), ("quiet", ["quiet", "noisy"])):

        def moved(self, condition, changed=changed):
            more = {"more": 1} if condition == changed else {}
            return {**parameters(self, condition), **more}

        with monkeypatch.context() as patch:
            patch.setattr(fake_atlas.Diodes, "parameters", moved)
            after = condition_digests(fake_atlas.Diodes())
        assert [name for name in before if after[name] != before[name]] == expected


def test_a_data_set_s_digest_depends_on_version_parameters_conditions_and_name():
    preset = fake_atlas.Diodes()
    others = [
        replace(preset, version=2),
        replace(preset, seed=8),
        replace(preset, name="fake-other"),
    ]
    found = {data_digest(one) for one in (preset, *others)}
    assert len(found) == 1 + len(others)
    assert data_digest(fake_atlas.Diodes()) == data_digest(preset)
    fewer = condition_digests(replace(preset, conditions=("quiet",)))
    assert fewer == {"quiet": data_digest(preset)}
    assert {len(one) for one in found} == {16}


def test_a_version_counts_though_the_parameters_do_not_tell_it(monkeypatch):
    monkeypatch.setattr(fake_atlas.Diodes, "parameters", lambda self, condition: {})
    found = {data_digest(fake_atlas.Diodes(version=version)) for version in (1, 2)}
    assert len(found) == 2


def test_a_data_set_s_digest_depends_on_the_code_of_all_it_is_made_of(plug_in):
    """A part that is a plug-in's: its module is read, though the preset's own has not changed."""
    part = plug_in / "deep" / "leaf.py"
    write(part, "from dataclasses import dataclass\n\n\n@dataclass(frozen=True)\nclass Part:\n"
                "    passes: int = 4\n")  # fmt: skip
    from plugin_pkg.deep.leaf import Part

    preset = replace(fake_atlas.Diodes(), repeats=Part())
    assert "plugin_pkg.deep.leaf:Part" in entries_of(preset)
    for repeats in ({"x": Part()}, [Part()], (1, {"y": ("z", Part())}), {"x": write, "y": Part()}):
        held = entries_of(replace(fake_atlas.Diodes(), repeats=repeats))
        assert set(held) >= {"fake_atlas:Diodes", "plugin_pkg.deep.leaf:Part"}
    assert f"{write.__module__}:write" in held, "a function's too"
    before = data_digest(preset)
    rewrite(part, "passes: int = 4", "passes: int = 4  # a comment")
    assert data_digest(preset) == before
    rewrite(part, "passes: int = 4", "passes: int = 5")
    assert data_digest(preset) != before


def test_a_method_s_digest_depends_on_its_name_version_and_code(plug_in):
    method = fake_atlas.Currents
    same = {"__module__": "fake_atlas", "__qualname__": "Currents"}
    others = [
        fake_atlas.Gaps,
        type("Newer", (method,), {"about": replace(method.about, version=2), **same}),
        type("Elsewhere", (method,), {"__module__": "plugin_pkg.top"}),  # all of the module
    ]
    found = {method_digest(one) for one in (method, *others)}
    assert len(found) == 1 + len(others)
    assert method_digest(type("Same", (method,), same)) == method_digest(method)
    elsewhere = others[-1]
    before = method_digest(elsewhere)
    rewrite(plug_in / "far.py", "value = 3", "value = 4")
    assert method_digest(elsewhere) != before


def test_several_modules_have_one_digest_of_what_they_reach(plug_in):
    one = closure_digest("plugin_pkg.top")
    assert closure_digest("plugin_pkg.top", "plugin_pkg.lazy") == one, "reached already"
    assert closure_digest("plugin_pkg.top", "plugin_pkg.unrelated") != one


def test_a_series_digest_depends_on_what_it_holds_and_on_the_code_of_that(plug_in):
    """A camera that is handed in is not among the modules that the series' own imports."""
    part = plug_in / "deep" / "leaf.py"
    write(part, "from dataclasses import dataclass\n\n\n@dataclass(frozen=True)\nclass Part:\n"
                "    passes: int = 4\n\n    def twice(self):\n        return 2\n")  # fmt: skip
    from plugin_pkg.deep.leaf import Part

    before = series_digest(Inner((Part(),)))
    assert series_digest(Inner((Part(),))) == before
    assert series_digest(Inner((Part(5),))) != before
    rewrite(part, "return 2", "return 3")
    assert series_digest(Inner((Part(),))) != before

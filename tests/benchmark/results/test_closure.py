"""Which code a digest is of: what is reached moves it, and nothing else does."""

import importlib
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmark.plan.parts import installed_parts
from benchmark.results import analyses
from benchmark.results.analyses import Analyses
from benchmark.results.closure import (
    FIRST_PARTY,
    ClosureError,
    Sources,
    closure_digest,
    reachable_definitions,
)
from benchmark.results.definitions import analyse
from benchmark.results.digests import entries_of, method_entries

ROOT = Path(__file__).parents[3]


@pytest.fixture
def plug_in(tmp_path, monkeypatch):
    """Return a function that writes a package outside the project: texts by module."""

    def write(**modules):
        package = tmp_path / "plugged_pkg"
        package.mkdir(exist_ok=True)
        for name, text in {"__init__": "", **modules}.items():
            path = package.joinpath(*name.split("__of__")[::-1]).with_suffix(".py")
            path.parent.mkdir(exist_ok=True)
            path.write_text(text)
        importlib.invalidate_caches()

    monkeypatch.syspath_prepend(tmp_path)
    return write


def digest(entry="top:work"):
    return Sources(Analyses()).digest(f"plugged_pkg.{entry}")


TOP = (
    "from plugged_pkg.other import used, Thing\n\nUNUSED = 1\n\ndef idle():\n    return UNUSED\n\n"
)
OTHER = (
    "import math\nfrom dataclasses import dataclass\n\nSCALE = 2.0\nIDLE = 3\n\n"
    "def used(x):\n    return _inner(x) * SCALE\n\ndef _inner(x):\n    return math.sin(x)\n\n"
    "def idle(x):\n    return x + IDLE\n\n"
    "class Base:\n    def of_base(self):\n        return 4\n\n"
    "def half():\n    return 0.5\n\nFACTOR = 7\n\n"
    "@dataclass\nclass Thing(Base):\n    share: float = half()\n\n"
    "    def method(self):\n        return FACTOR\n"
)


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("other", "IDLE = 3", "IDLE = 4"),
        ("other", "return x + IDLE", "return x - IDLE"),
        ("other", "IDLE = 3", "IDLE = 3\nNEW = 5"),
        ("other", "def idle(x)", "def renamed(x)"),
        ("other", "SCALE = 2.0\nIDLE = 3", "IDLE = 3\nSCALE = 2.0"),
        ("other", "import math\n", "import math\nimport os\n"),
        ("other", "_inner(x) * SCALE", "_inner(x) * (SCALE)"),
        ("top", "UNUSED = 1", "UNUSED = 2"),
        ("top", "return UNUSED", "return UNUSED + 1"),
        ("top", "def work():", 'def work():\n    """Work."""'),
        ("top", "def idle():", "import plugged_pkg.third\ndef idle():"),
    ],
)
def test_what_is_not_reached_does_not_change_a_digest(plug_in, module, old, new):
    texts = {"top": f"{TOP}def work():\n    return used(1), Thing()\n", "other": OTHER}
    plug_in(third="VALUE = 1\n", **texts)
    before = digest()
    assert old in texts[module]
    plug_in(**{module: texts[module].replace(old, new)})
    assert digest() == before


@pytest.mark.parametrize(
    ("module", "old", "new"),
    [
        ("top", "used(1)", "used(2)"),
        ("other", "SCALE = 2.0", "SCALE = 2.5"),
        ("other", "SCALE = 2.0", "SCALE = 2.0\nSCALE += 1"),
        ("other", "SCALE = 2.0", "SCALE = 2.0\nSCALE = 3.0"),
        ("other", "math.sin(x)", "math.cos(x)"),
        ("other", "import math", "import cmath as math"),
        ("other", "return 4", "return 5"),
        ("other", "(Base)", "(object)"),
        ("other", "return 0.5", "return 0.25"),
        ("other", "FACTOR = 7", "FACTOR = 8"),
        ("other", "@dataclass", "@dataclass(frozen=True)"),
        ("other", "IDLE = 3", "IDLE = 3\nprint(IDLE)"),
        ("other", "IDLE = 3", "IDLE = 3\nfor _ in ():\n    pass"),
        ("other", "IDLE = 3", "IDLE = 3\nBase.of_base = half"),
        ("other", "def idle(x)", "@half\ndef idle(x)"),
        ("other", "import math\n", "import math\nimport plugged_pkg.loud\n"),
        ("other", "class Base:", "class Base(metaclass=half):"),
        ("__init__", "", "print()\n"),
    ],
)
def test_what_is_reached_changes_a_digest(plug_in, module, old, new):
    texts = {
        "top": f"{TOP}def work():\n    return used(1), Thing()\n",
        "other": OTHER,
        "__init__": "",
    }
    plug_in(loud="print()\n", **texts)
    before = digest()
    assert old in texts[module]
    plug_in(**{module: texts[module].replace(old, new, 1)})
    assert digest() != before


#: Ways to reach ``far.value``, by the texts of modules on the way.
WAYS = {
    "import": {"top": "from plugged_pkg.far import value\ndef work():\n    return value\n"},
    "renamed": {"top": "from plugged_pkg.far import value as v\ndef work():\n    return v\n"},
    "relative": {"top": "from .far import value\ndef work():\n    return value\n"},
    "attribute": {"top": "from plugged_pkg import far\ndef work():\n    return far.value\n"},
    "alias": {"top": "import plugged_pkg.far as f\ndef work():\n    return f.value\n"},
    "dotted": {"top": "import plugged_pkg.far\ndef work():\n    return plugged_pkg.far.value\n"},
    "in a function": {"top": "def work():\n    from .far import value\n    return value\n"},
    "module in a function": {"top": "def work():\n    from . import far\n    return far.value\n"},
    "in a closure": {
        "top": "def work():\n    import plugged_pkg.far as f\n    return lambda: f.value\n"
    },
    "star": {"top": "from .far import *\ndef work():\n    return value\n"},
    "star on star": {
        "top": "from .mid import *\ndef work():\n    return value\n",
        "mid": "from .far import *\n",
    },
    "re-export": {
        "top": "from .sub import value\ndef work():\n    return value\n",
        "__init____of__sub": "from ..far import value\n",
    },
    "re-export of a name that is a module's": {
        "top": "from .sub import far\ndef work():\n    return far\n",
        "__init____of__sub": "from ..far import value as far\n",
        "far__of__sub": "",
    },
    "default": {"top": "from .far import value\ndef work(x=value):\n    return x\n"},
    "lambda": {"top": "from .far import value\nwork = lambda: value\n"},
    "comprehension": {
        "top": "from .far import value\ndef work():\n    return [value for x in range(3)]\n"
    },
    "first iterable": {
        "top": "from .far import value\ndef work():\n    return [value for value in [value]]\n"
    },
    "class": {
        "top": "from .far import value\nclass work:\n    def f(self):\n        return value\n"
    },
    "attribute of a class": {"top": "from .far import value\nclass work:\n    x = value\n"},
    "base": {"top": "from .far import Kind\nclass work(Kind):\n    pass\n"},
    "annotation": {"top": "from .far import Kind\ndef work(x: Kind):\n    return x.f()\n"},
    "for type checkers": {
        "top": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from .far import Kind\n"
        "def work(x: 'int', y: Kind):\n    return y.f()\n"
    },
    "either": {
        "top": "try:\n    from .far import value\nexcept ImportError:\n    value = 1\n"
        "def work():\n    return value\n"
    },
    "global": {
        "top": "from .far import value\nknown = None\ndef work():\n    global known\n"
        "    known = 1\n\nknown = value\n"
    },
    "written into": {
        "top": "from .far import value\nknown = {1: value}\ndef work():\n    known[2] = 3\n"
    },
    "walrus": {"top": "from .far import value\ndef work():\n    return (x := value)\n"},
    "as a value": {"top": "from . import far\ndef work(n):\n    return getattr(far, n)\n"},
    "a computed name of a package": {
        "top": "from . import sub\ndef work(n):\n    return getattr(sub, n)\n",
        "__init____of__sub": "from ..far import value\n",
    },
    "what is not seen": {
        "top": "from .far import made\ndef work():\n    return made\n",
    },
    "globals": {
        "top": "from .far import value\nx = value\ndef work(n):\n    return globals()[n]\n"
    },
    "import_module": {
        "top": "from importlib import import_module\ndef work():\n"
        "    return import_module('plugged_pkg.far').value\n"
    },
    "effect": {"top": "from .far import value\nprint(value)\ndef work():\n    return 1\n"},
    "effect of what is imported": {
        "top": "from . import mid\ndef work():\n    return 1\n",
        "mid": "from .far import value\nvalue.append(1)\n",
    },
    "with": {"top": "from .far import value\nwith value as work:\n    pass\n"},
    "match": {
        "top": "from .far import Kind\ndef work(x):\n    match x:\n        case Kind():\n"
        "            return 1\n"
    },
    "a type": {"top": "from .far import value\nclass work:\n    value: int = value\n"},
}
FAR = "value = {0}\nKind = type('Kind', (), {{'f': lambda self: {0}}})\n"


@pytest.mark.parametrize("way", WAYS)
def test_every_way_to_a_name_is_followed(plug_in, way):
    plug_in(far=FAR.format(1), **WAYS[way])
    before = digest()
    plug_in(far=FAR.format(2))
    assert digest() != before


def test_local_names_are_not_those_of_the_module(plug_in):
    text = (
        "from .far import value\n\n"
        "def work(value, *rest, **named):\n    return [value for x in rest]\n\n"
        "def loop():\n    for value in range(3):\n        pass\n    return value\n\n"
        "def inner():\n    def value():\n        return 1\n    return value()\n\n"
        "def caught():\n    try:\n        pass\n    except OSError as value:\n"
        "        return value\n\n"
        "class Own:\n    value: int = 3\n"
    )
    plug_in(far="value = 1\n", top=text)
    names = ("work", "loop", "inner", "caught", "Own")
    before = [digest(f"top:{name}") for name in names]
    plug_in(far="value = 2\n")
    assert [digest(f"top:{name}") for name in names] == before
    assert reachable_definitions("plugged_pkg.top:work") == ("plugged_pkg.top:work",)


def test_an_entry_is_a_name_or_a_whole_module(plug_in):
    plug_in(top="from .far import other\nx = 1\n\ndef work():\n    return 2\n", far="other = 3\n")
    assert digest("top:work.__call__") == digest("top:work") != digest("top")
    assert digest("top:<lambda>") == digest("top:nobody") == digest("top")
    assert set(reachable_definitions("plugged_pkg.top")) == {
        f"plugged_pkg.{name}" for name in ("top:work", "top:x", "top:other", "far:other")
    }
    assert "plugged_pkg" not in sys.modules, "nothing is imported to find out"
    with pytest.raises(ClosureError, match="nowhere_at_all"):
        closure_digest("nowhere_at_all.module:name")


@given(
    calls=st.lists(st.sets(st.integers(0, 7), max_size=3), min_size=8, max_size=8),
    changed=st.integers(0, 7),
)
def test_a_digest_moves_just_where_the_call_graph_reaches(tmp_path_factory, calls, changed):
    """Eight functions in three modules that call each other at random."""
    folder = tmp_path_factory.mktemp("graph")
    package = f"graph_{folder.name.replace('-', '_')}"
    (folder / package).mkdir()

    def write(values):
        for module in range(3):
            text = "".join(
                f"def f{number}():\n    x = {values[number]}\n"
                + "".join(
                    f"    from {package}.m{other % 3} import f{other}\n    f{other}()\n"
                    if (number + other) % 2
                    else f"    m{other % 3}.f{other}()\n"
                    for other in sorted(calls[number])
                )
                for number in range(8)
                if number % 3 == module
            )
            imports = "".join(f"from {package} import m{one}\n" for one in range(3))
            (folder / package / f"m{module}.py").write_text(imports + text)

    there, waiting = set(), [0]
    while waiting:
        one = waiting.pop()
        if one not in there:
            there.add(one)
            waiting += calls[one]
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(folder)
        (folder / package / "__init__.py").write_text("")
        write([1] * 8)
        before = Sources(Analyses()).digest(f"{package}.m0:f0")
        write([2 if number == changed else 1 for number in range(8)])
        moved = Sources(Analyses()).digest(f"{package}.m0:f0") != before
    assert moved == (changed in there)


class Edited(Analyses):
    """Analyses of files, in one of which some text is another."""

    def __init__(self, file: str, old: str, new: str) -> None:
        super().__init__()
        text = (ROOT / file).read_text()
        assert text.count(old) == 1, (file, old)
        self._edited = ROOT / file, analyse(text.replace(old, new).encode(), file)

    def of(self, path):
        edited, found = self._edited
        return found if path == edited else Analyses.of_user().of(path)


SCORE = "benchmark/metrics/score.py"
CENTROID = "algorithms/extractors/frames/centroid.py"
#: File, text in it, text in its place; of all components, those whose digest moves.
EDITS = [
    (SCORE, "\nAVAILABLE = 0.95", "\nAVAILABLE = 0.96", set()),
    (SCORE, "\n_UNIT_TOLERANCE = 1e-6", "\n_UNIT_TOLERANCE = 2e-6", {"score"}),
    (CENTROID, "\n_DEVIATIONS = 6.0", "\n_DEVIATIONS = 5.0", {"bctm", "bctm-profile"}),
    ("algorithms/extractors/frames/balance_kernel.py", "_HALF = 10", "_HALF = 9", {"dbcm"}),
]


@pytest.fixture(scope="module")
def components():
    """Entries of all components, by name, and of the score."""
    parts = installed_parts()
    found = {name: method_entries(one) for name, one in parts.extractors.items()}
    found |= {name: method_entries(one) for name, one in parts.models.items()}
    found |= {name: entries_of(one) for name, one in parts.presets.items()}
    return {**found, "score": ("benchmark.metrics.score:score",)}


def digests_of(components, known):
    sources = Sources(known)
    return {name: sources.digest(*entries) for name, entries in components.items()}


@pytest.fixture(scope="module")
def as_they_are(components):
    return digests_of(components, Analyses.of_user())


@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_of_the_tree_moves_the_digests_of_what_uses_it(components, as_they_are, edit):
    after = digests_of(components, Edited(*edit[:-1]))
    assert {name for name in components if after[name] != as_they_are[name]} == edit[-1]


def test_the_tree_registers_nothing_where_the_closure_cannot_see_it():
    """What is not followed is not done: no class collects its subclasses."""
    for top in set(FIRST_PARTY) - {"api"}:
        for path in (ROOT / top).rglob("*.py"):
            assert "def __init_subclass__" not in path.read_text(), path


def test_few_modules_are_taken_whole(components):
    sources = Sources()
    for name, one in components.items():
        whole = {module for module, what in sources.walk(one) if what == "*"}
        kernels = "algorithms.extractors.frames.mirror."
        assert all(m.startswith(kernels) or m == "algorithms.kernels.moments" for m in whole), name


def test_analyses_are_kept_between_processes_and_made_again_where_a_file_changed(
    tmp_path, monkeypatch
):
    source, file = tmp_path / "m.py", tmp_path / "cache" / "definitions"
    source.write_text("x = 1\n")
    made = []
    monkeypatch.setattr(analyses, "analyse", lambda *of: made.append(of) or analyse(*of))
    first = Analyses(file)
    found = first.of(source)
    first.keep()
    assert Analyses(file).of(source) == found
    assert len(made) == 1
    source.write_text("x = 12\n")
    assert Analyses(file).of(source) != found
    assert len(made) == 2


def test_a_damaged_file_of_analyses_is_no_file(tmp_path):
    source, file = tmp_path / "m.py", tmp_path / "definitions"
    source.write_text("x = 1\n")
    first = Analyses(file)
    found = first.of(source)
    first.keep()
    kept = file.read_bytes()
    for damaged in (b"", kept[:-1], kept[:20], kept.replace(b"x", b"y"), b"{}"):
        file.write_bytes(damaged)
        assert Analyses(file).of(source) == found


def test_analyses_are_written_where_any_was_made_alone(tmp_path):
    source, file = tmp_path / "m.py", tmp_path / "definitions"
    source.write_text("x = 1\n")
    Analyses(file).keep()
    assert not file.exists()
    first = Analyses(file)
    found = first.of(source)
    first.keep()
    file.unlink()
    first.keep()
    assert not file.exists(), "it is written already"
    assert first.of(source) == found

"""Discovery finds each implementation once, complains of broken ones, and loads nothing heavy."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import algorithms
from algorithms.contract import Extractor
from algorithms.discovery import discover_extractors, discover_models, implementations

GOOD = """
from dataclasses import dataclass
from typing import ClassVar

@dataclass(frozen=True)
class {cls}:
    name: ClassVar[str] = "{name}"
    taxonomy: ClassVar[str] = "BCM"
    studies: ClassVar[tuple] = ()
    labels: ClassVar[tuple] = ()
    origin: ClassVar[str] = "ours"
    version: ClassVar[int] = 1
    observation: ClassVar[str] = "frames"
    kind: ClassVar[str] = "spot"
    needs: ClassVar[tuple] = ()
    features = ("x_px", "y_px")

    @classmethod
    def for_sensor(cls, geometry):
        return cls()

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


def test_the_first_set_is_found():
    assert {"direct", "voltage-balance", "bcm", "bctm", "ifm", "pm"} <= set(discover_extractors())
    assert {
        "lut",
        "lut-polynomial",
        "linear",
        "polynomial-1d",
        "polynomial-2d",
        "spm",
        "lsq",
        "basic",
    } <= set(discover_models())


def test_names_are_keys_and_sorted():
    for found in (discover_extractors(), discover_models()):
        assert list(found) == sorted(found)
        assert all(cls.name == name for name, cls in found.items())


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


def test_missing_metadata_is_named(package):
    folder, load = package
    text = GOOD.format(cls="One", name="one").replace("    version: ClassVar[int] = 1\n", "")
    (folder / "one.py").write_text(text)
    with pytest.raises(TypeError, match=r"one\.One lacks version"):
        implementations(load(), Extractor, "extract")


def test_a_class_that_is_no_dataclass_is_refused(package):
    folder, load = package
    text = GOOD.format(cls="One", name="one").replace("@dataclass(frozen=True)", "")
    (folder / "one.py").write_text(text)
    with pytest.raises(TypeError, match="dataclass"):
        implementations(load(), Extractor, "extract")


def test_finding_everything_loads_no_numerics_but_numpy():
    code = (
        "import sys\n"
        "from algorithms.discovery import discover_extractors, discover_models\n"
        "assert discover_extractors() and discover_models()\n"
        "heavy = {'numba', 'scipy', 'cv2', 'pandas', 'plotly'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    root = Path(algorithms.__file__).parent.parent
    subprocess.run([sys.executable, "-c", code], check=True, cwd=root, timeout=600)

"""A changed module re-runs the cells that import it and no others, a comment none: in a copy."""

from __future__ import annotations

import csv
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from benchmark.results.store import PUBLISHED

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
FLOORS = ("files", "survey_data", "registry", "algorithms", "calibrate", "benchmark", "api")

#: Which implementations load a module: asked of Python's own imports, one after another.
REACHING = """
import importlib, json, sys
from algorithms.discovery import discover_chains, discover_extractors

modules = {name: [one.__module__] for name, one in discover_extractors().items()}
for name, model in discover_chains().items():
    modules[name] = [one.__module__ for one in getattr(model, "stages", [model])]

def loaded(name):
    for known in [one for one in sys.modules if one.partition(".")[0] == "algorithms"]:
        del sys.modules[known]
    importlib.import_module(name)
    return set(sys.modules)

there = {one: loaded(one) for one in {one for some in modules.values() for one in some}}
print(json.dumps([name for name, some in modules.items()
                  if any(sys.argv[1] in there[one] for one in some)]))
"""


def run(arguments: list[str], tree: Path, store: Path) -> str:
    environment = os.environ | {"PYTHONPATH": str(tree), "SUNATLAS_STORE": str(store)}
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=tree,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    tree = tmp_path_factory.mktemp("tree")
    left_out = shutil.ignore_patterns("*.nb?", "*.tmp.*", ".sunatlas")
    for floor in FLOORS:
        shutil.copytree(ROOT / floor, tree / floor, ignore=left_out)
    return tree


def planned(tree: Path, store: Path) -> dict[tuple[str, ...], str]:
    """Reasons by cell, of the suite of all that is published."""
    arguments = ["-m", "api.cli.command_line", "plan", "--suite", "standard", "--format", "json"]
    found = json.loads(run(arguments, tree, store))
    assert found["planned"] == len(published()) > 8000
    names = ("dataset", "condition", "extractor", "model", "unit")
    return {tuple(str(row[name]) for name in names): row["why"] for row in found["missing"]}


def published() -> list[tuple[str, ...]]:
    """Cells of the committed files, read without the code that reads them."""
    found = []
    for path in sorted((PUBLISHED / "scores").glob("*.csv")):
        with path.open() as file:
            rows = csv.DictReader(file)
            names = ("condition", "extractor", "model", "unit")
            found += [(path.stem, *(row[name] for name in names)) for row in rows]
    return found


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        (("extractors/profiles/spot_spectra.py", "1.2196699}", "1.2196698}"), "extractor"),
        (("compensations/electronics/angular_loss.py", "ROUNDS = 20", "ROUNDS = 21"), "model"),
    ],
)
def test_a_changed_line_plans_the_cells_that_import_it(
    tree: Path, tmp_path: Path, change: tuple[str, str, str], kind: str
) -> None:
    file, constant, changed = change
    path = tree / "algorithms" / file
    before = path.read_text()
    assert before.count(constant) == 1
    path.write_text(before.replace(constant, changed))
    try:
        found = planned(tree, tmp_path)
    finally:
        path.write_text(before)
    module = f"algorithms.{file.removesuffix('.py').replace('/', '.')}"
    reaching = set(json.loads(run(["-c", REACHING, module], tree, tmp_path)))
    assert len(reaching) > 1, "several share it"
    place = 2 if kind == "extractor" else 3
    expected = [cell for cell in published() if cell[place] in reaching]
    assert 0 < len(expected) < len(published()) / 2
    assert sorted(found) == sorted(expected)
    assert set(found.values()) == {f"{kind} {cell[place]} changed" for cell in expected}


def test_comments_and_docstrings_plan_nothing_and_nor_does_a_face(
    tree: Path, tmp_path: Path
) -> None:
    """In an algorithm, in what many share, in a data set's sensor and in a stage."""
    with (tree / "api" / "cli" / "measuring.py").open("a") as face:
        face.write("\n\nMORE = 1\n")
    for name in (
        "algorithms/extractors/profiles/spot_spectra.py",
        "algorithms/calibration/calibrated.py",
        "benchmark/simulator/sensors/frames.py",
        "benchmark/running/fitting.py",
    ):
        path = tree / name
        text = path.read_text()
        assert text.startswith('"""')
        changed = text.replace('"""', '"""Other words. ', 1).replace("\n\n", "\n\n# a remark\n\n")
        path.write_text(f"{changed}\n# the end\n")
    assert planned(tree, tmp_path) == {}

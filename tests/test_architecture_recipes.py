"""The recipes of the guide, followed as printed, in a copy of the tree."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
FLOORS = ("files", "survey_data", "registry", "algorithms", "calibrate", "benchmark", "api")
RECIPE = re.compile(r"```python file=(\S+)\n(.*?)```", re.DOTALL)
SUNATLAS = ("-m", "api.cli.command_line")
PAGES = ("add-an-algorithm.md", "add-a-data-set.md")

MEASURE = """
import json, sys
from benchmark import datasets
from benchmark.plan import combinations as plan
from benchmark.running import runner
from benchmark.results.store import Store
from registry.catalogue import catalogue

found = catalogue()
pairs = [("pd-maskless-dodecahedron", "direct", "panoramic"),
         ("pd-maskless-cube", "direct", "basic")]
store = Store(sys.argv[1])
for dataset, extractor, model in pairs:
    runner.run(plan.cells(dataset, "nominal", extractor, model), store)
print(json.dumps({
    "for_value": [c.about.name for c in found.extractors_for("BCM")],
    "datasets": list(datasets.names()),
    "rows": store.rows(),
}))
"""


def printed() -> dict[str, str]:
    """The files that the guide prints, by their paths."""
    pages = [(ROOT / "docs" / "guide" / name).read_text() for name in PAGES]
    files = dict(found for page in pages for found in RECIPE.findall(page))
    assert len(files) == len(PAGES)
    return files


def started(arguments: list[str], tree: Path) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": str(tree), "COLUMNS": "200"}
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=tree,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


def run(arguments: list[str], tree: Path) -> str:
    done = started(arguments, tree)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The floors copied, with the documented files added and nothing else changed."""
    tree = tmp_path_factory.mktemp("tree")
    for floor in FLOORS:
        # With the machine code that is cached beside the sources, finished files of it only:
        # compiling all of it again would take a minute.
        unfinished = shutil.ignore_patterns("*.tmp.*", "*.pyc*")
        shutil.copytree(ROOT / floor, tree / floor, ignore=unfinished)
    shutil.copytree(ROOT / "tests" / "algorithms", tree / "tests" / "algorithms")
    shutil.copyfile(ROOT / "pyproject.toml", tree / "pyproject.toml")
    for name, text in printed().items():
        assert not (tree / name).exists()
        (tree / name).write_text(text)
    return tree


def test_one_file_makes_a_dataset_that_is_measured_and_an_algorithm_is_in_the_catalogue(
    tree: Path,
) -> None:
    answer = json.loads(run(["-c", MEASURE, str(tree / "store")], tree))
    assert "squared-centroid" in answer["for_value"]
    assert "pd-maskless-dodecahedron" in answer["datasets"]
    rows = {(row["dataset"], row["extractor"]): row for row in answer["rows"]}
    twelve = rows["pd-maskless-dodecahedron", "direct"]
    six = rows["pd-maskless-cube", "direct"]
    # a tenth of the light at the same amplifier noise, on twelve faces instead of six
    expected = 10.0 * (6 / 12) ** 0.5
    assert twelve["bound_deg"] / six["bound_deg"] == pytest.approx(expected, rel=0.1)
    assert twelve["status"] == "ok"
    assert 1.0 < twelve["over_bound"] < 3.0


def test_a_dataset_is_one_short_file_in_the_recipe() -> None:
    recipes = printed()
    (dataset,) = (text for name, text in recipes.items() if name.startswith("benchmark/"))
    assert len(dataset.splitlines()) <= 40
    assert "datasets.standard" not in dataset, "a sensor of its own, not another data set's"

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
FLOORS = ("files", "survey_data", "registry", "algorithms", "benchmark", "api")
RECIPE = re.compile(r"```python file=(\S+)\n(.*?)```", re.DOTALL)
PAGES = ("add-an-algorithm.md", "add-a-data-set.md")

MEASURE = """
import json, sys
from benchmark import datasets
from benchmark.plan import combinations as plan
from benchmark.running import run as runner
from benchmark.results.store import Store
from registry.catalogue import catalogue

found = catalogue()
pairs = [("cmos-single-aperture", "squared-centroid", "spm"),
         ("pd-maskless-dodecahedron", "direct", "panoramic"),
         ("pd-maskless-cube", "direct", "basic")]
store = Store(sys.argv[1])
for dataset, extractor, model in pairs:
    runner.run(plan.cells(dataset, "nominal", extractor, model), store)
print(json.dumps({
    "extractor": "squared-centroid" in found.extractors,
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


def run(arguments: list[str], tree: Path) -> str:
    environment = os.environ | {"PYTHONPATH": str(tree)}
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
    """The floors copied, with the documented files added and nothing else changed."""
    tree = tmp_path_factory.mktemp("tree")
    for floor in FLOORS:
        # With the machine code that is cached beside the sources, finished files of it only:
        # compiling all of it again would take a minute.
        unfinished = shutil.ignore_patterns("*.tmp.*", "*.pyc*")
        shutil.copytree(ROOT / floor, tree / floor, ignore=unfinished)
    shutil.copytree(ROOT / "tests" / "algorithms", tree / "tests" / "algorithms")
    for name, text in printed().items():
        assert not (tree / name).exists()
        (tree / name).write_text(text)
    return tree


def test_one_file_makes_an_algorithm_and_one_a_dataset_that_are_measured(tree: Path) -> None:
    answer = json.loads(run(["-c", MEASURE, str(tree / "store")], tree))
    assert answer["extractor"]
    assert "squared-centroid" in answer["for_value"]
    assert "pd-maskless-dodecahedron" in answer["datasets"]
    rows = {(row["dataset"], row["extractor"]): row for row in answer["rows"]}
    centroid = rows["cmos-single-aperture", "squared-centroid"]
    assert centroid["status"] == "ok"
    assert 1.0 < centroid["over_bound"] < 1000.0
    twelve = rows["pd-maskless-dodecahedron", "direct"]
    six = rows["pd-maskless-cube", "direct"]
    # a tenth of the light at the same amplifier noise, on twelve faces instead of six
    expected = 10.0 * (6 / 12) ** 0.5
    assert twelve["bound_deg"] / six["bound_deg"] == pytest.approx(expected, rel=0.1)
    assert twelve["status"] == "ok"
    assert 1.0 < twelve["over_bound"] < 3.0


def test_a_dataset_is_one_short_file_in_the_recipe_and_here() -> None:
    recipes = printed()
    (dataset,) = (text for name, text in recipes.items() if name.startswith("benchmark/"))
    assert len(dataset.splitlines()) <= 40
    assert "datasets.standard" not in dataset, "a sensor of its own, not another data set's"
    standard = ROOT / "benchmark" / "datasets" / "standard"
    lines = {path.name: len(path.read_text().splitlines()) for path in standard.glob("*_*.py")}
    assert len(lines) > 30
    assert {name: count for name, count in lines.items() if count > 45} == {}
    assert sum(count > 40 for count in lines.values()) <= 6


def test_an_algorithm_with_its_docstring_takes_at_most_60_lines() -> None:
    recipes = printed()
    text = recipes["algorithms/extractors/frames/squared_centroid.py"]
    assert "    Examples\n    --------\n    >>> " in text
    assert len(text.splitlines()) <= 60


def test_the_example_of_the_new_algorithm_is_true(tree: Path) -> None:
    code = (
        "import doctest; from algorithms.extractors.frames import squared_centroid;"
        "found = doctest.testmod(squared_centroid); assert found.attempted, found; print(found)"
    )
    assert "failed=0" in run(["-c", code], tree)


def test_the_new_algorithm_passes_the_common_suite(tree: Path) -> None:
    printed = run(
        ["-m", "pytest", "-q", "-p", "no:cacheprovider", "--import-mode=importlib",
         "tests/algorithms/test_common_suite.py", "-k", "squared-centroid"],
        tree,
    )  # fmt: skip
    passed = int(re.search(r"(\d+) passed", printed)[1])
    assert passed >= 10


def test_adding_a_dataset_changes_no_other(tree: Path) -> None:
    digest = (
        "from benchmark import datasets as d;"
        "print(d.samples_hash(d.get('pd-maskless-cube').generate('nominal', 'test')))"
    )
    assert run(["-c", digest], tree) == run(["-c", digest], ROOT)

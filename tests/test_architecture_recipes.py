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


def test_the_one_command_of_the_guide_ends_on_a_board(tree: Path) -> None:
    page = (ROOT / "docs" / "guide" / "add-an-algorithm.md").read_text()
    (command,) = re.findall(r"^\.venv/bin/sunatlas (rank .+)$", page, re.MULTILINE)
    store = str(tree / "ranked")
    done = started([*SUNATLAS, *command.split(), "--store", store], tree)
    assert done.returncode == 0, done.stderr
    assert int(re.search(r"contract: (\d+) checks passed", done.stderr)[1]) >= 20
    assert "12 cells measured now" in done.stderr
    rows = [line.split() for line in done.stdout.splitlines()]
    marked = [row for row in rows if row[:1] == ["*"]]
    assert len(marked) == 12
    assert marked[0][2] == "squared-centroid"
    assert int(marked[0][1]) > 1
    assert any("mirror" in row for row in rows)
    assert re.search(r"\b12 pipelines\b", done.stdout)

    again = started([*SUNATLAS, "rank", "squared-centroid", *command.split()[2:],
                     "--store", store, "--format", "json"], tree)  # fmt: skip
    assert "0 cells measured now" in again.stderr
    items = json.loads(again.stdout)["items"]
    assert sum(item["new"] == "*" for item in items) == 12
    assert len(items) > 200


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("Cost:", "Time:", "Cost: is missing"),
        ("array([[1.1, 1. ]])", "array([[2.1, 1. ]])", "examples"),
        (".clip(min=0))", ".clip(min=0) - 1)", "dark samples are nan rows"),
        ("    def extract", "    def find", "lacks extract of the Extractor"),
        ("import numpy", "import nunpy", "squared_centroid.py, line 6"),
    ],
)
def test_a_broken_rule_is_named_and_nothing_is_measured(tree, old, new, said) -> None:
    path = tree / "algorithms/extractors/frames/squared_centroid.py"
    text = path.read_text()
    assert old in text
    try:
        path.write_text(text.replace(old, new))
        done = started([*SUNATLAS, "rank", str(path), "--dataset", "cmos-single-aperture",
                        "--store", str(tree / "unused")], tree)  # fmt: skip
    finally:
        path.write_text(text)
    assert done.returncode in {1, 2}
    assert done.stdout == ""
    assert said in done.stderr
    assert not (tree / "unused").exists()


def test_adding_a_dataset_changes_no_other(tree: Path) -> None:
    digest = (
        "from benchmark import datasets as d;"
        "print(d.samples_hash(d.get('pd-maskless-cube').generate('nominal', 'test')))"
    )
    assert run(["-c", digest], tree) == run(["-c", digest], ROOT)

"""Imports point down, never in a circle; and the contracts that say so fail when broken."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FLOORS = ("files", "survey_data", "registry", "algorithms", "calibrate", "benchmark", "api")

LINT = "from importlinter.cli import lint_imports_command; lint_imports_command()"
#: Prints the modules of every circle of imports, those inside functions included.
CIRCLES = f"""
import json
import grimp
from scipy.sparse import lil_array
from scipy.sparse.csgraph import connected_components

graph = grimp.build_graph(*{FLOORS}, cache_dir=None)
modules = sorted(graph.modules)
place = {{module: k for k, module in enumerate(modules)}}
imports = lil_array((len(modules), len(modules)), dtype=bool)
for module in modules:
    for imported in graph.find_modules_directly_imported_by(module):
        imports[place[module], place[imported]] = True
_, label = connected_components(imports.tocsr(), connection="strong")
found = {{}}
for module, component in zip(modules, label.tolist()):
    found.setdefault(component, []).append(module)
print(json.dumps([circle for circle in found.values() if len(circle) > 1]))
"""

#: By contract: a file, an import in it that must not be, and the importer and the imported.
OFFENCES = {
    "Floors: imports only point down": [
        ("registry/taxonomy.py", "import benchmark.seeds", "registry", "benchmark"),
    ],
    "Inside the benchmark: imports only point down": [
        ("benchmark/simulator/scene.py", "import benchmark.datasets.card",
         "benchmark.simulator", "benchmark.datasets"),
        ("benchmark/datasets/card.py", "import benchmark.running.task",
         "benchmark.datasets", "benchmark.running"),
        ("benchmark/metrics/rings.py", "import benchmark.datasets.card",
         "benchmark.metrics", "benchmark.datasets"),
    ],
    "Inside the data sets: a family does not know its members": [
        ("benchmark/datasets/conditions/cone.py", "import benchmark.datasets.standard.ccd_slit",
         "benchmark.datasets.conditions", "benchmark.datasets.standard"),
    ],
    "Inside the simulator: imports only point down": [
        ("benchmark/simulator/masks/slits.py", "import benchmark.simulator.sensors.line_sensor",
         "benchmark.simulator.masks", "benchmark.simulator.sensors"),
    ],
    "Inside the outward floor: schema < service < faces": [
        ("api/schema/words.py", "import api.service.problems", "api.schema", "api.service"),
        ("api/service/claims.py", "import api.web.requests", "api.service", "api.web"),
        ("api/pages/claim.py", "import api.http.reference", "api.pages", "api.http"),
        ("api/cli/commands/claims.py", "import api.pages.boards", "api.cli", "api.pages"),
    ],
    "Below the faces nothing knows HTTP": [
        ("api/service/advice.py", "import starlette", "api.service", "starlette"),
    ],
    "Facts carry no scientific stack beyond pandas": [
        ("survey_data/tables.py", "import scipy.stats", "survey_data", "scipy"),
    ],
}  # fmt: skip


def run(code: str, tree: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code],
        cwd=tree,
        env=os.environ | {"PYTHONPATH": str(tree), "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    )


def circles(tree: Path) -> list[list[str]]:
    done = run(CIRCLES, tree)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.fixture(scope="module")
def broken(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The floors copied, with one import for every offence and a circle in two functions."""
    tree = tmp_path_factory.mktemp("tree")
    for floor in FLOORS:
        shutil.copytree(ROOT / floor, tree / floor, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tree)
    for offences in OFFENCES.values():
        for name, statement, _, _ in offences:
            append(tree / name, f"{statement}\n")
    for one, other in (("score", "rings"), ("rings", "score")):
        lazy = f"def _late():\n    from benchmark.metrics import {other}\n    return {other}\n"
        append(tree / "benchmark" / "metrics" / f"{one}.py", lazy)
    return tree


def append(path: Path, text: str) -> None:
    path.write_text(f"{path.read_text()}\n\n{text}")


def test_no_module_imports_in_a_circle() -> None:
    assert circles(ROOT) == []


@pytest.mark.slow
def test_a_circle_through_functions_is_named(broken: Path) -> None:
    assert ["benchmark.metrics.rings", "benchmark.metrics.score"] in [
        [module for module in circle if module.startswith("benchmark.metrics.")]
        for circle in circles(broken)
    ]


def test_every_contract_is_kept() -> None:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    assert {contract["name"] for contract in contracts["contracts"]} == set(OFFENCES)
    here = run(LINT, ROOT)
    assert here.returncode == 0, here.stdout + here.stderr
    assert set(re.findall(r"^(.+) KEPT\b", here.stdout, re.MULTILINE)) == set(OFFENCES)


@pytest.mark.slow
def test_every_contract_fails_when_broken(broken: Path) -> None:
    there = run(LINT, broken)
    assert there.returncode == 1, there.stdout + there.stderr
    assert set(re.findall(r"^(.+) BROKEN\b", there.stdout, re.MULTILINE)) == set(OFFENCES)
    output = " ".join(there.stdout.split())
    for offences in OFFENCES.values():
        for name, statement, importer, imported in offences:
            assert f"{importer} is not allowed to import {imported}" in output, name
            module = name.removesuffix(".py").replace("/", ".")
            assert (
                f"{module} -> {statement.removeprefix('import ').partition('.stats')[0]}" in output
            )

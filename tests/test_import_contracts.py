"""Imports point down, never in a circle; and the contracts that say so fail when broken."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
FLOORS = ("files", "survey_data", "registry", "algorithms", "calibrate", "benchmark", "api")

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


def test_no_module_imports_in_a_circle() -> None:
    assert circles(ROOT) == []

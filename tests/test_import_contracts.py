"""No module imports in a circle; `make lint` checks that imports point down."""

from __future__ import annotations

import json
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


def test_no_module_imports_in_a_circle() -> None:
    command = [sys.executable, "-c", CIRCLES]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == []

"""What the registry loads, and when."""

import subprocess
import sys
from pathlib import Path

import registry

ROOT = Path(registry.__file__).parents[1]
HEAVY = ("scipy", "cv2", "numba", "plotly")


def loaded(code: str) -> set[str]:
    program = f"import sys\n{code}\nprint(*sorted(m for m in sys.modules if '.' not in m))"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    return set(done.stdout.split())


def test_importing_the_registry_loads_no_table_and_no_array_library() -> None:
    modules = ("flows", "requirements", "resolution", "catalogue", "studies")
    found = loaded("\n".join(f"import registry.{name}" for name in modules))
    assert not found & {*HEAVY, "pandas", "numpy"}


def test_answers_from_the_facts_load_no_scientific_stack() -> None:
    found = loaded(
        "from registry.recommendation import recommend\n"
        "from registry.flows import chart\n"
        "recommend({'task': 'Accuracy'})\n"
        "chart('error')"
    )
    assert not found & set(HEAVY)

"""What is imported when: the front door opens without the heavy furniture."""

import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("cv2", "scipy", "plotly", "numba", "pandas")
ROOT = Path(__file__).parents[3]


@pytest.mark.slow
@pytest.mark.parametrize(
    "code",
    [
        "import api",
        "import api.server.app",
        "import api.server.app; api.server.app.create_app()",
    ],
)
def test_nothing_heavy_is_loaded_before_it_is_needed(code):
    program = f"{code}\nimport sys\nprint([name for name in {HEAVY} if name in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]"

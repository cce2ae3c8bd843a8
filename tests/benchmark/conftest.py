"""Fixtures shared by the benchmark's tests."""

import sys
from pathlib import Path

FAKES = Path(__file__).parent / "fakes"

# Importable by name, so that worker processes (which inherit sys.path) find the same classes.
if str(FAKES) not in sys.path:
    sys.path.append(str(FAKES))

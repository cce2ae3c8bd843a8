"""Fixtures shared by the benchmark's tests."""

import sys
from pathlib import Path

import pytest

from algorithms.contract import Observation
from benchmark import sweep_plan

FAKES = Path(__file__).parent / "fakes"

# Importable by name, so that worker processes (which inherit sys.path) find the same classes.
if str(FAKES) not in sys.path:
    sys.path.append(str(FAKES))


@pytest.fixture(scope="module")
def readings_only():
    """Sweeps without frames: drawing those costs seconds, and fakes learn nothing from them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweep_plan, "_SERIES_OF", dict.fromkeys(Observation, ()))
        yield

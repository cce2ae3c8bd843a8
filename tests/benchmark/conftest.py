"""Fixtures shared by the benchmark's tests."""

import sys
from pathlib import Path

import pytest

from algorithms.contract import Observation
from benchmark.leaderboard import scope
from benchmark.leaderboard.board import board_of
from benchmark.results.store import PUBLISHED, Store
from benchmark.running import condition_data
from benchmark.sweeps import plan as sweep_plan

FAKES = Path(__file__).parent / "fakes"

# Importable by name, so that worker processes (which inherit sys.path) find the same classes.
if str(FAKES) not in sys.path:
    sys.path.append(str(FAKES))


@pytest.fixture(scope="session")
def published_board():
    """The board of the committed record; to look at, not to change."""
    return board_of(Store(PUBLISHED))


@pytest.fixture(scope="module")
def readings_only():
    """Sweeps without frames, and fakes that no study used: to find that out costs seconds."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scope, "studied_pipelines", lambda _parts: frozenset())
        patch.setattr(sweep_plan, "_SERIES_OF", dict.fromkeys(Observation, ()))
        yield


@pytest.fixture
def log(tmp_path, monkeypatch):
    """Lines of what implementations really did, whichever process did it."""
    path = tmp_path / "log.txt"
    monkeypatch.setenv("FAKE_ATLAS_LOG", str(path))
    condition_data.forget()
    return lambda: path.read_text().splitlines() if path.exists() else []

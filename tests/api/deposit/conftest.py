"""A bundle that is built once, and a copy of one's own."""

from __future__ import annotations

import pickle
import shutil
from fcntl import LOCK_EX, flock
from pathlib import Path

import pytest

from api.deposit.bundle import Bundle, build
from tests.api.deposit import small_bundle

#: Data sets whose samples go into the bundles of tests: one of frames, one of currents.
FRAMES = ("cmos-single-aperture", "pd-slit")


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """A bundle of nearly nothing, which a test may change."""
    return small_bundle.make(tmp_path / "bundle")


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Bundle:
    """A bundle with every table, and samples of two data sets; nobody changes it.

    It takes seconds to build: what one worker has built is there for all.
    """
    run = tmp_path_factory.getbasetemp()
    place = (run if worker_id == "master" else run.parent) / "deposit"
    place.mkdir(exist_ok=True)
    kept = place / "bundle.pickle"
    with (place / "lock").open("w") as lock:
        flock(lock, LOCK_EX)
        if not kept.exists():
            made = build(place / "bundle", frames=FRAMES)
            kept.write_bytes(pickle.dumps(made))
        return pickle.loads(kept.read_bytes())  # type: ignore[no-any-return]


@pytest.fixture
def bundle(built: Bundle, tmp_path: Path) -> Path:
    """A bundle of one's own."""
    return Path(shutil.copytree(built.directory, tmp_path / "bundle"))

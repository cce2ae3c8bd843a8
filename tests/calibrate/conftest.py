"""Puts `bench`, which makes the files, where these tests find it; a camera that many calibrate."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def camera(tmp_path_factory):
    """A calibration by the best of three models."""
    import bench

    from calibrate.calibration import calibrate

    angles = bench.grid(21)
    features = bench.spots(bench.sun_of(angles), 1)
    path = bench.write(
        tmp_path_factory.mktemp("camera") / "camera.csv", bench.HEADER, features, angles
    )
    return calibrate([path], models=("homography", "pinhole", "polynomial-2d"))

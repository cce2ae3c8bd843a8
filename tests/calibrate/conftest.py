"""Puts modules that make files and sensors where tests find them; a camera that many calibrate."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), *(str(HERE / part) for part in ("causes", "flight", "intervals"))]


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

"""What no calibration may accept: readings of chance, mirrored axes, too few poses."""

from __future__ import annotations

import os

import numpy as np
import pytest
from bench import CENTRE, HEADER, grid, spots, sun_of, write

from algorithms.contract import UnusableDataError
from calibrate.calibration import calibrate
from calibrate.readings import readings_of
from calibrate.roles import guess
from calibrate.selection import applicable, geometry_of
from calibrate.table import TableError, read_table

#: Files drawn for the last test, each tried with one model that reads it; 1,000 take long.
DRAWN = int(os.environ.get("SUNATLAS_DRAWN", "100"))
ANGLE_NAMES = ["theta_x_deg", "theta_y_deg"]
FACES = ["xp", "xm", "yp", "ym", "zp", "zm"]
KINDS = {
    "spot": ["x_px", "y_px"],
    "balance": ["balance_x", "balance_y"],
    "quadrants": ["q1", "q2", "q3", "q4"],
    "electrodes": ["x1", "x2", "y1", "y2"],
    "faces": FACES,
    "channels": [f"ch{n}" for n in range(8)],
}


def test_a_drawing_refuses_mirrored_axes_unless_it_may_mirror(tmp_path):
    angles = grid(15)
    mirrored = (spots(sun_of(angles), 1) - CENTRE) * [-1, 1] + CENTRE
    path = write(tmp_path / "mirrored.csv", HEADER, mirrored, angles)
    with pytest.raises(UnusableDataError, match="no model can be calibrated"):
        calibrate([path], models=("spm",))
    assert calibrate([path], models=("spm",), apply=True).chosen.rms_deg < 2.0
    with pytest.raises(UnusableDataError, match="no model no-such"):
        calibrate([path], models=("no-such",))


@pytest.mark.parametrize("count", [3, 4, 6])
def test_fewer_poses_than_terms_are_refused(count, tmp_path):
    angles = np.random.default_rng(count).uniform(-40, 40, (count, 2))
    path = write(tmp_path / "few.csv", HEADER, spots(sun_of(angles), 1), angles)
    with pytest.raises(UnusableDataError):
        calibrate([path], models=("polynomial-2d", "homography", "lut"))


def drawn(directory, seed):
    """A file of readings that have nothing to do with its directions."""
    rng = np.random.default_rng(seed)
    names = list(KINDS.values())[seed % len(KINDS)]
    count = int(rng.integers(30, 150))
    if "balance_x" in names:
        readings = rng.uniform(-0.9, 0.9, (count, 2))
    else:
        readings = rng.uniform(1.0, 1000.0, (count, len(names)))
    angles = rng.uniform(-50, 50, (count, 2))
    return write(directory / f"{seed}.csv", [*names, *ANGLE_NAMES], readings, angles)


@pytest.mark.slow
def test_readings_of_chance_are_accepted_by_no_model(tmp_path):
    accepted = []
    for seed in range(DRAWN):
        path = drawn(tmp_path, seed)
        table = read_table(path)
        settings = guess(table)
        readings = readings_of(table, settings)
        known = list(applicable(readings, geometry_of(readings, settings)))
        model = known[seed // len(KINDS) % len(known)]
        try:
            accepted.append((seed, calibrate([path], models=(model,)).chosen.name))
        except (UnusableDataError, TableError):
            continue
    assert accepted == []

"""Arrays and frames are calibrated as the same readings in a file are."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from algorithms.angles import separation_deg
from calibrate.arrays import CalibratedSensor, calibrate_arrays, calibrate_frame
from calibrate.calibration import calibrate
from tests.calibrate.bench import HEADER, grid, spots, sun_of, write

MODEL = ["homography"]
ANGLES = grid(11, 40.0)
SUN = sun_of(ANGLES)


@pytest.fixture(scope="module")
def sensor() -> CalibratedSensor:
    return calibrate_arrays(spots(SUN, 5), SUN, models=MODEL)


def test_arrays_frame_and_file_give_the_same_model(
    sensor: CalibratedSensor, tmp_path: Path
) -> None:
    read = spots(SUN, 5)
    frame = pd.DataFrame(np.column_stack([read, ANGLES]), columns=HEADER)
    path = write(tmp_path / "bench.csv", HEADER, read, ANGLES)
    directions = [
        sensor.predict(read),
        calibrate_frame(frame, models=MODEL).predict(read),
        calibrate([path], models=MODEL).model.predict(read, {}),
    ]
    for other in directions[1:]:  # the file's cells have six decimals
        assert np.nanmax(separation_deg(directions[0], other)) < 1e-6


def test_the_covariance_is_that_of_new_readings(sensor: CalibratedSensor) -> None:
    """Errors of readings not seen, over what is stated, have a mean square of two axes."""
    inner = sun_of(grid(31, 35.0))
    read = spots(inner, 6)
    found, covariance = sensor.predict(read), sensor.covariance(read)
    known = np.isfinite(found).all(axis=1)
    assert known.mean() > 0.99
    errors, stated = (found - inner)[known], covariance[known]
    assert np.allclose(np.einsum("nij,nj->ni", stated, found[known]), 0.0, atol=1e-12)
    squares = np.einsum("ni,nij,nj->n", errors, np.linalg.pinv(stated, rcond=1e-6), errors)
    assert 1.0 < squares.mean() < 3.0
    assert np.isnan(sensor.covariance(np.array([[1e6, 1e6]]))).all()


def test_changes_of_the_axes_are_part_of_what_is_predicted() -> None:
    swapped = spots(SUN, 7)[:, ::-1]
    found = calibrate_arrays(swapped, SUN, models=MODEL, apply=True)
    assert [one.about for one in found.found.applied] == ["axes"]
    errors = separation_deg(found.predict(swapped), SUN)
    assert np.sqrt(np.nanmean(errors**2)) < 0.02


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: calibrate_arrays(np.zeros(5), SUN), r"readings: expected an array \(N, F\)"),
        (lambda: calibrate_arrays(np.zeros((5, 2)), SUN), r"sun: expected an array \(5, 3\)"),
        (lambda: calibrate_arrays(spots(SUN, 1), SUN, run=[1]), "run: expected an array"),
        (lambda: calibrate_arrays(spots(SUN, 1), SUN, kind="frames"), "kind: expected one of"),
        (lambda: calibrate_arrays(spots(SUN, 1), SUN, kind="quadrants"), "4 columns; got 2"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_by_name(call: Callable[[], object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        call()

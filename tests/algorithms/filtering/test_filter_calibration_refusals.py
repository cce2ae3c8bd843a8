"""Calibrations that do not settle what filters need, and readings that begin no estimate."""

from __future__ import annotations

import numpy as np
import pytest
from kalman_runs import CUBE, SPACES

from algorithms.angles import sun_from_angles
from algorithms.contract import Floats, UnusableDataError
from algorithms.filtering.filter_calibration import FilterCalibration
from algorithms.filtering.filters import ExtendedKalman
from algorithms.filtering.readings import FaceReadings, SpotReadings

NO_FACES = np.empty((0, 3))
SPOT = SPACES["spot"]
TRIED = SPOT.states_towards(
    sun_from_angles(np.array([[a, b] for a in (-40.0, 0.0, 40.0) for b in (-40.0, 0.0, 40.0)]))
)


def sphere(count: int = 400) -> Floats:
    vectors = np.random.default_rng(1).standard_normal((count, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def known_of(sun: Floats, kelvin: Floats) -> Floats:
    """Rates, nadir and temperature (n, 7): the Earth opposite to a direction that turns."""
    nadir = np.roll(sun, 1, axis=0)
    return np.column_stack([np.zeros((len(sun), 3)), nadir, kelvin])


def test_a_face_that_light_darkens_is_refused() -> None:
    sun = sphere()
    signals = 100.0 * np.maximum(sun @ CUBE.T, 0.0)
    known = known_of(sun, 290.0 + np.arange(400.0) % 17)
    assert FaceReadings.from_calibration(CUBE, signals, sun, known, "filter").count == 6
    signals[:, 3] *= -1.0
    with pytest.raises(UnusableDataError, match="every face must be lit, with a positive signal"):
        FaceReadings.from_calibration(CUBE, signals, sun, known, "filter")


def test_suns_in_a_few_places_do_not_settle_what_the_earth_adds() -> None:
    sun = np.repeat(CUBE, 30, axis=0)
    known = known_of(sun, 290.0 + np.arange(180.0) % 17)
    with pytest.raises(UnusableDataError, match="how 6 faces respond and what the Earth adds"):
        FaceReadings.from_calibration(CUBE, 100.0 * np.maximum(sun @ CUBE.T, 0.0), sun, known, "f")


def spots(count: int = 300) -> tuple[Floats, Floats]:
    """Suns (n, 3), and where a pinhole's spot falls (n, 2), px."""
    rng = np.random.default_rng(4)
    sun = sun_from_angles(rng.uniform(-30.0, 30.0, (count, 2)))
    return sun, 50.0 + 200.0 * sun[:, :2] / sun[:, 2:] + 0.01 * rng.standard_normal((count, 2))


def test_a_temperature_that_goes_with_the_angle_is_not_told_from_it() -> None:
    """Up to differences so small that the spots' coefficients would be of rounding."""
    sun, read = spots()
    beta = sun[:, 0] / sun[:, 2]
    apart = np.random.default_rng(5).standard_normal(len(sun))
    known = known_of(sun, beta + 1e-2 * apart)
    assert SpotReadings.from_calibration(read, sun, known, "filter").count == 2
    known = known_of(sun, beta + 3e-10 * apart)
    with pytest.raises(UnusableDataError, match=r"filter: .*do not settle where spots fall"):
        SpotReadings.from_calibration(read, sun, known, "filter")


@pytest.mark.parametrize("step_s", [0.0, -10.0])
def test_samples_that_do_not_follow_each_other_tell_no_noise(step_s: float) -> None:
    sun, read = spots()
    known = known_of(sun, 290.0 + np.arange(300.0) % 17)
    time_s = np.arange(300.0)
    assert FilterCalibration.from_calibration(
        NO_FACES, read, sun, known, 10.0 * time_s, by="filter"
    ).step_s == pytest.approx(10.0)
    with pytest.raises(UnusableDataError, match=r"filter: .*samples must follow each other"):
        FilterCalibration.from_calibration(NO_FACES, read, sun, known, step_s * time_s, by="filter")


@pytest.mark.parametrize(
    "read",
    [(np.nan, np.nan), (50.0 + 100.0 * 300.0, 40.0)],
    ids=["no spot", "a spot of a Sun that is hardly above the horizon"],
)
def test_a_reading_that_no_direction_explains_begins_nothing(read: tuple[float, float]) -> None:
    known = np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    filtering = ExtendedKalman()
    assert SPOT.start_belief(filtering, TRIED, np.array([60.0, 30.0]), known) is not None
    assert SPOT.start_belief(filtering, TRIED, np.array(read), known) is None

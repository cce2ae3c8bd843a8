"""Pyramids in light that all faces see alike, and cells that warm up."""

from __future__ import annotations

import math

import numpy as np
import pytest

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind, SensorGeometry, UnusableDataError
from algorithms.models.geometric.panoramic import WeightedCells
from algorithms.models.geometric.panoramic_temperature import WarmCells
from algorithms.models.geometric.pyramidal import RegularPyramid
from algorithms.models.geometric.pyramidal_constant import SteadyPyramid

FACES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
T_0 = 298.15


def pyramid(count, tilt_deg, first_deg=0.0):
    turn = np.radians(first_deg + 360 / count * np.arange(count))
    tilt = np.radians(tilt_deg)
    flat = np.column_stack([np.cos(turn), np.sin(turn)]) * np.sin(tilt)
    return np.column_stack([flat, np.full(count, np.cos(tilt))])


def as_design(normals):
    return tuple(tuple(row) for row in np.asarray(normals, dtype=float).tolist())


def rings(*offs_deg, step_deg=15):
    off, turn = np.meshgrid(np.radians(offs_deg), np.radians(np.arange(0, 360, step_deg)))
    off, turn = off.ravel(), turn.ravel()
    return np.column_stack([np.sin(off) * np.cos(turn), np.sin(off) * np.sin(turn), np.cos(off)])


def lit(sun, normals):
    return np.maximum(sun @ np.asarray(normals, dtype=float).T, 0.0)


def lattice(count):
    """Normals all around, evenly."""
    step = np.arange(count) + 0.5
    z, turn = 1 - 2 * step / count, np.pi * (3 - np.sqrt(5)) * step
    return np.column_stack(
        [np.sqrt(1 - z * z) * np.cos(turn), np.sqrt(1 - z * z) * np.sin(turn), z]
    )


@pytest.mark.parametrize("count", [3, 9])
@pytest.mark.parametrize("constant", [0.0, 0.2, 1.0])
def test_a_constant_on_all_faces_changes_nothing(count, constant):
    normals, sun = pyramid(count, 30.0, 7.0), rings(5, 20, 40, 55)
    model = SteadyPyramid(as_design(normals)).fit(1.7 * lit(sun, normals) + 0.1, sun)
    found = model.predict(1.7 * lit(sun, normals) + constant)
    assert separation_deg(found, sun).max() < 1e-9
    assert model.coefficient_ == pytest.approx(1 / 1.7)


@pytest.mark.parametrize(("constant", "degrees"), [(0.05, 1.0), (0.2, 4.0)])
def test_three_rows_are_pulled_towards_the_axis_by_it(constant, degrees):
    """What the survey's third row makes of the constant, from Suns with none."""
    normals, sun = pyramid(6, 30.0), rings(5, 20, 40, 55)
    three = RegularPyramid(as_design(normals)).fit(lit(sun, normals), sun)
    two = SteadyPyramid(as_design(normals)).fit(lit(sun, normals), sun)
    disturbed = lit(sun, normals) + constant
    off = separation_deg(three.predict(disturbed), sun)
    expected = sun + np.array([0, 0, constant / math.cos(math.radians(30.0))])
    np.testing.assert_allclose(off, separation_deg(expected, sun), atol=1e-9)
    assert off.max() > degrees
    assert separation_deg(two.predict(disturbed), sun).max() < 1e-9


def test_interference_of_no_mean_is_averaged_by_the_faces():
    """sqrt(2 / M) sigma / sin(tilt) on each horizontal component: least squares' own scatter."""
    sigma, tilt, count = 1e-4, 30.0, 8
    normals, sun = pyramid(count, tilt), np.tile([[0.0, 0.0, 1.0]], (4000, 1))
    calibrated = rings(10, 30)
    model = SteadyPyramid(as_design(normals), extrapolation=math.inf)
    model.fit(lit(calibrated, normals), calibrated)
    noise = np.random.default_rng(1).normal(0, sigma, (len(sun), count))
    spread = model.predict(lit(sun, normals) + noise)[:, :2].std(axis=0)
    expected = sigma * math.sqrt(2 / count) / math.sin(math.radians(tilt))
    np.testing.assert_allclose(spread, expected, rtol=0.05)


def test_a_dark_face_is_told_by_the_others():
    normals = pyramid(6, 30.0)
    calibrated, low = rings(10, 40), rings(75)  # at 75 deg the far face looks 15 deg away
    model = SteadyPyramid(as_design(normals), extrapolation=math.inf)
    model.fit(lit(calibrated, normals), calibrated)
    assert (lit(low, normals) == 0).any(axis=1).all()
    assert np.isnan(model.predict(lit(low, normals) + 0.05)).all()
    uneven = lit(calibrated, normals) + np.array([0.3, 0, 0, 0, 0, 0])
    assert np.isnan(model.predict(uneven)).all()
    assert np.isnan(model.predict(3.0 * lit(rings(40), normals))).all()  # x and y beyond one


def test_one_sun_off_the_boresight_that_lights_all_faces_is_enough():
    normals, sun = pyramid(4, 30.0), np.vstack([rings(20)[:1], rings(75)])
    assert (lit(sun, normals) > 0).all(axis=1).sum() == 1
    model = SteadyPyramid(as_design(normals), extrapolation=math.inf)
    model.fit(1.7 * lit(sun, normals), sun)
    assert model.coefficient_ == pytest.approx(1 / 1.7)


def test_pyramids_that_nothing_is_learnt_of_are_refused():
    normals = pyramid(4, 30.0)
    model = SteadyPyramid(as_design(normals), extrapolation=math.inf)
    axis, low = np.array([[0.0, 0.0, 1.0]]), rings(75)
    for sun in (axis, low):
        with pytest.raises(UnusableDataError, match="pyramidal-constant"):
            model.fit(lit(sun, normals), sun)
    with pytest.raises(UnusableDataError, match="lean towards"):
        model.fit(lit(rings(20), normals), rings(20) * [-1, -1, 1])
    for wrong in (FACES, pyramid(6, 30.0)[:5], ()):
        with pytest.raises(ValueError, match="pyramidal-constant"):
            SteadyPyramid.for_sensor(
                SensorGeometry(face_normals=as_design(wrong)), FeatureKind.SIGNALS
            )


# Cells that warm up


def warmed(sun, normals, temperature, fall, gains=1.0):
    return lit(sun, normals) * gains * (1 - fall * (temperature - T_0))[:, None]


def test_warm_cells_are_found_with_their_coefficient():
    normals, sun = lattice(16), rings(*range(5, 180, 10))
    rng = np.random.default_rng(2)
    temperature, gains = rng.uniform(230, 370, len(sun)), rng.uniform(0.8, 1.2, 16)
    signals = warmed(sun, normals, temperature, 0.0045, gains)
    context = {"temperature_K": temperature}
    model = WarmCells(as_design(normals)).fit(signals, sun, context)
    assert separation_deg(model.predict(signals, context), sun).max() < 1e-9
    assert model.coefficient_ == pytest.approx(0.0045, abs=1e-12)
    np.testing.assert_allclose(model.reference_, gains, atol=1e-12)
    # and that is the one least squares finds over all numbers together
    from scipy.optimize import least_squares

    noisy = signals + rng.normal(0, 0.01, signals.shape)
    model.fit(noisy, sun, context)
    cosines = sun @ normals.T
    cosines[cosines < math.cos(math.radians(75))] = 0.0

    def residuals(p):
        fitted = cosines * p[:-1] * (1 - p[-1] * (temperature - T_0)[:, None])
        return np.where(cosines > 0, noisy - fitted, 0.0).ravel()

    solution = least_squares(
        residuals, [*np.ones(16), 0.0], x_scale=[*np.ones(16), 1e-3], xtol=1e-14
    )
    assert model.coefficient_ == pytest.approx(solution.x[-1], abs=1e-8)


def test_the_coefficients_standard_error_is_least_squares_own():
    """By SciPy: the residuals' squares over what samples are left beyond the numbers fitted."""
    from scipy.optimize import curve_fit

    normals, sun = pyramid(4, 30.0), rings(10, 30, step_deg=60)
    warmth = np.tile([-40.0, 25.0, 40.0], 4)
    cosines, rng = lit(sun, normals), np.random.default_rng(5)
    signals = cosines * (1 - 0.0045 * warmth[:, None]) + rng.normal(0, 0.01, cosines.shape)

    def fitted(_, *p):
        return (cosines * p[:-1] * (1 - p[-1] * warmth[:, None])).ravel()

    found, covariance = curve_fit(fitted, None, signals.ravel(), [1.0, 1.0, 1.0, 1.0, 0.0])
    model = WarmCells(as_design(normals)).fit(signals, sun, {"temperature_K": T_0 + warmth})
    assert model.coefficient_ == pytest.approx(found[-1], rel=1e-6)
    assert model.coefficient_deviation_ == pytest.approx(math.sqrt(covariance[-1, -1]), rel=1e-4)


def test_cells_calibrated_cold_and_flown_warm_need_their_temperature():
    """By signals alone, cells at the edge of what counts as lit are lost and currents are wrong."""
    normals, sun = lattice(16), rings(*range(5, 180, 10))
    temperature = np.tile([T_0 - 40, T_0 + 40], len(sun) // 2)
    gains = 1 + 0.1 * np.sin(np.arange(16))
    context = {"temperature_K": temperature}
    signals = warmed(sun, normals, temperature, 0.0045, gains)
    blind = WeightedCells(as_design(normals)).fit(signals, sun)
    aware = WarmCells(as_design(normals)).fit(signals, sun, context)
    assert aware.quality_.residual_rms_deg < 1e-9
    assert blind.quality_.residual_rms_deg > 0.01


def test_at_the_reference_it_is_the_model_without_temperature():
    normals, sun = lattice(16), rings(20, 60, 100, 140)
    temperature = np.linspace(260, 340, len(sun))
    context = {"temperature_K": temperature}
    model = WarmCells(as_design(normals)).fit(
        warmed(sun, normals, temperature, 0.004), sun, context
    )
    plain = WeightedCells(as_design(normals)).fit(lit(sun, normals), sun)
    noisy = lit(sun, normals) + np.random.default_rng(4).normal(0, 0.02, (len(sun), 16))
    found = model.predict(noisy, {"temperature_K": np.full(len(sun), T_0)})
    assert np.nanmax(separation_deg(found, plain.predict(noisy))) < 1e-9


def test_intervals_of_the_coefficient_hold_the_truth_as_often_as_they_say():
    normals, sun = lattice(16), rings(*range(5, 180, 20))
    temperature = np.random.default_rng(3).uniform(260, 340, len(sun))
    signals, context = warmed(sun, normals, temperature, 0.0045), {"temperature_K": temperature}
    model, held = WarmCells(as_design(normals)), []
    for seed in range(200):
        noise = np.random.default_rng(seed).normal(0, 0.003, signals.shape)
        model.learn(signals + noise, sun, context)
        low, high = model.fitted_parameters()[0].interval()
        held.append(low <= 0.0045 <= high)
    assert 0.93 <= np.mean(held) <= 0.97


def test_a_temperature_that_is_not_known_or_does_not_change():
    normals, sun = lattice(16), rings(*range(5, 180, 20))
    temperature = np.random.default_rng(3).uniform(260, 340, len(sun))
    signals, context = warmed(sun, normals, temperature, 0.0045), {"temperature_K": temperature}
    model = WarmCells(as_design(normals)).fit(signals, sun, context)
    found = model.predict(signals[:3], {"temperature_K": [temperature[0], np.nan, 9000.0]})
    assert np.isnan(found).all(axis=1).tolist() == [False, True, True]
    steady = {"temperature_K": np.full(len(sun), 300.0)}
    with pytest.raises(UnusableDataError, match="different temperatures"):
        model.fit(signals, sun, steady)
    with pytest.raises(UnusableDataError, match="panoramic-temperature needs"):
        model.fit(signals, sun, {"temperature_K": np.full(len(sun), np.nan)})

"""Faces as they were mounted: found again, and directions from them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize

from algorithms.angles import separation_deg
from algorithms.contract import UnusableDataError
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from algorithms.models.physics_informed.faces_fit import FacesFit
from algorithms.models.physics_informed.faces_kernel import bend_and_slope

CUBE = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
KELLY = np.array([-0.015, 0.750, 0.637, -0.369]) / 1.003


def pyramid(count=6, tilt_deg=30.0):
    turns, off = 2 * math.pi * np.arange(count) / count, math.radians(tilt_deg)
    return tuple(
        (math.sin(off) * math.cos(t), math.sin(off) * math.sin(t), math.cos(off)) for t in turns
    )


def spread(count, half_deg=180.0, seed=0):
    rng = np.random.default_rng(seed)
    z = rng.uniform(np.cos(np.radians(half_deg)), 1, count)
    turn = rng.uniform(0, 2 * np.pi, count)
    wide = np.sqrt(1 - z**2)
    return np.column_stack([wide * np.cos(turn), wide * np.sin(turn), z])


def mounted(nominal, seed=0, error_deg=1.0):
    """Normals off their drawing and gains off each other."""
    rng = np.random.default_rng(seed)
    normals = np.array(nominal) + math.radians(error_deg) * rng.standard_normal((len(nominal), 3))
    gains = 1.0 + 0.05 * rng.standard_normal(len(nominal))
    return normals / np.linalg.norm(normals, axis=1, keepdims=True), gains


def read(sun, normals, gains, response=KELLY, light=(0.0, 0.0, 0.0)):
    c = sun @ normals.T
    value = ((response[3] * c + response[2]) * c + response[1]) * c + response[0]
    return gains * np.where((c > 0) & (value > 0), value, 0.0) * (1 + sun @ light)[:, None]


@pytest.mark.parametrize(("nominal", "half_deg"), [(CUBE, 180.0), (pyramid(), 50.0)])
def test_a_noiseless_sensor_is_inverted(nominal, half_deg):
    normals, gains = mounted(nominal)
    sun = spread(500, half_deg)
    signals = read(sun, normals, gains, light=(0.01, -0.02, 0.005))
    model = AssembledFaces(nominal, level_spread=10.0).fit(signals, sun)
    assert separation_deg(model.normals_, normals).max() < 1e-5
    asked = spread(400, 0.9 * half_deg, seed=1)
    seen = read(asked, normals, gains)
    error = separation_deg(model.predict(seen), asked)
    lit = ((asked @ normals.T) > 0.03).sum(axis=1) >= 3
    assert np.isfinite(error[lit]).all()
    assert error[lit].max() < 1e-6


@pytest.mark.slow
def test_intervals_hold_what_was_put_in():
    """93 to 97 % of 95 % intervals hold the true tilts and gains' ratios, over 200 seeds."""
    nominal = pyramid()
    normals, gains = mounted(nominal, error_deg=0.5)
    sun = spread(200, 50.0)
    clean = read(sun, normals, gains)
    drawn = np.array(nominal)
    truth = FacesFit(drawn, clean, sun, "test").solve(each=False).parameters
    held = []
    for seed in range(200):
        noisy = clean + np.random.default_rng(seed).normal(0, 1e-3, clean.shape)
        found = FacesFit(drawn, noisy, sun, "test").solve(each=False).parameters
        held.append(
            [
                abs(one.value - true.value) < 1.96 * one.deviation
                for one, true in zip(found, truth, strict=True)
                if not one.name.startswith("gain")  # in units of the largest signal, which is noisy
            ]
        )
    assert 0.93 <= np.mean(held) <= 0.97


def calibrated():
    """A pyramid of five faces fitted to noisy signals; its true normals and gains, and the draw."""
    nominal = pyramid(5, 35.0)
    normals, gains = mounted(nominal)
    sun = spread(300, 40.0)
    rng = np.random.default_rng(2)
    noisy = read(sun, normals, gains) + rng.normal(0, 2e-3, (300, 5))
    return AssembledFaces(nominal).fit(noisy, sun), normals, gains, rng


def test_a_direction_is_the_least_squares_one():
    """SciPy's own minimiser, over direction and strength, one sample at a time."""
    model, normals, gains, rng = calibrated()
    asked = spread(6, 35.0, seed=4)
    seen = read(asked, normals, gains) + rng.normal(0, 5e-3, (6, 5))
    for signal, found in zip(seen, model.predict(seen), strict=True):

        def cost(vector, signal=signal):
            level = np.linalg.norm(vector)
            light = [
                bend_and_slope(vector @ normal / level, response, noise / 2)[0]
                for normal, response, noise in zip(
                    model.normals_, model.responses_, model.noise_, strict=True
                )
            ]
            off = (signal - model.dark_ - level * np.array(light)) / model.noise_
            return (off**2).sum() + ((level - 1) / model.level_spread) ** 2

        solution = minimize(
            cost, found, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-9}
        )
        assert separation_deg([solution.x], [found])[0] < 1e-3
        assert cost(found * np.linalg.norm(solution.x)) < cost(solution.x) + 1e-4


def test_a_variance_is_that_of_the_normal_equations_at_the_answer():
    """Mean of the variances of both components across, of numeric derivatives of the residuals."""
    model, *_ = calibrated()
    asked = spread(4, 30.0, seed=4)

    def residuals(vector):
        level = np.linalg.norm(vector)
        faces = zip(model.normals_, model.responses_, model.noise_, strict=True)
        light = [bend_and_slope(vector @ n / level, r, noise / 2)[0] for n, r, noise in faces]
        return np.append(level * np.array(light) / model.noise_, level / model.level_spread)

    seen = [model.dark_ + model.noise_ * residuals(vector)[:-1] for vector in asked]
    for vector, variance in zip(asked, model.variance(np.array(seen), {}), strict=True):
        steps = 1e-6 * np.eye(3)
        slopes = [(residuals(vector + step) - residuals(vector - step)) / 2e-6 for step in steps]
        covariance = np.linalg.inv(np.array(slopes) @ np.array(slopes).T)
        across = (np.trace(covariance) - vector @ covariance @ vector) / 2.0
        assert variance == pytest.approx(across, rel=1e-6)


def test_unequal_light_of_the_lamp_does_not_tilt_the_faces():
    normals, gains = mounted(CUBE, error_deg=0.3)
    sun = spread(600)
    signals = read(sun, normals, gains, light=(0.0, 0.03, 0.0))
    model = AssembledFaces(CUBE).fit(signals, sun)
    assert separation_deg(model.normals_, normals).max() < 1e-5
    assert model.quality_.parameter("light_y").value == pytest.approx(0.03, abs=1e-6)


def test_elements_of_different_makes_have_a_response_each():
    normals, gains = mounted(pyramid())
    sun = spread(500, 50.0)
    bent = [KELLY + k * np.array([0.0, 0.05, -0.05, 0.0]) for k in range(6)]
    signals = np.column_stack(
        [read(sun, normals[[k]], gains[[k]], bent[k])[:, 0] for k in range(6)]
    )
    each = AssembledFaces(pyramid(), response="each", level_spread=10.0).fit(signals, sun)
    common = AssembledFaces(pyramid()).fit(signals, sun)
    assert each.quality_.residual_rms_deg < 1e-6
    assert common.quality_.residual_rms_deg > 0.05


def test_a_direction_that_the_lit_faces_leave_open_is_none():
    """One lit face of a pyramid gives a cone of directions."""
    normals, gains = mounted(pyramid(4, 70.0))
    sun = spread(600, 85.0)
    model = AssembledFaces(pyramid(4, 70.0)).fit(read(sun, normals, gains), sun)
    alone = np.array([[0.5, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]])
    assert np.isnan(model.predict(alone)).all()


def test_faces_that_are_not_lit_are_named():
    normals, gains = mounted(CUBE)
    sun = spread(400, 60.0)
    with pytest.raises(UnusableDataError, match=r"face 6.*0"):
        AssembledFaces(CUBE).fit(read(sun, normals, gains), sun)
    sun = spread(400)
    signals = read(sun, normals, gains)
    signals[:, 2] = 0.0
    with pytest.raises(UnusableDataError, match="face 3 has no signal"):
        AssembledFaces(CUBE).fit(signals, sun)


@pytest.mark.slow
@given(st.integers(0, 2**32 - 1))
@settings(max_examples=3, deadline=None)
def test_answers_do_not_hang_on_rounding(seed):
    """Noisy readings, every face of the cube dark and grazed somewhere, moved by 1e-13."""
    rng = np.random.default_rng(seed)
    normals, gains = mounted(CUBE)
    sun, asked = spread(300), spread(300, seed=1)
    known = read(sun, normals, gains) + rng.normal(0, 3e-3, (300, 6))
    seen = read(asked, normals, gains) + rng.normal(0, 3e-3, (300, 6))
    moved = [one * (1 + 1e-13 * rng.standard_normal(one.shape)) for one in (known, seen)]
    before = AssembledFaces(CUBE).fit(known, sun).predict(seen)
    after = AssembledFaces(CUBE).fit(moved[0], sun).predict(moved[1])
    np.testing.assert_allclose(after, before, atol=1e-8)

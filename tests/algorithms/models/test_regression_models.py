"""Fourier, Sigmoid, Trig and raw-signal polynomials: their own curves, and what noise does."""

from __future__ import annotations

import numpy as np
import pytest
from known_truths import SEEDS, covered

from algorithms.angles import (
    angles_from_sun,
    separation_deg,
    sun_from_angles,
)
from algorithms.calibration.hull import Hull
from algorithms.contract import (
    UnusableDataError,
)
from algorithms.models.non_physical.fourier_balance import FourierBalance
from algorithms.models.non_physical.linear import LinearFit
from algorithms.models.non_physical.polynomial import AxisPolynomial
from algorithms.models.non_physical.sigmoid import SigmoidBalance


def grid(limit=50.0, steps=21):
    axis = np.linspace(-limit, limit, steps)
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)


# What all share -----------------------------------------------------------------------------------


def test_a_hull_seen_at_a_glance_is_the_one_measured():
    rng = np.random.default_rng(5)
    for turn in (0.0, 0.4):
        corners = rng.uniform(-1, 1, (40, 2)) @ [[np.cos(turn), 2.0], [-0.3, np.cos(turn)]]
        hull = Hull.around(corners, "test")
        for size in (0.05, 0.4, 1.0, 3.0):  # all in the box, some, hardly any
            points = corners.mean(axis=0) + rng.uniform(-size, size, (2000, 2))
            np.testing.assert_array_equal(hull.holds(points), hull.outside(points) <= hull.margin)
            points[7] = np.nan
            assert not hull.holds(points)[7]


# Fourier ------------------------------------------------------------------------------------------


def series(u):
    """Any line and two harmonics of a balance already on [-1, 1], degrees."""
    w = np.pi / 2
    return 1.5 + 30 * u + 2 * np.cos(w * u) - 3 * np.sin(w * u) + 0.5 * np.sin(2 * w * u)


def test_fourier_inverts_its_own_series():
    balances = grid(1.0, 15)
    sun = sun_from_angles(series(balances[:, ::-1]))
    model = FourierBalance(harmonics=2).fit(balances, sun)
    assert separation_deg(model.predict(balances), sun).max() < 1e-6
    chosen = FourierBalance().fit(balances, sun)
    assert separation_deg(chosen.predict(balances), sun).max() < 1e-6
    assert chosen.quality_.settings["harmonics"] >= 2
    np.testing.assert_allclose(
        model.coefficients_, np.tile([1.5, 30, 2, -3, 0, 0.5], (2, 1)), atol=1e-9
    )


def test_fourier_follows_a_periodic_error_that_a_polynomial_of_as_many_terms_does_not():
    """model:fourier: calibration errors of coded and interfering light are periodic."""
    balances = grid(1.0, 41)
    angles = 30 * balances[:, ::-1] + 0.5 * np.sin(4 * np.pi * balances[:, ::-1])
    sun = sun_from_angles(angles)
    fourier = FourierBalance(harmonics=8, target="angle").fit(balances, sun)
    polynomial = AxisPolynomial(degree=9).fit(balances, sun)  # 9 + 1 against 2 + 16 terms
    assert fourier.quality_.residual_rms_deg < 1e-9
    assert polynomial.quality_.residual_rms_deg > 0.1


def test_fourier_is_least_squares_with_its_closed_form_of_uncertainty():
    """NumPy's own solution, and the spread of predictions over noise against ``variance``."""
    balances = grid(1.0, 15)
    angles = series(balances[:, ::-1])
    u = balances[:, 1]
    design = np.column_stack(
        [np.ones_like(u), u] + [f(n * np.pi / 2 * u) for n in (1, 2, 3) for f in (np.cos, np.sin)]
    )
    rng, model, found = np.random.default_rng(5), FourierBalance(harmonics=3), []
    noise = 0.02
    for _ in range(SEEDS):
        noisy = angles + noise * rng.standard_normal(angles.shape)
        model.fit(balances, sun_from_angles(noisy))
        found.append(angles_from_sun(model.predict(balances))[:, 0])
    expected = design @ np.linalg.lstsq(design, noisy[:, 0])[0]
    np.testing.assert_allclose(found[-1], expected, atol=1e-9)
    spread = np.mean(np.var(found, axis=0))
    assert spread == pytest.approx(noise**2 * design.shape[1] / len(u), rel=0.1)  # trace of H / n
    # residuals of two axes, on the sphere: near the boresight a degree of each is one
    near = np.hypot(*balances.T) < 0.2
    said = np.degrees(np.sqrt(model.variance(balances, {})[near]))
    np.testing.assert_allclose(said, np.std(found, axis=0)[near], rtol=0.35)


def test_fourier_refuses_too_few_balances():
    balances = grid(1.0, 5)
    with pytest.raises(UnusableDataError, match="harmonics"):
        FourierBalance(harmonics=2).fit(balances, sun_from_angles(series(balances[:, ::-1])))


# Sigmoid ------------------------------------------------------------------------------------------

LOGISTIC = {
    "height": 0.9,
    "steep": 2.8,
    "centre": 1.5,
    "cosine": 0.01,
    "sine": -0.02,
    "level": 0.03,
}


def logistic(angles_deg, limit_deg=50.0, **p):
    """As Pentke2022 has it in words, with the logistic function itself."""
    turn = np.pi * angles_deg / limit_deg
    curve = 2 / (1 + np.exp(-p["steep"] * np.radians(angles_deg - p["centre"]))) - 1
    return p["height"] * curve + p["cosine"] * np.cos(turn) + p["sine"] * np.sin(turn) + p["level"]


def parameters_of(**p):
    """The model's own numbers of that curve, by the addition theorem, of both axes."""
    q = p["steep"] / 2
    shift = np.tanh(-q * np.radians(p["centre"]))
    own = {
        "slope": p["height"] * q * (1 - shift**2),
        "bend": q**2,
        "skew": q * shift,
        "cosine": p["cosine"],
        "sine": p["sine"],
        "offset": p["level"] + p["height"] * shift,
    }
    return {f"{name}_{axis}": value for name, value in own.items() for axis in ("alpha", "beta")}


def test_sigmoid_inverts_its_own_curve_and_finds_its_numbers():
    angles = grid()
    sun = sun_from_angles(angles)
    balances = logistic(angles[:, ::-1], **LOGISTIC)
    model = SigmoidBalance().fit(balances, sun)
    assert separation_deg(model.predict(balances), sun).max() < 1e-6
    for name, value in parameters_of(**LOGISTIC).items():
        assert model.quality_.parameter(name).value == pytest.approx(value, abs=1e-7)


def test_sigmoid_holds_a_straight_line_where_a_logistic_has_no_numbers():
    angles = grid()
    sun = sun_from_angles(angles)
    balances = np.radians(angles[:, ::-1] - 3.0)
    noisy = balances + 1e-3 * np.random.default_rng(1).standard_normal(balances.shape)
    assert separation_deg(SigmoidBalance().fit(balances, sun).predict(balances), sun).max() < 1e-6
    assert SigmoidBalance().fit(noisy, sun).quality_.residual_rms_deg < 0.1


@pytest.mark.parametrize(("way", "root"), [(1, 1.0), (-1, 1.0), (1, 1.2)])
def test_sigmoid_holds_a_square_apertures_tangent(way, root):
    """Bent the other way than any logistic: ``tan(p t)`` is its bend ``-p^2`` exactly."""
    angles = grid()
    sun = sun_from_angles(angles)
    balances = way * np.tan(root * np.radians(angles[:, ::-1])) / 1.3
    model = SigmoidBalance().fit(balances, sun)
    assert separation_deg(model.predict(balances), sun).max() < 1e-6
    assert model.quality_.parameter("bend_alpha").value == pytest.approx(-(root**2), abs=1e-6)


def test_sigmoid_refuses_what_turns_back_or_does_not_belong():
    angles = grid()
    sun = sun_from_angles(angles)
    straight = np.radians(angles[:, ::-1])
    turning = np.sin(np.radians(2.6 * angles[:, ::-1]))  # falls again past 35 degrees
    with pytest.raises(UnusableDataError, match=r"turns back|converge|rise"):
        SigmoidBalance().fit(turning, sun)
    with pytest.raises(UnusableDataError, match="rise or fall"):
        SigmoidBalance().fit(straight[:, ::-1], sun)
    with pytest.raises(UnusableDataError, match="at least 7"):
        SigmoidBalance().fit(straight[::80], sun[::80])


def test_sigmoid_says_nothing_of_a_balance_its_curve_does_not_reach():
    angles = grid()
    balances = logistic(angles[:, ::-1], **{**LOGISTIC, "sine": 0.0, "cosine": 0.0})
    model = SigmoidBalance(extrapolation=float("inf")).fit(balances, sun_from_angles(angles))
    found = model.predict([[0.0, 0.0], [0.90, 0.0], [0.92, 0.0], [-5.0, 0.0]])  # 0.906 at 89.9 deg
    assert np.isnan(found[:, 0]).tolist() == [False, False, True, True]


@pytest.mark.slow
def test_sigmoid_intervals_cover_the_injected_numbers():
    angles = grid(steps=7)
    truth = parameters_of(**LOGISTIC)
    balances = logistic(angles[:, ::-1], **LOGISTIC)
    sun = sun_from_angles(angles)
    # two axes with the same numbers and noise of their own: a seed is two
    share = covered(SigmoidBalance(), truth, balances, sun, noise=1e-3, seeds=SEEDS // 2)
    assert 0.93 < share < 0.97


# Linear -------------------------------------------------------------------------------------------


def test_linear_intervals_cover_the_injected_line():
    angles = grid(10.0, 7)
    balances = (angles[:, ::-1] - 0.5) / 14.0
    truth = {f"{what}_{axis}": v for what, v in (("intercept", 0.5), ("slope", 14.0)) for axis in
             ("alpha", "beta")}  # fmt: skip
    rng, held = np.random.default_rng(11), []
    for _ in range(SEEDS):
        noisy = sun_from_angles(angles + 0.05 * rng.standard_normal(angles.shape))
        quality = LinearFit().fit(balances, noisy).quality_
        for name, value in truth.items():
            lowest, highest = quality.parameter(name).interval()
            held.append(lowest <= value <= highest)
    assert 0.93 < np.mean(held) < 0.97


def test_linear_deviations_are_the_textbooks():
    angles = grid(10.0, 7)
    x = angles[:, 1] / 14.0
    noisy = angles + 0.05 * np.random.default_rng(2).standard_normal(angles.shape)
    model = LinearFit().fit(np.column_stack([x, angles[:, 0]]), sun_from_angles(noisy))
    slope, level = np.polyfit(x, noisy[:, 1], 1)
    size = ((noisy[:, 1] - level - slope * x) ** 2).sum() / (len(x) - 2)
    spread = ((x - x.mean()) ** 2).sum()
    expected = np.sqrt([size * (1 / len(x) + x.mean() ** 2 / spread), size / spread])
    np.testing.assert_allclose(model.deviations_[1], expected, rtol=1e-9)

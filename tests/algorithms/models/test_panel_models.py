"""Trig and polynomials of raw signals: cosines of panels found again, cubes of faces."""

from __future__ import annotations

import numpy as np
import pytest
from known_truths import covered

from algorithms.angles import (
    separation_deg,
)
from algorithms.contract import (
    FeatureKind,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
)
from algorithms.models.non_physical.panel_curves import AveragedPanelCurves
from algorithms.models.non_physical.signal_polynomial import SignalPolynomial
from algorithms.models.non_physical.trigonometric import TrigonometricPanels

CUBE = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
RAYS = np.array(CUBE, dtype=float)


def sphere(count=500, seed=3):
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


# Trig ---------------------------------------------------------------------------------------------


def panel_signals(sun, offsets, amplitudes):
    """Cosines of panels that are each turned, biased and of their own gain."""
    return np.where(sun @ RAYS.T > 0, offsets + sun @ amplitudes.T, offsets)


def built(seed=4):
    rng = np.random.default_rng(seed)
    amplitudes = RAYS * rng.uniform(0.9, 1.1, (6, 1)) + rng.normal(0, 0.02, (6, 3))
    return np.zeros(6), amplitudes


def test_direct_trig_inverts_panels_of_any_gain_and_tilt():
    sun = sphere()
    offsets, amplitudes = built()
    lit = np.abs(sun).min(axis=1) > 0.05  # away from where a tilted panel is lit from behind
    signals = panel_signals(sun, offsets, amplitudes)
    model = TrigonometricPanels(CUBE).fit(signals[lit], sun[lit])
    assert separation_deg(model.predict(signals[lit]), sun[lit]).max() < 1e-6
    np.testing.assert_allclose(model.amplitudes_, amplitudes, atol=1e-9)


def test_direct_trig_knows_its_quadrant_over_a_whole_slew():
    """Richie2015: theta is an arc tangent of two cosines; no quadrant is checked."""
    sun = sphere()
    model = TrigonometricPanels(CUBE).fit(np.maximum(sun @ RAYS.T, 0), sun)
    theta = np.radians(np.arange(0.0, 360.0, 7.5))
    slew = np.column_stack([np.cos(theta), np.sin(theta), 0 * theta])
    found = model.predict(1.3 * np.maximum(slew @ RAYS.T, 0))
    turned = np.arctan2(found[:, 1], found[:, 0]) - theta
    assert np.abs(np.angle(np.exp(1j * turned))).max() < 1e-9


def test_averaged_trig_inverts_its_own_curves():
    sun = sphere()
    cosines = sun @ RAYS.T
    curves = np.repeat([[0.05, 0.9, 0.04], [0.0, 1.1, -0.05], [0.1, 1.0, 0.02]], 2, axis=0)
    a, b, c = curves.T
    signals = np.where(cosines > 0, a + b * cosines + c * (2 * cosines**2 - 1), 0.0)
    lit = np.abs(sun).min(axis=1) > 0.12  # where a curve that starts above zero is the brighter
    model = AveragedPanelCurves(CUBE).fit(signals[lit], sun[lit])
    assert separation_deg(model.predict(signals[lit]), sun[lit]).max() < 1e-6
    np.testing.assert_allclose(model.curves_, curves[::2], atol=1e-9)


def test_direct_trig_is_better_than_averaged_curves_where_panels_differ():
    """C06, by its mechanism: one curve for two panels lets half their difference through."""
    sun = sphere()
    signals = np.maximum(sun @ RAYS.T, 0) * [1.0, 1.05, 0.95, 1.0, 1.02, 0.98]
    direct = TrigonometricPanels(CUBE).fit(signals, sun).quality_.residual_rms_deg
    averaged = AveragedPanelCurves(CUBE).fit(signals, sun).quality_.residual_rms_deg
    assert direct < 1e-9
    assert averaged > 0.3


@pytest.mark.slow
def test_direct_trig_intervals_cover_the_injected_cosines():
    sun = sphere(250)
    offsets, amplitudes = built()
    names = ("offset", "amplitude_x", "amplitude_y", "amplitude_z")
    truth = {
        f"{name}_{panel}": value
        for panel in range(6)
        for name, value in zip(names, (offsets[panel], *amplitudes[panel]), strict=True)
    }
    signals = panel_signals(sun, offsets, amplitudes)
    assert 0.93 < covered(TrigonometricPanels(CUBE), truth, signals, sun, noise=1e-2) < 0.97


@pytest.mark.slow
def test_averaged_trig_intervals_cover_the_injected_curves():
    sun = sphere(250)
    cosines = sun @ RAYS.T
    signals = np.where(cosines > 0, 0.02 + 0.9 * cosines + 0.04 * (2 * cosines**2 - 1), 0.0)
    truth = {
        f"{name}_{pair}": value
        for pair in range(3)
        for name, value in (("level", 0.02), ("cosine", 0.9), ("double", 0.04))
    }
    assert 0.93 < covered(AveragedPanelCurves(CUBE), truth, signals, sun, noise=1e-2) < 0.97


@pytest.mark.parametrize("model", [TrigonometricPanels(CUBE), AveragedPanelCurves(CUBE)], ids=str)
def test_trig_needs_every_pair_lit_and_says_nothing_in_the_dark(model):
    sun = sphere()
    signals = np.maximum(sun @ RAYS.T, 0)
    assert np.isnan(model.fit(signals, sun).predict(np.full((1, 6), -1e-3))).all()
    ring = sun[:, :2] / np.linalg.norm(sun[:, :2], axis=1, keepdims=True)
    ring = np.column_stack([ring, 0.019 * np.sign(sun[:, 2])])
    ring /= np.linalg.norm(ring, axis=1, keepdims=True)
    with pytest.raises(UnusableDataError, match="panels 4 and 5"):
        model.fit(np.maximum(ring @ RAYS.T, 0), ring)


def test_averaged_trig_refuses_a_curve_that_turns_back():
    sun = sphere()
    cosines = np.maximum(sun @ RAYS.T, 0)
    with pytest.raises(UnusableDataError, match="turns back"):
        AveragedPanelCurves(CUBE).fit(cosines * (1.2 - cosines), sun)


# Polynomials of raw signals -----------------------------------------------------------------------


def test_signal_polynomial_holds_a_polynomial_of_its_degree_exactly():
    """Signals that are an invertible quadratic's argument: ``s = A m + m B m``, of unit length."""
    sun = sphere()
    sun[:, 2] = np.abs(sun[:, 2])
    m = np.column_stack([sun[:, 0], sun[:, 1], sun[:, 2], sun[:, 2] ** 2 - sun[:, 0] * sun[:, 1]])
    model = SignalPolynomial(signals=4, degree=2).fit(m, sun)
    assert separation_deg(model.predict(m), sun).max() < 1e-6


def test_signal_polynomial_is_the_least_squares_one_where_all_terms_are_settled():
    rng = np.random.default_rng(8)
    signals = rng.uniform(-1, 1, (400, 3))
    sun = np.column_stack([0.4 * np.sin(signals[:, :2] + 0.2 * signals[:, 2:]), np.ones(400)])
    sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    model = SignalPolynomial(signals=3, degree=2, extrapolation=float("inf")).fit(signals, sun)
    x, y, z = signals.T
    design = np.column_stack([x**0, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z])
    expected = design @ np.linalg.lstsq(design, sun)[0]
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    np.testing.assert_allclose(model.predict(signals), expected, atol=1e-12)
    assert model.quality_.settings == {"degree": 2, "terms": 10, "dropped": 0}


def test_signal_polynomial_leaves_out_what_a_cube_does_not_settle():
    """m_+ m_- is nothing, and the squares of a cube's signals add up to one."""
    sun = sphere()
    signals = np.maximum(sun @ RAYS.T, 0)
    model = SignalPolynomial(signals=6, degree=2).fit(signals, sun)
    assert model.quality_.settings == {"degree": 2, "terms": 28 - 4, "dropped": 4}
    assert separation_deg(model.predict(signals), sun).max() < 1e-6


def test_signal_polynomial_undoes_angular_responses_that_geometry_does_not_know():
    sun = sphere(1000)
    signals = np.maximum(sun @ RAYS.T, 0) ** 1.05
    polynomial = SignalPolynomial(signals=6).fit(signals, sun)
    cosines = TrigonometricPanels(CUBE).fit(signals, sun)
    new = sphere(500, seed=9)
    asked = np.maximum(new @ RAYS.T, 0) ** 1.05
    left = [np.sqrt(np.mean(separation_deg(m.predict(asked), new) ** 2)) for m in
            (polynomial, cosines)]  # fmt: skip
    assert left[0] < 0.1
    assert left[1] > 0.3


def test_signal_polynomial_says_nothing_of_a_detector_that_was_never_lit():
    sun = sphere()
    front = sun[sun[:, 2] > 0.2]
    signals = np.maximum(front @ RAYS.T, 0)  # the sixth panel looks away
    model = SignalPolynomial(signals=6).fit(signals, front)
    lit = signals[:2].copy()
    lit[1, 5] = 1.5
    assert np.isnan(model.predict(lit)[:, 0]).tolist() == [False, True]


def test_signal_polynomial_refuses_many_detectors_and_few_samples():
    ring = tuple((np.cos(t), np.sin(t), 0.0) for t in np.arange(9.0))
    with pytest.raises(UnsuitableDesignError, match="2 to 8"):
        SignalPolynomial.for_sensor(SensorGeometry(face_normals=ring), FeatureKind.SIGNALS)
    sun = sphere(20)
    with pytest.raises(UnusableDataError, match="samples"):
        SignalPolynomial(signals=6, degree=2).fit(np.abs(sun @ RAYS.T + 0.3), sun)

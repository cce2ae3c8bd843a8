"""Code dials, Periodic and Fourier, against signals written down from eq:fourier and eq:pamulti."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.angles import separation_deg, sun_from_angles, sun_from_tangents
from algorithms.contract import FeatureKind, SensorGeometry
from algorithms.models.multiplex.periodic import PeriodicCode
from algorithms.models.non_physical.fourier_phase import FourierPhase

BITS, CELL_MM, PERIOD_MM, FOCAL_MM = 5, 0.32, 0.64, 2.5
DESIGN = SensorGeometry(
    focal_length_mm=FOCAL_MM,
    code_bits=BITS,
    code_cell_mm=CELL_MM,
    fine_period_mm=PERIOD_MM,
    line_axes=("x", "y"),
)
MODELS = [PeriodicCode, FourierPhase]


def gray_bits(number):
    """Gray code by reflection: the list of n bits is that of n - 1, and that backwards."""
    codes = [()]
    for _ in range(BITS):
        codes = [(0, *code) for code in codes] + [(1, *code) for code in reversed(codes)]
    return np.array(codes, dtype=float)[number]


def tracks(place_mm, phase=None, light=1.0, offset=0.0, contrast=0.5):
    """(N, 9) currents of one dial: eq:fourier with a_1 alone, a_0/2 = half of an open track."""
    place_mm = np.asarray(place_mm, dtype=float)
    number = np.floor(place_mm / CELL_MM).astype(int) + 2 ** (BITS - 1)
    phase = 2 * np.pi * place_mm / PERIOD_MM if phase is None else phase
    wave = contrast * np.column_stack(
        [-np.cos(phase), -np.sin(phase), np.cos(phase), np.sin(phase)]
    )
    return light * np.hstack([gray_bits(number), 0.5 + wave]) + offset


def dials(tangents, focal_mm=FOCAL_MM, **how):
    """(N, 18) currents: the dial along x, then that along y."""
    return np.hstack([tracks(focal_mm * column, **how) for column in np.asarray(tangents).T])


def field_tangents(limit_deg=58.0, count=400, seed=0):
    angles = np.random.default_rng(seed).uniform(-limit_deg, limit_deg, (count, 2))
    return np.tan(np.radians(angles))


def sun_of(tangents):
    return sun_from_tangents(np.asarray(tangents)[:, ::-1])


def fitted(model, tangents=None, signals=None, **parameters):
    tangents = field_tangents() if tangents is None else tangents
    signals = dials(tangents) if signals is None else signals
    made = model(
        **{
            "bits": BITS,
            "cell_mm": CELL_MM,
            "period_mm": PERIOD_MM,
            "focal_length_mm": FOCAL_MM,
            "extrapolation": math.inf,
            **parameters,
        }
    )
    return made.fit(signals, sun_of(tangents))


@cache
def fitted_to_the_drawing(model):
    return fitted(model)


# Periodic and Fourier


@pytest.mark.parametrize("model", MODELS)
@settings(deadline=None, derandomize=True, max_examples=60)
@given(
    beta=st.floats(-60, 60),
    alpha=st.floats(-60, 60),
    light=st.floats(0.01, 100),
    offset=st.floats(0, 0.2),
    contrast=st.floats(0.3, 0.5),
)
def test_ideal_dials_are_inverted_in_any_light(model, *, beta, alpha, light, offset, contrast):
    sun = sun_from_angles([[alpha, beta]])
    signals = dials(sun[:, :2] / sun[:, 2:], light=light, offset=offset * light, contrast=contrast)
    assert separation_deg(fitted_to_the_drawing(model).predict(signals), sun).max() < 1e-9


@pytest.mark.parametrize("model", MODELS)
def test_a_half_lit_bit_may_fall_either_way(model):
    """At the edge of a cell the Gray code changes one bit; the phase settles the place."""
    made = fitted(model)
    edges = CELL_MM * np.arange(-14, 15)
    expected = sun_of(np.column_stack([edges, np.full(len(edges), 0.01)]) / FOCAL_MM)
    for shift in (-1e-9, 1e-9):
        signals = dials(np.column_stack([edges + shift, np.full(len(edges), 0.01)]) / FOCAL_MM)
        signals[:, BITS : BITS + 4] = tracks(edges)[:, BITS:]
        assert separation_deg(made.predict(signals), expected).max() < 1e-9


@pytest.mark.parametrize("model", MODELS)
def test_cell_and_phase_that_contradict_each_other_give_nothing(model):
    made = fitted(model)
    place = CELL_MM * (np.arange(-10, 10) + 0.5)  # in the middle of cells
    right = dials(np.column_stack([place, place]) / FOCAL_MM)
    wrong = right.copy()
    wrong[:, :BITS] = tracks(place + CELL_MM)[:, :BITS]  # a cell away: half a period
    assert np.isfinite(made.predict(right)).all()
    assert np.isnan(made.predict(wrong)).all()


@pytest.mark.parametrize("model", MODELS)
def test_rows_without_light_or_pattern_are_nan(model):
    made = fitted(model)
    rows = np.vstack([dials([[0.3, -0.2]])] * 4)
    rows[1] = 0.0
    rows[2] = 0.01  # light from elsewhere, the same on all tracks
    rows[3, -4:] = 0.5  # one dial alone without a pattern
    assert np.isnan(made.predict(rows)).all(axis=1).tolist() == [False, True, True, True]


@pytest.mark.parametrize("model", MODELS)
def test_dials_may_come_in_either_order(model):
    signals = dials(field_tangents(seed=3))
    swapped = np.hstack([signals[:, 9:], signals[:, :9]])
    other = fitted(model, signals=np.roll(dials(field_tangents()), 9, axis=1), axes=("y", "x"))
    np.testing.assert_array_equal(other.predict(swapped), fitted(model).predict(signals))


@settings(deadline=None, derandomize=True, max_examples=15)
@given(
    scale=st.floats(0.95, 1.05),
    shift=st.floats(-0.03, 0.03),
    bend=st.floats(-0.03, 0.03),
    k=st.floats(0.001, 0.01),
    t=st.floats(-3, 3),
)
def test_periodic_is_the_inverse_of_its_own_equation(scale, shift, bend, k, t):
    """eq:pamulti: alpha_2 is read short by k sin(2 p + t), then a conversion of each dial."""
    true = field_tangents(50.0, 200)
    phase_read = np.random.default_rng(1).uniform(-np.pi, np.pi, true.shape)
    number = np.rint((true * FOCAL_MM - phase_read / (2 * np.pi) * PERIOD_MM) / PERIOD_MM)
    read = (number + phase_read / (2 * np.pi)) * PERIOD_MM / FOCAL_MM  # tan(alpha_1 + alpha_2)
    tan_s = read + k * np.sin(2 * phase_read + t)
    a, b, c, d = -1.0, shift, bend, -scale
    tangents = (b - d * tan_s) / (c * tan_s - a)
    model = fitted(PeriodicCode, tangents, dials(read))
    assert separation_deg(model.predict(dials(read)), sun_of(tangents)).max() < 1e-6
    np.testing.assert_allclose(model.conversion_, [[a, b, c, d]] * 2, atol=1e-9)
    np.testing.assert_allclose(model.correction_[:, 0], k, atol=1e-9)
    np.testing.assert_allclose(np.exp(1j * model.correction_[:, 1]), np.exp(1j * t), atol=1e-6)


def rotation(tilt_x_deg, tilt_y_deg, turn_deg):
    x, y, z = np.radians([tilt_x_deg, tilt_y_deg, turn_deg])
    about_x = [[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]]
    about_y = [[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]]
    about_z = [[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]]
    return np.array(about_x) @ np.array(about_y) @ np.array(about_z)


def turned_head(tangents, turn, focal_mm, centre_mm):
    """Tangents by the drawing of a head turned, too far from its dials, and off centre."""
    head = sun_of(tangents) @ turn.T
    return focal_mm / FOCAL_MM * head[:, :2] / head[:, 2:] + np.array(centre_mm) / FOCAL_MM


def test_projection_takes_a_turned_head_out_exactly_and_an_axis_alone_cannot():
    tangents = field_tangents(50.0)
    read = turned_head(tangents, rotation(1.0, -0.7, 0.5), 2.53, (0.05, -0.04))
    error = {
        model: separation_deg(
            fitted(model, tangents, dials(read)).predict(dials(read)), sun_of(tangents)
        )
        for model in MODELS
    }
    assert error[FourierPhase].max() < 1e-6
    assert error[PeriodicCode].max() > 0.1  # its docstring says so


@pytest.mark.parametrize(("tilt_x", "tilt_y"), [(2.0, 0.0), (0.0, -1.5)])
def test_conversion_of_an_axis_takes_a_tilt_in_its_plane_out_exactly(tilt_x, tilt_y):
    """With the Sun in the plane of the tilt, which is where eq:pamulti is stated."""
    angle = np.linspace(-50, 50, 301)
    swept = np.tan(np.radians(angle))
    still = np.random.default_rng(2).uniform(-0.9, 0.9, 301)
    turn = rotation(tilt_x, tilt_y, 0.0)
    column = 0 if tilt_y else 1
    tangents = np.zeros((301, 2))
    tangents[:, column] = swept
    read = turned_head(tangents, turn, 2.48, (0.03, 0.02))
    # the other dial swept by itself, so that its own numbers are settled
    read[:, 1 - column], tangents[:, 1 - column] = still, still
    model = fitted(PeriodicCode, tangents, dials(read))
    assert separation_deg(model.predict(dials(read)), sun_of(tangents)).max() < 1e-6


def test_phase_errors_of_any_harmonic_are_in_the_series():
    """Phases read that differ from the true ones by a series of what is read."""
    read = field_tangents()
    phase = 2 * np.pi * read * FOCAL_MM / PERIOD_MM
    coefficients = np.array([(0.004, -0.002), (0.003, 0.001), (-0.001, 0.0005), (0.002, 0.002)])
    tangents = read.copy()
    for n, (sine, cosine) in enumerate(coefficients, start=1):
        tangents += sine * np.sin(n * phase) + cosine * np.cos(n * phase)
    model = fitted(FourierPhase, tangents, dials(read))
    assert separation_deg(model.predict(dials(read)), sun_of(tangents)).max() < 1e-6
    np.testing.assert_allclose(model.series_, [coefficients] * 2, atol=1e-9)
    np.testing.assert_allclose(model.conversion_, np.eye(3), atol=1e-9)
    short = fitted(FourierPhase, tangents, dials(read), harmonics=3)
    assert separation_deg(short.predict(dials(read)), sun_of(tangents)).max() > 0.05


@pytest.mark.parametrize("model", MODELS)
def test_samples_that_do_not_settle_the_fit_are_refused(model):
    one_place = np.tile(field_tangents(count=1), (200, 1))
    one_dial = np.column_stack([field_tangents()[:, 0], np.full(400, 0.3)])
    for tangents in (one_place, one_dial):
        with pytest.raises(ValueError, match="do not settle"):
            fitted(model, tangents)
    with pytest.raises(ValueError, match="3 samples give 6 angles"):
        fitted(model, field_tangents(count=3))
    tangents = field_tangents()
    signals = dials(tangents)
    with pytest.raises(ValueError, match="in front"):
        model.for_sensor(DESIGN, FeatureKind.SIGNALS).fit(signals, -sun_of(tangents))


# The extractor

"""Linear, Polynomial and LUT against NumPy's own fits and responses they must hold exactly."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.polynomial import polynomial

from algorithms.angles import angles_from_sun, separation_deg, sun_from_angles
from algorithms.contract import FeatureKind, UnusableDataError
from algorithms.models.lut.blended_polynomials import BlendedPolynomials
from algorithms.models.lut.lookup_table import ErrorTable
from algorithms.models.non_physical.linear import LinearFit
from algorithms.models.non_physical.polynomial import AxisPolynomial, SurfacePolynomial

TABLES = [ErrorTable, BlendedPolynomials]


def grid(limit=30.0, steps=13):
    axis = np.linspace(-limit, limit, steps)
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)


def scattered(limit=30.0, count=300, seed=0):
    return np.random.default_rng(seed).uniform(-limit, limit, (count, 2))


def response(features):
    """Any (alpha, beta) in degrees: bent, skewed and away from the axes."""
    x, y = features.T
    alpha = 3 + 0.9 * y + 0.05 * x + 2e-4 * y**3 - 1e-3 * x * y
    beta = -2 + 1.1 * x - 0.03 * y - 1e-4 * x**3 + 5e-4 * x**2
    return np.column_stack([alpha, beta])


def test_linear_fit_is_numpys_own():
    features = scattered() + np.array([500.0, -200.0])
    angles = response(features - np.array([500.0, -200.0]))
    model = LinearFit().fit(features, sun_from_angles(angles))
    alpha = polynomial.Polynomial.fit(features[:, 1], angles[:, 0], 1).convert().coef
    beta = polynomial.Polynomial.fit(features[:, 0], angles[:, 1], 1).convert().coef
    np.testing.assert_allclose(model.coefficients_, [alpha, beta], rtol=1e-9)


def test_linear_fit_of_tangents_inverts_a_pinhole_exactly(geometry, field):
    spot = 250.0 + 180.0 * field[:, :2] / field[:, 2:]
    model = LinearFit(target="tangent").fit(spot, field)
    assert separation_deg(model.predict(spot), field).max() < 1e-10


@pytest.mark.parametrize("degree", [1, 3, 6, 11])
def test_axis_polynomial_is_numpys_own_fit(degree):
    features = scattered() * 10 + 1000
    angles = np.column_stack(
        [30 * np.sin(features[:, 1] / 300), 25 * np.tanh((features[:, 0] - 1000) / 250)]
    )
    model = AxisPolynomial(degree=degree).fit(features, sun_from_angles(angles))
    new = scattered(25, seed=1) * 10 + 1000
    expected = np.column_stack(
        [
            polynomial.Polynomial.fit(features[:, 1], angles[:, 0], degree)(new[:, 1]),
            polynomial.Polynomial.fit(features[:, 0], angles[:, 1], degree)(new[:, 0]),
        ]
    )
    np.testing.assert_allclose(angles_from_sun(model.predict(new)), expected, atol=1e-8)


def test_axis_polynomial_holds_a_polynomial_of_its_degree_exactly():
    x, y = scattered().T
    angles = np.column_stack([1 + y - 1e-9 * y**6, 0.8 * x + 1e-5 * x**4])
    model = AxisPolynomial(degree=6).fit(np.column_stack([x, y]), sun_from_angles(angles))
    predicted = angles_from_sun(model.predict(np.column_stack([x, y])))
    np.testing.assert_allclose(predicted, angles, atol=1e-10)


@pytest.mark.parametrize("bent", [0, 1])
def test_axis_polynomials_take_the_degree_that_either_axis_needs(bent):
    angles = grid()[:, ::-1].copy()
    angles[:, bent] += 1e-7 * angles[:, bent] ** 5
    model = AxisPolynomial().fit(grid(), sun_from_angles(angles))
    np.testing.assert_allclose(angles_from_sun(model.predict(grid())), angles, atol=1e-6)


@pytest.mark.parametrize("degree", [1, 2, 4])
def test_surface_polynomial_is_the_least_squares_one_over_all_terms(degree):
    features = scattered()
    angles = response(features) + 0.5 * np.sin(features[:, ::-1] / 7)
    model = SurfacePolynomial(degree=degree).fit(features, sun_from_angles(angles))
    x, y = (features / 30).T
    terms = [x**i * y**j for i in range(degree + 1) for j in range(degree + 1 - i)]
    design = np.column_stack(terms)
    expected = design @ np.linalg.lstsq(design, angles)[0]
    np.testing.assert_allclose(angles_from_sun(model.predict(features)), expected, atol=1e-9)


def test_surface_polynomial_holds_cross_terms_that_axis_polynomials_cannot():
    features = grid()
    sun = sun_from_angles(response(features))
    surface = SurfacePolynomial(degree=3).fit(features, sun).predict(features)
    axes = AxisPolynomial(degree=3).fit(features, sun).predict(features)
    assert separation_deg(surface, sun).max() < 1e-10
    assert separation_deg(axes, sun).max() > 0.5


def test_high_degrees_keep_their_digits_far_from_the_origin():
    features = scattered(count=2000) + 1e5
    angles = response(features - 1e5)
    model = SurfacePolynomial(degree=12).fit(features, sun_from_angles(angles))
    np.testing.assert_allclose(angles_from_sun(model.predict(features)), angles, atol=1e-7)


@pytest.mark.parametrize("model", [AxisPolynomial(), SurfacePolynomial()], ids=str)
def test_polynomials_say_nothing_far_outside_the_calibration(model):
    features = grid()
    model.fit(features, sun_from_angles(response(features)))
    found = model.predict([[31.0, 0.0], [0.0, -32.4], [32.6, 0.0], [0.0, 40.0]])  # 5 a step
    assert np.isnan(found).any(axis=1).tolist() == [False, False, True, True]


@pytest.mark.parametrize(
    ("model", "needed"),
    [(LinearFit(), 3), (AxisPolynomial(degree=6), 7), (SurfacePolynomial(degree=5), 21)],
    ids=str,
)
def test_too_few_samples_are_refused_with_the_number_needed(model, needed):
    features = scattered(count=needed)
    sun = sun_from_angles(response(features))
    model.fit(features, sun)
    holes = features.copy()
    holes[0] = np.nan
    for wrong in (features[1:], holes):
        with pytest.raises(UnusableDataError, match=f"at least {needed} samples"):
            model.fit(wrong, sun[-len(wrong) :])


@pytest.mark.parametrize(
    "model", [LinearFit(), AxisPolynomial(degree=2), SurfacePolynomial(degree=2)], ids=str
)
def test_samples_that_do_not_spread_are_refused(model):
    sun = np.tile([0.0, 0.0, 1.0], (50, 1))
    with pytest.raises(UnusableDataError, match="spread"):
        model.fit(np.column_stack([np.arange(50.0), np.full(50, 3.0)]), sun)
    if not isinstance(model, LinearFit):
        two_places = np.repeat([[0.0, 0.0], [1.0, 1.0]], 25, axis=0)
        with pytest.raises(UnusableDataError, match="on one line"):
            model.fit(two_places, sun)


@pytest.mark.parametrize("model", TABLES)
def test_tables_hold_a_smooth_error_between_their_nodes(model, geometry, calibration_for):
    """Errors of a real kind, half a degree over the field, learnt from a 5 degree turntable."""
    nominal_deg = grid(32.0, 33)
    spot = geometry.centre_px + geometry.focal_length_mm / geometry.pixel_pitch_mm * np.tan(
        np.radians(nominal_deg[:, ::-1])
    )
    a, b = np.radians(nominal_deg).T
    truth = nominal_deg + np.column_stack(
        [0.5 * np.sin(3 * a) * np.cos(2 * b), 0.4 * np.sin(4 * b)]
    )
    sun = sun_from_angles(truth)
    table = model.for_sensor(geometry, FeatureKind.SPOT).fit(spot[::2], sun[::2])
    assert separation_deg(table.predict(spot), sun).max() < 0.005
    uncorrected = separation_deg(sun_from_angles(nominal_deg), sun)
    assert uncorrected.max() > 0.4


@pytest.mark.parametrize("model", TABLES)
def test_tables_hold_a_linear_error_exactly_wherever_samples_lie(model):
    """No second difference, nothing to smooth: what is left is rounding."""
    nominal = scattered(25.0, 200)
    truth = nominal + np.array([0.5, -0.3]) + 0.02 * nominal[:, ::-1]
    features = np.tan(np.radians(nominal[:, ::-1]))
    table = model(focal_length_mm=1.0, unit_mm=1.0).fit(features, sun_from_angles(truth))
    assert separation_deg(table.predict(features), sun_from_angles(truth)).max() < 1e-6


def test_error_table_nodes_are_the_errors_sampled_on_them():
    nominal = grid(10.0, 21)  # one sample on every node of the 1 degree table
    errors = np.random.default_rng(4).normal(0, 0.1, nominal.shape)
    features = np.tan(np.radians(nominal[:, ::-1]))
    table = ErrorTable(focal_length_mm=1.0, unit_mm=1.0, smoothing=1e-9)
    table.fit(features, sun_from_angles(nominal + errors))
    order = np.lexsort((nominal[:, 1], nominal[:, 0]))
    np.testing.assert_allclose(table.table_deg_[:21, :21].reshape(-1, 2), errors[order], atol=1e-6)


@pytest.mark.parametrize("long", [0, 1])
def test_a_table_reaches_as_far_along_each_axis_as_the_samples_do(long):
    """One sample on every node of an oblong field: the table holds any errors there."""
    axes = [np.arange(-3.0, 6.0), np.arange(-3.0, 6.0)]
    axes[long] = np.arange(-12.0, 9.0)
    nominal = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    sun = sun_from_angles(nominal + np.random.default_rng(4).normal(0, 0.1, nominal.shape))
    features = np.tan(np.radians(nominal[:, ::-1]))
    table = ErrorTable(focal_length_mm=1.0, unit_mm=1.0, smoothing=1e-9).fit(features, sun)
    assert separation_deg(table.predict(features), sun).max() < 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("model", TABLES)
def test_tables_average_repeated_samples(model):
    nominal = np.repeat(grid(10.0, 11), 400, axis=0)
    noise = np.random.default_rng(6).normal(0, 0.1, nominal.shape)
    features = np.tan(np.radians(nominal[:, ::-1]))
    table = model(focal_length_mm=1.0, unit_mm=1.0, interval_deg=2.0)
    table.fit(features, sun_from_angles(nominal + noise))
    error = separation_deg(table.predict(features[::400]), sun_from_angles(nominal[::400]))
    assert np.sqrt(np.mean(error**2)) < 0.1 * np.sqrt(2 / 400) * 1.3


@pytest.mark.parametrize("model", TABLES)
def test_tables_say_nothing_outside_the_calibrated_region(model):
    nominal = grid(20.0, 21)
    nominal = nominal[np.hypot(*nominal.T) < 20]  # a round field, 2 a step
    features = np.tan(np.radians(nominal[:, ::-1]))
    table = model(focal_length_mm=1.0, unit_mm=1.0).fit(features, sun_from_angles(nominal))
    asked = np.array([[0.0, 0.0], [18.3, 0.0], [0.0, -19.2], [16.0, 16.0], [19.5, 0.0]])
    found = table.predict(np.tan(np.radians(asked[:, ::-1])))
    assert np.isnan(found).any(axis=1).tolist() == [False, False, True, True, True]


@pytest.mark.parametrize("model", TABLES)
def test_tables_refuse_samples_that_span_no_region(model):
    table = model(focal_length_mm=1.0, unit_mm=1.0)
    line = np.column_stack([np.linspace(-0.5, 0.5, 60), np.linspace(-0.5, 0.5, 60)])
    sun = np.tile([0.0, 0.0, 1.0], (60, 1))
    with pytest.raises(UnusableDataError, match=r"on one line|settle"):
        table.fit(line, sun)
    with pytest.raises(UnusableDataError, match=r"at least (3|4) samples"):
        table.fit(line[:2], sun[:2])
    with pytest.raises(UnusableDataError, match="unknowns"):
        model(focal_length_mm=1.0, unit_mm=1.0, interval_deg=1e-4).fit(
            np.tan(np.radians(scattered(20.0)[:, ::-1])), sun_from_angles(scattered(20.0))
        )


@pytest.mark.parametrize("jitter", [1e-9, 1e-6, 1e-4])
def test_blended_polynomials_refuse_what_rounding_would_decide(jitter):
    """Six poses a row for nine terms: a little jitter settles them formally, by rounding alone."""
    angles = grid(20.0, 6)
    features = np.tan(np.radians(angles[:, ::-1]))
    features += jitter * np.random.default_rng(3).standard_normal(features.shape)
    rows = BlendedPolynomials(focal_length_mm=1.0, unit_mm=1.0, degree=8, smoothing=1e-3)
    with pytest.raises(UnusableDataError, match=r"settle"):
        rows.fit(features, sun_from_angles(angles))


def test_what_blended_polynomials_accept_does_not_hang_on_the_order_of_sums():
    """The same poses in another order are summed otherwise, as on another processor."""
    angles = grid(20.0, 12)
    features = np.tan(np.radians(angles[:, ::-1]))
    features += 1e-3 * np.random.default_rng(3).standard_normal(features.shape)
    rows = BlendedPolynomials(focal_length_mm=1.0, unit_mm=1.0)
    found = rows.fit(features, sun_from_angles(angles)).predict(features)
    turned = rows.fit(features[::-1], sun_from_angles(angles)[::-1]).predict(features)
    np.testing.assert_allclose(turned, found, rtol=0, atol=1e-9)

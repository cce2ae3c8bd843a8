"""SPM, LSQ and Basic: sensors built in closed form are inverted exactly."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from known_truths import rotation_about

from algorithms.angles import separation_deg, sun_from_angles, sun_from_rotations
from algorithms.contract import FeatureKind, UnusableDataError
from algorithms.models.geometric.least_squares import LeastSquaresGeometry, rotation_angles
from algorithms.models.geometric.multisensor_fusion import SixFaces
from algorithms.models.geometric.pinhole import BuiltPinhole
from algorithms.models.geometric.standard_projection import StandardProjection

FACES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))


def turntable(limit_deg=50.0, steps=11):
    axis = np.linspace(-limit_deg, limit_deg, steps)
    return np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)


def pinhole(head, focal_mm, pitch_mm, foot_px):
    """Spot of the Sun, as a head sees it, at X = h tan(beta), Y = h tan(alpha)."""
    return np.asarray(foot_px) + focal_mm / pitch_mm * head[:, :2] / head[:, 2:]


def test_spm_inverts_a_perfect_pinhole_exactly(geometry, field):
    spot = pinhole(field, geometry.focal_length_mm, geometry.pixel_pitch_mm, geometry.centre_px)
    model = StandardProjection.for_sensor(geometry, FeatureKind.SPOT).fit(spot, field)
    assert separation_deg(model.predict(spot), field).max() < 1e-11


def test_spm_angles_are_the_survey_equations():
    """eq:stdproj: alpha = arctan(Y s / h), beta = arctan(X s / h)."""
    model = StandardProjection(focal_length_mm=3.0, unit_mm=0.02, centre=(10.0, 20.0))
    x, y = 110.0, -55.0
    model.fit([[x, y]], [[0.0, 0.0, 1.0]])
    alpha = np.degrees(np.arctan((y - 20.0) * 0.02 / 3.0))
    beta = np.degrees(np.arctan((x - 10.0) * 0.02 / 3.0))
    expected = sun_from_angles([[alpha, beta]])
    np.testing.assert_allclose(model.predict([[x, y]]), expected, atol=1e-15)


def test_spm_reads_balances_of_a_square_aperture_exactly(geometry, field):
    """tan = S d / (2 h), with the balances of the lit areas themselves."""
    h, d = geometry.focal_length_mm, geometry.aperture_width_mm
    x, y = (h * field[:, :2] / field[:, 2:]).T
    balances = np.column_stack([2 * x / d, 2 * y / d])
    model = StandardProjection.for_sensor(geometry, FeatureKind.BALANCE).fit(balances, field)
    assert separation_deg(model.predict(balances), field).max() < 1e-11


def test_lsq_gives_zero_angles_at_its_zero_point():
    """ERRATA of eq:lsq: x = x_zp, y = y_zp must give alpha = beta = 0."""
    for alpha_0, beta_0 in ((0.0, 0.0), (3.0, 0.0), (0.0, -4.0), (5.0, 7.0)):
        p = np.array([0.1, *np.radians([alpha_0, beta_0]), 0.3, -0.2])
        np.testing.assert_allclose(rotation_angles(p, np.array([[0.3, -0.2]])), 0.0, atol=1e-16)


def test_lsq_follows_the_corrected_equation():
    """eq:lsq written out with its own symbols, x_zp - x replaced by x - x_zp."""
    F, dF, x_zp, y_zp = 2.0, 0.13, 0.05, -0.07
    alpha_0, beta_0 = np.radians([1.5, -2.5])
    for x, y in ((0.4, 0.9), (-1.1, 0.3), (0.0, 0.0)):
        inner = np.arctan(((x - x_zp) + (F + dF) * np.tan(beta_0)) / (F + dF))
        beta_m = -beta_0 + inner
        bracket = (y - y_zp) + (F + dF) * np.tan(alpha_0) / np.cos(beta_0)
        alpha_m = -alpha_0 + np.arctan(1 / (F + dF) * np.cos(inner) * bracket)
        p = np.array([dF / F, alpha_0, beta_0, x_zp / F, y_zp / F])
        found = rotation_angles(p, np.array([[x / F, y / F]]))
        np.testing.assert_allclose(found, [[alpha_m, beta_m]], atol=1e-15)


@pytest.mark.parametrize("boresight", [(0.0, 0.0), (1.5, 0.0), (0.0, -2.0), (0.7, 1.1)])
@pytest.mark.parametrize("focal_error_mm", [0.0, -0.15, 0.2])
def test_lsq_inverts_offset_turntable_angles_and_focal_error_exactly(
    geometry, boresight, focal_error_mm
):
    """The geometry eq:lsq describes: rotation angles with a zero off by (alpha_0, beta_0)."""
    angles = turntable()
    sun = sun_from_rotations(angles)
    head = sun_from_rotations(angles + boresight)
    focal = geometry.focal_length_mm + focal_error_mm
    spot = pinhole(head, focal, geometry.pixel_pitch_mm, (203.0, 141.0))
    model = LeastSquaresGeometry.for_sensor(geometry, FeatureKind.SPOT).fit(spot, sun)
    assert separation_deg(model.predict(spot), sun).max() < 1e-6
    found = {parameter.name: parameter.value for parameter in model.quality_.parameters}
    assert found["focal_length_error"] == pytest.approx(focal_error_mm, abs=1e-9)
    assert (found["alpha_0"], found["beta_0"]) == pytest.approx(boresight, abs=1e-8)
    zero = pinhole(sun_from_rotations([boresight]), focal, geometry.pixel_pitch_mm, (203.0, 141.0))
    assert (found["x_zp"], found["y_zp"]) == pytest.approx(tuple(zero[0]), abs=1e-6)
    assert model.quality_.residual_rms_deg < 1e-9


def test_lsq_inverts_a_head_turned_about_y_exactly(geometry):
    """A rigid turn about y only moves beta of the rotation angles."""
    sun = sun_from_angles(turntable())
    head = sun @ rotation_about(1, 1.7).T
    spot = pinhole(head, 2.05, geometry.pixel_pitch_mm, geometry.centre_px)
    model = LeastSquaresGeometry.for_sensor(geometry, FeatureKind.SPOT).fit(spot, sun)
    assert separation_deg(model.predict(spot), sun).max() < 1e-6
    assert abs(model.quality_.parameter("beta_0").value) == pytest.approx(1.7, abs=1e-8)


def test_lsq_beats_spm_for_a_head_turned_about_any_axis(geometry):
    """It holds SPM as a special case; a turn about x it cannot take up wholly."""
    sun = sun_from_angles(turntable())
    for tilt in ((0.5, 0.0), (0.5, -0.5), (-1.0, 0.3)):
        head = sun @ (rotation_about(1, tilt[1]) @ rotation_about(0, tilt[0])).T
        spot = pinhole(head, 2.04, geometry.pixel_pitch_mm, (201.0, 149.5))
        error = {
            model: separation_deg(
                model.for_sensor(geometry, FeatureKind.SPOT).fit(spot, sun).predict(spot), sun
            )
            for model in (LeastSquaresGeometry, StandardProjection)
        }
        rms = {model: np.sqrt(np.mean(values**2)) for model, values in error.items()}
        assert rms[LeastSquaresGeometry] < 0.5 * rms[StandardProjection]
        assert rms[LeastSquaresGeometry] > 1e-3  # and is no exact inverse: the docstring says so


def test_lsq_inverts_balances_with_a_wrong_focal_length_and_offset(geometry, field):
    tangents = field[:, :2] / field[:, 2:]
    balances = 2 * 2.1 / geometry.aperture_width_mm * tangents + [0.02, -0.01]
    model = LeastSquaresGeometry.for_sensor(geometry, FeatureKind.BALANCE).fit(balances, field)
    assert separation_deg(model.predict(balances), field).max() < 1e-6


@pytest.mark.parametrize(
    "features",
    [
        np.tile([200.0, 150.0], (20, 1)),  # all in one place
        np.column_stack([np.full(20, 200.0), np.linspace(50, 250, 20)]),  # alpha swept alone
    ],
)
def test_lsq_refuses_samples_that_do_not_settle_it(geometry, features):
    nominal = StandardProjection.for_sensor(geometry, FeatureKind.SPOT)
    sun = nominal.fit(features, np.tile([0.0, 0.0, 1.0], (20, 1))).predict(features)
    model = LeastSquaresGeometry.for_sensor(geometry, FeatureKind.SPOT)
    with pytest.raises(ValueError, match="on one line"):
        model.fit(features, sun)
    with pytest.raises(ValueError, match="on one line"):
        model.fit(features[:2], sun[:2])


def test_four_poses_settle_a_built_pinhole_and_three_do_not(geometry):
    """Two angles a pose against seven numbers."""
    sun = sun_from_angles([[-30.0, -20.0], [25.0, -35.0], [40.0, 30.0], [-20.0, 35.0]])
    head = sun @ rotation_about(2, 3.0) @ rotation_about(0, 0.7)
    spots = pinhole(head, 2.1, geometry.pixel_pitch_mm, (203.0, 141.0))
    model = BuiltPinhole.for_sensor(geometry, FeatureKind.SPOT).fit(spots, sun)
    between = sun_from_angles(turntable(15.0, 3))
    head = between @ rotation_about(2, 3.0) @ rotation_about(0, 0.7)
    asked = pinhole(head, 2.1, geometry.pixel_pitch_mm, (203.0, 141.0))
    assert separation_deg(model.predict(asked), between).max() < 1e-6
    with pytest.raises(UnusableDataError, match="at least 4 samples"):
        model.fit(spots[:3], sun[:3])


def test_planar_models_refuse_a_sun_behind_the_detector(geometry):
    for model in (StandardProjection, LeastSquaresGeometry):
        with pytest.raises(ValueError, match="in front"):
            model.for_sensor(geometry, FeatureKind.SPOT).fit([[200.0, 150.0]], [[0.0, 0.0, -1.0]])


directions = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3)


@settings(deadline=None, derandomize=True)
@given(directions, st.permutations(FACES), st.floats(0.01, 10))
def test_basic_inverts_cosine_faces_in_every_direction_and_order(direction, faces, light):
    sun = np.array([direction]) / np.linalg.norm(direction)
    signals = light * np.maximum(sun @ np.array(faces).T, 0.0)
    model = SixFaces(tuple(faces)).fit(signals, sun)
    assert separation_deg(model.predict(signals), sun).max() < 1e-12


def test_basic_takes_the_brighter_face_of_a_pair_and_its_side():
    """eq:msfstd with albedo on the faces away from the Sun."""
    model = SixFaces(FACES).fit(np.ones((1, 6)), [[0.0, 0.0, 1.0]])
    found = model.predict([[0.1, 0.3, 0.6, 0.2, 0.2, 0.2]])
    np.testing.assert_allclose(found, [np.array([-0.3, 0.6, 0.2]) / 0.7], atol=1e-15)
    assert np.isnan(model.predict([[0.0, -0.1, 0.0, 0.0, -0.2, 0.0]])).all()
    noisy = model.predict([[-0.01, -0.02, 0.0, 0.0, 1.0, 0.0]])
    np.testing.assert_allclose(noisy, [[0.0, 0.0, 1.0]], atol=1e-15)


@pytest.mark.slow
@pytest.mark.parametrize("of_features", [0.0, 0.05], ids=["turntable", "pixels"])
@pytest.mark.parametrize("make", [LeastSquaresGeometry, BuiltPinhole])
def test_intervals_hold_the_truth_as_often_as_they_say(make, of_features, geometry, coverage_of):
    """The truth is what a pinhole 0.1 mm too long, turned and off its centre gives noiseless."""
    angles = turntable(steps=7)
    sun = sun_from_rotations(angles)
    focal, pitch = geometry.focal_length_mm + 0.1, geometry.pixel_pitch_mm
    if make is BuiltPinhole:
        head = sun @ rotation_about(2, 1.5) @ rotation_about(0, 0.7)
    else:  # its offsets are a turntable's zeros
        head = sun_from_rotations(angles + np.array([0.7, -1.1]))
    spots = pinhole(head, focal, pitch, (203.0, 141.0))
    model = make.for_sensor(geometry, FeatureKind.SPOT).fit(spots, sun)
    assert model.quality_.residual_rms_deg < 1e-9
    assert 0.93 <= coverage_of(model, spots, sun, model.vector_.copy(), of_features) <= 0.97

"""Camera against OpenCV's projection, homography against rays on a tilted detector."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from algorithms.angles import angles_from_sun, separation_deg, sun_from_angles
from algorithms.calibration.forward import inward
from algorithms.contract import FeatureKind, SensorGeometry, UnusableDataError
from algorithms.models.geometric.bare_detector import BareDetector
from algorithms.models.geometric.camera import LensCamera

PITCH = 0.01
FOCAL = 3.0
CENTRE = (320.0, 240.0)
#: f_x, f_y mm; principal point px; k1, k2, p1, p2; rotation and tilts deg.
CAMERA = (3.02, 3.05, 324.0, 233.0, -0.15, 0.05, 0.002, -0.003, 0.5, 1.0, -0.7)
#: H by rows without its last 1, in focal lengths; k1, k2.
PLANE = (1.02, 0.01, 0.03, -0.02, 0.97, -0.05, 0.02, -0.03, -0.04, 0.01)

BUILT = {
    "camera": (LensCamera(FOCAL, PITCH, CENTRE, (-0.1, 0.0)), CAMERA),
    "homography": (BareDetector(FOCAL, PITCH, CENTRE), PLANE),
}


def field(limit_deg=35.0, steps=11):
    axis = np.linspace(-limit_deg, limit_deg, steps)
    return sun_from_angles(np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2))


def turned(axis, angle_deg):
    vector = np.zeros(3)
    vector[axis] = np.radians(angle_deg)
    return cv2.Rodrigues(vector)[0]


def opencv_spots(sun, camera=CAMERA):
    """Pixels by cv2.projectPoints, with all eleven numbers as OpenCV has them."""
    focal_x, focal_y, u, v, k1, k2, p1, p2, rotation, tilt_x, tilt_y = camera
    to_camera = (turned(0, tilt_x) @ turned(1, tilt_y) @ turned(2, rotation)).T
    intrinsic = np.array([[focal_x / PITCH, 0.0, u], [0.0, focal_y / PITCH, v], [0.0, 0.0, 1.0]])
    pixels, _ = cv2.projectPoints(
        sun[:, None],
        cv2.Rodrigues(to_camera)[0],
        np.zeros(3),
        intrinsic,
        np.array([k1, k2, p1, p2]),
    )
    return pixels[:, 0]


def test_camera_is_opencvs():
    sun = field()
    model, truth = BUILT["camera"]
    pixels = opencv_spots(sun)
    model.fit(pixels, sun)
    np.testing.assert_allclose(model.vector_, truth, atol=1e-7)
    between = field(33.0, 8)
    found = model.predict(opencv_spots(between))
    assert separation_deg(found, between).max() < 1e-6


def test_camera_without_distortion_is_the_surveys_equation():
    """eq:cameq with y as this project counts it: up the picture where alpha is positive."""
    model = LensCamera(FOCAL, PITCH, CENTRE)
    sun = field()
    pixels = np.asarray(CENTRE) + FOCAL / PITCH * sun[:, :2] / sun[:, 2:]
    u, v = pixels.T
    phi = np.degrees(np.arctan((u - CENTRE[0]) * PITCH / FOCAL))
    theta = np.degrees(np.arctan((v - CENTRE[1]) * PITCH / FOCAL))
    found = angles_from_sun(model.fit(pixels, sun).predict(pixels))
    np.testing.assert_allclose(found, np.column_stack([theta, phi]), atol=1e-9)


def test_homography_is_a_tilted_detector_behind_a_pinhole():
    """Rays through a pinhole onto a plane that stands askew, met one by one."""
    sun, tilt = field(), turned(0, 4.0) @ turned(1, -3.0) @ turned(2, 1.0)
    middle = np.array([0.02, -0.05, -FOCAL])
    across, up = tilt[:, 0], tilt[:, 1]
    spots = []
    for x, y, z in sun:
        ray = np.array([x / z, y / z, -1.0])  # axes flipped: light moves on by +tan as it falls
        _, right, above = np.linalg.solve(np.column_stack([ray, -across, -up]), middle)
        spots.append((right / PITCH, above / PITCH))
    spots = np.asarray(CENTRE) + np.array(spots)
    model = BUILT["homography"][0].fit(spots, sun)
    assert separation_deg(model.predict(spots), sun).max() < 1e-6
    stretch = [model.quality_.parameter(name).value for name in ("k1", "k2")]
    np.testing.assert_allclose(stretch, 0.0, atol=1e-8)


def test_homography_is_opencvs_perspective_of_stretched_tangents():
    sun = field()
    tangents = sun[:, :2] / sun[:, 2:]
    square = (tangents**2).sum(axis=1, keepdims=True)
    stretched = tangents * (1 + PLANE[8] * square + PLANE[9] * square**2)
    matrix = np.append(PLANE[:8], 1.0).reshape(3, 3)
    places = cv2.perspectiveTransform(stretched[:, None], matrix)[:, 0]
    model, truth = BUILT["homography"]
    model.fit(np.asarray(CENTRE) + places * FOCAL / PITCH, sun)
    np.testing.assert_allclose(model.vector_, truth, atol=1e-8)


def test_a_homography_is_a_turned_camera_until_there_is_distortion():
    """H = K R; a camera's distortion is about its own axis, a bare sensor's about the mask's."""
    sun = field()
    plain = (*CAMERA[:4], 0.0, 0.0, 0.0, 0.0, 2.0, 3.0, -2.5)
    bent = (*CAMERA[:4], -0.15, 0.05, 0.0, 0.0, 2.0, 3.0, -2.5)
    model = BareDetector(FOCAL, PITCH, CENTRE)
    assert model.fit(opencv_spots(sun, plain), sun).quality_.residual_rms_deg < 1e-9
    assert model.fit(opencv_spots(sun, bent), sun).quality_.residual_rms_deg > 0.01


def test_a_mirrored_detector_is_a_homography():
    sun = field()
    model, truth = BUILT["homography"]
    mirrored = model.cast(np.array(truth), sun[:, :2] / sun[:, 2:]) * (-1.0, 1.0)
    assert separation_deg(model.fit(mirrored, sun).predict(mirrored), sun).max() < 1e-6


def test_where_the_picture_folds_back_there_is_no_direction():
    sun, barrel = field(), -0.3  # turns back where 1 = 0.9 r^2, at 46 deg
    tangents = sun[:, :2] / sun[:, 2:]
    inside = np.hypot(*tangents.T) < 0.7
    spots = np.asarray(CENTRE) + FOCAL / PITCH * tangents * (
        1 + barrel * (tangents**2).sum(axis=1, keepdims=True)
    )
    model = LensCamera(FOCAL, PITCH, CENTRE, extrapolation=np.inf).fit(spots[inside], sun[inside])
    outermost = FOCAL / PITCH * np.sqrt(1 / 0.9) * (1 - 1 / 3)
    rim = np.array([[0.99 * outermost, 0.0], [1.01 * outermost, 0.0]])
    found = model.predict(np.asarray(CENTRE) + rim)
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1]).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILT)
def test_intervals_hold_the_truth_as_often_as_they_say(name, coverage_of):
    model, truth = BUILT[name]
    sun = field(steps=7)
    spots = model.cast(np.array(truth), inward(sun, model.turns(np.array(truth))))
    assert 0.93 <= coverage_of(model, spots, sun, truth) <= 0.97


@pytest.mark.parametrize("unit_mm", [1e-6, 1e3])
@pytest.mark.parametrize("name", BUILT)
def test_a_sensor_is_found_whatever_unit_its_spots_are_counted_in(name, unit_mm):
    sun, (model, truth) = field(), BUILT[name]
    pixels = model.cast(np.array(truth), inward(sun, model.turns(np.array(truth))))
    counted = replace(model, unit_mm=unit_mm, centre=tuple(PITCH / unit_mm * np.array(CENTRE)))
    counted.fit(PITCH / unit_mm * pixels, sun)
    assert separation_deg(counted.predict(PITCH / unit_mm * pixels), sun).max() < 1e-6
    found = {one.name: one.value for one in counted.quality_.parameters}
    for one, value in zip(model.free_parameters(), truth, strict=True):
        length = unit_mm / PITCH if one.unit == "px" else 1.0
        assert length * found[one.name] == pytest.approx(value, abs=1e-6)


@pytest.mark.parametrize("name", BUILT)
def test_poses_that_do_not_settle_a_sensor_are_refused(name):
    model, sun = BUILT[name][0], field()
    spots = opencv_spots(sun)
    for rows in (np.arange(3), np.zeros(60, dtype=int)):
        with pytest.raises(UnusableDataError, match=name):
            model.fit(spots[rows], sun[rows])


def test_a_camera_is_what_has_a_lens():
    bare = SensorGeometry(focal_length_mm=FOCAL, pixel_pitch_mm=PITCH, centre_px=CENTRE)
    with pytest.raises(ValueError, match="lens_distortion"):
        LensCamera.for_sensor(bare, FeatureKind.SPOT)
    assert BareDetector.for_sensor(bare, FeatureKind.SPOT).focal_length_mm == FOCAL

"""Lines and circles by Hough transforms against OpenCV, brute force, least squares and geometry."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares
from scipy.special import ndtr

from algorithms.angles import sun_from_angles
from algorithms.contract import SensorGeometry
from algorithms.extractors.frames.cameras.blooming_cameras import (
    LineCamera,
    sun_from_blooming_lines,
)
from algorithms.extractors.frames.cameras.hough import HoughCircle, HoughLines


def blooming(centres, *, shape=(120, 90), half_length=40.0, lean=0.0, noise=1.0, seed=0):
    """Frames of saturated Suns in halos with a line of columns as long as each one's light."""
    y, x = np.mgrid[: shape[0], : shape[1]]
    rng = np.random.default_rng(seed)
    frames = np.empty((len(centres), *shape))
    for frame, (a, b) in zip(frames, centres, strict=True):
        r2 = (x - a) ** 2 + (y - b) ** 2
        frame[:] = 10 + 2000 * (1 + r2 / 4) ** -1.5
        away = x - a + np.tan(np.radians(lean)) * (y - b)
        length = half_length * np.exp(-(away**2) / 4)
        frame[(np.abs(y - b) < length) & (np.abs(away) < 3)] = 240
    frames = np.minimum(frames, 240) + noise * rng.standard_normal(frames.shape)
    return np.clip(np.rint(frames), 0, 255).astype(np.uint8)


def discs(centres, radius, *, shape=(60, 64), peak=800.0, noise=3.0, seed=0):
    y, x = np.mgrid[: shape[0], : shape[1]]
    rng = np.random.default_rng(seed)
    light = [20 + peak * ndtr((radius - np.hypot(x - a, y - b)) / 0.7) for a, b in centres]
    frames = np.stack(light) + noise * rng.standard_normal((len(light), *shape))
    return np.clip(np.rint(frames), 0, 4095).astype(np.uint16)


# Lines

places = st.tuples(st.floats(30.0, 60.0), st.floats(45.0, 75.0))


@settings(deadline=None, derandomize=True, max_examples=40)
@given(places)
def test_the_sun_on_its_blooming_line_is_found(place):
    found = HoughLines().extract(blooming([place]))
    np.testing.assert_allclose(found, [place], atol=0.25)


@pytest.mark.parametrize("lean", [-4.0, -2.0, 0.0, 3.0])
def test_opencv_finds_the_same_line(lean):
    """OpenCV votes with the edge pixels at whole cells: its line is ours to a cell."""
    frame = blooming([(44.3, 60.2)], lean=lean)[0]
    edges = cv2.Canny(frame, 100, 200)
    found = cv2.HoughLines(edges, 1, np.radians(0.25), 25)[:, 0, :2].astype(float)
    found[found[:, 0] < 0] = -found[found[:, 0] < 0] + [0, np.pi]
    flat = found[np.abs(np.sin(found[:, 1])) < np.sin(np.radians(8.0))]
    ends = HoughLines(tilt_deg=6.0).lines(frame[None])[0]
    for x, y in (ends[:2], ends[2:4]):
        assert flat.size
        theirs = (flat[:, 0] - y * np.sin(flat[:, 1])) / np.cos(flat[:, 1])
        assert np.min(np.abs(theirs - x)) < 3.0  # half a line's width: it has the edges


@settings(deadline=None, derandomize=True, max_examples=20)
@given(places, st.floats(-4.0, 4.0))
def test_the_votes_are_those_of_the_printed_accumulator(place, lean):
    """H[r, theta] by brute force over all middles of runs and all angles."""
    frame = blooming([place], lean=lean)[0]
    level = frame.min() + 0.8 * (float(frame.max()) - frame.min())
    middles = []
    for row, line in enumerate(frame > level):
        steps = np.flatnonzero(np.diff(np.concatenate([[0], line, [0]])))
        runs = steps.reshape(-1, 2)
        keep = [0] + [n for n in range(1, len(runs)) if runs[n, 0] - runs[n - 1, 1] > 1]
        for n, first in enumerate(keep if len(runs) else ()):
            last = (keep[n + 1] if n + 1 < len(keep) else len(runs)) - 1
            middles.append(((runs[first, 0] + runs[last, 1] - 1) / 2, row))
    x, y = np.array(middles).T
    votes = 0.0
    for theta in np.radians(np.arange(-20, 21) * 0.25):
        r = x * np.cos(theta) + y * np.sin(theta)
        cells = np.zeros(400)
        np.add.at(cells, np.floor(r).astype(int) + 200, 1 - (r - np.floor(r)))
        np.add.at(cells, np.floor(r).astype(int) + 201, r - np.floor(r))
        votes = max(votes, cells.max())
    assert HoughLines(tilt_deg=5.0).lines(frame[None])[0, 4] == pytest.approx(votes, abs=1e-9)


def test_dead_pixels_and_a_cut_line_do_not_matter():
    where = np.array([[40.3, 30.4], [50.7, 92.2], [44.1, 60.9]])
    frames = blooming(where, half_length=50.0)
    frames[:, 5::9, 4::7] = 3
    np.testing.assert_allclose(HoughLines().extract(frames), where, atol=0.3)


def test_without_a_blooming_line_nothing_is_found():
    noise = np.random.default_rng(1).integers(0, 40, (120, 90)).astype(np.uint16)
    for frame in (noise, discs([(40, 50)], 14.0, shape=(120, 90))[0]):
        assert np.isnan(HoughLines().extract(frame[None])).all()
        assert np.isnan(HoughLines().lines(frame[None])).all()


@pytest.mark.parametrize("turn_deg", [-75.0, -40.0, 20.0, 50.0, 90.0])
def test_a_line_at_any_angle_is_found(turn_deg):
    """As in alg:BHT, whose angle goes through half a turn; columns alone do not see it."""
    y, x = np.mgrid[:110, :110]
    c, s = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    across, along = (x - 55) * c + (y - 55) * s, (y - 55) * c - (x - 55) * s
    frame = 10 + 2000 * (1 + ((x - 55) ** 2 + (y - 55) ** 2) / 4) ** -1.5
    frame[(np.abs(across) <= 1.5) & (np.abs(along) < 45)] = 240
    frame = np.minimum(frame, 240)[None]
    ends = HoughLines().lines(frame)[0]
    found = np.degrees(np.arctan2(-(ends[2] - ends[0]), ends[3] - ends[1]))
    assert abs((found - turn_deg + 90) % 180 - 90) < 0.6
    np.testing.assert_allclose(HoughLines().extract(frame), [[55, 55]], atol=0.3)
    assert np.isnan(HoughLines(tilt_deg=0.0).lines(frame)).all()


def test_a_line_covered_by_a_cloud_is_a_line_without_a_place():
    frame = blooming([(44.3, 60.2)])
    y, x = np.mgrid[:120, :90]
    frame[0, np.hypot(x - 48, y - 66) < 14] = 240
    assert np.isnan(HoughLines().extract(frame)).all()
    np.testing.assert_allclose(HoughLines().lines(frame)[0, [0, 2]], 44.3, atol=1.0)


# Several cameras


def rotation(turns_deg):
    a, b, c = np.radians(turns_deg)
    about_x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    about_z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    return tuple(map(tuple, about_x @ about_y @ about_z))


CAMERAS = [
    LineCamera(3.0, 0.01, (127.5, 127.5), (-0.15, 0.05), rotation((3.0, -2.0, 0.0))),
    LineCamera(2.5, 0.012, (120.0, 130.0), (-0.1, 0.02), rotation((-4.0, 1.0, 70.0))),
    LineCamera(4.0, 0.008, (140.0, 125.0), (0.08, 0.0), rotation((0.0, 5.0, -55.0))),
]


def column_lines(camera, sun, rng, off=0.0):
    """Columns through the Sun's image, of any length, the Sun anywhere on them."""
    point = camera.points_px(sun) + off * rng.standard_normal((len(sun), 1)) * [1.0, 0.0]
    up, down = rng.uniform(-90, -5, len(sun)), rng.uniform(5, 90, len(sun))
    x, y = point.T
    return np.column_stack([x, y + up, x, y + down, down - up])


def test_lines_of_distorted_cameras_meet_exactly_in_the_sun():
    rng = np.random.default_rng(2)
    sun = sun_from_angles(rng.uniform(-15, 15, (50, 2)))
    for chosen in (CAMERAS[:2], CAMERAS):
        lines = [column_lines(camera, sun, rng) for camera in chosen]
        np.testing.assert_allclose(sun_from_blooming_lines(lines, chosen), sun, atol=1e-10)


def test_without_the_distortion_they_would_not():
    rng = np.random.default_rng(3)
    sun = sun_from_angles(rng.uniform(-15, 15, (50, 2)))
    lines = [column_lines(camera, sun, rng) for camera in CAMERAS]
    plain = [
        LineCamera(c.focal_length_mm, c.pixel_pitch_mm, c.centre_px, rotation=c.rotation)
        for c in CAMERAS
    ]
    error = np.degrees(np.linalg.norm(sun_from_blooming_lines(lines, plain) - sun, axis=1))
    assert np.sqrt(np.mean(error**2)) > 0.05


def test_a_third_camera_lessens_the_noise_and_a_missing_line_is_left_out():
    rng = np.random.default_rng(4)
    sun = sun_from_angles(rng.uniform(-12, 12, (400, 2)))
    lines = [column_lines(camera, sun, rng, off=0.3) for camera in CAMERAS]
    rms = [
        np.sqrt(np.mean((sun_from_blooming_lines(lines[:n], CAMERAS[:n]) - sun) ** 2))
        for n in (2, 3)
    ]
    assert rms[1] < 0.95 * rms[0]
    missing = [lines[0], lines[1], np.full_like(lines[2], np.nan)]
    np.testing.assert_array_equal(
        sun_from_blooming_lines(missing, CAMERAS), sun_from_blooming_lines(lines[:2], CAMERAS[:2])
    )
    one = [lines[0], *(np.full_like(line, np.nan) for line in lines[1:])]
    assert np.isnan(sun_from_blooming_lines(one, CAMERAS)).all()


def test_parallel_lines_do_not_meet():
    rng = np.random.default_rng(5)
    sun = sun_from_angles(rng.uniform(-12, 12, (5, 2)))
    twin = [CAMERAS[0], CAMERAS[0]]
    lines = [column_lines(camera, sun, rng) for camera in twin]
    assert np.isnan(sun_from_blooming_lines(lines, twin)).all()


def test_wrong_lines_and_cameras_are_named():
    line = np.ones((3, 5))
    with pytest.raises(ValueError, match="two cameras"):
        sun_from_blooming_lines([line], CAMERAS[:1])
    with pytest.raises(ValueError, match=r"\(3, 5\)"):
        sun_from_blooming_lines([line, line[:, :4]], CAMERAS[:2])
    with pytest.raises(ValueError, match="rotation"):
        LineCamera(1.0, 0.01, (0.0, 0.0), rotation=((1, 0, 0), (0, 1, 0), (0, 0, 2)))
    with pytest.raises(ValueError, match="focal_length_mm"):
        LineCamera.for_sensor(SensorGeometry())


# Circles


@settings(deadline=None, derandomize=True, max_examples=40)
@given(st.floats(20.0, 42.0), st.floats(20.0, 38.0), st.floats(4.0, 14.0))
def test_a_circle_of_unknown_radius_is_found(x, y, radius):
    frames = discs([(x, y)], radius)
    np.testing.assert_allclose(HoughCircle().circles(frames), [[x, y, radius]], atol=0.2)


def test_opencv_and_the_printed_accumulator_find_the_same_circle():
    """alg:CHT by brute force over all centres, radii and edge pixels; both at whole cells."""
    for n, place in enumerate(np.random.default_rng(6).uniform(24, 36, (4, 2))):
        frame = discs([place], 8.0, seed=n)
        found = HoughCircle().circles(frame)[0]
        image = np.clip(frame[0] / 4.0, 0, 255).astype(np.uint8)
        theirs = cv2.HoughCircles(image, cv2.HOUGH_GRADIENT, 1, 60, param1=100, param2=8)
        np.testing.assert_allclose(found, theirs[0, 0], atol=1.5)
        rows, columns = np.nonzero(cv2.Canny(image, 100, 200))
        b, a = np.mgrid[:60, :64]
        r = np.hypot(a[..., None] - columns, b[..., None] - rows)
        votes = np.stack([(np.rint(r) == k).sum(axis=2) for k in range(3, 30)])
        k, b, a = np.unravel_index(np.argmax(votes), votes.shape)
        np.testing.assert_allclose(found, (a, b, k + 3), atol=1.5)


def test_the_circle_is_the_fit_of_the_true_shape_to_within_its_noise():
    places = np.random.default_rng(7).uniform(24, 36, (30, 2))
    frames = discs(places, 8.0)
    rows, columns = np.indices(frames.shape[1:])
    found, fits = HoughCircle().extract(frames), []
    for frame, place in zip(frames, places, strict=True):

        def residuals(p, frame=frame):
            r = np.hypot(columns - p[0], rows - p[1])
            return (frame.astype(float) - 20 - 800 * ndtr((8 - r) / 0.7)).ravel()

        fits.append(least_squares(residuals, place).x)
    assert np.sqrt(np.mean((found - fits) ** 2)) < 0.03


def test_missing_parts_noise_and_a_bright_line_leave_the_circle_where_it_is():
    frames = discs([(30.4, 28.7)] * 3, 9.0)
    frames[0, 28:, 31:] = 20  # a quarter of it gone
    frames[1, 40:43] = 800
    frames[2] += np.random.default_rng(8).integers(0, 60, frames[2].shape).astype(np.uint16)
    np.testing.assert_allclose(HoughCircle().extract(frames), [[30.4, 28.7]] * 3, atol=0.3)


def test_a_dark_circle_comes_first_where_the_sun_may_be_black():
    """The halo's rim is a circle too, about another point."""
    frames = discs([(30.0, 30.0)], 14.0)
    y, x = np.mgrid[:60, :64]
    frames[0][np.hypot(x - 32.3, y - 27.8) < 4.0] = 20
    found = HoughCircle(dark_first=True).circles(frames)[0]
    np.testing.assert_allclose(found, [32.3, 27.8, 4.0], atol=0.3)


def test_bad_frames_have_no_circle():
    noise = np.random.default_rng(9).normal(100, 5, (60, 64))
    line = np.full((60, 64), 20.0)
    line[:, 30:34] = 800
    two = np.maximum(*discs([(16, 30), (46, 30)], 7.0).astype(float))
    cut = discs([(-2.0, 30.0)], 8.0)[0]
    for frame in (noise, line, two, cut):
        assert np.isnan(HoughCircle(sure=True).extract(frame[None])).all()
    found = HoughCircle().extract(two[None])[0]  # as published: one of them, unseen
    assert min(np.hypot(*(found - place)) for place in ((16, 30), (46, 30))) < 0.2


# Both


def test_designs_that_do_not_fit_are_refused():
    hole = SensorGeometry(pixel_pitch_mm=0.01, aperture_width_mm=0.2, aperture_shape="round")
    assert HoughCircle.for_sensor(hole) == HoughCircle()
    with pytest.raises(ValueError, match="lens_distortion"):
        HoughLines.for_sensor(hole)
    for field, value in (
        ("aperture_shape", "square"),
        ("apertures", ((0.0, 0.0, 0.1),)),
        ("slits", ((0.0, 0.0, 0.1),)),
    ):
        with pytest.raises(ValueError, match=field):
            HoughCircle.for_sensor(replace(hole, **{field: value}))

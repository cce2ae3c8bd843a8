"""PPE against SciPy's least squares on the printed model, its derivatives and image types."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares
from scipy.special import ndtr

from algorithms.contract import SensorGeometry
from algorithms.extractors.profiles import peak_fit_kernel
from algorithms.extractors.profiles.peak_position import (
    SLIT_IMAGE,
    FramePeakPositionEstimate,
    PeakPositionEstimate,
)

IMAGES = ("rational", "gaussian", "diffraction")
#: One line behind two crossed pairs: A and B shift by D_x - D_y, C and D by D_x + D_y.
OFFSETS = np.array([-60.0, -30.0, 20.0, 70.0])
CROSSED = PeakPositionEstimate(
    line_axes=("x",),
    line_pixels=400,
    slits=tuple((o, t, 10.0) for o, t in zip(OFFSETS, (-1.0, -1.0, 1.0, 1.0), strict=True)),
    reach_px=55.0,
    margin_px=3.0,
)
MIDDLE = 199.5


def image(u, kind):
    """I_mdl1 of alg:PPE, and its two other choices with their half at one."""
    if kind == "rational":
        c1, c2, c3, c4, c5, c6 = SLIT_IMAGE
        return (c1 * u**4 + c2 * u**2 + c3) / (c4 * u**4 + c5 * u**2 + c6)
    if kind == "gaussian":
        return 0.5 ** (u**2)
    return np.sinc(1.3915573782515103 * u / np.pi) ** 2


def model(parameters, kind, shared=None, length=400):
    """I_mdl of alg:PPE for a_1, a_2, b_1, b_2, m_x, m_y; images end at eight half widths."""
    *amplitudes, m_x, m_y = parameters
    if shared is not None:
        amplitudes[shared[1]] = amplitudes[shared[0]]
    n = np.arange(length)
    total = np.zeros(length)
    for a, offset, shift in zip(amplitudes, OFFSETS, (m_x, m_x, m_y, m_y), strict=True):
        u = (n - MIDDLE - offset - shift) / 5.0
        total += a * np.where(np.abs(u) <= 8, image(u, kind), 0.0)
    return total


def shadows(spot, light=(1.0, 1.0, 1.0, 1.0), peak=2000.0, floor=25.0):
    """Blurred shadows of the four slits for a spot's displacement (D_x, D_y), px."""
    n = np.arange(400)
    line = np.full(400, floor)
    shifts = (spot[0] - spot[1], spot[0] + spot[1])
    for k, (offset, a) in enumerate(zip(OFFSETS, light, strict=True)):
        u = n - MIDDLE - offset - shifts[k // 2]
        line += a * peak * (ndtr((u + 5) / 1.5) - ndtr((u - 5) / 1.5))
    return line


def noisy(lines, seed):
    rng = np.random.default_rng(seed)
    return np.rint(rng.poisson(lines) + rng.normal(0, 8, lines.shape)).clip(0).astype(np.uint16)


@pytest.mark.parametrize("kind", IMAGES)
def test_the_normal_equations_are_those_of_differenced_residuals(kind):
    """Q by central differences of the printed model, for image type 3 (A and D share)."""
    truth = np.array([900.0, 700.0, 1100.0, 20.0, -10.0])  # a_1 = b_2, a_2, b_1, m_x, m_y
    row = np.random.default_rng(1).uniform(0, 1000, 400)

    def line(p):
        return model((p[0], p[1], p[2], p[0], p[3], p[4]), kind)

    steps = np.diag([1e-3, 1e-3, 1e-3, 1e-5, 1e-5])
    q = np.column_stack([(line(truth + s) - line(truth - s)) / (2 * s.max()) for s in steps])
    matrix, right = np.empty((6, 6)), np.empty(6)
    peak_fit_kernel.normal_equations(
        row,
        0.0,
        MIDDLE + OFFSETS,
        np.array([0, 0, 1, 1]),
        np.full(4, 5.0),
        np.array([0, 1, 2, 0]),
        peak_fit_kernel.number_items(kind),
        np.array(SLIT_IMAGE),
        truth,
        truth,
        matrix,
        right,
    )
    np.testing.assert_allclose(np.tril(matrix[:5, :5]), np.tril(q.T @ q), rtol=1e-5, atol=1e-2)
    np.testing.assert_allclose(right[:5], q.T @ (row - line(truth)), rtol=1e-5, atol=1e-2)


#: Differences D_y that lay one peak of either pair on one of the other, and which those are.
TYPES = {
    0: ((12.0, 3.0), (-1, -1), None),
    1: ((8.0, -38.9), (0, 2), (0, 2)),  # A and C: -60 - D_y = 20 + D_y
    2: ((8.0, -24.2), (1, 2), (1, 2)),
    4: ((8.0, -49.1), (1, 3), (1, 3)),
}


@pytest.mark.parametrize("kind", IMAGES)
@pytest.mark.parametrize("number", TYPES)
def test_the_fit_is_scipys_for_every_image_type(number, kind):
    spot, pair, shared = TYPES[number]
    line = noisy(shadows(spot), number)
    extractor = replace(CROSSED, image=kind, tolerance=1e-9, iterations=80)
    shifts, pairs = extractor.fit(line[None])
    assert tuple(pairs[0]) == pair
    light = line - float(np.median(line))
    start = (2000.0, 2000.0, 2000.0, 2000.0, spot[0] - spot[1], spot[0] + spot[1])
    expected = least_squares(
        lambda p: light - model(p, kind, shared), start, xtol=1e-14, ftol=1e-14, x_scale="jac"
    )
    np.testing.assert_allclose(shifts[0], expected.x[4:], rtol=0, atol=2e-5)


@pytest.mark.parametrize("kind", IMAGES)
@pytest.mark.parametrize("width", [2.0, 3.0, 5.0, 10.0])
def test_spots_between_two_pixels_are_found_without_noise(width, kind):
    """Two pixels tie, and one may lie on the border of those that count: the fit ends all the same.

    A symmetric light about a shift that is a multiple of half a pixel is fitted at that shift.
    """
    slits = tuple((o, t, width) for o, t, _ in CROSSED.slits)
    extractor = replace(CROSSED, slits=slits, image=kind)
    steps = np.arange(-3.0, 3.1, 0.5)
    spots = np.array([(x, y) for x in steps for y in steps])
    n = np.arange(400)
    lines = np.full((len(spots), 400), 25.0)
    blur = 0.15 * width  # of the half width 0.3, as the rational image has it
    for row, (x, y) in enumerate(spots):
        for k, offset in enumerate(OFFSETS):
            u = n - MIDDLE - offset - (x - y if k < 2 else x + y)
            lines[row] += 2000.0 * (ndtr((u + width / 2) / blur) - ndtr((u - width / 2) / blur))
    np.testing.assert_allclose(extractor.extract(lines) - MIDDLE, spots, rtol=0, atol=0.01)


@pytest.mark.parametrize("kind", IMAGES)
def test_a_slit_narrower_than_a_pixel_is_found_where_two_pixels_share_it(kind):
    slits = tuple((o, t, 0.5) for o, t, _ in CROSSED.slits)
    extractor = replace(CROSSED, slits=slits, image=kind)
    line = np.full(400, 25.0)
    for k, offset in enumerate(OFFSETS):  # D_x = 2, D_y = 1: half between two pixels
        first = int(MIDDLE + offset + (1 if k < 2 else 3))
        line[first : first + 2] += 1000.0
    np.testing.assert_allclose(extractor.extract(line[None])[0] - MIDDLE, [2.0, 1.0], atol=1e-4)


def test_image_type_three_is_a_and_d():
    """Pairs so far apart that D of the second lies on A of the first need another mask."""
    slits = tuple((-o, t, w) for o, t, w in CROSSED.slits)  # mirrored: A right, D left
    mirrored = replace(CROSSED, slits=slits, reach_px=75.0)
    spot = (5.0, 65.4)
    line = shadows((-spot[0], -spot[1]))[::-1]
    assert tuple(mirrored.image_types(line[None])[0]) == (0, 3)
    np.testing.assert_allclose(mirrored.extract(line[None])[0] - MIDDLE, spot, atol=0.05)


@pytest.mark.parametrize("kind", IMAGES)
@settings(deadline=None, derandomize=True, max_examples=25)
@given(st.floats(-30, 30), st.floats(-12, 30), st.floats(0.6, 1.0))
def test_the_model_itself_is_inverted_exactly(kind, d_x, d_y, dim):
    """lambda + d_lambda: with the printed update, no parameter would ever move."""
    light = model((1000, 1000 * dim, 1000, 900, d_x - d_y, d_x + d_y), kind)
    found = replace(CROSSED, image=kind, tolerance=1e-8).extract(light[None])
    floor = np.median(light)  # the tails of the images lie in what is taken for dark
    atol = 1e-3 + 0.002 * abs(floor)
    np.testing.assert_allclose(found[0] - MIDDLE, (d_x, d_y), rtol=0, atol=atol)


def test_all_pixels_say_more_than_the_brightest():
    """To some hundredths of a pixel, also where peaks overlap."""
    rng = np.random.default_rng(4)
    spots = np.column_stack([rng.uniform(-30, 30, 200), rng.uniform(-45, 45, 200)])
    lines = noisy(np.stack([shadows(spot) for spot in spots]), 4)
    found = CROSSED.extract(lines) - MIDDLE
    seen = ~np.isnan(found[:, 0])
    assert seen.mean() > 0.95
    assert np.sqrt(np.mean((found[seen] - spots[seen]) ** 2)) < 0.05


def test_slits_in_each_others_way_get_their_own_amplitudes_when_apart():
    line = shadows((0.0, 10.0), light=(1.0, 0.7, 0.9, 0.6))
    np.testing.assert_allclose(CROSSED.extract(line[None])[0] - MIDDLE, (0.0, 10.0), atol=0.01)


def test_no_peaks_or_a_missing_one_are_not_found():
    noise = noisy(np.full((1, 400), 30.0), 5)[0]
    missing = shadows((3.0, 5.0), light=(1.0, 0.0, 1.0, 1.0))
    second = shadows((3.0, 5.0)) + shadows((20.0, 29.0))
    off = shadows((130.0, 40.0))
    for line in (noise, missing, second, off, np.full(400, 4095.0)):
        assert np.isnan(CROSSED.extract(line[None])).all()


# Frames


def discs(centres, shape=(60, 64), radius=6.5, peak=2000.0):
    y, x = np.mgrid[: shape[0], : shape[1]]
    return np.stack(
        [20.0 + peak * ndtr((radius - np.hypot(x - a, y - b)) / 0.7) for a, b in centres]
    )


def test_frames_are_fitted_as_scipy_fits_their_profiles():
    centres = np.random.default_rng(6).uniform(20, 38, (5, 2))
    frames = noisy(discs(centres), 6)
    extractor = FramePeakPositionEstimate(width_px=12.0, tolerance=1e-9, iterations=80)
    found = extractor.extract(frames)
    for k, frame in enumerate(frames):
        for axis in range(2):
            profile = frame.sum(axis=axis).astype(float)
            light, n = profile - np.median(profile), np.arange(profile.size)

            def residuals(p, light=light, n=n):
                u = (n - p[1]) / 6.0
                return light - p[0] * np.where(np.abs(u) <= 8, image(u, "rational"), 0.0)

            start = (light.max(), float(light.argmax()))
            fitted = least_squares(residuals, start, xtol=1e-14, ftol=1e-14, x_scale="jac")
            assert found[k, axis] == pytest.approx(fitted.x[1], abs=2e-5)


@pytest.mark.parametrize("kind", IMAGES)
def test_a_disc_in_a_frame_is_found_to_a_tenth_of_a_pixel(kind):
    centres = np.random.default_rng(7).uniform(14, 45, (60, 2))
    found = FramePeakPositionEstimate(image=kind).extract(noisy(discs(centres), 7))
    assert np.sqrt(np.mean((found - centres) ** 2)) < 0.1


def test_a_frame_without_a_whole_spot_is_not_found_outside_it():
    frames = np.random.default_rng(15).integers(0, 50, (40, 30, 34)).astype(np.uint16)
    found = FramePeakPositionEstimate().extract(frames)
    inside = (found >= -0.5) & (found <= [33.5, 29.5])
    assert (inside | np.isnan(found)).all()


def test_many_spots_are_refused():
    holes = SensorGeometry(apertures=((0.0, 0.0, 0.1), (1.0, 0.0, 0.1)))
    with pytest.raises(ValueError, match="one spot"):
        FramePeakPositionEstimate.for_sensor(holes)

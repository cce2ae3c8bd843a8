"""DBCM, MT-ACM, TM and Gaussian fit against the printed loops and SciPy."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import curve_fit
from scipy.special import ndtr

from algorithms.contract import SensorGeometry
from algorithms.extractors.frames.balance import DoubleBalance
from algorithms.extractors.frames.gaussian import GaussianFit
from algorithms.extractors.frames.template import TemplateMatch
from algorithms.extractors.frames.threshold_average import MultipleThresholdCentroid

ALL = [
    DoubleBalance(),
    MultipleThresholdCentroid(),
    MultipleThresholdCentroid(crossing="linear"),
    TemplateMatch(width_px=13.0),
    GaussianFit(),
]


def discs(centres, shape=(60, 64), radius=6.5, peak=2000.0):
    background, edge = 20.0, 0.7
    y, x = np.mgrid[: shape[0], : shape[1]]
    return np.stack(
        [background + peak * ndtr((radius - np.hypot(x - a, y - b)) / edge) for a, b in centres]
    )


def gaussians(centres, shape=(40, 44), sigma=3.0, peak=200.0, background=20.0):
    y, x = np.mgrid[: shape[0], : shape[1]]
    r2 = np.stack([(x - a) ** 2 + (y - b) ** 2 for a, b in centres])
    return background + peak * np.exp(-r2 / (2 * sigma**2))


def noisy(frames, seed, read_noise=10.0):
    rng = np.random.default_rng(seed)
    signal = rng.poisson(frames) + rng.normal(0, read_noise, frames.shape)
    return np.clip(np.rint(signal), 0, 4095).astype(np.uint16)


def rms(found, centres):
    return float(np.sqrt(np.mean((found - centres) ** 2)))


centres_inside = st.tuples(st.floats(20.0, 40.0), st.floats(20.0, 38.0))


# DBCM


def dbcm_as_printed(image):
    """alg:DBCM with the window moved by the rounded offset; areas 1 | 9 | 1 | 9 | 1."""
    row, column = np.unravel_index(np.argmax(image), image.shape)
    for _ in range(10):
        window = image[row - 10 : row + 11, column - 10 : column + 11].astype(float)
        offsets = []
        for sums in (window.sum(axis=0), window.sum(axis=1)):
            a, b, c, d, e = np.split(sums, [1, 10, 11, 20])
            balance = (d.sum() - b.sum()) / (2 * c.sum() - a.sum() - e.sum())
            offsets.append(min(max(balance, -5.0), 5.0))
        if max(map(abs, offsets)) <= 0.5:
            return [column + offsets[0], row + offsets[1]]
        column, row = column + round(offsets[0]), row + round(offsets[1])
    raise AssertionError("the printed balance did not settle")


@settings(deadline=None, derandomize=True, max_examples=40)
@given(centres_inside)
def test_dbcm_is_the_printed_balance(centre):
    frames = np.rint(discs([centre], radius=5.0)).astype(np.uint16)
    found = DoubleBalance().extract(frames)
    np.testing.assert_allclose(found[0], dbcm_as_printed(frames[0]), rtol=0, atol=1e-12)


@settings(deadline=None, derandomize=True, max_examples=40)
@given(st.tuples(st.floats(24.0, 36.0), st.floats(24.0, 34.0)))
def test_dbcm_balances_a_square_exactly(centre):
    """A sharp square's columns are equal: moving the balance by dx moves 2 dx of a column."""
    y, x = np.mgrid[:60, :64]
    cover = [
        np.clip(5.0 - np.abs(axis - c) + 0.5, 0, 1) for axis, c in zip((x, y), centre, strict=True)
    ]
    frame = 100.0 + 1000.0 * cover[0] * cover[1]
    np.testing.assert_allclose(DoubleBalance().extract(frame[None])[0], centre, atol=1e-9)


def test_dbcm_starts_anywhere_on_a_saturated_spot():
    """The first of equal maxima lies on the rim, farthest from the centre."""
    centres = np.array([[30.25, 28.5], [31.75, 30.0]])
    frames = np.minimum(discs(centres, radius=7.5), 1000).astype(np.uint16)
    np.testing.assert_allclose(DoubleBalance().extract(frames), centres, atol=0.03)


def test_dbcm_ignores_a_second_weaker_spot_outside_its_window():
    frames = discs([[16.0, 16.0]], radius=4) + discs([[50.0, 44.0]], radius=4, peak=1500.0)
    np.testing.assert_allclose(DoubleBalance().extract(frames), [[16.0, 16.0]], atol=1e-9)


# MT-ACM


def mt_acm_as_printed(image, accuracy, lowest, highest):
    """alg:MTACM1 and MTACM2 along both axes."""
    found = []
    for profile in (image.sum(axis=0).astype(float), image.sum(axis=1).astype(float)):
        floor, peak = np.median(profile), profile.max()
        sigma = (profile - floor).sum() / ((peak - floor) * math.sqrt(2 * math.pi))
        number = 1
        while not number > sigma * math.sqrt(math.e) / accuracy:
            number += 1
        middles = []
        for step in range(number):
            part = lowest + (step + 0.5) * (highest - lowest) / number
            binary = profile > floor + part * (peak - floor)
            rises = [j for j in range(1, len(binary)) if binary[j] and not binary[j - 1]]
            falls = [j for j in range(len(binary) - 1) if binary[j] and not binary[j + 1]]
            if not binary[0] and not binary[-1]:
                middles.append((rises[0] + falls[-1]) / 2)
        found.append(np.mean(middles))
    return found


@settings(deadline=None, derandomize=True, max_examples=30)
@given(centres_inside, st.sampled_from([0.5, 0.1, 0.03]), st.integers(0, 5))
def test_mt_acm_is_the_printed_loop(centre, accuracy, seed):
    frames = noisy(discs([centre]), seed)
    extractor = MultipleThresholdCentroid(accuracy_px=accuracy, lowest=0.2, highest=0.8)
    expected = mt_acm_as_printed(frames[0], accuracy, 0.2, 0.8)
    np.testing.assert_allclose(extractor.extract(frames)[0], expected, rtol=0, atol=1e-9)


def test_thresholds_by_the_rule_reach_the_wanted_accuracy_on_a_noiseless_gaussian():
    """The rule bounds the spacing of crossings; the mean over them keeps it and shrinks with it."""
    centres = np.random.default_rng(2).uniform(18, 24, (60, 2))
    errors = {}
    for accuracy in (0.5, 0.1, 0.02):
        extractor = MultipleThresholdCentroid(accuracy_px=accuracy, lowest=0.1)
        errors[accuracy] = rms(extractor.extract(gaussians(centres)), centres)
        assert errors[accuracy] < max(accuracy, 0.05)
    assert errors[0.02] < errors[0.5]


def test_interpolated_crossings_are_finer_than_plain_ones_without_noise():
    centres = np.random.default_rng(2).uniform(26, 34, (60, 2))
    frames = discs(centres)
    plain = rms(MultipleThresholdCentroid().extract(frames), centres)
    linear = rms(MultipleThresholdCentroid(crossing="linear").extract(frames), centres)
    assert linear < 0.5 * plain


def test_thresholds_that_one_side_does_not_cross_are_left_out():
    """A spot cut so that its left flank is seen above 60 % only is still found in its middle."""
    frame = gaussians([[20.0, 20.0]], background=0.0)[:, :, 17:]
    np.testing.assert_allclose(MultipleThresholdCentroid().extract(frame), [[3.0, 20.0]], atol=0.3)


# TM


def difference(lit, x, y, half, shape):
    rows, columns = np.indices(lit.shape)
    if shape == "round":
        template = (columns - x) ** 2 + (rows - y) ** 2 <= half**2
    else:
        template = (np.abs(columns - x) <= half) & (np.abs(rows - y) <= half)
    return int((lit != template).sum())


@pytest.mark.parametrize("shape", ["round", "square"])
def test_tm_differs_least_among_all_candidates_and_their_neighbourhood(shape):
    """Over every lit pixel, as alg:TM prints it, and over a sub-pixel grid about the answer."""
    rng = np.random.default_rng(4)
    for centre in rng.uniform(12, 16, (6, 2)):
        image = noisy(discs([centre], shape=(28, 30), radius=5.3), int(centre[0] * 1e3))
        if shape == "square":
            rows, columns = np.indices(image.shape[1:])
            away = np.maximum(np.abs(columns - centre[0]), np.abs(rows - centre[1]))
            image = noisy(20 + 2000 * ndtr((5.3 - away) / 0.7), 4)[None]
        lit = image[0] > 0.5 * image.max()
        found = TemplateMatch(width_px=10.6, shape=shape).extract(image)[0]
        here = difference(lit, *found, 5.3, shape)
        rows, columns = np.nonzero(lit)
        printed = min(difference(lit, x, y, 5.3, shape) for x, y in zip(columns, rows, strict=True))
        steps = np.arange(-16, 17) / 16
        around = min(
            difference(lit, found[0] + a, found[1] + b, 5.3, shape) for a in steps for b in steps
        )
        assert here <= printed + 5
        assert here <= around + 5  # the answer is the middle of the good ones, not the best of them


def test_tm_finds_an_exact_template():
    y, x = np.mgrid[:40, :44]
    frame = np.where((x - 20) ** 2 + (y - 17) ** 2 <= 6.5**2, 900, 10).astype(np.uint16)
    np.testing.assert_allclose(TemplateMatch(width_px=13).extract(frame[None]), [[20, 17]], atol=0)


@pytest.mark.parametrize("turns", range(4))
def test_tm_walks_from_stray_light_to_the_spot_whichever_way_it_lies(turns):
    """A brighter patch at the edge: the lit pixels' mean is 5 px off, and the maximum in it."""
    y, x = np.mgrid[:61, :61]
    frame = np.where((x - 30) ** 2 + (y - 30) ** 2 <= 6.5**2, 900, 10)
    frame[28:33, 54:60] = 1000
    frame = np.ascontiguousarray(np.rot90(frame, turns))
    found = TemplateMatch(width_px=13.0).extract(frame[None])
    np.testing.assert_allclose(found, [[30.0, 30.0]], rtol=0, atol=0.1)


def test_tm_of_another_shape_or_two_spots_is_not_found_where_that_is_asked_for():
    two = discs([[14.0, 30.0], [46.0, 30.0]], radius=5).sum(axis=0)
    other = discs([[30.0, 30.0]], radius=4)
    for width, frames in ((10.0, two[None]), (20.0, other)):
        asked = TemplateMatch(width_px=width, most_different=0.5)
        assert np.isnan(asked.extract(frames)).all()
        assert np.isfinite(TemplateMatch(width_px=width).extract(frames)).all()


# Gaussian fit


def test_the_gaussian_fit_is_scipys():
    frames = noisy(gaussians(np.random.default_rng(7).uniform(14, 26, (8, 2))), 7)
    rows, columns = np.indices(frames.shape[1:])

    def model(_, *p):
        a, x, y, s, t, b = p
        wide = ((columns - x) / s) ** 2 + ((rows - y) / t) ** 2
        return (b + a * np.exp(-wide / 2)).ravel()

    found = GaussianFit().extract(frames)
    for k, frame in enumerate(frames):
        start = (200, *found[k].round(), 3, 3, 20)
        expected, _ = curve_fit(model, None, frame.ravel().astype(float), start, xtol=1e-12)
        np.testing.assert_allclose(found[k], expected[1:3], rtol=0, atol=1e-5)


@settings(deadline=None, derandomize=True, max_examples=40)
@given(st.floats(12, 30), st.floats(12, 28), st.floats(1.0, 5.0), st.floats(1.0, 5.0))
def test_the_gaussian_fit_inverts_its_model(x, y, s, t):
    rows, columns = np.mgrid[:40, :44]
    frame = 7 + 300 * np.exp(-(((columns - x) / s) ** 2 + ((rows - y) / t) ** 2) / 2)
    # whatever its shape: the narrowest are drawn out five times
    np.testing.assert_allclose(GaussianFit(light="any").extract(frame[None]), [[x, y]], atol=1e-6)


def test_a_mask_of_several_apertures_is_refused():
    with pytest.raises(ValueError, match="apertures"):
        GaussianFit.for_sensor(SensorGeometry(apertures=((0.0, 0.0, 0.1), (1.0, 0.0, 0.1))))


# All


@pytest.mark.parametrize("extractor", ALL, ids=str)
def test_a_bright_spot_is_found_to_a_fifth_of_a_pixel_anywhere(extractor):
    centres = np.random.default_rng(12).uniform((14, 14), (49, 45), (50, 2))
    found = extractor.extract(noisy(discs(centres), 12))
    assert np.abs(found - centres).max() < 0.2


@pytest.mark.parametrize("extractor", ALL, ids=str)
def test_transposing_the_frame_swaps_x_and_y(extractor):
    frames = noisy(discs(np.random.default_rng(13).uniform(22, 36, (10, 2))), 13)
    swapped = extractor.extract(frames.transpose(0, 2, 1))
    atol = 1e-6 if extractor != ALL[3] else 0.1  # TM's search breaks ties in reading order
    np.testing.assert_allclose(swapped, extractor.extract(frames)[:, ::-1], atol=atol)


@pytest.mark.parametrize("extractor", [ALL[0], ALL[3]], ids=str)
def test_a_spot_cut_in_half_by_the_edge_is_not_found(extractor):
    for axis in (0, 1):
        for side in (-1.0, 60.0 if axis else 64.0):
            centre = np.array([30.0, 30.0])
            centre[axis] = side
            assert np.isnan(extractor.extract(noisy(discs([centre]), 14))).all()


@pytest.mark.parametrize("extractor", ALL, ids=str)
def test_a_frame_of_noise_alone_is_never_a_result_outside_it(extractor):
    frames = np.random.default_rng(15).integers(0, 50, (40, 30, 34)).astype(np.uint16)
    found = extractor.extract(frames)
    inside = (found > -0.5) & (found < [33.5, 29.5])
    assert (inside | np.isnan(found)).all()

"""BCM, BCTM, IFM and PM against the survey's loops, SciPy, OpenCV and exact arithmetic."""

from __future__ import annotations

from fractions import Fraction

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy import ndimage

from algorithms.extractors.frames.centroid import (
    BasicCentroid,
    FilteredCentroid,
    ThresholdedCentroid,
)
from algorithms.extractors.frames.peak import PixelMax

small_frames = hnp.arrays(
    np.uint16,
    st.tuples(st.just(1), st.integers(1, 9), st.integers(1, 11)),
    elements=st.integers(0, 4095),
).filter(lambda frames: np.ptp(frames) > 0)

CENTROIDS = [
    BasicCentroid(),
    BasicCentroid(background="border"),
    ThresholdedCentroid(),
    ThresholdedCentroid(threshold=0.3),
    ThresholdedCentroid(threshold=0.1, background="median"),
    FilteredCentroid(),
    FilteredCentroid(background="border"),
]


def gaussians(centres, shape=(48, 56), sigma=2.0, peak=3000.0):
    y, x = np.mgrid[: shape[0], : shape[1]]
    return np.stack(
        [peak * np.exp(-((x - cx) ** 2 + (y - cy) ** 2) / (2 * sigma**2)) for cx, cy in centres]
    )


def bcm_as_printed(image):
    """alg:BCM with i over rows and j over columns, in exact arithmetic."""
    total = x_c = y_c = Fraction(0)
    for i in range(image.shape[0]):
        for j in range(image.shape[1]):
            value = Fraction(image[i, j].item())
            total += value
            x_c += j * value
            y_c += i * value
    return [float(x_c / total), float(y_c / total)]


def bctm_as_printed(image, mu):
    """alg:BCTM in exact arithmetic."""
    largest = max(Fraction(value.item()) for value in image.flat)
    cut = np.empty(image.shape, dtype=object)
    for index, value in np.ndenumerate(image):
        cut[index] = max(Fraction(value.item()) - Fraction(mu) * largest, Fraction(0))
    total = sum(cut.flat)
    rows, columns = np.indices(image.shape)
    return [float((columns * cut).sum() / total), float((rows * cut).sum() / total)]


def ifm_as_printed(image):
    """alg:IFM: the mean of nine pixels, zero outside (ERRATA: on all four sides)."""
    height, width = image.shape
    smooth = np.empty(image.shape, dtype=object)
    for m in range(height):
        for n in range(width):
            smooth[m, n] = Fraction(0)
            for i in range(m - 1, m + 2):
                for j in range(n - 1, n + 2):
                    if 0 <= i < height and 0 <= j < width:
                        smooth[m, n] += Fraction(image[i, j].item(), 9)
    rows, columns = np.indices(image.shape)
    total = smooth.sum()
    return [float((columns * smooth).sum() / total), float((rows * smooth).sum() / total)]


@settings(deadline=None, derandomize=True, max_examples=60)
@given(small_frames)
def test_bcm_is_the_printed_loop_to_the_last_bit(frames):
    assert BasicCentroid().extract(frames)[0].tolist() == bcm_as_printed(frames[0])


@settings(deadline=None, derandomize=True, max_examples=60)
@given(small_frames, st.sampled_from([0.0, 0.1, 0.3, 0.5, 0.77, 0.99]))
def test_bctm_is_the_printed_loop(frames, mu):
    expected = bctm_as_printed(frames[0], mu)
    for dtype in (np.uint16, np.float32, np.float64):
        found = ThresholdedCentroid(threshold=mu).extract(frames.astype(dtype))
        np.testing.assert_allclose(found[0], expected, rtol=0, atol=1e-9)


@settings(deadline=None, derandomize=True, max_examples=60)
@given(small_frames)
def test_ifm_is_the_printed_loop_to_the_last_bit(frames):
    assert FilteredCentroid().extract(frames)[0].tolist() == ifm_as_printed(frames[0])


@settings(deadline=None, derandomize=True, max_examples=60)
@given(small_frames)
def test_pm_is_the_first_maximum_of_each_profile(frames):
    """alg:PM: the words stop at the first maximum, where the loop would keep the last."""
    image = frames[0].astype(int)
    expected = [
        next(j for j in range(image.shape[1]) if image[:, j].sum() == image.sum(axis=0).max()),
        next(i for i in range(image.shape[0]) if image[i].sum() == image.sum(axis=1).max()),
    ]
    assert PixelMax().extract(frames)[0].tolist() == expected


def test_centroids_agree_with_scipy_and_opencv():
    rng = np.random.default_rng(3)
    frames = gaussians(rng.uniform(12, 36, (20, 2))) + rng.uniform(0, 50, (20, 48, 56))
    plain = BasicCentroid().extract(frames)
    cut = ThresholdedCentroid(threshold=0.2).extract(frames)
    smooth = FilteredCentroid().extract(frames)
    for k, frame in enumerate(frames):
        np.testing.assert_allclose(plain[k, ::-1], ndimage.center_of_mass(frame), atol=1e-9)
        moments = cv2.moments(np.maximum(frame - 0.2 * frame.max(), 0))
        by_opencv = [moments["m10"] / moments["m00"], moments["m01"] / moments["m00"]]
        np.testing.assert_allclose(cut[k], by_opencv, atol=1e-9)
        mean = ndimage.uniform_filter(frame, size=3, mode="constant")
        np.testing.assert_allclose(smooth[k, ::-1], ndimage.center_of_mass(mean), atol=1e-9)


@pytest.mark.parametrize("extractor", CENTROIDS, ids=str)
def test_a_symmetric_spot_is_found_at_its_centre(extractor):
    centres = np.array([[27.5, 23.5], [27.25, 23.0], [28.0, 23.875]])
    np.testing.assert_allclose(extractor.extract(gaussians(centres, sigma=2.5)), centres, atol=0.02)
    symmetric = gaussians(centres[:1])
    np.testing.assert_allclose(extractor.extract(symmetric), centres[:1], atol=1e-12)


@settings(deadline=None, derandomize=True, max_examples=40)
@given(
    hnp.arrays(np.uint16, (7, 7), elements=st.integers(1, 4000)),
    st.integers(0, 20),
    st.integers(0, 12),
    st.sampled_from([*CENTROIDS, PixelMax(), ThresholdedCentroid(window_px=11)]),
)
def test_moving_the_spot_moves_the_result(spot, right, down, extractor):
    """Whole pixels, on a dark frame, off the edge."""
    frames = np.zeros((2, 30, 40), dtype=np.uint16)
    frames[0, 4:11, 4:11] = spot
    frames[1, 4 + down : 11 + down, 4 + right : 11 + right] = spot
    first, second = extractor.extract(frames)
    np.testing.assert_allclose(second - first, [right, down], atol=1e-9)


@settings(deadline=None, derandomize=True, max_examples=40)
@given(small_frames, st.sampled_from([2, 3, 15]), st.sampled_from([*CENTROIDS, PixelMax()]))
def test_gain_does_not_matter(frames, gain, extractor):
    np.testing.assert_allclose(
        extractor.extract(frames.astype(np.uint16) * np.uint16(gain)),
        extractor.extract(frames),
        atol=1e-8,
    )


@settings(deadline=None, derandomize=True, max_examples=40)
@given(small_frames, st.sampled_from([*CENTROIDS, PixelMax()]))
def test_transposing_the_frame_swaps_x_and_y(frames, extractor):
    found = extractor.extract(frames)
    swapped = extractor.extract(frames.transpose(0, 2, 1))
    np.testing.assert_allclose(swapped, found[:, ::-1], atol=1e-9)


@pytest.mark.parametrize("extractor", CENTROIDS, ids=str)
def test_rotating_the_frame_by_half_a_turn_mirrors_the_result(extractor):
    frames = gaussians([[20.3, 17.8], [30.1, 29.4]]).astype(np.uint16)
    found = extractor.extract(frames)
    np.testing.assert_allclose(
        extractor.extract(frames[:, ::-1, ::-1]), [55, 47] - found, atol=1e-9
    )


def test_mean_filter_changes_bcm_only_through_light_at_the_border():
    """A finding of the code: smoothing is linear and symmetric, so BCM does not see it."""
    rng = np.random.default_rng(8)
    frames = rng.integers(0, 4000, (10, 20, 30)).astype(np.uint16)
    frames[:, [0, -1]] = 0
    frames[:, :, [0, -1]] = 0
    plain, smooth = BasicCentroid().extract(frames), FilteredCentroid().extract(frames)
    np.testing.assert_allclose(smooth, plain, atol=1e-12)
    frames[:, 0] = 4000
    assert (
        np.abs(FilteredCentroid().extract(frames) - BasicCentroid().extract(frames)) > 0.01
    ).any()


def test_threshold_removes_a_background_that_bcm_follows():
    frames = gaussians([[12.0, 12.0]]) + 100.0
    assert np.hypot(*(BasicCentroid().extract(frames) - 12.0)[0]) > 5
    assert np.hypot(*(ThresholdedCentroid().extract(frames) - 12.0)[0]) < 1e-3


@pytest.mark.parametrize("background", ["border", "median"])
@pytest.mark.parametrize("method", [BasicCentroid, ThresholdedCentroid, FilteredCentroid])
def test_background_estimation_makes_a_pedestal_harmless(method, background):
    frames = np.rint(gaussians([[14.3, 20.6], [40.2, 31.1]]))
    extractor = method(background=background)
    for dtype in (np.uint16, np.float64):
        np.testing.assert_allclose(
            extractor.extract((frames + 317).astype(dtype)),
            extractor.extract(frames.astype(dtype)),
            atol=1e-9,
        )


@pytest.mark.parametrize("method", [BasicCentroid, ThresholdedCentroid, FilteredCentroid])
@pytest.mark.parametrize("window", [15, 21])
def test_window_is_the_centroid_of_the_cut_out_patch(method, window):
    rng = np.random.default_rng(9)
    centres = rng.uniform(1, 46, (12, 2))  # some windows are cut by the edge
    frames = np.rint(gaussians(centres) + rng.uniform(0, 200, (12, 48, 56))).astype(np.uint16)
    mu = {"threshold": 0.3} if method is ThresholdedCentroid else {}
    found = method(window_px=window, **mu).extract(frames)
    half = window // 2
    for k, raw in enumerate(frames.astype(float)):
        smooth = ndimage.uniform_filter(raw, size=3, mode="constant")
        frame = smooth if method is FilteredCentroid else raw
        x, y = np.rint(found[k]).astype(int)
        top, left = max(y - half, 0), max(x - half, 0)
        patch = frame[top : y + half + 1, left : x + half + 1]
        if method is ThresholdedCentroid:
            patch = np.maximum(patch - 0.3 * frame.max(), 0)
        mean_y, mean_x = ndimage.center_of_mass(patch)
        np.testing.assert_allclose(found[k], [left + mean_x, top + mean_y], atol=1e-9)


def threshold_by_noise(frame):
    """Second smallest of what the four sides tell: mean and six standard deviations."""
    sides = [frame[0], frame[-1], frame[:, 0], frame[:, -1]]
    return sorted(side.mean() + 6 * side.std() for side in sides)[1]


def noisy_spots(count, seed, sigma, peak):
    rng = np.random.default_rng(seed)
    light = gaussians(rng.uniform(14, 34, (count, 2)), sigma=sigma, peak=peak)
    return rng.poisson(light + 25) + rng.normal(0, 6, light.shape)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.int32, np.float64])
@pytest.mark.parametrize("bright_sides", [0, 1, 2])
def test_without_a_fraction_the_dark_sides_noise_sets_the_threshold(dtype, bright_sides):
    frames = np.rint(noisy_spots(6, 3, 2.0, 150.0)).clip(0, 250)
    frames[:, :bright_sides, 10:] = 240  # a hot row at the top
    frames[:, :, :1][:, :, : bright_sides // 2] = 230
    expected = []
    for frame in frames:
        cut = threshold_by_noise(frame)
        y, x = ndimage.center_of_mass(np.maximum(frame - cut, 0))
        expected.append((x, y))
    found = ThresholdedCentroid().extract(frames.astype(dtype))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)
    windowed = ThresholdedCentroid(window_px=201).extract(frames.astype(dtype))
    np.testing.assert_allclose(windowed, found, rtol=0, atol=1e-12)


def test_noise_alone_is_not_above_its_threshold():
    frames = noisy_spots(200, 5, 2.0, 0.0)
    assert np.isnan(ThresholdedCentroid().extract(frames)).all()
    assert np.isfinite(ThresholdedCentroid(threshold=0.3).extract(frames)).all()


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("shape", [(1, 1), (1, 6), (2, 2), (3, 5), (17, 9), (5, 40)])
def test_narrow_integers_are_summed_as_wide_ones(shape, dtype):
    """The kernels of 8 and 16 bits beside those of any number."""
    rng = np.random.default_rng(9)
    frames = rng.integers(0, np.iinfo(dtype).max + 1, (8, *shape)).astype(dtype)
    for extractor in (BasicCentroid(), FilteredCentroid(), FilteredCentroid(background="median")):
        found = extractor.extract(frames)
        np.testing.assert_array_equal(found, extractor.extract(frames.astype(np.int64)))


def test_window_keeps_a_second_weaker_light_out():
    frames = gaussians([[14.0, 14.0]]) + gaussians([[45.0, 38.0]], peak=2000.0)
    assert np.hypot(*(ThresholdedCentroid().extract(frames) - 14.0)[0]) > 5
    np.testing.assert_allclose(
        ThresholdedCentroid(window_px=17).extract(frames), [[14.0, 14.0]], atol=1e-3
    )


@pytest.mark.parametrize("extractor", [*CENTROIDS, PixelMax(), BasicCentroid(window_px=5)], ids=str)
def test_light_without_a_positive_sum_is_not_found(extractor):
    frames = -np.abs(gaussians([[20.0, 20.0], [9.0, 9.0]])) - 1.0
    if getattr(extractor, "background", "none") == "none":
        assert np.isnan(extractor.extract(frames)).all()


def test_pixels_of_both_signs_that_almost_cancel_are_not_found():
    frame = np.zeros((1, 9, 9))
    frame[0, 2, 2], frame[0, 6, 6] = 1.0, -0.999
    for extractor in (BasicCentroid(), FilteredCentroid()):
        assert np.isnan(extractor.extract(frame)).all()


@pytest.mark.parametrize("extractor", [*CENTROIDS, PixelMax(), BasicCentroid(window_px=5)], ids=str)
def test_values_too_large_to_sum_are_not_found(extractor):
    frame = np.full((1, 6, 6), 1e300)
    frame[0, 2, 2] = 1.7e308
    found = extractor.extract(frame)
    assert np.isnan(found).all() or np.abs(found - 2.5).max() < 3


def test_sums_do_not_overflow_on_large_saturated_frames():
    frame = np.full((1, 2000, 3000), 65535, dtype=np.uint16)
    frame[0, 0, 0] = 65534
    for extractor in (BasicCentroid(), ThresholdedCentroid(threshold=0.3), FilteredCentroid()):
        np.testing.assert_allclose(extractor.extract(frame), [[1499.5, 999.5]], atol=1e-6)

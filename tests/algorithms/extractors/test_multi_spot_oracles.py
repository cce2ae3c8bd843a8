"""Multi-spot methods beside SciPy and the survey's pseudocode, written out pixel by pixel."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage, signal
from scipy.special import ndtr

from algorithms.extractors.frames.multi_spot.image_correlation import (
    ImageCorrelation,
    drawn_templates,
)
from algorithms.extractors.frames.multi_spot.mean_shift import MeanShift
from algorithms.extractors.frames.multi_spot.multiple_centroids import MultipleCentroids
from algorithms.extractors.frames.multi_spot.records import Seen
from algorithms.extractors.frames.multi_spot.spots_kernel import segment

WIDTH = 9.0
STEPS = (-35.55, -11.85, 11.85, 35.55)
GRID = tuple((x, y, WIDTH) for y in STEPS for x in STEPS)


def frame_of(apertures, place, seed, shape=(128, 132)):
    """Noisy discs with a soft rim, background 20, peak 600."""
    y, x = np.mgrid[: shape[0], : shape[1]]
    frame = np.full(shape, 20.0)
    for dx, dy, width in apertures:
        away = width / 2 - np.hypot(x - place[0] - dx, y - place[1] - dy)
        frame += 600.0 * ndtr(away / 0.7)
    frame += np.random.default_rng(seed).normal(0, 8.0, shape)
    return np.clip(np.rint(frame), 0, 4095).astype(np.uint16)


# Segmentation


@settings(deadline=None, derandomize=True, max_examples=60)
@given(st.integers(0, 10**6), st.floats(0.05, 0.7), st.integers(3, 30), st.integers(3, 30))
def test_spots_are_scipys_labels_of_touching_pixels(seed, density, height, width):
    rng = np.random.default_rng(seed)
    frame = rng.integers(1, 100, (height, width)) * (rng.random((height, width)) < density)
    frame = frame.astype(np.uint16)
    frame.setflags(write=False)  # as extractors get them
    spots, cuts = np.full((1, 900, 4), np.nan), np.full((1, 900, 3), np.nan)
    counts, cut_counts = np.zeros((2, 1), dtype=np.int64)
    maxima, level = frame.max(axis=1)[None], np.array([9.0])
    segment(frame[None], maxima, level, 2.0, 40.0, Seen(spots, counts, cuts, cut_counts))

    above = np.maximum(frame - 9.0, 0.0)
    labels, number = ndimage.label(above > 0, structure=np.ones((3, 3)))
    expected, at_edge = [], []
    for label in range(1, number + 1):
        rows, columns = np.nonzero(labels == label)
        whole = rows.min() > 0 and columns.min() > 0
        whole &= rows.max() < height - 1 and columns.max() < width - 1
        y, x = ndimage.center_of_mass(above, labels, label)
        light = above[labels == label].sum()
        if whole and 2 <= len(rows) <= 40:
            expected.append((x, y, len(rows), light))
        elif not whole and 4 <= len(rows) <= 40:
            at_edge.append((x, y, light / len(rows)))
    assert (counts[0], cut_counts[0]) == (len(expected), len(at_edge))
    np.testing.assert_allclose(spots[0, : counts[0]], np.array(expected).reshape(-1, 4), rtol=1e-12)
    np.testing.assert_allclose(
        cuts[0, : cut_counts[0]], np.array(at_edge).reshape(-1, 3), rtol=1e-12
    )


# MCAM


def mcam_as_printed(image, places, level, half):
    """alg:MCAM with the segments given: a box about each aperture's spot."""
    total = np.zeros(2)
    for x, y in places:
        rows = slice(round(y) - half, round(y) + half + 1)
        columns = slice(round(x) - half, round(x) + half + 1)
        light = np.maximum(image[rows, columns].astype(float) - level, 0.0)
        y_n, x_n = ndimage.center_of_mass(light)
        total += x_n + columns.start, y_n + rows.start
    return total / len(places)


@settings(deadline=None, derandomize=True, max_examples=8)
@given(st.floats(60, 70), st.floats(58, 68), st.integers(0, 99))
def test_mcam_is_the_printed_loop(x, y, seed):
    image = frame_of(GRID, (x, y), seed)
    level = 0.3
    floor = np.median(image)
    rows = np.sort(image.max(axis=1))  # four rows are half of a spot nine wide
    assert int(image.max()) - int(rows[-4]) < 40
    extractor = MultipleCentroids(GRID, threshold=level)
    places = [(x + dx, y + dy) for dx, dy, _ in GRID]
    expected = mcam_as_printed(image, places, floor + level * (rows[-4] - floor), 9)
    np.testing.assert_allclose(extractor.extract(image[None])[0], expected, rtol=0, atol=0.01)


# FMMS


def histogram(bins_of, centre, radius, count):
    """``p_u`` of alg:FMMS1 before it is normalised, pixel by pixel."""
    found = [0.0] * count
    for (row, column), u in np.ndenumerate(bins_of):
        squared = ((column - centre[0]) ** 2 + (row - centre[1]) ** 2) / radius**2
        if squared < 1:
            found[u] += 1 - squared
    return np.array(found)


def fmms_as_printed(bins_of, start, goal, radius, tolerance):
    """alg:FMMS2 of one spot, weights at y_0."""

    def likeness(y):
        p = histogram(bins_of, y, radius, len(goal))
        return p / p.sum(), float(np.sqrt(p / p.sum() * goal).sum())

    y_0 = np.array(start, dtype=float)
    for _ in range(20):
        p, here = likeness(y_0)
        weight, moment = 0.0, np.zeros(2)
        for (row, column), u in np.ndenumerate(bins_of):
            offset = np.array([column, row]) - y_0
            if np.hypot(*offset) <= radius and p[u] > 0:
                w = math.sqrt(goal[u] / p[u])
                weight += w
                moment += w * offset
        step = moment / weight
        while likeness(y_0 + step)[1] < here and np.hypot(*step) > tolerance:
            step = step / 2
        y_0 = y_0 + step
        if np.hypot(*step) <= tolerance:
            break
    return y_0, likeness(y_0)[1]


def test_fmms_is_the_printed_loop():
    apertures = ((-14.0, -10.0, 7.0), (13.0, -12.0, 7.0), (2.0, 14.0, 7.0))
    image = frame_of(apertures, (27.3, 25.8), 3, (52, 56))
    extractor = MeanShift(apertures, bandwidth_px=8.0, bins=6, blur_px=1.0)
    seen = MultipleCentroids(apertures, blur_px=1.0).spots(image[None])[0]
    floor, peak = np.median(image), np.sort(image.max(axis=1))[-4]
    level = floor + 0.3 * (peak - floor)
    bins_of = np.where(
        image > level, np.minimum(1 + (image - level) // ((peak - level) / 4), 5), 0
    ).astype(int)
    goal = sum(histogram(bins_of, spot, 8.0 / 2 + 1.0, 6) for spot in seen)
    goal[0] = 0
    goal /= goal.sum()
    start = np.mean(seen - np.array(apertures)[:, :2], axis=0)
    spots, likes = zip(
        *[fmms_as_printed(bins_of, start + a[:2], goal, 8.0, 0.01) for a in apertures], strict=True
    )
    np.testing.assert_allclose(extractor.spots(image[None])[0], spots, rtol=0, atol=1e-9)
    expected = np.average(np.array(spots) - np.array(apertures)[:, :2], axis=0, weights=likes)
    np.testing.assert_allclose(extractor.extract(image[None])[0], expected, rtol=0, atol=1e-9)


# FEIC


def feic_as_printed(image, apertures, template, place, lags):
    """alg:FEIC with windows about `place`, its errata and the gain from the matrix itself."""
    half, reach = template.shape[0] // 2, lags // 2
    light = image - np.median(image)
    total, weights, away = np.zeros((lags, lags)), [], []
    for dx, dy, _ in apertures:
        x, y = math.floor(place[0] + dx + 0.5), math.floor(place[1] + dy + 0.5)
        size = half + reach
        window = light[y - size : y + size + 1, x - size : x + size + 1]
        matrix = signal.correlate2d(window, template, mode="valid")
        total += matrix
        weights.append(matrix.sum())
        away.append((x - dx, y - dy))
    found = []
    for axis in (0, 1):
        profile = total.sum(axis=axis)
        hill = profile - profile.min()
        middle = np.arange(lags - 1) - (lags - 2) / 2
        early = (hill[:-1] * middle).sum() / hill[:-1].sum()
        late = (hill[1:] * middle).sum() / hill[1:].sum()
        found.append((early + late) / 2 / (early - late))
    return np.average(away, axis=0, weights=weights) + found


@settings(deadline=None, derandomize=True, max_examples=8)
@given(st.floats(60, 70), st.floats(58, 68), st.integers(0, 99))
def test_feic_is_scipys_correlation_summed(x, y, seed):
    image = frame_of(GRID, (x, y), seed)
    place = MultipleCentroids(GRID).extract(image[None])[0]
    template = drawn_templates((WIDTH,), 0.0, False)[0]
    expected = feic_as_printed(image.astype(float), GRID, template, place, 9)
    np.testing.assert_allclose(
        ImageCorrelation(GRID).extract(image[None])[0], expected, rtol=0, atol=0.02
    )


@pytest.mark.parametrize(("square", "area"), [(False, math.pi * 4.5**2), (True, 81.0)])
def test_templates_are_centred_and_have_their_apertures_area(square, area):
    template = drawn_templates((WIDTH,), 0.0, square)[0]
    assert template.sum() == pytest.approx(area, rel=2e-3)
    np.testing.assert_allclose(template, template[::-1, ::-1], atol=1e-12)
    np.testing.assert_allclose(template, template.T, atol=1e-12)

"""alg:BCM, BCTM, IFM, DBCM, MTACM and PM transcribed; x runs along columns (ERRATA)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from algorithms.extractors.frames.balance import DoubleBalance
from algorithms.extractors.frames.centroid import (
    BasicCentroid,
    FilteredCentroid,
    ThresholdedCentroid,
)
from algorithms.extractors.frames.peak import PixelMax
from algorithms.extractors.frames.threshold_average import MultipleThresholdCentroid


def small_frames(count=6, size=(27, 31), seed=2, dark=20.0, peak=400.0):
    """Frames (count, H, W) of codes, each of one noisy round spot away from the sides."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[: size[0], : size[1]]
    frames = []
    for place in rng.uniform(11.5, 15.5, (count, 2)):
        light = peak * np.exp(-((x - place[0]) ** 2 + (y - place[1]) ** 2) / 9.0)
        frames.append(rng.poisson(light + dark) + rng.normal(0, 3, light.shape))
    return np.rint(frames).clip(0).astype(np.uint16)


def bcm_as_printed(image):
    """alg:BCM."""
    total = x_c = y_c = 0.0
    for i, row in enumerate(image):
        for j, value in enumerate(row):
            total += float(value)
            x_c += j * float(value)
            y_c += i * float(value)
    return x_c / total, y_c / total


def bctm_as_printed(image, mu):
    """alg:BCTM: ``I' = I - mu I_max``, and zero where that is below."""
    largest = float(image.max())
    thresholded = [[max(float(value) - mu * largest, 0.0) for value in row] for row in image]
    return bcm_as_printed(thresholded)


def mu_of_the_noise(image):
    """The fraction that the survey leaves open: dark and six deviations over the maximum.

    Of the frame's four sides the one with the second least.
    """
    levels = []
    for side in (image[0], image[-1], image[:, 0], image[:, -1]):
        values = [float(value) for value in side]
        mean = sum(values) / len(values)
        squares = sum((value - mean) ** 2 for value in values)
        levels.append(mean + 6.0 * math.sqrt(squares / len(values)))
    return sorted(levels)[1] / float(image.max())


def ifm_as_printed(image):
    """alg:IFM: the mean of nine pixels, zero outside (ERRATA: on all four sides), then alg:BCM."""
    height, width = image.shape
    smooth = [[0.0] * width for _ in range(height)]
    for m in range(height):
        for n in range(width):
            for i in range(m - 1, m + 2):
                for j in range(n - 1, n + 2):
                    if 0 <= i < height and 0 <= j < width:
                        smooth[m][n] += float(image[i, j]) / 9.0
    return bcm_as_printed(smooth)


def pm_as_printed(image):
    """alg:PM: the words stop at the first maximum, where the loop would keep the last."""
    rows = [sum(int(value) for value in row) for row in image]
    columns = [sum(int(row[j]) for row in image) for j in range(image.shape[1])]
    return columns.index(max(columns)), rows.index(max(rows))


def balanced(image, x, y):
    """Step 2 of alg:DBCM about one pixel: areas of 1, 9, 1, 9 and 1 columns, and rows, of 21."""
    region = [[float(image[y + i, x + j]) for j in range(-10, 11)] for i in range(-10, 11)]
    found = []
    for lines in (list(zip(*region, strict=True)), region):
        s_a = sum(lines[0])
        s_b = sum(sum(line) for line in lines[1:10])
        s_c = sum(lines[10])
        s_d = sum(sum(line) for line in lines[11:20])
        s_e = sum(lines[20])
        dark = (s_a + s_e) / 2.0  # printed as S_A, on the assumption that S_A = S_E
        found.append(0.5 * (s_d - s_b) / (s_c - dark))
    return found


def brightest(image):
    """Winner-takes-all of alg:DBCM: where the rows' and the columns' maxima are largest."""
    rows, columns = image.max(axis=1), image.max(axis=0)
    return int(np.argmax(columns)), int(np.argmax(rows))


def dbcm_as_printed(image):
    """alg:DBCM: acquisition, and one balance."""
    x, y = brightest(image)
    off_x, off_y = balanced(image, x, y)
    return x + off_x, y + off_y


def dbcm_tracking(image):
    """The words of fe:dbcm: the spot is tracked over successive balances until it stays."""
    x, y = brightest(image)
    off_x, off_y = balanced(image, x, y)
    while max(abs(off_x), abs(off_y)) > 0.5:
        x, y = x + round(off_x), y + round(off_y)
        off_x, off_y = balanced(image, x, y)
    return x + off_x, y + off_y


def mtacm_as_printed(profile, accuracy=0.01, lowest=0.25, highest=0.9):
    """alg:MTACM1 and MTACM2 along one axis, Delta X = 1.

    ERRATA: h_l is the first rise from the left, k_l from the right, and both must be there. The
    thresholds, which the survey leaves open, lie evenly between two parts of the height.
    """
    values = [float(value) for value in profile]
    floor = float(np.median(values))
    height = max(values) - floor
    sigma = sum(value - floor for value in values) / (height * math.sqrt(2.0 * math.pi))
    number = math.floor(sigma * math.sqrt(math.e) / accuracy) + 1
    middles = []
    for step in range(number):
        part = lowest + (step + 0.5) * (highest - lowest) / number
        binary = [int(value > floor + part * height) for value in values]
        h = next((n for n in range(1, len(binary)) if binary[n - 1] < binary[n]), None)
        k = next((n for n in range(len(binary) - 2, -1, -1) if binary[n + 1] < binary[n]), None)
        if h is not None and k is not None:
            middles.append((h + k) / 2.0)
    return sum(middles) / len(middles)


@pytest.mark.parametrize(
    ("method", "printed"),
    [
        (BasicCentroid(), bcm_as_printed),
        (ThresholdedCentroid(), lambda image: bctm_as_printed(image, mu_of_the_noise(image))),
        (ThresholdedCentroid(threshold=0.4), lambda image: bctm_as_printed(image, 0.4)),
        (FilteredCentroid(), ifm_as_printed),
        (PixelMax(), pm_as_printed),
        (DoubleBalance(moves=0), dbcm_as_printed),
        (DoubleBalance(), dbcm_tracking),
        (
            MultipleThresholdCentroid(),
            lambda image: [mtacm_as_printed(image.sum(axis=axis)) for axis in (0, 1)],
        ),
    ],
    ids=lambda value: getattr(getattr(value, "about", None), "name", "printed"),
)
def test_ours_is_the_printed_loop(method, printed):
    frames = small_frames()
    expected = [printed(frame) for frame in frames]
    np.testing.assert_allclose(method.extract(frames), expected, rtol=0, atol=1e-8)

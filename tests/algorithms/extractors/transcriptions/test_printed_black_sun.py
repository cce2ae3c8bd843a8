"""alg:BCSM transcribed: corners of the dark hole in masks of descending thresholds."""

from __future__ import annotations

import math

import cv2
import numpy as np
import pytest
from scipy import ndimage

from algorithms.extractors.frames.cameras.black_sun import BlackSunCentroid


def black_suns(count, radius, seed, size=(46, 50)):
    """Noisy black discs in saturated halos, and their places (count, 2)."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[: size[0], : size[1]]
    places = rng.uniform(19.0, 27.0, (count, 2))
    frames = []
    for a, b in places:
        away = np.hypot(x - a, y - b)
        halo = 1000 / (1 + np.exp(1.5 * (away - radius - 7)))
        frames.append(20 + halo / (1 + np.exp(-4.0 * (away - radius))))
    noisy = np.array(frames) + rng.normal(0, 4.0, (count, *size))
    return np.rint(noisy).clip(0, 1023).astype(np.uint16), places


def blurred(frame):
    return ndimage.gaussian_filter(frame.astype(float), 1.0, mode="nearest", truncate=3.0)


def thresholds(image, loops=16, highest=0.9, lowest=0.1):
    """``T + f`` for falling f: the survey leaves T and the camera's alpha open."""
    low, high = image.min(), image.max()
    step = (lowest - highest) / loops
    return [low + (highest + (f + 0.5) * step) * (high - low) for f in range(loops)]


def hole_of(mask):
    """The largest dark part that the largest contour of a mask encloses; None without one."""
    labels, count = ndimage.label(mask)
    largest = 1 + int(np.argmax([(labels == n).sum() for n in range(1, count + 1)]))
    inside = ndimage.binary_fill_holes(labels == largest) & ~mask
    labels, count = ndimage.label(inside)
    holes = [labels == n for n in range(1, count + 1)]
    return max(holes, key=np.sum) if holes else None


def refined(hole):
    """Sub-pixel corner: ``sum(n n^T (q - p)) = 0`` over all edges p of the hole, normals n."""
    matrix, right = np.zeros((2, 2)), np.zeros(2)
    for i, j in np.argwhere(hole):
        for di, dj in ((0, 1), (0, -1), (1, 0), (-1, 0)):
            if not hole[i + di, j + dj]:
                normal, place = np.array([dj, di]), np.array([j + dj / 2, i + di / 2])
                matrix += np.outer(normal, normal)
                right += np.outer(normal, normal) @ place
    return np.linalg.solve(matrix, right)


def bscm_as_printed(frame, survival=0.75, moved=0.5):
    """alg:BCSM: the corner that survives most iterations, over which it is accumulated."""
    image = blurred(frame)
    kept, best = [], []
    for level in thresholds(image):
        hole = hole_of(image > level)
        corner = refined(hole) if hole is not None else None
        if corner is None or (kept and math.dist(corner, kept[-1]) > moved):
            kept = []
        if corner is not None:
            kept = [*kept, corner]
        if len(kept) > len(best):
            best = kept
    return np.mean(best, axis=0) if len(best) >= survival * 16 else np.full(2, np.nan)


@pytest.mark.parametrize("radius", [2.5, 4.0, 6.0])
def test_bscm(radius):
    frames, places = black_suns(4, radius, 1)
    found = BlackSunCentroid().extract(frames)
    np.testing.assert_allclose(found, [bscm_as_printed(frame) for frame in frames], atol=1e-9)
    np.testing.assert_allclose(found, places, rtol=0, atol=0.08)


def opencv_corners(mask):
    """Strong corners of a mask and their refinement with OpenCV's window of 11 px."""
    picture = np.where(mask, 255, 0).astype(np.uint8)
    corners = cv2.goodFeaturesToTrack(picture, 30, 0.1, 2, blockSize=3)
    until = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 40, 1e-3)
    return cv2.cornerSubPix(picture, corners, (5, 5), (-1, -1), until)[:, 0]


def test_strong_corners_refined_in_a_fixed_window_stay_on_the_rim_of_all_but_the_smallest():
    """Why ours is refined over the whole hole: a window's weights hold a corner where it started.

    A corner of a large hole is a place on its rim, about a radius off the Sun's middle.
    """
    for radius, least, most in ((1.6, 0.0, 0.7), (6.0, 2.0, 9.0)):
        frames, places = black_suns(4, radius, 2)
        for frame, place in zip(frames, places, strict=True):
            image = blurred(frame)
            corners = opencv_corners(image > 0.5 * image.max())
            nearest = np.hypot(*(corners - place).T).min()
            assert least <= nearest <= most

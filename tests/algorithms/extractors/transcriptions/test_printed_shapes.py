"""alg:TM, BHT and CHT transcribed on small frames."""

from __future__ import annotations

import math

import numpy as np
import pytest

from algorithms.extractors.frames.cameras.hough import HoughCircle, HoughLines
from algorithms.extractors.frames.template import TemplateMatch

RADIUS = 5.0


def discs(count, seed, size=(29, 33)):
    """Noisy frames of a disc with a soft rim, and its places (count, 2)."""
    rng = np.random.default_rng(seed)
    y, x = np.mgrid[: size[0], : size[1]]
    places = rng.uniform(12.0, 17.0, (count, 2))
    away = [RADIUS + 0.5 - np.hypot(x - a, y - b) for a, b in places]
    light = 30.0 + 600.0 * np.clip(away, 0, 1)
    return np.rint(rng.normal(light, 8.0)).clip(0).astype(np.uint16), places


def template_error(image, mu, place):
    """``E_n`` of alg:TM: pixels in which the bi-level image and the template differ.

    The projected aperture is the same at every incidence: a thin one's, onto a parallel plane.
    """
    largest = float(image.max())
    error = 0
    for (i, j), value in np.ndenumerate(image):
        measured = int(float(value) > mu * largest)
        theory = int((j - place[0]) ** 2 + (i - place[1]) ** 2 <= RADIUS**2)
        error += (measured - theory) ** 2
    return error


def tm_as_printed(image, mu=0.5):
    """alg:TM: of the brightest pixels the one whose template errs least."""
    candidates = [(j, i) for (i, j), value in np.ndenumerate(image) if value == image.max()]
    return min(candidates, key=lambda place: template_error(image, mu, place))


def test_tm_of_the_printed_candidates():
    frames, _ = discs(6, 1)
    saturated = np.minimum(frames, 580)  # several brightest pixels
    method = TemplateMatch(width_px=2 * RADIUS, candidates="brightest")
    for frame in (*frames, *saturated):
        np.testing.assert_array_equal(method.extract(frame[None])[0], tm_as_printed(frame))


def test_tm_searches_further_for_a_template_that_errs_less():
    frames, places = discs(6, 2)
    found = TemplateMatch(width_px=2 * RADIUS).extract(frames)
    for frame, mine, place in zip(frames, found, places, strict=True):
        assert template_error(frame, 0.5, mine) <= template_error(frame, 0.5, tm_as_printed(frame))
        assert math.dist(mine, place) < 0.3


def runs_of(row):
    """First and last full pixel of each run in a row, a single pixel missing being dead."""
    lit = [j for j, full in enumerate(row) if full]
    starts = [j for n, j in enumerate(lit) if n == 0 or j - lit[n - 1] > 2]
    ends = [j for n, j in enumerate(lit) if n + 1 == len(lit) or lit[n + 1] - j > 2]
    return zip(starts, ends, strict=True)


def bht_as_printed(image, saturated=0.8):
    """alg:BHT of one image: ``H[r, theta]`` over half a turn, and its maximum.

    A row's two edges vote as one, with their middle, so that the line and not its sides has the
    peak; beyond 45 deg the columns' edges do. A vote is shared by the two cells that r lies in.
    """
    low, high = float(image.min()), float(image.max())
    best = (0.0, None)
    for turned, frame in ((False, image), (True, image.T)):
        full = frame > low + saturated * (high - low)
        edges = [((a + b) / 2.0, i) for i, row in enumerate(full) for a, b in runs_of(row)]
        for quarter in sorted(range(-180, 181), key=abs):
            theta = math.radians(0.25 * quarter)
            cells: dict[int, float] = {}
            for x, y in edges:
                r = x * math.cos(theta) + y * math.sin(theta)
                cell = math.floor(r)
                cells[cell] = cells.get(cell, 0.0) + 1.0 - (r - cell)
                cells[cell + 1] = cells.get(cell + 1, 0.0) + r - cell
            most = max(cells.values(), default=0.0)
            if most > best[0] + 1e-9:
                best = (most, 90.0 - 0.25 * quarter if turned else 0.25 * quarter)
    return best


def blooming(turn_deg, size=61):
    y, x = np.mgrid[:size, :size]
    c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    across, along = (x - 30.3) * c + (y - 30.3) * s, (y - 30.3) * c - (x - 30.3) * s
    frame = 10 + 1500 * (1 + ((x - 30.3) ** 2 + (y - 30.3) ** 2) / 4) ** -1.5
    frame[(np.abs(across) <= 1.4) & (np.abs(along) < 24)] = 240
    return np.rint(np.minimum(frame, 240)).astype(np.uint8)


def test_bht():
    for turn_deg in (0.0, 12.0, -38.0, 66.0, 90.0):
        frame = blooming(turn_deg)
        votes, angle = bht_as_printed(frame)
        line = HoughLines().lines(frame[None])[0]
        assert abs(line[4] - votes) < 1e-9
        mine = math.degrees(math.atan2(-(line[2] - line[0]), line[3] - line[1]))
        for other in (turn_deg, angle):
            assert abs((mine - other + 90.0) % 180.0 - 90.0) < 1.0


def cht_as_printed(image, edge=0.25):
    """alg:CHT: every edge pixel votes for all circles through it, in whole cells."""
    light = image.astype(float)
    down, across = np.gradient(light)
    steep = np.hypot(down, across)
    edges = np.argwhere(steep > edge * steep.max())
    angles = np.arange(0.0, 2.0 * math.pi, math.radians(3.0))
    largest = min(image.shape) // 2
    votes = np.zeros((largest, *image.shape))
    for r in range(2, largest):
        for y, x in edges:
            cells = {
                (round(x - r * math.cos(theta)), round(y - r * math.sin(theta))) for theta in angles
            }
            for a, b in cells:
                if 0 <= a < image.shape[1] and 0 <= b < image.shape[0]:
                    votes[r, b, a] += 1.0 / r  # ours: circles of every size compare
    _, b, a = np.unravel_index(np.argmax(votes), votes.shape)
    return a, b


@pytest.mark.slow
def test_cht():
    frames, places = discs(3, 4)
    found = HoughCircle().extract(frames)
    for frame, mine, place in zip(frames, found, places, strict=True):
        assert math.dist(mine, cht_as_printed(frame)) < 1.5  # whole cells
        assert math.dist(mine, place) < 0.15

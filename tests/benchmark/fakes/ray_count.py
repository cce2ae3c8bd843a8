"""Frames of rays traced one by one through both rims of each opening: an oracle of shadows.

Angles throughout, the Sun on a square grid; nothing is shared with the simulator.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit


def dense_suns(sun: np.ndarray, cells: int, turn: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Rays (K, 3) of a limb-darkened disc 0.533 deg wide about a direction, and their weights."""
    grid = (np.arange(cells) + 0.5) / cells * 2 - 1
    u, v = (axis.ravel() for axis in np.meshgrid(grid, grid))
    keep = u**2 + v**2 <= 1
    u, v = u[keep], v[keep]
    weight = 1 - 0.6 * (1 - np.sqrt(1 - u**2 - v**2))
    c, s = math.cos(turn), math.sin(turn)
    u, v = c * u - s * v, s * u + c * v
    e1 = np.cross([0.0, 1.0, 0.0], sun)
    e1 /= np.linalg.norm(e1)
    across = u[:, None] * e1 + v[:, None] * np.cross(sun, e1)
    rays = sun + math.sin(math.radians(0.533 / 2)) * across
    return rays / np.linalg.norm(rays, axis=1, keepdims=True), weight / weight.sum()


@njit
def _depth(x, y, half_w, half_h, turn):
    """How far inside an opening a point lies, in pixels; a height of 0 is that of a round one."""
    if half_h == 0.0:
        return half_w - math.sqrt(x * x + y * y)
    c, s = math.cos(turn), math.sin(turn)
    return min(half_w - abs(c * x + s * y), half_h - abs(c * y - s * x))


@njit
def count_rays(size, openings, suns, sub, rng):
    """Share of randomly jittered rays through both rims of any opening, by pixel.

    Openings (M, 5) are their middle, in pixels from the frame's corner, half width, half height
    (0: round, of this radius) and turn; suns (K, 5) where a ray from either rim lands, and weight.
    """
    frame = np.zeros(size)
    for m in range(openings.shape[0]):
        x0, y0, half_w, half_h, turn = openings[m]
        for k in range(suns.shape[0]):
            weight = suns[k, 4]
            for row in range(size[0]):
                for column in range(size[1]):
                    least = 1e9
                    for at in (0, 2):
                        x, y = column + 0.5 - x0 - suns[k, at], row + 0.5 - y0 - suns[k, at + 1]
                        least = min(least, _depth(x, y, half_w, half_h, turn))
                    if abs(least) > 0.75:  # no rim within half the pixel's diagonal
                        frame[row, column] += weight * (least > 0)
                        continue
                    hits = 0
                    for i in range(sub * sub):
                        x = column + (i % sub + rng.random()) / sub - x0
                        y = row + (i // sub + rng.random()) / sub - y0
                        passed = True
                        for at in (0, 2):
                            dx, dy = x - suns[k, at], y - suns[k, at + 1]
                            passed &= _depth(dx, dy, half_w, half_h, turn) > 0
                        hits += passed
                    frame[row, column] += weight * hits / sub**2
    return frame


def centroid(frame: np.ndarray) -> np.ndarray:
    y, x = np.mgrid[: frame.shape[0], : frame.shape[1]]
    return np.array([(frame * x).sum(), (frame * y).sum()]) / frame.sum()

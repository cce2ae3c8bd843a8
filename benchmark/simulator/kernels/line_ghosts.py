"""Compiled second images of slits on linear arrays (loaded on first use: Numba).

Light that the array throws back and the plate's underside throws down again lands after three
heights; where it met a slit on its way it is gone. Slits do not overlap, so that what is left of
each far image is its length less what it shares with every slit's direct image, point of the Sun
by point, on a few lines along the array. Lengths are in pixels.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats


@compiled
def _chords(ends: Floats, slits: Floats, u: float, v: float, line: float) -> None:
    """Write where each slit, displaced by (u, v), begins and ends (A, 2) on a line along the array.

    An end before its beginning: the slit does not reach there.
    """
    for m in range(slits.shape[0]):
        _, x, y, a, b, c, s = slits[m]
        off = line - y - v
        left, right = (-a - s * off) / c, (a - s * off) / c
        if s != 0.0:
            one, two = (c * off - b) / s, (c * off + b) / s
            left, right = max(left, min(one, two)), min(right, max(one, two))
        elif abs(off) > b:
            right = left - 1.0
        ends[m, 0], ends[m, 1] = x + u + left, x + u + right


@compiled
def _add(line: Floats, left: float, right: float, dead: float, weight: float) -> None:
    """Add light between two places to the pixels' sensitive parts."""
    for pixel in range(max(math.floor(left), 0), min(math.ceil(right), line.shape[0])):
        start, stop = pixel + dead, pixel + 1.0 - dead
        covered = min(right, stop) - max(left, start)
        if covered > 0.0:
            line[pixel] += weight * covered / (stop - start)


@compiled
def add_ghosts(
    flux: Floats,
    slits: Floats,
    sunlight: tuple[Floats, Floats],
    lines: Floats,
    numbers: tuple[float, float, float],
) -> None:
    """Add second images to every pixel of one array, sample by sample.

    Parameters
    ----------
    flux
        (N, W), added to: share of each pixel's sensitive length lit, times the light.
    slits
        (A, 7) `Mask.table` in pixels, u along the array, v across it.
    sunlight
        (2, N, K, 2) by point of the Sun, (u, v): how far it displaces the direct image and the far
        one, px; and (N, K) light of each of the K points.
    lines
        (Q,) places across the array over which light is averaged, px.
    numbers
        Position of the array's first edge, px; share of a pixel's length that is sensitive; 1 where
        slits let the light out again, else 0.
    """
    first, fill, lost = numbers
    paths, light = sunlight
    dead = (1.0 - fill) / 2.0
    count = slits.shape[0]
    near, far = np.empty((count, 2)), np.empty((count, 2))
    for n in range(flux.shape[0]):
        for k in range(light.shape[1]):
            weight = light[n, k] / lines.shape[0]
            if weight == 0.0:
                continue
            for q in range(lines.shape[0]):
                _chords(near, slits, paths[0, n, k, 0] - first, paths[0, n, k, 1], lines[q])
                _chords(far, slits, paths[1, n, k, 0] - first, paths[1, n, k, 1], lines[q])
                for m in range(count):
                    left, right = far[m, 0], far[m, 1]
                    if right <= max(left, 0.0) or left >= flux.shape[1]:
                        continue
                    _add(flux[n], left, right, dead, weight)
                    if lost == 0.0:
                        continue
                    for other in range(count):
                        start, stop = max(left, near[other, 0]), min(right, near[other, 1])
                        if stop > start:
                            _add(flux[n], start, stop, dead, -weight)

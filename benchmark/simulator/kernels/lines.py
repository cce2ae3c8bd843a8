"""Compiled light on the pixels of linear arrays behind slits (loaded on first use: Numba).

A point of the Sun puts a slit's light on a parallelogram of the detector plane; what its part
within the array's height covers of every pixel is exact. Where the slit reaches across the whole
array, that part is the difference of two ramps along it, one an edge. Where it ends on the array,
it is a polygon of at most six corners, integrated edge by edge (Green's theorem). Lengths are in
pixels.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Middle, unit vectors across and along (u and v each), half width and half length.
Shadow = tuple[float, float, float, float, float, float, float, float]


@compiled
def _shadow(slit: Floats, paths: Floats, flat: float, rise: float) -> Shadow:
    """Where the light of one slit falls; half sizes of 0 where nothing gets through.

    `paths` (3, 2) is one point's of `expose`, `flat` and `rise` are the cosine and sine of the
    plate's inclination.
    """
    _, x, y, a, b, c, s = slit
    lower, upper, tangent = paths
    # where the plate's own axes end up: a point (p, q) of it is q * rise higher
    across_u, across_v = rise * tangent[0], flat + rise * tangent[1]
    wide_u, wide_v = c + s * across_u, s * across_v
    long_u, long_v = c * across_u - s, c * across_v
    turn = wide_u * long_v - wide_v * long_u
    if turn <= 0.0:
        return 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0
    du, dv = upper[0] - lower[0], upper[1] - lower[1]
    a = max(a - abs(du * long_v - dv * long_u) / turn / 2.0, 0.0)
    b = max(b - abs(wide_u * dv - wide_v * du) / turn / 2.0, 0.0)
    middle_u = x + y * across_u + (lower[0] + upper[0]) / 2.0
    middle_v = y * across_v + (lower[1] + upper[1]) / 2.0
    return middle_u, middle_v, wide_u, wide_v, long_u, long_v, a, b


@compiled
def _reaches_across(shadow: Shadow, half: float) -> bool:
    """Whether both ends of a slit's light lie beyond the array, one on either side."""
    _, middle, _, wide, _, along, a, b = shadow
    return along > 0.0 and b * along - a * abs(wide) - abs(middle) >= half


@compiled
def _ramp(
    line: Floats, steps: Floats, ends: tuple[float, float], dead: float, weight: float
) -> None:
    """Add light that rises from none to `weight` between two places and stays there.

    Pixels on the ramp take their share in `line`, all later ones a step in `steps` (W + 1).
    `dead` is the share of a pixel lost on either side of it.
    """
    low, high = min(ends[0], ends[1]), max(ends[0], ends[1])
    width = line.shape[0]
    if low >= width:
        return
    if high <= 0.0:
        steps[0] += weight
        return
    last = math.floor(high)
    for pixel in range(max(math.floor(low), 0), min(last, width - 1) + 1):
        start, stop = pixel + dead, pixel + 1.0 - dead
        area = max(stop - max(start, high), 0.0)
        left, right = max(start, low), min(stop, high)
        if right > left:
            area += ((left + right) / 2.0 - low) / (high - low) * (right - left)
        line[pixel] += weight * area / (stop - start)
    if last < width:
        steps[last + 1] += weight


@compiled
def _cut(kept: Floats, corners: Floats, count: int, sign: float, limit: float) -> int:
    """Write the part of a polygon with ``sign v <= limit``; return its number of corners."""
    total = 0
    for i in range(count):
        j = (i + 1) % count
        here, there = sign * corners[i, 1], sign * corners[j, 1]
        if here <= limit:
            kept[total] = corners[i]
            total += 1
        if (here <= limit) != (there <= limit):
            share = (limit - here) / (there - here)
            kept[total, 0] = corners[i, 0] + share * (corners[j, 0] - corners[i, 0])
            kept[total, 1] = sign * limit
            total += 1
    return total


@compiled
def _edge(line: Floats, first: Floats, second: Floats, dead: float, weight: float) -> None:
    """Add the area between an edge and the array's axis to every pixel it passes.

    Negative from left to right.
    """
    left, right = first[0], second[0]
    sign = -weight
    if left > right:
        left, right = right, left
        sign = weight
    if right <= 0.0 or left >= line.shape[0] or left == right:
        return
    slope = (second[1] - first[1]) / (second[0] - first[0])
    for pixel in range(max(math.floor(left), 0), min(math.ceil(right), line.shape[0])):
        start, stop = max(left, pixel + dead), min(right, pixel + 1.0 - dead)
        if stop > start:
            height = first[1] + slope * ((start + stop) / 2.0 - first[0])
            line[pixel] += sign * height * (stop - start)


@compiled
def _polygon(line: Floats, shadow: Shadow, half: float, dead: float, weight: float) -> None:
    """Add the light of a slit that may end on the array."""
    u, v, wide_u, wide_v, long_u, long_v, a, b = shadow
    corners, one, two = np.empty((4, 2)), np.empty((8, 2)), np.empty((8, 2))
    for i, (p, q) in enumerate(((-a, -b), (a, -b), (a, b), (-a, b))):
        corners[i, 0] = u + p * wide_u + q * long_u
        corners[i, 1] = v + p * wide_v + q * long_v
    count = _cut(one, corners, 4, 1.0, half)
    count = _cut(two, one, count, -1.0, half)
    share = weight / (2.0 * half * (1.0 - 2.0 * dead))
    for i in range(count):
        _edge(line, two[i], two[(i + 1) % count], dead, share)


@compiled
def expose(
    flux: Floats,
    slits: Floats,
    paths: Floats,
    light: Floats,
    numbers: tuple[float, float, float, float, float],
) -> None:
    """Write the light on every pixel of one array, sample by sample.

    Parameters
    ----------
    flux
        (N, W), overwritten: share of each pixel's sensitive area lit, times the light.
    slits
        (A, 7) `Mask.table` in pixels, u along the array, v across it.
    paths
        (3, N, K, 2) by point of the Sun, (u, v): displacements of the mask's lower and upper rims,
        px, and the tangents of the point's angles along and across the array.
    light
        (N, K) light of each of the K points of the Sun.
    numbers
        Position of the array's first edge, px; half height of the array, px; share of a pixel's
        length that is sensitive; cosine and sine of the plate's inclination.
    """
    first, half, fill, flat, rise = numbers
    dead = (1.0 - fill) / 2.0
    width = flux.shape[1]
    steps = np.zeros(width + 1)
    for n in range(flux.shape[0]):
        line = flux[n]
        line[:] = 0.0
        steps[:] = 0.0
        for k in range(light.shape[1]):
            weight = light[n, k]
            if weight == 0.0:
                continue
            for m in range(slits.shape[0]):
                shadow = _shadow(slits[m], paths[:, n, k], flat, rise)
                u, v, wide_u, wide_v, long_u, long_v, a, b = shadow
                if a <= 0.0 or b <= 0.0:
                    continue
                u -= first
                if not _reaches_across(shadow, half):
                    moved = (u, v, wide_u, wide_v, long_u, long_v, a, b)
                    _polygon(line, moved, half, dead, weight)
                    continue
                slope = long_u / long_v
                for side in (-1.0, 1.0):
                    at = u + side * a * wide_u - (v + side * a * wide_v) * slope
                    ends = (at - half * slope, at + half * slope)
                    _ramp(line, steps, ends, dead, -side * weight)
        total = 0.0
        for column in range(width):
            total += steps[column]
            line[column] = max(line[column] + total, 0.0)

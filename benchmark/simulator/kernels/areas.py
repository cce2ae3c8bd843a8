"""Exact areas of intersections of half-planes and discs (compiled; loaded on first use).

Lines are rows (a, b, c) of ``a x + b y <= c`` with ``a^2 + b^2 = 1``, discs rows (x, y, radius).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

Interval = tuple[float, float]

_EMPTY = (0.0, 0.0)


@compiled
def _cut_by_line(line: Floats, other: Floats, other_first: bool) -> Interval:
    """Part of a boundary line on the allowed side of another, as a run of arc length."""
    a, b, c = line
    slope = other[1] * a - other[0] * b
    room = other[2] - c * (other[0] * a + other[1] * b)
    if abs(slope) >= 1e-14:
        return (-1e300, room / slope) if slope > 0.0 else (room / slope, 1e300)
    same = other[0] * a + other[1] * b > 0.0 and room == 0.0
    if room < 0.0 or (same and other_first):  # of two equal lines only the first one counts
        return _EMPTY
    return -1e300, 1e300


@compiled
def _cut_by_disc(line: Floats, disc: Floats) -> Interval:
    """Part of a boundary line inside a disc, as a run of arc length."""
    a, b, c = line
    x, y = a * c - disc[0], b * c - disc[1]
    half = b * x - a * y
    square = half * half - (x * x + y * y - disc[2] * disc[2])
    if square <= 0.0:
        return _EMPTY
    root = math.sqrt(square)
    return half - root, half + root


@compiled
def _line_part(i: int, lines: Floats, discs: Floats) -> float:
    """Green's integral along boundary line `i`: half its offset times its length."""
    low, high = -1e300, 1e300
    for j in range(lines.shape[0]):
        if j != i:
            start, stop = _cut_by_line(lines[i], lines[j], j < i)
            low, high = max(low, start), min(high, stop)
            if start == stop:
                return 0.0
    for j in range(discs.shape[0]):
        start, stop = _cut_by_disc(lines[i], discs[j])
        low, high = max(low, start), min(high, stop)
        if start == stop:
            return 0.0
    return float(0.5 * lines[i, 2] * max(high - low, 0.0))


@compiled
def _meeting(disc: Floats, other: Floats, is_line: bool) -> Interval:
    """Where the rim of a disc leaves another boundary's inside: angle of its middle, half width.

    Half width 0: the whole rim is inside; pi: none of it is (touching from outside counts so).
    """
    x, y, radius = disc
    if is_line:
        middle = math.atan2(other[1], other[0])
        cosine = (other[2] - other[0] * x - other[1] * y) / radius
    else:
        dx, dy = other[0] - x, other[1] - y
        apart2 = dx * dx + dy * dy
        if apart2 == 0.0:
            return 0.0, 0.0 if radius <= other[2] else math.pi
        middle = math.atan2(-dy, -dx)
        cosine = (other[2] * other[2] - apart2 - radius * radius) / (
            2.0 * math.sqrt(apart2) * radius
        )
    return middle, math.acos(min(max(cosine, -1.0), 1.0))


@compiled
def _cuts(i: int, lines: Floats, discs: Floats) -> Floats:
    """Sorted angles at which the rim of disc `i` meets other boundaries, ends included.

    Empty when all of the rim lies outside one of them.
    """
    cuts = np.empty(2 * (lines.shape[0] + discs.shape[0]) + 2)
    cuts[0], cuts[1] = -math.pi, math.pi
    count = 2
    for j in range(lines.shape[0] + discs.shape[0]):
        is_line = j < lines.shape[0]
        other = lines[j] if is_line else discs[j - lines.shape[0]]
        middle, half = _meeting(discs[i], other, is_line)
        if half == math.pi:
            return cuts[:0]
        if half > 0.0:
            for k, angle in enumerate((middle - half, middle + half)):
                cuts[count + k] = angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)
            count += 2
    return np.sort(cuts[:count])


@compiled
def _holds(x: float, y: float, i: int, lines: Floats, discs: Floats) -> bool:
    """Whether a point of the rim of disc `i` belongs to the boundary of the intersection."""
    for j in range(lines.shape[0]):
        if lines[j, 0] * x + lines[j, 1] * y > lines[j, 2]:
            return False
    for j in range(discs.shape[0]):
        if j == i:
            continue
        dx, dy = x - discs[j, 0], y - discs[j, 1]
        if (discs[j] == discs[i]).all():
            if j < i:  # of two equal discs only the first one counts
                return False
        elif dx * dx + dy * dy > discs[j, 2] * discs[j, 2]:
            return False
    return True


@compiled
def _disc_part(i: int, lines: Floats, discs: Floats) -> float:
    """Green's integral along the arcs of disc `i` that bound the intersection."""
    x, y, radius = discs[i]
    total = 0.0
    cuts = _cuts(i, lines, discs)
    for j in range(cuts.shape[0] - 1):
        start, stop = cuts[j], cuts[j + 1]
        middle = (start + stop) / 2.0
        point_x, point_y = x + radius * math.cos(middle), y + radius * math.sin(middle)
        if stop > start and _holds(point_x, point_y, i, lines, discs):
            sines = math.sin(stop) - math.sin(start)
            cosines = math.cos(stop) - math.cos(start)
            total += 0.5 * radius * (radius * (stop - start) + x * sines - y * cosines)
    return total


@compiled
def convex_area(lines: Floats, discs: Floats) -> float:
    """Area of the intersection of half-planes (M, 3) and discs (D, 3), by Green's theorem.

    Returns 0 when it is empty. It must be bounded.
    """
    total = 0.0
    for i in range(lines.shape[0]):
        total += _line_part(i, lines, discs)
    for i in range(discs.shape[0]):
        total += _disc_part(i, lines, discs)
    return float(max(total, 0.0))


@compiled
def _lines_of_box(box: Floats, extra: int) -> Floats:
    """Half-planes (4 + extra, 3) of x_min, x_max, y_min, y_max; the extra rows left open."""
    lines = np.zeros((4 + extra, 3))
    lines[0, 0], lines[0, 2] = -1.0, -box[0]
    lines[1, 0], lines[1, 2] = 1.0, box[1]
    lines[2, 1], lines[2, 2] = -1.0, -box[2]
    lines[3, 1], lines[3, 2] = 1.0, box[3]
    return lines


@compiled
def _lit_by_disc(box: Floats, aperture: Floats, lower: Floats, upper: Floats) -> float:
    """Area of a box lit through a round aperture with both rims displaced."""
    same = lower[0] == upper[0] and lower[1] == upper[1]
    discs = np.empty((1 if same else 2, 3))
    discs[0, 0], discs[0, 1] = aperture[1] + lower[0], aperture[2] + lower[1]
    discs[-1, 0], discs[-1, 1] = aperture[1] + upper[0], aperture[2] + upper[1]
    discs[:, 2] = aperture[3]
    return float(convex_area(_lines_of_box(box, 0), discs))


@compiled
def _lit_by_box(box: Floats, aperture: Floats, lower: Floats, upper: Floats) -> float:
    """Area of a box lit through a rectangular aperture with both rims displaced."""
    c, s = aperture[5], aperture[6]
    dx, dy = upper[0] - lower[0], upper[1] - lower[1]
    a = aperture[3] - abs(c * dx + s * dy) / 2.0
    b = aperture[4] - abs(c * dy - s * dx) / 2.0
    if a <= 0.0 or b <= 0.0:
        return 0.0
    x = aperture[1] + (lower[0] + upper[0]) / 2.0
    y = aperture[2] + (lower[1] + upper[1]) / 2.0
    if s == 0.0:
        across = min(box[1], x + a) - max(box[0], x - a)
        along = min(box[3], y + b) - max(box[2], y - b)
        return float(max(across, 0.0) * max(along, 0.0))
    u, v = c * x + s * y, c * y - s * x
    lines = _lines_of_box(box, 4)
    lines[4] = np.array([c, s, u + a])
    lines[5] = np.array([-c, -s, a - u])
    lines[6] = np.array([-s, c, v + b])
    lines[7] = np.array([s, -c, b - v])
    return float(convex_area(lines, np.empty((0, 3))))


@compiled
def lit_boxes(area: Floats, boxes: Floats, apertures: Floats, rims: Floats, light: Floats) -> None:
    """Write the lit area of boxes (detector elements) behind a mask, weighted by the light.

    Parameters
    ----------
    area
        (N, B), overwritten; square of the unit of the lengths.
    boxes
        (B, 4) x_min, x_max, y_min, y_max.
    apertures
        (A, 7) `Mask.table`.
    rims
        (2, N, K, 2) displacement of the mask's lower and upper rims.
    light
        (N, K) light of each of the K points of the Sun.
    """
    area[:] = 0.0
    for n in range(area.shape[0]):
        for k in range(light.shape[1]):
            for m in range(apertures.shape[0]):
                for j in range(boxes.shape[0]):
                    if apertures[m, 0] < 0.5:
                        lit = _lit_by_disc(boxes[j], apertures[m], rims[0, n, k], rims[1, n, k])
                    else:
                        lit = _lit_by_box(boxes[j], apertures[m], rims[0, n, k], rims[1, n, k])
                    area[n, j] += light[n, k] * lit

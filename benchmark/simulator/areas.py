"""Exact areas of intersections of half-planes and discs (compiled; loaded on first use)."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def _convex_area(lines: Floats, discs: Floats) -> float:
    """Area of ``{a x + b y <= c for all lines} and {inside all discs}`` by Green's theorem.

    Parameters
    ----------
    lines
        (M, 3) rows a, b, c with ``a^2 + b^2 = 1``.
    discs
        (D, 3) rows x, y, radius.

    Returns
    -------
    The area; 0 when the intersection is empty. The intersection must be bounded.
    """
    total = 0.0
    for i in range(lines.shape[0]):
        a, b, c = lines[i, 0], lines[i, 1], lines[i, 2]
        px, py, tx, ty = a * c, b * c, -b, a
        low, high = -1e300, 1e300
        for j in range(lines.shape[0]):
            if j == i:
                continue
            slope = lines[j, 0] * tx + lines[j, 1] * ty
            room = lines[j, 2] - lines[j, 0] * px - lines[j, 1] * py
            if abs(slope) < 1e-14:
                same = lines[j, 0] * a + lines[j, 1] * b > 0.0 and room == 0.0
                if room < 0.0 or (same and j < i):  # of two equal lines the first one counts
                    low, high = 0.0, 0.0
            elif slope > 0.0:
                high = min(high, room / slope)
            else:
                low = max(low, room / slope)
        for j in range(discs.shape[0]):
            dx, dy = px - discs[j, 0], py - discs[j, 1]
            half = dx * tx + dy * ty
            root = half * half - (dx * dx + dy * dy - discs[j, 2] * discs[j, 2])
            if root <= 0.0:
                low, high = 0.0, 0.0
            else:
                root = math.sqrt(root)
                low, high = max(low, -half - root), min(high, -half + root)
        if high > low:
            total += 0.5 * c * (high - low)
    cuts = np.empty(2 * (lines.shape[0] + discs.shape[0]) + 2)
    for i in range(discs.shape[0]):
        x, y, radius = discs[i, 0], discs[i, 1], discs[i, 2]
        cuts[0], cuts[1] = -math.pi, math.pi
        count = 2
        for j in range(lines.shape[0]):
            reach = (lines[j, 2] - lines[j, 0] * x - lines[j, 1] * y) / radius
            if abs(reach) < 1.0:
                centre, half = math.atan2(lines[j, 1], lines[j, 0]), math.acos(reach)
                cuts[count] = centre - half
                cuts[count + 1] = centre + half
                count += 2
        for j in range(discs.shape[0]):
            dx, dy = discs[j, 0] - x, discs[j, 1] - y
            apart = math.sqrt(dx * dx + dy * dy)
            if j == i or apart == 0.0:
                continue
            reach = (apart * apart + radius * radius - discs[j, 2] * discs[j, 2]) / (
                2.0 * apart * radius
            )
            if abs(reach) < 1.0:
                centre, half = math.atan2(dy, dx), math.acos(reach)
                cuts[count] = centre - half
                cuts[count + 1] = centre + half
                count += 2
        for j in range(2, count):
            if cuts[j] < -math.pi:
                cuts[j] += 2.0 * math.pi
            elif cuts[j] > math.pi:
                cuts[j] -= 2.0 * math.pi
        ordered = np.sort(cuts[:count])
        for j in range(count - 1):
            start, stop = ordered[j], ordered[j + 1]
            middle = (start + stop) / 2.0
            mx, my = x + radius * math.cos(middle), y + radius * math.sin(middle)
            inside = stop > start
            for m in range(lines.shape[0]):
                if lines[m, 0] * mx + lines[m, 1] * my > lines[m, 2]:
                    inside = False
            for m in range(discs.shape[0]):
                dx, dy = mx - discs[m, 0], my - discs[m, 1]
                same = discs[m, 0] == x and discs[m, 1] == y and discs[m, 2] == radius
                if m != i and same and m < i:
                    inside = False
                if m != i and not same and dx * dx + dy * dy > discs[m, 2] * discs[m, 2]:
                    inside = False
            if inside:
                total += 0.5 * (
                    radius * radius * (stop - start)
                    + radius * x * (math.sin(stop) - math.sin(start))
                    - radius * y * (math.cos(stop) - math.cos(start))
                )
    return max(total, 0.0)


convex_area: Callable[[Floats, Floats], float] = njit(cache=True)(_convex_area)


def _lit_boxes(
    area: Floats,
    boxes: Floats,
    apertures: Floats,
    lower: Floats,
    upper: Floats,
    weights: Floats,
) -> None:
    """Write the weighted lit area of boxes (detector elements) behind a mask.

    Parameters
    ----------
    area
        (N, B), overwritten; square of the unit of the lengths.
    boxes
        (B, 4) x_min, x_max, y_min, y_max.
    apertures
        (A, 7) `Mask.table`.
    lower, upper
        (N, K, 2) displacement of the mask's rims.
    weights
        (N, K) light of each of the K points of the Sun.
    """
    area[:] = 0.0
    disc_lines = np.empty((4, 3))
    box_lines = np.empty((8, 3))
    no_discs = np.empty((0, 3))
    one_disc, two_discs = np.empty((1, 3)), np.empty((2, 3))
    for n in range(area.shape[0]):
        for k in range(lower.shape[1]):
            for m in range(apertures.shape[0]):
                a, b = apertures[m, 3], apertures[m, 4]
                c, s = apertures[m, 5], apertures[m, 6]
                cx, cy = apertures[m, 1] + lower[n, k, 0], apertures[m, 2] + lower[n, k, 1]
                ux, uy = apertures[m, 1] + upper[n, k, 0], apertures[m, 2] + upper[n, k, 1]
                dx, dy = ux - cx, uy - cy
                for j in range(boxes.shape[0]):
                    x0, x1, y0, y1 = boxes[j]
                    lines = disc_lines if apertures[m, 0] < 0.5 else box_lines
                    lines[0] = (-1.0, 0.0, -x0)
                    lines[1] = (1.0, 0.0, x1)
                    lines[2] = (0.0, -1.0, -y0)
                    lines[3] = (0.0, 1.0, y1)
                    if apertures[m, 0] < 0.5:
                        if dx == 0.0 and dy == 0.0:
                            one_disc[0] = (cx, cy, a)
                            lit = _area(lines, one_disc)
                        else:
                            two_discs[0] = (cx, cy, a)
                            two_discs[1] = (ux, uy, a)
                            lit = _area(lines, two_discs)
                    else:
                        half_a = a - abs(c * dx + s * dy) / 2.0
                        half_b = b - abs(c * dy - s * dx) / 2.0
                        mx, my = (cx + ux) / 2.0, (cy + uy) / 2.0
                        if half_a <= 0.0 or half_b <= 0.0:
                            lit = 0.0
                        elif s == 0.0:
                            across = min(x1, mx + half_a) - max(x0, mx - half_a)
                            along = min(y1, my + half_b) - max(y0, my - half_b)
                            lit = max(across, 0.0) * max(along, 0.0)
                        else:
                            u, v = c * mx + s * my, c * my - s * mx
                            lines[4] = (c, s, u + half_a)
                            lines[5] = (-c, -s, half_a - u)
                            lines[6] = (-s, c, v + half_b)
                            lines[7] = (s, -c, half_b - v)
                            lit = _area(lines, no_discs)
                    area[n, j] += weights[n, k] * lit


_area = convex_area
lit_boxes: Callable[[Floats, Floats, Floats, Floats, Floats, Floats], None] = njit(cache=True)(
    _lit_boxes
)

"""Matched estimate of a round spot's centre from its own radial profile, frame by frame.

Frames are (N, H, W) arrays from `algorithms.inputs.as_frames`; all sums are float64.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.kernels.compilation import compiled

#: Sums of a ring: see `_ring_sums`.
_SUMS = 16
#: Width of a ring, px, at a contrast of one, and its limits.
_WIDTH, _FINEST, _COARSEST = 2.1, 0.3, 1.0


@compiled
def _border(frame: NDArray[Any]) -> tuple[float, float]:
    """Mean and variance of the outermost pixels."""
    height, width = frame.shape
    first = float(frame[0, 0])
    total = 0.0
    squares = 0.0
    for i in (0, height - 1):
        for j in range(width):
            u = float(frame[i, j]) - first
            total += u
            squares += u * u
    for i in range(1, height - 1):
        for j in (0, width - 1):
            u = float(frame[i, j]) - first
            total += u
            squares += u * u
    count = 2 * width + 2 * max(height - 2, 0)
    mean = total / count
    return first + mean, max(squares / count - mean * mean, 0.0)


@compiled
def _lit_spot(
    frame: NDArray[Any], maxima: NDArray[Any], cut: float, spread: float
) -> tuple[float, float, float]:
    """Centroid of the light above a cut, and the radius of a disc of as many pixels.

    The radius is zero where the lit pixels reach the frame's border, or where their mean squared
    distance exceeds `spread` times that of a disc: not one whole spot.
    """
    height, width = frame.shape
    light = 0.0
    light_x = 0.0
    light_y = 0.0
    pixels = 0
    pixels_x = 0
    pixels_y = 0
    squares = 0
    cut_off = False
    for i in range(height):
        if not maxima[i] > cut:
            continue
        cut_off |= i == 0 or i == height - 1
        row = frame[i]
        cut_off |= row[0] > cut or row[width - 1] > cut
        for j in range(width):
            if row[j] > cut:
                u = row[j] - cut
                light += u
                light_x += j * u
                light_y += i * u
                pixels += 1
                pixels_x += j
                pixels_y += i
                squares += i * i + j * j
    if cut_off or not light > 0:
        return 0.0, 0.0, 0.0
    mean_x = pixels_x / pixels
    mean_y = pixels_y / pixels
    apart = squares / pixels - mean_x * mean_x - mean_y * mean_y
    if apart > spread * max(pixels, 3) / (2 * math.pi):
        return 0.0, 0.0, 0.0
    return light_x / light, light_y / light, math.sqrt(pixels / math.pi)


@compiled
def _ring_sums(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any], x: float, y: float, base: float, reach: float, ring: float, sums: Floats
) -> int:
    """Sum the pixels within `reach` of (x, y) by rings of width `ring`; return how many rings.

    With u the pixel above `base`, (c, s) its direction and d its distance beyond the ring's inner
    edge, a row of `sums` is ``n, c, s, c^2, c s, d, c d, s d, d^2, c d^2, s d^2, u, c u, s u,
    d u, u^2``, each summed over the ring.
    """
    height, width = frame.shape
    rings = int(reach / ring) + 1
    sums[:rings] = 0.0
    scale = 1.0 / ring
    for i in range(max(math.ceil(y - reach), 0), min(math.floor(y + reach), height - 1) + 1):
        dy = i - y
        side = math.sqrt(max(reach * reach - dy * dy, 0.0))
        first = max(math.ceil(x - side), 0)
        row = frame[i, first : min(math.floor(x + side), width - 1) + 1]
        for j in range(row.size):
            dx = (first + j) - x
            r = math.sqrt(dx * dx + dy * dy)
            inverse = 1.0 / max(r, 1e-300)
            # Unsigned: an index that might be negative is checked at every use.
            k = np.uint32(r * scale)
            c = dx * inverse
            s = dy * inverse
            d = r - k * ring
            u = row[j] - base
            at = sums[k]
            c_d = c * d
            s_d = s * d
            at[0] += 1.0
            at[1] += c
            at[2] += s
            at[3] += c * c
            at[4] += c * s
            at[5] += d
            at[6] += c_d
            at[7] += s_d
            at[8] += d * d
            at[9] += c_d * d
            at[10] += s_d * d
            at[11] += u
            at[12] += c * u
            at[13] += s * u
            at[14] += d * u
            at[15] += u * u
    return rings


@compiled
def _step(  # noqa: PLR0915 - the formulas in their order
    sums: Floats, rings: int, ring: float, noise: float, rows: Floats
) -> tuple[float, float, bool]:
    """One Gauss-Newton step of the centre from ring sums, and whether there is one.

    `noise` is the variance of a dark pixel; a lit one has more in proportion to its light, by
    the factor that explains the scatter within the rings.
    """
    # Rings as parabolas: mean distance, mean light, slope, half curvature, variance of a pixel.
    count = 0
    for k in range(rings):
        n = sums[k, 0]
        if n > 0:
            rows[count, 0] = k
            rows[count, 1] = k * ring + sums[k, 5] / n
            rows[count, 2] = sums[k, 11] / n
            count += 1
    if count < 3:
        return 0.0, 0.0, False
    excess = 0.0
    light = 0.0
    for m in range(count):
        middle = min(max(m, 1), count - 2)
        before = rows[middle, 1] - rows[middle - 1, 1]
        after = rows[middle + 1, 1] - rows[middle, 1]
        rise = (rows[middle, 2] - rows[middle - 1, 2]) / before
        next_rise = (rows[middle + 1, 2] - rows[middle, 2]) / after
        bend = (next_rise - rise) / (before + after)
        slope = rise + bend * before
        slope += 2 * bend * (rows[m, 1] - rows[middle, 1])
        rows[m, 3] = slope
        rows[m, 4] = bend
        at = sums[int(rows[m, 0])]
        n, d, u = at[0], at[5] / at[0], rows[m, 2]
        scatter = at[15] - n * u * u
        scatter -= 2 * slope * (at[14] - n * d * u) - slope * slope * (at[8] - n * d * d)
        if n > 1:
            excess += scatter - (n - 1) * noise
            light += (n - 1) * max(u, 0.0)
    gain = max(excess / light, 0.0) if light > 0 else 0.0
    floor = 1e-12 * rows[0, 2] * rows[0, 2]
    for m in range(count):
        rows[m, 5] = noise + gain * max(rows[m, 2], 0.0) + floor
    a_xx = 0.0
    a_xy = 0.0
    a_yy = 0.0
    b_x = 0.0
    b_y = 0.0
    for m in range(count):
        low = max(m - 1, 0)
        high = min(m + 1, count - 1)
        at = sums[int(rows[m, 0])]
        n, u, slope, bend = at[0], rows[m, 2], rows[m, 3], rows[m, 4]
        # Of the squared slope, what its own noise explains is no slope.
        apart = rows[high, 1] - rows[low, 1]
        doubt = rows[low, 5] / sums[int(rows[low, 0]), 0]
        doubt += rows[high, 5] / sums[int(rows[high, 0]), 0]
        doubt /= apart * apart
        if slope * slope <= doubt:
            continue
        weight = (1.0 - doubt / (slope * slope)) * slope / rows[m, 5]
        c, s, d, dd = at[1], at[2], at[5] / n, at[8] / n
        a_xx += weight * slope * (at[3] - c * c / n)
        a_xy += weight * slope * (at[4] - c * s / n)
        a_yy += weight * slope * (n - at[3] - s * s / n)
        # Light expected beyond the mean: slope (d - dbar) + bend ((d - dbar)^2 - its mean).
        tilt = slope - 2 * bend * d
        level = u - tilt * d - bend * dd
        b_x -= weight * (at[12] - level * c - tilt * at[6] - bend * at[9])
        b_y -= weight * (at[13] - level * s - tilt * at[7] - bend * at[10])
    determinant = a_xx * a_yy - a_xy * a_xy
    if not determinant > 1e-12 * a_xx * a_yy:
        return 0.0, 0.0, False
    return (
        (a_yy * b_x - a_xy * b_y) / determinant,
        (a_xx * b_y - a_xy * b_x) / determinant,
        True,
    )


@compiled
def matched_centres(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    maxima: NDArray[Any],
    threshold: float,
    spread: float,
    steps: int,
    out: Floats,
) -> None:
    """Write the centre (x, y) of each frame's spot to `out` (N, 2); NaN where there is not one.

    `maxima` (N, H) are the rows' largest values, `threshold` the fraction of the peak above which
    pixels start the search, `spread` the limit of `_lit_spot`.
    """
    count, height, width = frames.shape
    widest = 1.2 * math.hypot(height, width) + 4.0
    sums = np.empty((int(widest / _FINEST) + 2, _SUMS))
    rows = np.empty((len(sums), 6))
    for k in range(count):
        frame = frames[k]
        out[k, 0] = np.nan
        out[k, 1] = np.nan
        base, noise = _border(frame)
        peak = float(maxima[k].max())
        if not peak > base:
            continue
        cut = base + threshold * (peak - base)
        x, y, radius = _lit_spot(frame, maxima[k], cut, spread)
        if radius == 0.0:
            continue
        # A parabola misses the profile by the cube of a ring's width: to keep that in the same
        # proportion to the noise, finer rings for brighter spots.
        contrast = (peak - base) / math.sqrt(noise) if noise > 0 else np.inf
        ring = min(max(_WIDTH * contrast ** (-1.0 / 3.0), _FINEST), _COARSEST)
        found = True
        for _ in range(steps):
            rings = _ring_sums(frame, x, y, base, 1.1 * radius + 3.5, ring, sums)
            move_x, move_y, found = _step(sums, rings, ring, noise, rows)
            found = found and abs(move_x) <= radius and abs(move_y) <= radius
            if not found:
                break
            x += move_x
            y += move_y
        if found:
            out[k, 0] = x
            out[k, 1] = y

"""Matched estimate of a round spot's centre from its own radial profile, frame by frame.

Frames are (N, H, W) arrays from `algorithms.inputs.as_frames`; all sums are float64.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Width of a ring, px, at a contrast of one, and its limits.
_WIDTH, _FINEST, _COARSEST = 1.05, 0.15, 0.5
#: Rings to each side that a straight line through the profile is fitted to.
_NEAR = 3
#: Columns of the sums of a ring, of the running sums and of the profile: see where they are made.
_SUMS, _RUNNING, _PROFILE = 6, 7, 7
#: Pixels of a lit region below which its rings do not tell whether they are even, nor its profile.
_ENOUGH, _RESOLVED = 12.0, 32.0
#: Columns that `matched_centres` writes.
MATCHED = 6


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
        row_light = 0.0
        row_pixels = 0
        row_x = 0
        row_squares = 0
        for j in range(width):
            if row[j] > cut:
                u = row[j] - cut
                row_light += u
                light_x += j * u
                row_pixels += 1
                row_x += j
                row_squares += j * j
        light += row_light
        light_y += i * row_light
        pixels += row_pixels
        pixels_x += row_x
        pixels_y += i * row_pixels
        squares += i * i * row_pixels + row_squares
    if cut_off or not light > 0:
        return 0.0, 0.0, 0.0
    mean_x = pixels_x / pixels
    mean_y = pixels_y / pixels
    apart = squares / pixels - mean_x * mean_x - mean_y * mean_y
    if apart > spread * max(pixels, 3) / (2 * math.pi):
        return 0.0, 0.0, 0.0
    return light_x / light, light_y / light, math.sqrt(pixels / math.pi)


@compiled
def _pixels_near(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any], x: float, y: float, base: float, reach: float, pixels: Floats
) -> int:
    """List the pixels within `reach` of (x, y) and return how many there are.

    Rows of `pixels` (4, P): direction c and s, distance r, light above `base`.
    """
    height, width = frame.shape
    count = 0
    for i in range(max(math.ceil(y - reach), 0), min(math.floor(y + reach), height - 1) + 1):
        dy = i - y
        side = math.sqrt(max(reach * reach - dy * dy, 0.0))
        first = max(math.ceil(x - side), 0)
        row = frame[i, first : min(math.floor(x + side), width - 1) + 1]
        # Slices, counted from zero: with an index that might be negative no loop vectorises.
        c = pixels[0, count : count + row.size]
        s = pixels[1, count : count + row.size]
        r = pixels[2, count : count + row.size]
        u = pixels[3, count : count + row.size]
        offset = first - x
        for j in range(row.size):
            dx = offset + j
            distance = math.sqrt(dx * dx + dy * dy)
            inverse = 1.0 / max(distance, 1e-300)
            c[j] = dx * inverse
            s[j] = dy * inverse
            r[j] = distance
            u[j] = row[j] - base
        count += row.size
    return count


@compiled
def _ring_sums(pixels: Floats, count: int, scale: float, sums: Floats) -> None:
    """Add to each ring's row of `sums` its pixels' ``1, r, u, u^2, c, s``; rings per px `scale`."""
    c = pixels[0, :count]
    s = pixels[1, :count]
    r = pixels[2, :count]
    u = pixels[3, :count]
    for p in range(count):
        # Unsigned: an index that might be negative is checked at every use.
        at = sums[np.uint32(r[p] * scale)]
        at[0] += 1.0
        at[1] += r[p]
        at[2] += u[p]
        at[3] += u[p] * u[p]
        at[4] += c[p]
        at[5] += s[p]


@compiled
def _running_sums(sums: Floats, rings: int, running: Floats) -> None:
    """Sum over the rings before one, those before the first and after the last repeated.

    Rows of `running` (7, >= rings + 2 near + 1): ``n, r, r^2, u, u r, c, s``, a ring's pixels all
    taken at its mean distance.
    """
    n_, r_, rr_, u_, ur_ = running[0], running[1], running[2], running[3], running[4]
    c_, s_ = running[5], running[6]
    running[:, : _NEAR + 1] = 0.0
    n, r, rr, u, ur, c, s = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for q in range(rings):
        at = sums[q]
        mean = at[1] / max(at[0], 1.0)
        n += at[0]
        r += at[1]
        rr += at[1] * mean
        u += at[2]
        ur += at[2] * mean
        c += at[4]
        s += at[5]
        after = q + _NEAR + 1
        n_[after] = n
        r_[after] = r
        rr_[after] = rr
        u_[after] = u
        ur_[after] = ur
        c_[after] = c
        s_[after] = s
    for k in range(len(running)):
        last = running[k, rings + _NEAR]
        running[k, rings + _NEAR + 1 : rings + 2 * _NEAR + 1] = last


@compiled
def _profile(  # noqa: PLR0917 - the formulas in their order
    sums: Floats, running: Floats, rings: int, ring: float, noise: float, lines: Floats, out: Floats
) -> float:
    """Light against distance, ring by ring, and what a pixel's departure from it counts.

    `noise` is the variance of a dark pixel; a lit one has more in proportion to its light, by
    the factor that explains the scatter within the rings. `lines` (7, >= rings + 2 near) is work
    space. A row of `out` holds ``p_0, p_1, p_2`` of the light ``p_0 + p_1 r + p_2 r^2``, the
    weight of a pixel's departure, weight times slope, and the mean c and s of the pixels near.

    Return the square of what light within a ring scatters by, over the brightest ring's.
    """
    wide = 2 * _NEAR + 1
    slopes, means, levels, spreads, shares = lines[0], lines[1], lines[2], lines[3], lines[6]
    n_, r_, rr_, u_, ur_ = running[0], running[1], running[2], running[3], running[4]
    c_, s_ = running[5], running[6]
    for q in range(rings):
        n = n_[wide + q] - n_[q]
        inverse = 1.0 / max(n, 1.0)
        mean = (r_[wide + q] - r_[q]) * inverse
        level = (u_[wide + q] - u_[q]) * inverse
        spread = rr_[wide + q] - rr_[q] - n * mean * mean
        rise = ur_[wide + q] - ur_[q] - n * mean * level
        single = spread <= 1e-9 * n
        slopes[_NEAR + q] = 0.0 if single else rise / spread
        spreads[q] = 0.0 if single else spread
        means[_NEAR + q] = mean
        levels[q] = level
        shares[q] = inverse
    for q in range(_NEAR):
        slopes[q], means[q] = slopes[_NEAR], means[_NEAR]
        slopes[_NEAR + rings + q] = slopes[_NEAR + rings - 1]
        means[_NEAR + rings + q] = means[_NEAR + rings - 1]
    excess = 0.0
    light = 0.0
    for q in range(rings):
        at = sums[q]
        others = max(at[0] - 1.0, 0.0)
        u = at[2] / max(at[0], 1.0)
        slope = slopes[_NEAR + q]
        excess += at[3] - at[2] * u - others * noise - slope * slope * at[0] * ring * ring / 12.0
        light += others * max(u, 0.0)
    gain = max(excess / light, 0.0) if light > 0 else 0.0
    # Of the brightest ring: around a point between four pixels the innermost ones are empty.
    brightest = 0.0
    for q in range(rings):
        brightest = max(brightest, levels[q])
    floor = 1e-12 * brightest * brightest + 1e-300
    bends, weights = lines[4], lines[5]
    for q in range(rings):
        apart = max(means[q + 2 * _NEAR] - means[q], 1e-9)
        bends[q] = 0.5 * (slopes[q + 2 * _NEAR] - slopes[q]) / apart
        slope = slopes[_NEAR + q]
        variance = noise + gain * max(levels[q], 0.0) + floor
        # Of the squared slope, what its own noise explains is no slope.
        sure = slope * slope * spreads[q]
        weights[q] = 0.0 if sure <= variance else slope / variance * (1.0 - variance / sure)
    for q in range(rings):
        inverse = shares[q]
        slope, mean, bend = slopes[_NEAR + q], means[_NEAR + q], bends[q]
        at = out[q]
        at[0] = levels[q] - bend * spreads[q] * inverse - slope * mean + bend * mean * mean
        at[1] = slope - 2 * bend * mean
        at[2] = bend
        at[3] = weights[q]
        at[4] = weights[q] * slope
        at[5] = (c_[wide + q] - c_[q]) * inverse
        at[6] = (s_[wide + q] - s_[q]) * inverse
    return gain / max(brightest, 1e-300)


@compiled
def _step(pixels: Floats, count: int, scale: float, profile: Floats) -> tuple[float, float, bool]:
    """One Gauss-Newton step of the centre to where the profile fits, and whether there is one."""
    c_ = pixels[0, :count]
    s_ = pixels[1, :count]
    r_ = pixels[2, :count]
    u_ = pixels[3, :count]
    a_xx, a_xy, a_yy = 0.0, 0.0, 0.0
    b_x, b_y = 0.0, 0.0
    for p in range(count):
        c, s, r = c_[p], s_[p], r_[p]
        at = profile[np.uint32(r * scale)]
        departure = at[3] * (u_[p] - at[0] - (at[1] + at[2] * r) * r)
        b_x -= departure * c
        b_y -= departure * s
        # The profile takes up what the pixels near have in common.
        a_xx += at[4] * c * (c - at[5])
        a_xy += at[4] * (c * s - 0.5 * (c * at[6] + s * at[5]))
        a_yy += at[4] * s * (s - at[6])
    determinant = a_xx * a_yy - a_xy * a_xy
    if not determinant > 1e-12 * a_xx * a_yy:
        return 0.0, 0.0, False
    return (
        (a_yy * b_x - a_xy * b_y) / determinant,
        (a_xx * b_y - a_xy * b_x) / determinant,
        True,
    )


@compiled
def _sure(  # noqa: PLR0917 - Numba takes no keyword-only ones
    pixels: Floats, count: int, scale: float, profile: Floats, noise: Floats, out: Floats
) -> float:
    """Write the covariance xx, yy, xy of a step's end; return how pixels depart from the profile.

    By the mean square over their variance, which multiplies the covariance: `noise` is the variance
    of a dark pixel, and what light adds.
    """
    a_xx, a_xy, a_yy, squares = 0.0, 0.0, 0.0, 0.0
    b_xx, b_xy, b_yy = 0.0, 0.0, 0.0
    for p in range(count):
        c, s, r = pixels[0, p], pixels[1, p], pixels[2, p]
        at = profile[np.uint32(r * scale)]
        light = at[0] + (at[1] + at[2] * r) * r
        variance = noise[0] + noise[1] * max(light, 0.0)
        squares += (pixels[3, p] - light) ** 2 / variance
        c_own, s_own = c - at[5], s - at[6]
        a_xx += at[4] * c * c_own
        a_xy += at[4] * 0.5 * (c * s_own + s * c_own)
        a_yy += at[4] * s * s_own
        weight = at[3] * at[3] * variance
        b_xx += weight * c_own * c_own
        b_xy += weight * c_own * s_own
        b_yy += weight * s_own * s_own
    determinant = a_xx * a_yy - a_xy * a_xy
    if not determinant > 1e-12 * a_xx * a_yy:
        return np.inf
    departs = squares / count
    a, b, d = a_yy / determinant, -a_xy / determinant, a_xx / determinant
    out[0] = departs * (a * a * b_xx + 2.0 * a * b * b_xy + b * b * b_yy)
    out[1] = departs * (b * b * b_xx + 2.0 * b * d * b_xy + d * d * b_yy)
    out[2] = departs * (a * b * b_xx + (a * d + b * b) * b_xy + b * d * b_yy)
    return departs


@compiled
def matched_centres(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    maxima: NDArray[Any],
    threshold: float,
    spread: float,
    steps: int,
    noises: Floats,
    misfit: float,
    out: Floats,
) -> None:
    """Write the centre of each frame's spot to `out` (N, 6); NaN where there is not one.

    Columns: x, y; their covariance xx, yy, xy; and the square of what the light within a ring
    scatters by beyond the dark pixels' noise, over the brightest ring's: infinite where a spot of a
    few pixels does not tell.

    `maxima` (N, H) are the rows' largest values, `threshold` the fraction of the peak above which
    pixels start the search, `spread` the limit of `_lit_spot`. `noises` (N, 2) are the variance of
    a dark pixel, and what a unit of light adds to it, NaN or zero where not told; of (0, 2) no
    covariance is looked for. It is NaN, too, where what pixels depart from the profile by has a
    mean square over `misfit` of their variance, and where a spot has too few for rings to show it.
    """
    count, height, width = frames.shape
    widest = 1.2 * math.hypot(height, width) + 4.0
    most = int(widest / _FINEST) + 3
    pixels = np.empty((4, height * width))
    sums = np.empty((most, _SUMS))
    profile = np.empty((most, _PROFILE))
    running = np.empty((_RUNNING, most + 2 * _NEAR + 1))
    lines, sure = np.empty((7, most + 2 * _NEAR)), np.empty(3)
    for k in range(count):
        frame = frames[k]
        out[k] = np.nan
        base, noise = _border(frame)
        peak = float(maxima[k].max())
        if not peak > base:
            continue
        cut = base + threshold * (peak - base)
        x, y, radius = _lit_spot(frame, maxima[k], cut, spread)
        if radius == 0.0:
            continue
        # What a straight line misses of the profile grows with the rings' width: to keep it in
        # the same proportion to the noise, finer rings for brighter spots.
        contrast = (peak - base) / math.sqrt(noise) if noise > 0 else np.inf
        ring = min(max(_WIDTH * contrast ** (-1.0 / 3.0), _FINEST), _COARSEST)
        reach = 1.1 * radius + 3.5
        scale = 1.0 / ring
        rings = int(reach * scale) + 2
        found = True
        uneven = np.inf
        for _ in range(steps):
            sums[:rings] = 0.0
            near = _pixels_near(frame, x, y, base, reach, pixels)
            _ring_sums(pixels, near, scale, sums)
            _running_sums(sums, rings, running)
            uneven = _profile(sums, running, rings, ring, noise, lines, profile)
            move_x, move_y, found = _step(pixels, near, scale, profile)
            found = found and abs(move_x) <= radius and abs(move_y) <= radius
            if not found:
                break
            x += move_x
            y += move_y
        if found:
            out[k, 0] = x
            out[k, 1] = y
            area = math.pi * radius * radius
            out[k, 5] = uneven if area >= _ENOUGH else np.inf
            if len(noises) > 0 and noises[k, 0] > 0.0 and area >= _RESOLVED:
                sums[:rings] = 0.0
                near = _pixels_near(frame, x, y, base, reach, pixels)
                _ring_sums(pixels, near, scale, sums)
                _running_sums(sums, rings, running)
                _profile(sums, running, rings, ring, noise, lines, profile)
                if _sure(pixels, near, scale, profile, noises[k], sure) <= misfit:
                    out[k, 2:5] = sure

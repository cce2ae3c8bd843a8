"""Centre of a point-symmetric spot from the differences of its pixels and their mirror images.

About a point m / 2, m whole, pixels x and m - x are a pair: with f the spot about its own centre
and d = 2 c - m, their difference is ``D = f(u - d/2) - f(u + d/2)`` and their mean
``S = (f(u - d/2) + f(u + d/2)) / 2`` at ``u = x - m/2``, so that ``D = -2 tanh(d . grad / 2) S``.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Taps n = 1 .. 6 of ``sum t_n (S(u + n) - S(u - n))``, as ``t = sum TAPS[q] d^(2 q)``: of all such
#: filters exact to third order, the one that is nearest to ``2 tan(pi k d) / d`` for edges as
#: soft as half a pixel.
TAPS = np.array(
    [
        [0.9246398, -0.3624963, 0.1562918, -0.0589719, 0.0162817, -0.0023405],
        [0.2622294, -0.2387220, 0.1137634, -0.0443487, 0.0124225, -0.0017989],
        [0.1112456, -0.1298026, 0.0820968, -0.0349416, 0.0101683, -0.0015010],
        [0.0518314, -0.0676519, 0.0497708, -0.0240701, 0.0074510, -0.0011357],
    ]
)
#: Pixels around the box of the mean that hold its border's values.
_PAD = 8
#: Half the core, px: the lit extent times one and a bit, more where the light falls off slowly.
_WIDER, _SOFTER, _MARGIN = 1.1, 1.5, 3.0
#: The ring about the core that tells the background's slope, px and over the core.
_RING, _RING_SHARE = 3.0, 0.3
#: Levels of smoothing of the weighting, by binomials 1, 2, 4 ... px apart.
_LEVELS = 5
#: Share of noise in the weighting from which a smoother one is tried.
_NOISY = 0.05
_PASSES, _CENTRES = 6, 3
#: Change of d, px, up to which the filters of the last one stand.
_SAME = 0.02
#: A pair is left out whose difference departs by so many deviations and this share of the slope.
_BAD, _BAD_SLOPE = 6.0, 0.4
#: Light that departs in clusters of pairs, over the spot's, above which it is not symmetric.
_ASYMMETRIC = 0.06
#: Standard deviation of the centre, px, over which it is not known.
_UNSURE = 0.5
#: From the lit light's centroid, in half extents and px, no registration leads further.
_ASTRAY, _ASTRAY_PX = 0.25, 0.75


def _noise_of_levels() -> tuple[Floats, Floats]:
    """Of each level's weighting along x: sum of squared taps, and products with `TAPS[0]`."""
    squares, products = np.empty(_LEVELS), np.empty(_LEVELS)
    smooth = np.array([1.0])
    for level in range(_LEVELS):
        binomial = np.zeros(2 * 2**level + 1)
        binomial[[0, 2**level, -1]] = 0.25, 0.5, 0.25
        smooth = np.convolve(smooth, binomial)
        slope = np.convolve(smooth, [-0.5, 0.0, 0.5])
        if level==0: slope=np.array([-.5,0,.5])
        squares[level] = np.sum(slope**2) * np.sum(smooth**2)
        middle = len(slope) // 2
        reach = min(TAPS.shape[1], middle)
        taps = slope[middle + 1 : middle + 1 + reach]
        products[level] = 2.0 * taps @ TAPS[0, :reach] * smooth[len(smooth) // 2]
    return squares, products


_SQUARES, _PRODUCTS = _noise_of_levels()


@compiled
def _pairs(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any], box: NDArray[np.int64], base: float, most: float, s: Floats, d: Floats
) -> None:
    """Write means of pairs to `s`, with a margin, and differences to `d`, the upper half's rows.

    `box` holds first and last column and first and last row. Light above `most` counts as `most`.
    """
    left, right, top, bottom = box
    rows, columns = len(d), right - left + 1
    for i in range(rows):
        upper = frame[top + i, left : right + 1]
        lower = frame[bottom - i, left : right + 1][::-1]
        means, differences = s[i + _PAD, _PAD : _PAD + columns], d[i]
        for j in range(columns):
            a = min(upper[j] - base, most)
            b = min(lower[j] - base, most)
            means[j] = 0.5 * (a + b)
            differences[j] = a - b
    _complete(s, rows, columns, bottom - top + 1)


@compiled
def _complete(s: Floats, rows: int, columns: int, height: int) -> None:
    """Fill the rows below the middle by symmetry and the margin with its neighbours' values."""
    for i in range(rows, min(rows + _PAD, height)):
        above = s[height - 1 - i + _PAD, _PAD : _PAD + columns][::-1]
        below = s[i + _PAD, _PAD : _PAD + columns]
        for j in range(columns):
            below[j] = above[j]
    last = _PAD + min(rows + _PAD, height) - 1
    for i in range(_PAD, last + 1):
        s[i, :_PAD] = s[i, _PAD]
        s[i, _PAD + columns :] = s[i, _PAD + columns - 1]
    for i in range(_PAD):
        s[i] = s[_PAD]
    for i in range(last + 1, len(s)):
        s[i] = s[last]


@compiled
def _smoothed(s: Floats, apart: int, line: Floats, out: Floats) -> None:
    """Smooth by the binomial (1, 2, 1) / 4 of pixels `apart` along both axes; borders repeat."""
    height, width = s.shape
    for i in range(height):
        above, below = s[max(i - apart, 0)], s[min(i + apart, height - 1)]
        here, to = s[i], out[i]
        for j in range(width):
            line[j] = 0.25 * (above[j] + below[j]) + 0.5 * here[j]
        for j in range(width):
            if apart <= j < width - apart:
                to[j] = 0.25 * (line[j - apart] + line[j + apart]) + 0.5 * line[j]
            else:
                near, far = line[max(j - apart, 0)], line[min(j + apart, width - 1)]
                to[j] = 0.25 * (near + far) + 0.5 * line[j]


@compiled
def _slopes(  # noqa: PLR0917 - the formulas in their order
    s: Floats, core: NDArray[np.int64], d_x: float, d_y: float, mixed: Floats, g: Floats
) -> None:
    """Write to `g` (2, rows, columns) what a unit of d along x and along y takes off a difference.

    ``tan(a + b)`` of both axes is ``(tan a + tan b) / (1 - tan a tan b)``; of the latter the
    first order. `core` holds first column and row and the number of both, in the margin's frame.
    """
    left, top, columns, rows = core
    scale = -0.0625 * d_x * d_y
    width = columns + 12
    for i in range(rows + 12):
        at = top - 6 + i
        begin = left - 6
        above, here = s[at - 1, begin - 1 : begin + width + 1], s[at, begin : begin + width]
        below, to = s[at + 1, begin - 1 : begin + width + 1], mixed[i]
        for j in range(width):
            cross = below[j + 2] - below[j] - above[j + 2] + above[j]
            to[j] = here[j] + scale * cross
    for axis in range(2):
        d2 = d_x * d_x if axis == 0 else d_y * d_y
        t1 = TAPS[0, 0] + d2 * (TAPS[1, 0] + d2 * (TAPS[2, 0] + d2 * TAPS[3, 0]))
        t2 = TAPS[0, 1] + d2 * (TAPS[1, 1] + d2 * (TAPS[2, 1] + d2 * TAPS[3, 1]))
        t3 = TAPS[0, 2] + d2 * (TAPS[1, 2] + d2 * (TAPS[2, 2] + d2 * TAPS[3, 2]))
        t4 = TAPS[0, 3] + d2 * (TAPS[1, 3] + d2 * (TAPS[2, 3] + d2 * TAPS[3, 3]))
        t5 = TAPS[0, 4] + d2 * (TAPS[1, 4] + d2 * (TAPS[2, 4] + d2 * TAPS[3, 4]))
        t6 = TAPS[0, 5] + d2 * (TAPS[1, 5] + d2 * (TAPS[2, 5] + d2 * TAPS[3, 5]))
        for i in range(rows):
            to = g[axis, i]
            if axis == 0:
                row = mixed[i + 6, :width]
                for j in range(columns):
                    to[j] = (
                        t1 * (row[j + 7] - row[j + 5])
                        + t2 * (row[j + 8] - row[j + 4])
                        + t3 * (row[j + 9] - row[j + 3])
                        + t4 * (row[j + 10] - row[j + 2])
                        + t5 * (row[j + 11] - row[j + 1])
                        + t6 * (row[j + 12] - row[j])
                    )
            else:
                part = mixed[i : i + 13, 6 : 6 + columns]
                for j in range(columns):
                    to[j] = (
                        t1 * (part[7, j] - part[5, j])
                        + t2 * (part[8, j] - part[4, j])
                        + t3 * (part[9, j] - part[3, j])
                        + t4 * (part[10, j] - part[2, j])
                        + t5 * (part[11, j] - part[1, j])
                        + t6 * (part[12, j] - part[0, j])
                    )


@compiled
def _weighting(s: Floats, core: NDArray[np.int64], line: Floats, h: Floats) -> None:
    """Write to `h` (2, rows, columns) the slopes of the mean smoothed by (1, 2, 1) / 4."""
    left, top, columns, rows = core
    for i in range(rows):
        at = top + i
        begin = left - 2
        width = columns + 4
        a, b, c = s[at - 2, begin:], s[at - 1, begin:], s[at, begin:]
        d, e = s[at + 1, begin:], s[at + 2, begin:]
        along, across = h[0, i], h[1, i]
        for j in range(width):
            line[j] = 0.25 * (b[j] + d[j]) + 0.5 * c[j]
        for j in range(columns):
            along[j] = 0.5 * (line[j + 3] - line[j + 1])
        for j in range(width):
            line[j] = 0.5 * (d[j] - b[j])
        for j in range(columns):
            across[j] = 0.25 * (line[j + 1] + line[j + 3]) + 0.5 * line[j + 2]


@compiled
def _fit(  # noqa: PLR0917 - Numba takes no keyword-only ones
    h: Floats, g: Floats, d: Floats, w: Floats, level: int, along: Floats, found: Floats
) -> None:
    """Solve ``sum w h (d + d_x g_x + d_y g_y) = 0``; differences have twice a pixel's variance.

    What the noise of weighting and slope have in common is taken off their products. `found`
    holds d_x, d_y, the variance of the centre (that of d over four) and the noise's share in h.
    """
    rows, columns = w.shape
    along[:10, :columns] = 0.0
    for i in range(rows):
        h_x, h_y, g_x, g_y = h[0, i], h[1, i], g[0, i], g[1, i]
        for j in range(columns):
            a, b = w[i, j] * h_x[j], w[i, j] * h_y[j]
            along[0, j] += a * g_x[j]
            along[1, j] += a * g_y[j]
            along[2, j] += b * g_x[j]
            along[3, j] += b * g_y[j]
            along[4, j] += a * d[i, j]
            along[5, j] += b * d[i, j]
            along[6, j] += a * h_x[j]
            along[7, j] += b * h_y[j]
            along[8, j] += a * h_y[j]
    xx, xy, yx, yy, x, y, hh_x, hh_y, hh_xy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for j in range(columns):
        xx += along[0, j]
        xy += along[1, j]
        yx += along[2, j]
        yy += along[3, j]
        x += along[4, j]
        y += along[5, j]
        hh_x += along[6, j]
        hh_y += along[7, j]
        hh_xy += along[8, j]
    # Weights are per variance of a pixel, of which a mean has half.
    common = 0.5 * _PRODUCTS[level] * found[4]
    xx -= common
    yy -= common
    determinant = xx * yy - xy * yx
    found[2] = np.inf
    found[3] = 0.5 * _SQUARES[level] * found[4] / max(min(hh_x, hh_y), 1e-300)
    if xx > 0.0 and yy > 0.0 and determinant > 1e-6 * xx * yy:
        found[0] = -(yy * x - xy * y) / determinant
        found[1] = -(xx * y - yx * x) / determinant
        one = yy * yy * hh_x - 2 * yy * xy * hh_xy + xy * xy * hh_y
        other = xx * xx * hh_y - 2 * xx * yx * hh_xy + yx * yx * hh_x
        found[2] = 0.5 * max(one, other) / (determinant * determinant)


@compiled
def _weights(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Floats,
    core: NDArray[np.int64],
    noise: float,
    gain: float,
    whole: bool,
    kept: Floats,
    w: Floats,
) -> None:
    """One over the variance of a pixel; a middle row's pairs appear twice and count half."""
    left, top, columns, rows = core
    for i in range(rows):
        part = s[top + i, left : left + columns]
        share = 0.5 if whole and i == rows - 1 else 1.0
        for j in range(columns):
            w[i, j] = share * max(kept[i, j], 0.0) / (noise + gain * max(part[j], 0.0))


@compiled
def _ring_slope(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Floats,
    d: Floats,
    core: NDArray[np.int64],
    half_height: float,
    found: Floats,
    noise: float,
    gain: float,
    prior: float,
    e: Floats,
    along: Floats,
    slope: Floats,
) -> None:
    """Fit ``d = 2 slope . u`` to the pairs around the core; each departure counts up to a limit.

    The spot's own difference there is taken off by its slope. `prior` is the variance of a slope
    before anything is known, which counts where the frame's edge leaves few pairs.
    """
    rows, columns = d.shape
    half_width = 0.5 * (columns - 1)
    first, end = core[0] - _PAD, core[0] - _PAD + core[2]
    for i in range(rows):
        at = s[i + _PAD, _PAD - 1 : _PAD + columns + 1]
        above, below = s[i + _PAD - 1, _PAD:], s[i + _PAD + 1, _PAD:]
        for j in range(columns):
            moved = found[0] * (at[j + 2] - at[j]) + found[1] * (below[j] - above[j])
            e[i, j] = d[i, j] + 0.5 * moved
    for _ in range(3):
        along[:4, :columns] = 0.0
        for i in range(rows):
            y = i - half_height
            inner = i >= core[1] - _PAD
            for part in range(2):
                begin, stop = 0, columns
                if inner:
                    begin, stop = (0, first) if part == 0 else (end, columns)
                elif part == 1:
                    continue
                for j in range(begin, stop):
                    variance = 2.0 * (noise + gain * max(s[i + _PAD, j + _PAD], 0.0))
                    far = 4.0 * math.sqrt(variance)
                    r = e[i, j] - 2.0 * (slope[0] * (j - half_width) + slope[1] * y)
                    r = min(max(r, -far), far) / variance
                    along[0, j] += r
                    along[1, j] += r * y
                    along[2, j] += 1.0 / variance
                    along[3, j] += y * y / variance
        x, y, xx, yy = 0.0, 0.0, 0.0, 0.0
        for j in range(columns):
            u = j - half_width
            x += u * along[0, j]
            y += along[1, j]
            xx += u * u * along[2, j]
            yy += along[3, j]
        slope[0] += (2.0 * x - slope[0] / prior) / (4.0 * xx + 1.0 / prior)
        slope[1] += (2.0 * y - slope[1] / prior) / (4.0 * yy + 1.0 / prior)


@compiled
def _departures(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Floats,
    core: NDArray[np.int64],
    g: Floats,
    d: Floats,
    found: Floats,
    cut: float,
    noise: float,
    e: Floats,
    along: Floats,
) -> tuple[float, float]:
    """Write what the fit leaves of the differences to `e`; noise a unit of light, and the light."""
    left, top, columns, rows = core
    along[:4, :columns] = 0.0
    for i in range(rows):
        part = s[top + i, left : left + columns]
        for j in range(columns):
            r = d[i, j] + found[0] * g[0, i, j] + found[1] * g[1, i, j]
            e[i, j] = r
            lit = 1.0 if part[j] > cut else 0.0
            along[0, j] += lit
            along[1, j] += lit * abs(r)
            along[2, j] += lit * part[j]
            along[3, j] += max(part[j], 0.0)
    number, size, light, all_light = 0.0, 0.0, 0.0, 0.0
    for j in range(columns):
        number += along[0, j]
        size += along[1, j]
        light += along[2, j]
        all_light += along[3, j]
    if light <= 0.0:
        return 0.0, 0.0
    # Of a normal variable, the mean size is sqrt(2 / pi) of the standard deviation.
    variance = 0.25 * math.pi * (size / number) ** 2
    return max(variance - noise, 0.0) * number / light, 2.0 * all_light


@compiled
def _leave_out(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Floats,
    d: Floats,
    core: NDArray[np.int64],
    g: Floats,
    noise: float,
    gain: float,
    e: Floats,
    kept: Floats,
) -> tuple[int, float]:
    """Mark pairs that depart by too much, replace their worse pixel; how many, and clusters' light.

    The worse pixel is that farther from the mean of its neighbours; it becomes its partner.
    """
    left, top, columns, rows = core
    bad = 0
    for i in range(rows):
        part = s[top + i, left : left + columns]
        for j in range(columns):
            slope = abs(g[0, i, j]) + abs(g[1, i, j])
            far = _BAD * math.sqrt(2.0 * (noise + gain * max(part[j], 0.0))) + _BAD_SLOPE * slope
            if abs(e[i, j]) > far and kept[i, j] > 0.0:
                kept[i, j] = 0.0
                bad += 1
    if bad == 0:
        return 0, 0.0
    clusters = 0.0
    for i in range(rows):
        for j in range(columns):
            if kept[i, j] != 0.0:
                continue
            beside = -1
            for a in range(max(i - 1, 0), min(i + 2, rows)):
                for b in range(max(j - 1, 0), min(j + 2, columns)):
                    beside += kept[a, b] <= 0.0
            if beside >= 2:
                clusters += abs(e[i, j])
            kept[i, j] = -1.0
            at, column = top + i, left + j
            near = 0.25 * (
                s[at - 1, column] + s[at + 1, column] + s[at, column - 1] + s[at, column + 1]
            )
            mean, half = s[at, column], 0.5 * d[i, j]
            shift = 0.5 * (d[i, j] - e[i, j])
            # One pixel is mean + half, its partner mean - half; the fit sets them 2 shift apart.
            if abs(mean + half - near) > abs(mean - half - near):
                s[at, column] = mean - half + shift
            else:
                s[at, column] = mean + half - shift
            d[i, j] -= e[i, j]
    return bad, clusters


@compiled
def _frame_box(  # noqa: PLR0917 - Numba takes no keyword-only ones
    middle: int, half: float, outer: float, size: int
) -> tuple[int, int, int]:
    """First pixel of the box and of the core about middle / 2, and last of the box."""
    first = max(math.ceil(0.5 * middle - outer), 0, middle - (size - 1))
    return first, max(math.ceil(0.5 * middle - half), first), middle - first


@compiled
def _half_core(extent: float, fill: float) -> float:
    return (_WIDER + _SOFTER * (1.0 - min(max(fill, 0.5), 1.0))) * extent + _MARGIN


@compiled
def mirror_centres(frames: NDArray[Any], lights: Floats, out: Floats) -> None:  # noqa: C901, PLR0912, PLR0914, PLR0915 - one loop, its steps in order
    """Write the centre (x, y) of each frame's spot to `out` (N, 3) and its standard deviation.

    `lights` (N, 8) are what `find_lights` of the search wrote. NaN where there is no answer.
    """
    count, height, width = frames.shape
    size = (height + 2 * _PAD) * (width + 2 * _PAD)
    work = np.empty((12, size))
    line = np.empty(width + 2 * _PAD)
    along = np.empty((10, width + 2 * _PAD))
    box, core = np.empty(4, dtype=np.int64), np.empty(4, dtype=np.int64)
    found, other, slope, at = np.zeros(5), np.zeros(5), np.zeros(2), np.zeros(2)
    for k in range(count):
        out[k] = np.nan
        x, y, wide, high, base, noise, peak, fill = lights[k]
        if np.isnan(x):
            continue
        noise = max(noise, 1e-12 * peak * peak)
        half_x, half_y = _half_core(wide, fill), _half_core(high, fill)
        outer_x = half_x + max(_RING, _RING_SHARE * half_x)
        outer_y = half_y + max(_RING, _RING_SHARE * half_y)
        start_x, start_y = x, y
        for _ in range(_CENTRES):
            m_x, m_y = round(2.0 * x), round(2.0 * y)
            left, core_left, right = _frame_box(m_x, half_x, outer_x, width)
            top, core_top, bottom = _frame_box(m_y, half_y, outer_y, height)
            if right - left < 2.0 * wide + 1.0 or bottom - top < 2.0 * high + 1.0:
                found[2] = np.inf
                break
            columns, rows = right - left + 1, (bottom - top + 2) // 2
            box[0], box[1], box[2], box[3] = left, right, top, bottom
            core[0], core[1] = core_left - left + _PAD, core_top - top + _PAD
            core[2] = m_x - 2 * core_left + 1
            core[3] = rows - (core_top - top)
            whole = (bottom - top) % 2 == 0
            wider = columns + 2 * _PAD
            taller = rows + 2 * _PAD
            s = work[0, : taller * wider].reshape(taller, wider)
            t = work[1, : taller * wider].reshape(taller, wider)
            u = work[2, : taller * wider].reshape(taller, wider)
            d = work[3, : rows * columns].reshape(rows, columns)
            ring = work[4, : rows * columns].reshape(rows, columns)
            n, c = core[3], core[2]
            mixed = work[5, : (n + 12) * (c + 12)].reshape(n + 12, c + 12)
            # Two planes each: half a frame's rows twice fit in.
            g = work[6, : 2 * n * c].reshape(2, n, c)
            h = work[7, : 2 * n * c].reshape(2, n, c)
            h2 = work[8, : 2 * n * c].reshape(2, n, c)
            w = work[9, : n * c].reshape(n, c)
            e = work[10, : n * c].reshape(n, c)
            kept = work[11, : n * c].reshape(n, c)
            kept[:] = 1.0
            _pairs(frames[k], box, base, 4.0 * peak, s, d)
            dc = d[rows - n :, core[0] - _PAD : core[0] - _PAD + c]
            found[0], found[1] = 2.0 * x - m_x, 2.0 * y - m_y
            found[4] = c * (n - (0.5 if whole else 0.0))
            slope[:] = 0.0
            gain, clusters, light = 0.0, 0.0, 0.0
            level = 0
            dirty = True
            middle_x, middle_y = 0.5 * (columns - 1), 0.5 * (bottom - top)
            for turn in range(_PASSES):
                if dirty:
                    at[0], at[1] = min(max(found[0], -1.0), 1.0), min(max(found[1], -1.0), 1.0)
                    _slopes(s, core, at[0], at[1], mixed, g)
                    _weighting(s, core, line, h)
                    level = 0
                _weights(s, core, noise, gain, whole, kept, w)
                _fit(h, g, dc, w, level, along, found)
                while turn > 0 and level + 1 < _LEVELS and found[3] > _NOISY and 2**level < wide:
                    if level == 0:
                        _smoothed(s, 2, line, t)
                    else:
                        u[:] = t
                        _smoothed(u, 2 ** (level + 1), line, t)
                    _weighting(t, core, line, h2)
                    other[4] = found[4]
                    _fit(h2, g, dc, w, level + 1, along, other)
                    if not other[2] < found[2]:
                        break
                    level += 1
                    h[:] = h2
                    found[:] = other
                if not np.isfinite(found[2]):
                    break
                if turn < 2 or dirty:
                    for i in range(n):
                        v = 2.0 * slope[1] * (i + rows - n - middle_y)
                        for j in range(c):
                            dc[i, j] += 2.0 * slope[0] * (j + core[0] - _PAD - middle_x) + v
                    prior = (0.01 * peak / max(wide, high)) ** 2
                    _ring_slope(
                        s, d, core, middle_y, found, noise, gain, prior, ring, along, slope
                    )
                    for i in range(n):
                        v = 2.0 * slope[1] * (i + rows - n - middle_y)
                        for j in range(c):
                            dc[i, j] -= 2.0 * slope[0] * (j + core[0] - _PAD - middle_x) + v
                gain, light = _departures(s, core, g, dc, found, 0.3 * peak, noise, e, along)
                bad, more = _leave_out(s, dc, core, g, noise, gain, e, kept)
                clusters += more
                change = max(abs(found[0] - at[0]), abs(found[1] - at[1]))
                if turn > 0 and bad == 0 and change < _SAME:
                    break
                found[4] -= bad
                dirty = bad > 0 or change >= _SAME
                if bad:
                    _complete(s, rows, columns, bottom - top + 1)
            if not np.isfinite(found[2]):
                break
            x, y = 0.5 * (m_x + found[0]), 0.5 * (m_y + found[1])
            if abs(found[0]) <= 0.75 and abs(found[1]) <= 0.75:
                break
        near = abs(x - start_x) <= _ASTRAY * wide + _ASTRAY_PX
        near = near and abs(y - start_y) <= _ASTRAY * high + _ASTRAY_PX
        known = math.sqrt(found[2]) <= _UNSURE
        if near and known and clusters <= _ASYMMETRIC * light:
            out[k, 0] = x
            out[k, 1] = y
            out[k, 2] = math.sqrt(found[2])

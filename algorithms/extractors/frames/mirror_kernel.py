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
#: The sharpest weighting: slope along one axis by four pixels, mean along the other by three.
_SLOPE_1, _SLOPE_2, _BESIDE, _MIDDLE = 2.0 / 3.0, -1.0 / 12.0, 1.0 / 6.0, 2.0 / 3.0
#: Pixels around the box of the mean that hold its border's values.
_PAD = 8
#: Half the core, px: the lit extent times one and a bit, more where the light falls off slowly.
_WIDER, _SOFTER, _MARGIN = 1.1, 1.5, 3.0
#: The ring about the core that tells the background's slope, px and over the core.
_RING, _RING_SHARE = 4.0, 0.5
#: Levels of smoothing of the weighting, by binomials 2, 4 ... px apart.
_LEVELS = 5
#: Share of noise in the weighting from which a smoother one is tried.
_NOISY = 0.05
_TURNS, _CENTRES = 6, 3
#: Change of d, px, up to which the slopes for the last one stand.
_SAME = 0.05
#: What the slopes miss of a sharp rim, over the peak: pixels are not trusted to better than that.
_FLOOR = 0.0015
#: A pixel counts as lit above this fraction of the peak.
_CUT = 0.3
#: A pair is left out whose difference departs by so many deviations and this share of the slope.
_BAD, _BAD_SLOPE = 5.0, 0.2
#: Light that departs in clusters of pairs, over the spot's, and the square of what neighbours miss
#: alike, over that of the light: above either, the spot is not symmetric.
_CLUSTERS, _ALIKE = 0.02, 0.003
#: Standard deviation of the centre, px, over which it is not known.
_UNSURE = 0.5
#: From the lit light's centroid, in half extents and px, no registration leads further.
_ASTRAY, _ASTRAY_PX = 0.25, 0.75
#: Standard deviation of the background's slope, over the spot's own, before anything is known.
_PRIOR = 0.01
#: Standard deviations of a bend of the background from which it is one: extrapolating costs noise.
_BENT = 3.0


def _noise_of_levels() -> tuple[Floats, Floats]:
    """Of each level's weighting along x: sum of squared taps, and products with `TAPS[0]`."""
    squares, products = np.empty(_LEVELS), np.empty(_LEVELS)
    smooth = np.array([1.0])
    for level in range(_LEVELS):
        if level > 0:
            binomial = np.zeros(2 ** (level + 1) + 1)
            binomial[[0, 2**level, -1]] = 0.25, 0.5, 0.25
            smooth = np.convolve(smooth, binomial)
        slope = np.convolve(smooth, [-_SLOPE_2, -_SLOPE_1, 0.0, _SLOPE_1, _SLOPE_2])
        mean = np.convolve(smooth, [_BESIDE, _MIDDLE, _BESIDE])
        squares[level] = np.sum(slope**2) * np.sum(mean**2)
        middle = len(slope) // 2
        reach = min(TAPS.shape[1], middle)
        taps = slope[middle + 1 : middle + 1 + reach]
        products[level] = 2.0 * np.sum(taps * TAPS[0, :reach]) * mean[len(mean) // 2]
    return squares, products


_SQUARES, _PRODUCTS = _noise_of_levels()


@compiled
def _dot(a: Floats, b: Floats) -> float:
    """Sum of products in eight sums side by side: one alone waits for itself at every number."""
    whole = a.size - a.size % 8
    s0, s1, s2, s3, s4, s5, s6, s7 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for q in range(0, whole, 8):
        s0 += a[q] * b[q]
        s1 += a[q + 1] * b[q + 1]
        s2 += a[q + 2] * b[q + 2]
        s3 += a[q + 3] * b[q + 3]
        s4 += a[q + 4] * b[q + 4]
        s5 += a[q + 5] * b[q + 5]
        s6 += a[q + 6] * b[q + 6]
        s7 += a[q + 7] * b[q + 7]
    for q in range(whole, a.size):
        s0 += a[q] * b[q]
    return ((s0 + s1) + (s2 + s3)) + ((s4 + s5) + (s6 + s7))


@compiled
def _pairs(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    left: int,
    top: int,
    last: int,
    light: tuple[float, float],
    s: Floats,
    d: Floats,
) -> None:
    """Write means of pairs to `s`, with a margin, and differences to `d`, the upper half's rows.

    The box begins at column `left` and row `top` and ends with row `last`; `light` is what to take
    off, and the most that a pixel counts.
    """
    rows, columns = d.shape
    base, most = light
    for i in range(rows):
        upper = frame[top + i, left : left + columns]
        lower = frame[last - i, left : left + columns]
        means, differences = s[i + _PAD, _PAD : _PAD + columns], d[i]
        for j in range(columns):
            a = upper[j] - base
            means[j] = min(most, a)
        for j in range(columns):
            b = lower[j] - base
            differences[j] = min(most, b)
        for j in range((columns + 1) // 2):
            k = columns - 1 - j
            a, b, c, e = means[j], differences[k], means[k], differences[j]
            means[j], differences[j] = 0.5 * (a + b), a - b
            means[k], differences[k] = 0.5 * (c + e), c - e
    _complete(s, rows, columns, last - top + 1)


@compiled
def _complete(s: Floats, rows: int, columns: int, height: int) -> None:
    """Fill the rows below the middle by symmetry and the margin with its neighbours' values."""
    last = _PAD + min(rows + _PAD, height) - 1
    for i in range(_PAD + rows, last + 1):
        above = s[height - 1 - i + 2 * _PAD, _PAD : _PAD + columns][::-1]
        below = s[i, _PAD : _PAD + columns]
        for j in range(columns):
            below[j] = above[j]
    for i in range(_PAD, last + 1):
        row = s[i]
        first, end = row[_PAD], row[_PAD + columns - 1]
        for j in range(_PAD):
            row[j] = first
            row[_PAD + columns + j] = end
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
            near, far = line[max(j - apart, 0)], line[min(j + apart, width - 1)]
            to[j] = 0.25 * (near + far) + 0.5 * line[j]


@compiled
def _slopes(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Floats, left: int, top: int, d_x: float, d_y: float, mixed: Floats, g: Floats
) -> None:
    """Write to `g` (2, rows, columns) what a unit of d along x and along y takes off a difference.

    ``tan(a + b)`` of both axes is ``(tan a + tan b) / (1 - tan a tan b)``; of the latter the
    first order. The core begins at (`left`, `top`) of `s`.
    """
    _, rows, columns = g.shape
    scale = -0.0625 * d_x * d_y
    for i in range(rows + 12):
        above, here = s[top + i - 7, left - 7 :], s[top + i - 6, left - 6 :]
        below, to = s[top + i - 5, left - 7 :], mixed[i]
        for j in range(columns + 12):
            to[j] = here[j] + scale * (below[j + 2] - below[j] - above[j + 2] + above[j])
    t1, t2, t3, t4, t5, t6 = _taps(d_x)
    for i in range(rows):
        row, to = mixed[i + 6], g[0, i]
        for j in range(columns):
            to[j] = (
                t1 * (row[j + 7] - row[j + 5])
                + t2 * (row[j + 8] - row[j + 4])
                + t3 * (row[j + 9] - row[j + 3])
                + t4 * (row[j + 10] - row[j + 2])
                + t5 * (row[j + 11] - row[j + 1])
                + t6 * (row[j + 12] - row[j])
            )
    taps = _taps(d_y)
    for i in range(rows):
        to = g[1, i]
        to[:] = 0.0
        for n in range(6):
            below, above, t = mixed[i + 7 + n, 6:], mixed[i + 5 - n, 6:], taps[n]
            for j in range(columns):
                to[j] += t * (below[j] - above[j])


@compiled
def _taps(d: float) -> tuple[float, float, float, float, float, float]:
    d2 = d * d
    t = TAPS[0] + d2 * (TAPS[1] + d2 * (TAPS[2] + d2 * TAPS[3]))
    return t[0], t[1], t[2], t[3], t[4], t[5]


@compiled
def _weighting(s: Floats, left: int, top: int, line: Floats, h: Floats) -> None:
    """Write to `h` (2, rows, columns) the slopes of the mean, sharp but with little noise."""
    _, rows, columns = h.shape
    for i in range(rows):
        a, b, c = s[top + i - 2, left - 2 :], s[top + i - 1, left - 2 :], s[top + i, left - 2 :]
        d, e = s[top + i + 1, left - 2 :], s[top + i + 2, left - 2 :]
        along, across = h[0, i], h[1, i]
        for j in range(columns + 4):
            line[j] = _BESIDE * (b[j] + d[j]) + _MIDDLE * c[j]
        for j in range(columns):
            along[j] = _SLOPE_1 * (line[j + 3] - line[j + 1]) + _SLOPE_2 * (line[j + 4] - line[j])
        for j in range(columns + 4):
            line[j] = _SLOPE_1 * (d[j] - b[j]) + _SLOPE_2 * (e[j] - a[j])
        for j in range(columns):
            across[j] = _BESIDE * (line[j + 1] + line[j + 3]) + _MIDDLE * line[j + 2]


@compiled
def _fit(  # noqa: PLR0917 - Numba takes no keyword-only ones
    h: Floats,
    g: Floats,
    d: Floats,
    w: Floats,
    common: tuple[float, float],
    work: Floats,
    found: Floats,
) -> None:
    """Solve ``sum w h (d + d_x g_x + d_y g_y) = 0``; differences have twice a pixel's variance.

    `common` is what noise adds to the products of weighting and slope, and to the weighting's
    square. Written to `found`: d_x, d_y, the variance of the centre, and noise's share in h.
    """
    g_x, g_y, h_x, h_y = g[0].ravel(), g[1].ravel(), h[0].ravel(), h[1].ravel()
    a, b = work[0, : d.size], work[1, : d.size]
    for q in range(d.size):
        a[q] = w[q] * h_x[q]
        b[q] = w[q] * h_y[q]
    xx, yy = _dot(a, g_x) - common[0], _dot(b, g_y) - common[0]
    xy, yx = _dot(a, g_y), _dot(b, g_x)
    x, y = _dot(a, d), _dot(b, d)
    hh_x, hh_y, hh_xy = _dot(a, h_x), _dot(b, h_y), _dot(a, h_y)
    determinant = xx * yy - xy * yx
    found[2] = np.inf
    found[3] = common[1] / max(min(hh_x, hh_y), 1e-300)
    if xx > 0.0 and yy > 0.0 and determinant > 1e-6 * xx * yy:
        found[0] = -(yy * x - xy * y) / determinant
        found[1] = -(xx * y - yx * x) / determinant
        one = yy * yy * hh_x - 2 * yy * xy * hh_xy + xy * xy * hh_y
        other = xx * xx * hh_y - 2 * xx * yx * hh_xy + yx * yx * hh_x
        found[2] = 0.5 * max(one, other) / (determinant * determinant)


@compiled
def _smoother(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Floats,
    left: int,
    top: int,
    g: Floats,
    d: Floats,
    w: Floats,
    number: float,
    extent: float,
    work: Floats,
    found: Floats,
    h: Floats,
) -> int:
    """Smooth the weighting as long as the centre's variance falls; return the level reached."""
    size = s.size
    level, old = 0, s
    tried = work[17, : h.size].reshape(h.shape)
    other = found.copy()
    while level + 1 < _LEVELS and found[3] > _NOISY and 2**level < extent:
        smooth = work[18 + level % 2, :size].reshape(s.shape)
        _smoothed(old, 2 ** (level + 1), work[10], smooth)
        _weighting(smooth, left, top, work[10], tried)
        common = 0.5 * number * _PRODUCTS[level + 1], 0.5 * number * _SQUARES[level + 1]
        _fit(tried, g, d, w, common, work[11:17], other)
        if not other[2] < found[2]:
            break
        level += 1
        old = smooth
        h[:] = tried
        found[:] = other
    return level


@compiled
def _clean_ring(s: Floats, d: Floats, first: int, above: int, far: float) -> None:
    """Where a pair around the core differs by more than `far`, take the darker pixel for both."""
    rows, columns = d.shape
    for i in range(rows):
        at, row = s[i + _PAD], d[i]
        for j in range(columns):
            if abs(row[j]) > far and (i < above or j < first or j >= columns - first):
                at[_PAD + j] -= 0.5 * abs(row[j])
                row[j] = 0.0


@compiled
def _ring_pairs(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Floats, d: Floats, first: int, above: int, middle: float, found: Floats, pairs: Floats
) -> int:
    """List the pairs around the core and return how many they are.

    Rows of `pairs`: difference without what the spot's own slope explains, x, y and the mean. The
    core begins at column `first` and row `above` of the box and ends as far from its end.
    """
    rows, columns = d.shape
    count = 0
    for i in range(rows):
        at, before, after = s[i + _PAD], s[i + _PAD - 1], s[i + _PAD + 1]
        for part in range(2):
            begin = 0 if part == 0 else columns - first
            end = first if part == 0 else columns
            if i < above:
                begin, end = (0, columns) if part == 0 else (0, 0)
            r, x = pairs[0, count : count + end - begin], pairs[1, count : count + end - begin]
            y, mean = pairs[2, count : count + end - begin], pairs[3, count : count + end - begin]
            own = at[_PAD + begin - 1 :]
            up, down, differences = before[_PAD + begin :], after[_PAD + begin :], d[i, begin:]
            for j in range(end - begin):
                slope = found[0] * (own[j + 2] - own[j]) + found[1] * (down[j] - up[j])
                r[j] = differences[j] + 0.5 * slope
                x[j] = begin + j - 0.5 * (columns - 1)
                y[j] = i - middle
                mean[j] = own[j + 1]
            count += end - begin
    return count


@compiled
def _ring_slope(  # noqa: C901, PLR0917 - the method's steps in order
    pairs: Floats, count: int, noise: float, gain: float, prior: float, slope: Floats
) -> None:
    """Fit ``difference = 2 (slope + bend |u|^2 / r^2) . u`` to the pairs around the core.

    No pair has much influence. `slope` holds the slope along x and y, the bend along both, and
    r^2, the mean of ``|u|^2``. `prior` is the variance of a slope and of a bend before anything is
    known, which counts where the frame's edge leaves few pairs.
    """
    r, x, y = pairs[0, :count], pairs[1, :count], pairs[2, :count]
    size, far_x, far_y = pairs[4, :count], pairs[5, :count], pairs[3, :count]
    slope[4] = (_dot(x, x) + _dot(y, y)) / max(count, 1) + 1e-300
    light = 0.0
    for q in range(count):
        light += pairs[3, q]
        size[q] = abs(r[q])
    far = 0.0
    for q in range(count):
        far += size[q]
    variance = 2.0 * (noise + gain * max(light / max(count, 1), 0.0))
    for q in range(count):
        squared = (x[q] * x[q] + y[q] * y[q]) / slope[4]
        far_x[q] = squared * x[q]
        far_y[q] = squared * y[q]
    far = max(4.0 * math.sqrt(variance), 3.0 * far / max(count, 1))
    scale, ridge = 4.0 / variance, 1.0 / prior
    for axis in range(2):
        u, v = (x, far_x) if axis == 0 else (y, far_y)
        own, mixed, bent = (
            _dot(u, u) * scale + ridge,
            _dot(u, v) * scale,
            _dot(v, v) * scale + ridge,
        )
        determinant = own * bent - mixed * mixed
        for bends in (True, False):
            limit = far
            for _ in range(4):
                a, b = 2.0 * slope[axis], 2.0 * slope[2 + axis]
                beyond = 0
                for q in range(count):
                    e = r[q] - a * u[q] - b * v[q]
                    beyond += abs(e) > limit
                    e = min(limit, e)
                    size[q] = max(-limit, e)
                first = 0.5 * scale * _dot(size, u) - slope[axis] * ridge
                second = 0.5 * scale * _dot(size, v) - slope[2 + axis] * ridge
                if bends:
                    slope[axis] += (bent * first - mixed * second) / determinant
                    slope[2 + axis] += (own * second - mixed * first) / determinant
                else:
                    slope[axis] += first / own
                if beyond == 0 and limit <= 4.0 * math.sqrt(variance):
                    break  # one step solves what is linear
                limit = max(4.0 * math.sqrt(variance), 0.3 * limit)
            if bends and slope[2 + axis] ** 2 * determinant <= _BENT * _BENT * own:
                slope[axis], slope[2 + axis] = 0.0, 0.0
            else:
                break


@compiled
def _departures(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Floats,
    kept: Floats,
    g: Floats,
    d: Floats,
    found: Floats,
    cut: float,
    work: Floats,
    e: Floats,
) -> tuple[float, float, float]:
    """Write what the fit leaves of the differences to `e`; its noise and light where lit.

    Noise is told by neighbours' differences, which a light beside the spot hardly enters. Last
    is the share of the light that neighbours miss alike: that of a shape without symmetry.
    """
    g_x, g_y = g[0].ravel(), g[1].ravel()
    lit, flat, apart, own = (
        work[0, : d.size],
        work[1, : d.size],
        work[2, : d.size],
        work[3, : d.size],
    )
    # A loop each: of many arrays in one, none is seen to be apart from the others.
    for q in range(d.size):
        e[q] = d[q] + found[0] * g_x[q] + found[1] * g_y[q]
    for q in range(d.size):
        lit[q] = kept[q] if mean[q] > cut else 0.0
    for q in range(d.size):
        own[q] = lit[q] * e[q]
    scale = 3.0 / cut
    for q in range(d.size):
        steep = scale * (abs(g_x[q]) + abs(g_y[q]))
        flat[q] = lit[q] / (1.0 + steep * steep)
    last = d.size - 1
    for q in range(last):
        apart[q] = abs(e[q + 1] - e[q])
    for q in range(last):
        flat[q] *= flat[q + 1]
    number = max(_sum(flat[:last]), 1e-300)
    light = _dot(flat[:last], mean[:last]) / number
    # Of a normal variable, the mean size is sqrt(2 / pi) of the standard deviation.
    variance = 0.25 * math.pi * (_dot(flat[:last], apart[:last]) / number) ** 2
    for q in range(d.size):
        work[4, q] = mean[q] * mean[q]
    squares = _dot(lit, work[4, : d.size])
    alike = _dot(own[:last], own[1:])
    by_chance = 5.0 * _dot(own, own) / math.sqrt(max(_sum(lit), 1.0))
    return 0.5 * variance, max(light, 1e-300), (alike - by_chance) / max(squares, 1e-300)


@compiled
def _sum(a: Floats) -> float:
    """Sum in four sums side by side."""
    whole = a.size - a.size % 4
    s0, s1, s2, s3 = 0.0, 0.0, 0.0, 0.0
    for q in range(0, whole, 4):
        s0 += a[q]
        s1 += a[q + 1]
        s2 += a[q + 2]
        s3 += a[q + 3]
    for q in range(whole, a.size):
        s0 += a[q]
    return (s0 + s1) + (s2 + s3)


@compiled
def _leave_out(  # noqa: C901, PLR0912, PLR0917 - the method's steps in order
    s: Floats,
    left: int,
    top: int,
    d: Floats,
    g: Floats,
    noise: float,
    gain: float,
    least: float,
    slack: float,
    e: Floats,
    kept: Floats,
    work: Floats,
) -> tuple[int, float]:
    """Mark pairs that depart by too much, replace their worse pixel; how many, and clusters' light.

    The worse pixel is that farther from the mean of its neighbours; it becomes its partner.
    """
    rows, columns = d.shape
    bad = 0
    limit = work[0]
    for i in range(rows):
        part, g_x, g_y = s[top + i, left:], g[0, i], g[1, i]
        for j in range(columns):
            light = max(0.0, part[j])
            limit[j] = least + _BAD * math.sqrt(2.0 * (noise + gain * light))
            limit[j] += slack * (abs(g_x[j]) + abs(g_y[j]))
        row, keep = e[i], kept[i]
        beyond = 0
        for j in range(columns):
            beyond += abs(row[j]) * keep[j] > limit[j]
        if beyond:
            for j in range(columns):
                if abs(row[j]) * keep[j] > limit[j]:
                    keep[j] = -1.0
            bad += beyond
    if bad == 0:
        return 0, 0.0
    clusters = 0.0
    for i in range(rows):
        for j in range(columns):
            if kept[i, j] >= 0.0:
                continue
            beside = -1
            for a in range(max(i - 1, 0), min(i + 2, rows)):
                for b in range(max(j - 1, 0), min(j + 2, columns)):
                    beside += kept[a, b] <= 0.0
            if beside >= 2:
                clusters += abs(e[i, j])
            y, x = top + i, left + j
            near = 0.25 * (s[y - 1, x] + s[y + 1, x] + s[y, x - 1] + s[y, x + 1])
            # One pixel is mean + half, its partner mean - half; the fit sets them 2 shift apart.
            mean, half, shift = s[y, x], 0.5 * d[i, j], 0.5 * (d[i, j] - e[i, j])
            upper_is_worse = abs(mean + half - near) > abs(mean - half - near)
            s[y, x] = mean - half + shift if upper_is_worse else mean + half - shift
    for i in range(rows):
        for j in range(columns):
            kept[i, j] = max(kept[i, j], 0.0)
    return bad, clusters


@compiled
def _flatten(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Floats,
    left: int,
    top: int,
    d: Floats,
    slope: Floats,
    at: tuple[float, float],
    mean: Floats,
    out: Floats,
) -> None:
    """Copy the core's means, and its differences less the background's slope.

    `at` is where the core's first pixel lies from the middle.
    """
    rows, columns = out.shape
    first = d.shape[0] - rows
    for i in range(rows):
        part, row = s[top + i, left:], d[first + i, left - _PAD :]
        to, differences = mean[i], out[i]
        y = at[1] + i
        for j in range(columns):
            x = at[0] + j
            bend = (x * x + y * y) / slope[4]
            background = (slope[0] + slope[2] * bend) * x + (slope[1] + slope[3] * bend) * y
            to[j] = part[j]
            differences[j] = row[j] - 2.0 * background


@compiled
def _register(  # noqa: C901, PLR0915 - the method's steps in order
    frame: NDArray[Any], light: Floats, middle: tuple[int, int], work: Floats, found: Floats
) -> float:
    """Write d_x, d_y and the centre's variance about middle / 2 to `found`; asymmetric light.

    The variance is infinite where nothing is found.
    """
    wide, high, base, noise, peak, fill = light[2:]
    height, width = frame.shape
    found[2] = np.inf
    noise += (_FLOOR * peak) ** 2
    wider = _WIDER + _SOFTER * (1.0 - min(max(fill, 0.5), 1.0))
    half_x, half_y = wider * wide + _MARGIN, wider * high + _MARGIN
    ring_x, ring_y = max(_RING, _RING_SHARE * half_x), max(_RING, _RING_SHARE * half_y)
    m_x, m_y = middle
    left = max(math.ceil(0.5 * m_x - half_x - ring_x), 0, m_x - (width - 1))
    top = max(math.ceil(0.5 * m_y - half_y - ring_y), 0, m_y - (height - 1))
    columns, last = m_x - 2 * left + 1, m_y - top
    if columns < 2.0 * wide + 2.0 or last - top < 2.0 * high + 1.0:
        return 0.0  # cut by the frame's edge
    rows = (last - top + 2) // 2
    first = max(math.ceil(0.5 * m_x - half_x) - left, 0)
    above = max(math.ceil(0.5 * m_y - half_y) - top, 0)
    c, n = columns - 2 * first, rows - above
    core_left, core_top = first + _PAD, above + _PAD
    shape = rows + 2 * _PAD, columns + 2 * _PAD
    s = work[0, : shape[0] * shape[1]].reshape(shape)
    d = work[1, : rows * columns].reshape(rows, columns)
    mixed = work[2, : (n + 12) * (c + 12)].reshape(n + 12, c + 12)
    g = work[3, : 2 * n * c].reshape(2, n, c)
    h = work[4, : 2 * n * c].reshape(2, n, c)
    dc, mean = work[5, : n * c].reshape(n, c), work[6, : n * c].reshape(n, c)
    e, kept = work[7, : n * c].reshape(n, c), work[8, : n * c].reshape(n, c)
    w, line, spare = work[9, : n * c], work[10], work[11:17]
    _pairs(frame, left, top, last, (base, 4.0 * peak), s, d)
    _clean_ring(s, d, first, above, 0.1 * peak + _BAD * math.sqrt(2.0 * noise))
    _complete(s, rows, columns, last - top + 1)
    slope = np.zeros(5)
    slope[4] = 1.0
    at = first - 0.5 * (columns - 1), above - 0.5 * (last - top)
    kept[:] = 1.0
    # A middle row's pairs appear twice.
    twice = (last - top) % 2 == 0
    number = c * (n - 0.5 if twice else n + 0.0)
    gain, clusters, share, level = 0.0, 0.0, 0.0, 0
    prior = (_PRIOR * peak / max(wide, high)) ** 2
    d_x, d_y = found[0], found[1]
    fresh = False
    for turn in range(_TURNS):
        if not fresh:
            level = 0
            _weighting(s, core_left, core_top, line, h)
            d_x, d_y = min(max(found[0], -1.0), 1.0), min(max(found[1], -1.0), 1.0)
            if turn > 0:
                _slopes(s, core_left, core_top, d_x, d_y, mixed, g)
        _flatten(s, core_left, core_top, d, slope, at, mean, dc)
        flat, keep, means = dc.ravel(), kept.ravel(), mean.ravel()
        for q in range(n * c):
            lit = max(0.0, means[q])
            w[q] = keep[q] / (noise + gain * lit)
        if twice:
            w[(n - 1) * c :] *= 0.5
        # For a first guess the weighting is slope enough.
        slopes = g if turn > 0 else h
        product = _PRODUCTS[level] if turn > 0 else _SQUARES[level]
        common = 0.5 * number * product, 0.5 * number * _SQUARES[level]
        _fit(h, slopes, flat, w, common, spare, found)
        if not np.isfinite(found[2]):
            return 0.0
        if turn > 0 and level == 0 and found[3] > _NOISY:
            level = _smoother(s, core_left, core_top, slopes, flat, w, number, wide, work, found, h)
            common = 0.5 * number * _PRODUCTS[level], 0.5 * number * _SQUARES[level]
        if turn == 1:
            pairs = _ring_pairs(s, d, first, above, 0.5 * (last - top), found, spare)
            _ring_slope(spare, pairs, noise, gain, prior, slope)
            _flatten(s, core_left, core_top, d, slope, at, mean, dc)
            _fit(h, slopes, flat, w, common, spare, found)
            if not np.isfinite(found[2]):
                return 0.0
        variance, lit, share = _departures(
            means, keep, slopes, flat, found, _CUT * peak, spare, e.ravel()
        )
        before = gain
        gain = max(variance - noise, 0.0) / lit
        least = (0.1 if turn == 0 else 0.01) * peak
        slack = (2.0 if turn == 0 else 1.0) * _BAD_SLOPE
        bad, more = _leave_out(
            s, core_left, core_top, dc, slopes, noise, gain, least, slack, e, kept, spare
        )
        clusters += more
        number -= bad
        if bad:
            _complete(s, rows, columns, last - top + 1)
        same = abs(gain - before) <= 0.5 * before + 0.02 * noise / peak
        fresh = turn > 0 and bad == 0 and max(abs(found[0] - d_x), abs(found[1] - d_y)) < _SAME
        if fresh and same:
            break
    # Of the symmetric light, clusters and what neighbours miss alike, each over its limit.
    departing: float = clusters / max(2.0 * means.sum(), 1e-300)
    return max(departing / _CLUSTERS, share / _ALIKE)


@compiled
def mirror_centres(frames: NDArray[Any], lights: Floats, out: Floats) -> None:
    """Write the centre (x, y) of each frame's spot and its standard deviation to `out` (N, 3).

    `lights` (N, 8) are what `find_lights` of the search wrote. NaN where there is no answer.
    """
    count, height, width = frames.shape
    work = np.empty((20, (height + 2 * _PAD) * (width + 2 * _PAD)))
    found = np.zeros(4)
    for k in range(count):
        out[k] = np.nan
        light = lights[k]
        if np.isnan(light[0]):
            continue
        x, y = light[0], light[1]
        asymmetry = 0.0
        for _ in range(_CENTRES):
            m_x, m_y = round(2.0 * x), round(2.0 * y)
            found[0], found[1] = 2.0 * x - m_x, 2.0 * y - m_y
            asymmetry = _register(frames[k], light, (m_x, m_y), work, found)
            x, y = 0.5 * (m_x + found[0]), 0.5 * (m_y + found[1])
            if not max(abs(found[0]), abs(found[1])) > 0.75 or not np.isfinite(found[2]):
                break
        near = abs(x - light[0]) <= _ASTRAY * light[2] + _ASTRAY_PX
        near = near and abs(y - light[1]) <= _ASTRAY * light[3] + _ASTRAY_PX
        if near and math.sqrt(found[2]) <= _UNSURE and asymmetry <= 1.0:
            out[k, 0] = x
            out[k, 1] = y
            out[k, 2] = math.sqrt(found[2])

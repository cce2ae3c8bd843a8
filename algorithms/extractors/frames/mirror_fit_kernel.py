"""Solve for the displacement of a spot against its own mirror image.

The second stage of `algorithms.extractors.frames.registration`, which says what the arrays hold,
and what a pair's difference has to do with the displacement.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames import mirror_taps

Line = NDArray[np.float32]

#: The sharpest weighting: slope along one axis by four pixels, mean along the other by three.
_SLOPE_1, _SLOPE_2 = np.float32(mirror_taps.SLOPE_1), np.float32(mirror_taps.SLOPE_2)
_BESIDE, _MIDDLE = np.float32(mirror_taps.BESIDE), np.float32(mirror_taps.MIDDLE)
TAPS, _LEVELS = mirror_taps.TAPS, mirror_taps.LEVELS
_SQUARES, _PRODUCTS = mirror_taps.noise_of_levels()
_ZERO, _ONE, _HALF, _QUARTER = np.float32(0.0), np.float32(1.0), np.float32(0.5), np.float32(0.25)
#: Rows around the core that its slopes reach; lanes of the sums.
_REACH, _LANES = 7, 64
#: d, px, from which another middle is nearer; noise's share from which weights are smoothed.
_AWAY, _NOISY = 0.75, 0.05
#: What the slopes miss, over the peak: pixels are not trusted to better than that.
_FLOOR = 0.0005
#: Where the slope, over the peak, is above one over the root of this, little of noise is told.
_STEEP = np.float32(100.0)
#: A pixel counts as lit above this fraction of the peak.
_CUT = np.float32(0.3)


@compiled
def _fold(lanes: Line) -> float:
    """Sum of the lanes, halves added to halves."""
    size = lanes.size
    while size > 8:
        size //= 2
        first, second = lanes[:size], lanes[size : 2 * size]
        for j in range(size):
            first[j] += second[j]
    total = 0.0
    for j in range(size):
        total += lanes[j]
    return total


@compiled
def _total(a: Line, lanes: Line) -> float:
    """Sum of what is positive; all lines are a multiple of the lanes long."""
    lanes[:] = _ZERO
    for k in range(0, a.size, _LANES):
        u = a[k : k + _LANES]
        for j in range(_LANES):
            lanes[j] += max(_ZERO, u[j])
    return _fold(lanes)


@compiled
def _product(a: Line, b: Line, lanes: Line) -> float:
    """Sum of products."""
    lanes[:] = _ZERO
    for k in range(0, a.size, _LANES):
        u, v = a[k : k + _LANES], b[k : k + _LANES]
        for j in range(_LANES):
            lanes[j] += u[j] * v[j]
    return _fold(lanes)


@compiled
def _weighting(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, p: int, stride: int, line: Line, h_x: Line, h_y: Line
) -> None:
    """Write the slopes of the mean, sharp but with little noise; the core begins at `p` of `s`."""
    n = h_x.size
    a, b, c = s[p - 2 - stride :], s[p - 2 :], s[p - 2 + stride :]
    for q in range(n + 4):
        line[q] = _BESIDE * (a[q] + c[q]) + _MIDDLE * b[q]
    for q in range(n):
        h_x[q] = _SLOPE_1 * (line[q + 3] - line[q + 1]) + _SLOPE_2 * (line[q + 4] - line[q])
    d, e = s[p - 2 - 2 * stride :], s[p - 2 + 2 * stride :]
    for q in range(n + 4):
        line[q] = _SLOPE_1 * (c[q] - a[q]) + _SLOPE_2 * (e[q] - d[q])
    for q in range(n):
        h_y[q] = _BESIDE * (line[q + 1] + line[q + 3]) + _MIDDLE * line[q + 2]


@compiled
def _taps(d: float) -> tuple[Any, Any, Any, Any, Any, Any]:
    d2 = d * d
    t = (TAPS[0] + d2 * (TAPS[1] + d2 * (TAPS[2] + d2 * TAPS[3]))).astype(np.float32)
    return t[0], t[1], t[2], t[3], t[4], t[5]


@compiled
def _slopes(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, p: int, stride: int, d_x: float, d_y: float, mixed: Line, g_x: Line, g_y: Line
) -> None:
    """Write what a unit of d along x and along y takes off a difference.

    ``tan(a + b)`` of both axes is ``(tan a + tan b) / (1 - tan a tan b)``; of the latter the
    first order.
    """
    n = g_x.size
    scale = np.float32(-0.0625 * d_x * d_y)
    begin = p - 6 * stride - 6
    above, here, below = s[begin - stride - 1 :], s[begin:], s[begin + stride - 1 :]
    for q in range(n + 12 * stride + 12):
        mixed[q] = here[q] + scale * (below[q + 2] - below[q] - above[q + 2] + above[q])
    t1, t2, t3, t4, t5, t6 = _taps(d_x)
    row = mixed[6 * stride :]
    for q in range(n):
        g_x[q] = (
            t1 * (row[q + 7] - row[q + 5])
            + t2 * (row[q + 8] - row[q + 4])
            + t3 * (row[q + 9] - row[q + 3])
            + t4 * (row[q + 10] - row[q + 2])
            + t5 * (row[q + 11] - row[q + 1])
            + t6 * (row[q + 12] - row[q])
        )
    t1, t2, t3, t4, t5, t6 = _taps(d_y)
    at = mixed[6:]
    a6, a5, a4, a3 = at, at[stride:], at[2 * stride :], at[3 * stride :]
    a2, a1, b1, b2 = at[4 * stride :], at[5 * stride :], at[7 * stride :], at[8 * stride :]
    b3, b4, b5, b6 = at[9 * stride :], at[10 * stride :], at[11 * stride :], at[12 * stride :]
    for q in range(n):
        g_y[q] = (
            t1 * (b1[q] - a1[q])
            + t2 * (b2[q] - a2[q])
            + t3 * (b3[q] - a3[q])
            + t4 * (b4[q] - a4[q])
            + t5 * (b5[q] - a5[q])
            + t6 * (b6[q] - a6[q])
        )


@compiled
def _normal(  # noqa: PLR0917 - Numba takes no keyword-only ones
    h_x: Line,
    h_y: Line,
    g_x: Line,
    g_y: Line,
    d: Line,
    w: Line,
    share: Line,
    lanes: Line,
    sums: Floats,
) -> None:
    """Write the nine weighted sums of products that the fit needs; the last three of variances."""
    lanes[:] = _ZERO
    for k in range(0, w.size, _LANES):
        a, b, wk = h_x[k : k + _LANES], h_y[k : k + _LANES], w[k : k + _LANES]
        e, f, dk = g_x[k : k + _LANES], g_y[k : k + _LANES], d[k : k + _LANES]
        part = share[k : k + _LANES]
        for j in range(_LANES):
            x, y = wk[j] * a[j], wk[j] * b[j]
            lanes[j] += x * e[j]
            lanes[j + _LANES] += y * f[j]
            lanes[j + 2 * _LANES] += x * f[j]
            lanes[j + 3 * _LANES] += y * e[j]
            lanes[j + 4 * _LANES] += x * dk[j]
            lanes[j + 5 * _LANES] += y * dk[j]
            x *= part[j]
            lanes[j + 6 * _LANES] += x * a[j]
            lanes[j + 7 * _LANES] += y * b[j] * part[j]
            lanes[j + 8 * _LANES] += x * b[j]
    for q in range(9):
        sums[q] = _fold(lanes[q * _LANES : (q + 1) * _LANES])


@compiled
def _smoothed(s: Line, apart: int, stride: int, line: Line, out: Line) -> None:
    """Smooth by the binomial (1, 2, 1) / 4 of pixels `apart` along both axes; ends repeat."""
    n = s.size
    far = apart * stride
    line[:] = s[:n]
    for q in range(far, n - far):
        line[q] = _QUARTER * (s[q - far] + s[q + far]) + _HALF * s[q]
    for q in range(far):
        line[q] = _QUARTER * (s[q % stride] + s[q + far]) + _HALF * s[q]
        r = n - 1 - q
        line[r] = _QUARTER * (s[n - 1 - q % stride] + s[r - far]) + _HALF * s[r]
    out[:] = line[:n]
    for q in range(apart, n - apart):
        out[q] = _QUARTER * (line[q - apart] + line[q + apart]) + _HALF * line[q]


@compiled
def _weights(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, p: int, stride: int, keep: Line, state: Floats, line: Line, w: Line, share: Line
) -> None:
    """One over the variance of a pixel, by the light around it; zero where a pair is left out.

    Weights as sharp as a rim would turn what slopes miss of it into a share of d. What the variance
    by a pixel's own light is over that goes to `share`.
    """
    dark, more = np.float32(state[0]), np.float32(state[1])
    least = dark + np.float32(_FLOOR * _FLOOR)
    n = w.size
    a, b, c = s[p - 1 - stride :], s[p - 1 :], s[p - 1 + stride :]
    for q in range(n + 2):
        line[q] = _QUARTER * (a[q] + c[q]) + _HALF * b[q]
    for q in range(n):
        lit = _QUARTER * (line[q] + line[q + 2]) + _HALF * line[q + 1]
        lit, kept = max(_ZERO, lit), max(_ZERO, keep[q])
        # Numba's own division would look for zeros, one by one.
        w[q] = np.divide(kept, least + more * lit)
    for q in range(n):
        share[q] = w[q] * (dark + more * max(_ZERO, b[q + 1]))


@compiled
def _in_common(level: int, d: float) -> float:
    """Product of the weighting's taps with those of the slopes at d: noise that both have."""
    d2 = d * d
    p = _PRODUCTS[level]
    return float(p[0] + d2 * (p[1] + d2 * (p[2] + d2 * p[3])))


@compiled
def _solve(sums: Floats, product_x: float, product_y: float, square: float, state: Floats) -> bool:
    """Solve ``sum w h (d + d_x g_x + d_y g_y) = 0``; what noise adds to the products is taken off.

    To `state` go d_x, d_y, the covariance xx, yy, xy of the centre, noise's share in h, and how
    much a unit of the sums on the right moves the centre (4).
    """
    xx, yy, xy, yx = sums[0] - product_x, sums[1] - product_y, sums[2], sums[3]
    determinant = xx * yy - xy * yx
    state[7] = square / max(min(sums[6], sums[7]), 1e-300)
    if not (xx > 0.0 and yy > 0.0 and determinant > 1e-6 * xx * yy):
        state[4] = np.inf
        return False
    a, b, c, d = yy / determinant, -xy / determinant, -yx / determinant, xx / determinant
    state[2] = -(a * sums[4] + b * sums[5])
    state[3] = -(c * sums[4] + d * sums[5])
    # Differences have twice a pixel's variance; the centre moves by half of d.
    state[4] = 0.5 * (a * a * sums[6] + 2.0 * a * b * sums[8] + b * b * sums[7])
    state[5] = 0.5 * (c * c * sums[6] + 2.0 * c * d * sums[8] + d * d * sums[7])
    state[6] = 0.5 * (a * c * sums[6] + (a * d + b * c) * sums[8] + b * d * sums[7])
    state[8], state[9], state[10], state[11] = 0.5 * a, 0.5 * b, 0.5 * c, 0.5 * d
    return True


@compiled
def _noise(  # noqa: PLR0917 - Numba takes no keyword-only ones
    mean: Line, keep: Line, slack: Line, e: Line, flat: Line, apart: Line, lanes: Line
) -> tuple[float, float]:
    """Variance of a pixel where the spot is lit and flat, and the light there.

    Told by neighbours' departures, which a light beside the spot hardly enters.
    """
    n = e.size
    for q in range(n):
        lit = _ONE if mean[q] > _CUT else _ZERO
        kept = keep[q]
        lit *= max(_ZERO, kept)
        flat[q] = np.divide(lit, _ONE + _STEEP * slack[q] * slack[q])
    flat[n - 1] = _ZERO
    for q in range(n - 1):
        apart[q] = abs(e[q + 1] - e[q])
    for q in range(n - 1):
        flat[q] *= flat[q + 1]
    apart[n - 1] = _ZERO
    number = max(_total(flat, lanes), 1e-30)
    light = max(_product(flat, mean, lanes) / number, 1e-30)
    # Of a normal variable, the mean size is sqrt(2 / pi) of the standard deviation.
    variance = 0.125 * np.pi * (_product(flat, apart, lanes) / number) ** 2
    return variance, light


@compiled
def _background(  # noqa: PLR0917 - Numba takes no keyword-only ones
    box: Any,
    slope: Floats,
    h_x: Line,
    h_y: Line,
    w: Line,
    x: Line,
    y: Line,
    lanes: Line,
    sums: Floats,
    state: Floats,
) -> None:
    """Add to the centre's covariance what the background's slopes are uncertain by."""
    stride = box[4]
    left, two = np.float32(0.5 * (box[3] - 1)), np.float32(2.0)
    x[:], y[:] = _ZERO, _ZERO
    for i in range(box[7]):
        at = np.float32(2 * box[6] + 2 * i - (box[2] - box[1]))
        part, beside = x[i * stride : (i + 1) * stride], y[i * stride : (i + 1) * stride]
        for j in range(stride):
            part[j] = two * (np.float32(j) - left)
        beside[:] = at
    scale = np.float32(0.25 / slope[4])
    for bend in range(2):
        if bend == 1:
            if slope[2] == 0.0 and slope[3] == 0.0:
                break
            for q in range(w.size):
                rho = (x[q] * x[q] + y[q] * y[q]) * scale
                x[q] *= rho
                y[q] *= rho
        _normal(h_x, h_y, x, y, x, w, w, lanes, sums)
        for axis in range(2):
            right_x, right_y = (sums[0], sums[3]) if axis == 0 else (sums[2], sums[1])
            moved_x = state[8] * right_x + state[9] * right_y
            moved_y = state[10] * right_x + state[11] * right_y
            variance = slope[5 + 2 * bend + axis]
            state[4] += variance * moved_x * moved_x
            state[5] += variance * moved_y * moved_y
            state[6] += variance * moved_x * moved_y


@compiled
def fit(  # noqa: PLR0915, PLR0917 - the method's steps in order
    todo: NDArray[np.int64],
    boxes: NDArray[np.int64],
    first: bool,
    slopes: Floats,
    s: Line,
    d: Line,
    keep: Line,
    e: Line,
    slack: Line,
    space: Line,
    states: Floats,
) -> int:
    """Fit the windows `todo`: displacement, covariance, and what is left of the differences.

    In a `first` fit the weighting is slope enough. The variance is infinite where nothing is
    found, and such windows are passed over. Return how many another middle is nearer to.
    """
    away = 0
    work, wide = space[:11], space[11:16]
    lanes = np.empty(9 * _LANES, dtype=np.float32)
    sums, other_sums, other = np.empty(9), np.empty(9), np.empty(states.shape[1])
    for k in todo:
        box, state = boxes[k], states[k]
        if not np.isfinite(state[4]):
            continue
        stride = box[4]
        n = (box[7] * stride + _LANES - 1) // _LANES * _LANES
        p = 8 + (_REACH + box[6]) * stride
        from_row = box[6] * stride
        mean, kept, left = s[k, p : p + n], keep[k, :n], e[k, :n]
        differences = d[k, from_row : from_row + n]
        w, h_x, h_y, g_x, g_y = work[0, :n], work[1, :n], work[2, :n], work[3, :n], work[4, :n]
        share = wide[4, :n]
        _weighting(s[k], p, stride, work[5], h_x, h_y)
        _weights(s[k], p, stride, kept, state, work[5], w, share)
        d_x, d_y = 0.0, 0.0
        if first:
            g_x, g_y = h_x, h_y
        else:
            d_x, d_y = min(max(state[2], -1.0), 1.0), min(max(state[3], -1.0), 1.0)
            state[16], state[17] = d_x, d_y
            _slopes(s[k], p, stride, d_x, d_y, wide[3], g_x, g_y)
        _normal(h_x, h_y, g_x, g_y, differences, w, share, lanes, sums)
        half = 0.5 * _total(share, lanes[:_LANES])  # the mean of two pixels has half the variance
        square = half * _SQUARES[0]
        product_x = square if first else half * _in_common(0, d_x)
        product_y = square if first else half * _in_common(0, d_y)
        if not _solve(sums, product_x, product_y, square, state):
            continue
        away += max(abs(state[2]), abs(state[3])) > _AWAY
        level, old = 0, s[k]
        end = 8 + (box[6] + box[7] + 2 * _REACH) * stride
        while not first and level + 1 < _LEVELS and state[7] > _NOISY and 2**level < 0.5 * stride:
            smooth = wide[level % 2, :end]
            _smoothed(old[:end], 2 ** (level + 1), stride, wide[2, :end], smooth)
            wide[level % 2, end:] = _ZERO
            a, b = work[6, :n], work[7, :n]
            _weighting(wide[level % 2], p, stride, work[5], a, b)
            _normal(a, b, g_x, g_y, differences, w, share, lanes, other_sums)
            product_x = half * _in_common(level + 1, d_x)
            product_y = half * _in_common(level + 1, d_y)
            other[:] = state
            _solve(other_sums, product_x, product_y, half * _SQUARES[level + 1], other)
            if not max(other[4], other[5]) < max(state[4], state[5]):
                break
            level += 1
            old = wide[(level - 1) % 2]
            h_x[:], h_y[:] = a, b
            state[:] = other
        n_x, n_y, steep = np.float32(state[2]), np.float32(state[3]), slack[k, :n]
        for q in range(n):
            left[q] = differences[q] + n_x * g_x[q] + n_y * g_y[q]
            steep[q] = abs(g_x[q]) + abs(g_y[q])
        variance, light = _noise(mean, kept, steep, left, work[8, :n], work[9, :n], lanes[:_LANES])
        state[12] = max(variance - state[0], 0.0) / light
        if not first:
            _background(box, slopes[k], h_x, h_y, w, work[9, :n], work[10, :n], lanes, sums, state)
    return away

"""Solve for the displacement of a spot against its own mirror image.

The second stage of `mirror.registration`, which says what the arrays hold, and what a
pair's difference has to do with the displacement.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.mirror import taps
from algorithms.extractors.frames.mirror.lines_kernel import (
    FLOOR,
    HALF,
    LANES,
    REACH,
    ZERO,
    Line,
    core_start,
    fold,
    padded_length,
    places,
)
from algorithms.extractors.frames.mirror.records import SUMS, Background, Box, State, Sums
from algorithms.kernels.copies import copy_row
from algorithms.kernels.records import Records

#: The sharpest weighting: slope along one axis by four pixels, mean along the other by three.
_SLOPE_1, _SLOPE_2 = np.float32(taps.SLOPE_1), np.float32(taps.SLOPE_2)
_BESIDE, _MIDDLE = np.float32(taps.BESIDE), np.float32(taps.MIDDLE)
TAPS, _LEVELS = taps.TAPS, taps.LEVELS
_SQUARES, _PRODUCTS = taps.noise_of_levels()
_QUARTER = np.float32(0.25)
#: Numbers that single precision adds up, before double precision goes on.
_BLOCK = 1024
#: d, px, from which another middle is nearer; noise's share from which weights are smoothed.
_AWAY, _NOISY = 0.75, 0.05


@compiled
def _weight(  # noqa: PLR0917 - Numba takes no keyword-only ones
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
def _tap(n: int, d: float) -> Any:
    d2 = d * d
    t = TAPS[0, n] + d2 * (TAPS[1, n] + d2 * (TAPS[2, n] + d2 * TAPS[3, n]))
    return np.float32(t)


@compiled
def _taps(d: float) -> tuple[Any, Any, Any, Any, Any, Any]:
    return _tap(0, d), _tap(1, d), _tap(2, d), _tap(3, d), _tap(4, d), _tap(5, d)


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
    sums: Sums,
) -> None:
    """Write the weighted sums that the fit needs; `share` is a variance over that of the weight."""
    sums.xx, sums.yy, sums.xy, sums.yx, sums.x, sums.y = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    sums.noise_xx, sums.noise_yy, sums.noise_xy, sums.share = 0.0, 0.0, 0.0, 0.0
    for begin in range(0, w.size, _BLOCK):
        lanes[:] = ZERO
        for k in range(begin, min(begin + _BLOCK, w.size), LANES):
            for j in range(LANES):
                q = np.uint64(k) + np.uint64(j)  # what is never negative is vectorised
                a, b, dk, part = h_x[q], h_y[q], d[q], share[q]
                x, y = w[q] * a, w[q] * b
                lanes[j] += x * g_x[q]
                lanes[j + LANES] += y * g_y[q]
                lanes[j + 2 * LANES] += x * g_y[q]
                lanes[j + 3 * LANES] += y * g_x[q]
                lanes[j + 4 * LANES] += x * dk
                lanes[j + 5 * LANES] += y * dk
                lanes[j + 9 * LANES] += part
                x *= part
                lanes[j + 6 * LANES] += x * a
                lanes[j + 7 * LANES] += y * b * part
                lanes[j + 8 * LANES] += x * b
        sums.xx += fold(lanes, 0, LANES)
        sums.yy += fold(lanes, 1, LANES)
        sums.xy += fold(lanes, 2, LANES)
        sums.yx += fold(lanes, 3, LANES)
        sums.x += fold(lanes, 4, LANES)
        sums.y += fold(lanes, 5, LANES)
        sums.noise_xx += fold(lanes, 6, LANES)
        sums.noise_yy += fold(lanes, 7, LANES)
        sums.noise_xy += fold(lanes, 8, LANES)
        sums.share += fold(lanes, 9, LANES)


@compiled
def _smooth(s: Line, apart: int, stride: int, line: Line, out: Line) -> None:
    """Smooth by the binomial (1, 2, 1) / 4 of pixels `apart` along both axes; ends repeat."""
    n, far = s.size, apart * stride
    above, here, below, out_here = s[: n - 2 * far], s[far : n - far], s[2 * far :], line[far:]
    for q in range(here.size):
        out_here[q] = _QUARTER * (above[q] + below[q]) + HALF * here[q]
    for i in range(apart):
        first, last = i * stride, n - (i + 1) * stride
        a, b, c, e = s[:stride], s[n - stride :], line[first:], line[last:]
        after, before = s[first + far :], s[last - far :]
        own, other = s[first:], s[last:]
        for j in range(stride):
            c[j] = _QUARTER * (a[j] + after[j]) + HALF * own[j]
        for j in range(stride):
            e[j] = _QUARTER * (b[j] + before[j]) + HALF * other[j]
    for q in range(apart):
        out[q], out[n - 1 - q] = line[q], line[n - 1 - q]
    here, below, out_here = line[apart:], line[2 * apart :], out[apart:]
    for q in range(n - 2 * apart):
        out_here[q] = _QUARTER * (line[q] + below[q]) + HALF * here[q]


@compiled
def _weights(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, p: int, stride: int, keep: Line, state: State, line: Line, w: Line, share: Line
) -> None:
    """One over the variance of a pixel, by the light around it; zero where a pair is left out.

    Weights as sharp as a rim would turn what slopes miss of it into a share of d. What the variance
    by a pixel's own light is over that goes to `share`.
    """
    dark, more = np.float32(state.dark), np.float32(state.gain)
    least = dark + np.float32(FLOOR * FLOOR)
    n = w.size
    a, b, c = s[p - 1 - stride :], s[p - 1 :], s[p - 1 + stride :]
    for q in range(n + 2):
        line[q] = _QUARTER * (a[q] + c[q]) + HALF * b[q]
    for q in range(n):
        lit = _QUARTER * (line[q] + line[q + 2]) + HALF * line[q + 1]
        lit, kept = max(ZERO, lit), max(ZERO, keep[q])
        # Numba's own division would look for zeros, one by one.
        w[q] = np.divide(kept, least + more * lit)
    for q in range(n):
        share[q] = w[q] * (dark + more * max(ZERO, b[q + 1]))


@compiled
def _common_noise(level: int, d: float) -> float:
    """Product of the weighting's taps with those of the slopes at d: noise that both have."""
    d2 = d * d
    p = _PRODUCTS[level]
    return float(p[0] + d2 * (p[1] + d2 * (p[2] + d2 * p[3])))


@compiled
def _solve(sums: Sums, product_x: float, product_y: float, square: float, state: State) -> bool:
    """Solve ``sum w h (d + d_x g_x + d_y g_y) = 0``; what noise adds to the products is subtracted.

    To `state` go displacement and covariance, noise's share in h and how the sums move the centre.
    """
    xx, yy, xy, yx = sums.xx - product_x, sums.yy - product_y, sums.xy, sums.yx
    determinant = xx * yy - xy * yx
    state.noise_share = square / max(min(sums.noise_xx, sums.noise_yy), 1e-300)
    if not (xx > 0.0 and yy > 0.0 and determinant > 1e-6 * xx * yy):
        state.xx = np.inf
        return False
    a, b, c, d = yy / determinant, -xy / determinant, -yx / determinant, xx / determinant
    state.d[0] = -(a * sums.x + b * sums.y)
    state.d[1] = -(c * sums.x + d * sums.y)
    # Differences have twice a pixel's variance; the centre moves by half of d.
    noise_xx, noise_yy, noise_xy = sums.noise_xx, sums.noise_yy, sums.noise_xy
    state.xx = 0.5 * (a * a * noise_xx + 2.0 * a * b * noise_xy + b * b * noise_yy)
    state.yy = 0.5 * (c * c * noise_xx + 2.0 * c * d * noise_xy + d * d * noise_yy)
    state.xy = 0.5 * (a * c * noise_xx + (a * d + b * c) * noise_xy + b * d * noise_yy)
    state.by_x[0], state.by_y[0], state.by_x[1], state.by_y[1] = 0.5 * a, 0.5 * b, 0.5 * c, 0.5 * d
    return True


@compiled
def _odd_parts(  # noqa: PLR0917 - Numba takes no keyword-only ones
    inverse: float,
    bent: bool,
    h_x: Line,
    h_y: Line,
    w: Line,
    x: Line,
    y: Line,
    lanes: Line,
    products: Floats,
) -> None:
    """Write weighted products of the weighting with the background's odd shapes.

    To `products` (2, 2, 2): of `h_x` and `h_y`, with the slopes and, if `bent`, the bends along x
    and y: 2 x and 2 y, and rho times both, ``rho = inverse (x^2 + y^2)``.
    """
    factor = np.float32(inverse)
    lanes[:] = ZERO
    for k in range(0, w.size, LANES):
        for j in range(LANES):
            q = np.uint64(k) + np.uint64(j)
            a, b = w[q] * h_x[q], w[q] * h_y[q]
            lanes[j] += a * x[q]
            lanes[j + LANES] += a * y[q]
            lanes[j + 4 * LANES] += b * x[q]
            lanes[j + 5 * LANES] += b * y[q]
    if bent:
        for k in range(0, w.size, LANES):
            for j in range(LANES):
                q = np.uint64(k) + np.uint64(j)
                rho = factor * w[q] * (x[q] * x[q] + y[q] * y[q])
                lanes[j + 2 * LANES] += rho * h_x[q] * x[q]
                lanes[j + 3 * LANES] += rho * h_x[q] * y[q]
                lanes[j + 6 * LANES] += rho * h_y[q] * x[q]
                lanes[j + 7 * LANES] += rho * h_y[q] * y[q]
    for i in range(8):
        products[i // 4, i // 2 % 2, i % 2] = 2.0 * fold(lanes, i, LANES)


@compiled
def _background(  # noqa: PLR0917 - Numba takes no keyword-only ones
    box: Box,
    ground: Background,
    h_x: Line,
    h_y: Line,
    w: Line,
    x: Line,
    y: Line,
    lanes: Line,
    state: State,
) -> None:
    """Add to the centre's covariance what the background's slopes are uncertain by."""
    bent = ground.bend[0] != 0.0 or ground.bend[1] != 0.0
    products = np.empty((2, 2, 2))
    places(box, 1.0, x, y)
    _odd_parts(1.0 / ground.square, bent, h_x, h_y, w, x, y, lanes, products)
    for order in range(2 if bent else 1):
        variances = ground.slope_variance if order == 0 else ground.bend_variance
        for axis in range(2):
            variance, of_x, of_y = (
                variances[axis],
                products[0, order, axis],
                products[1, order, axis],
            )
            moved_x = state.by_x[0] * of_x + state.by_y[0] * of_y
            moved_y = state.by_x[1] * of_x + state.by_y[1] * of_y
            state.xx += variance * moved_x * moved_x
            state.yy += variance * moved_y * moved_y
            state.xy += variance * moved_x * moved_y


@compiled
def fit(  # noqa: PLR0915, PLR0917 - the method's steps in order
    todo: NDArray[np.int64],
    boxes: Records,
    first: bool,
    grounds: Records,
    s: Line,
    d: Line,
    keep: Line,
    e: Line,
    slack: Line,
    space: Line,
    states: Records,
) -> int:
    """Fit the windows `todo`: displacement, covariance, and what is left of the differences.

    In a `first` fit the weighting is slope enough. The variance is infinite where nothing is
    found, and such windows are passed over. Return how many another middle is nearer to.
    """
    away = 0
    work, wide = space[:11], space[11:16]
    lanes = np.empty(10 * LANES, dtype=np.float32)
    both = np.empty(2, dtype=SUMS)
    before = np.empty(1, dtype=states.dtype)
    for k in todo:
        # here, as a compiled record does not keep its array, which is freed after its last use
        sums, other_sums = both[0], both[1]
        box, state = boxes[k], states[k]
        if not np.isfinite(state.xx):
            continue
        stride, n, p = box.stride, padded_length(box), core_start(box)
        from_row = box.above * stride
        kept, left = keep[k, :n], e[k, :n]
        differences = d[k, from_row : from_row + n]
        w, h_x, h_y, g_x, g_y = work[0, :n], work[1, :n], work[2, :n], work[3, :n], work[4, :n]
        share = wide[4, :n]
        _weight(s[k], p, stride, work[5], h_x, h_y)
        _weights(s[k], p, stride, kept, state, work[5], w, share)
        d_x, d_y = 0.0, 0.0
        if first:
            g_x, g_y = h_x, h_y
        else:
            d_x, d_y = min(max(state.d[0], -1.0), 1.0), min(max(state.d[1], -1.0), 1.0)
            state.slopes_d[0], state.slopes_d[1] = d_x, d_y
            _slopes(s[k], p, stride, d_x, d_y, wide[3], g_x, g_y)
        _normal(h_x, h_y, g_x, g_y, differences, w, share, lanes, sums)
        half = 0.5 * sums.share  # the mean of two pixels has half the variance
        square = half * _SQUARES[0]
        product_x = square if first else half * _common_noise(0, d_x)
        product_y = square if first else half * _common_noise(0, d_y)
        if not _solve(sums, product_x, product_y, square, state):
            continue
        away += max(abs(state.d[0]), abs(state.d[1])) > _AWAY
        level, old = 0, s[k]
        end = 8 + (box.above + box.rows + 2 * REACH) * stride
        while (
            not first
            and level + 1 < _LEVELS
            and state.noise_share > _NOISY
            and 2**level < 0.5 * stride
        ):
            smooth = wide[level % 2, :end]
            _smooth(old[:end], 2 ** (level + 1), stride, wide[2, :end], smooth)
            wide[level % 2, end:] = ZERO
            a, b = work[6, :n], work[7, :n]
            _weight(wide[level % 2], p, stride, work[5], a, b)
            _normal(a, b, g_x, g_y, differences, w, share, lanes, other_sums)
            product_x = half * _common_noise(level + 1, d_x)
            product_y = half * _common_noise(level + 1, d_y)
            before[0] = state
            _solve(other_sums, product_x, product_y, half * _SQUARES[level + 1], state)
            if not max(state.xx, state.yy) < max(before[0].xx, before[0].yy):
                states[k] = before[0]
                break
            level += 1
            old = wide[(level - 1) % 2]
            copy_row(a, h_x)
            copy_row(b, h_y)
        n_x, n_y, steep = np.float32(state.d[0]), np.float32(state.d[1]), slack[k, :n]
        for q in range(n):
            left[q] = differences[q] + n_x * g_x[q] + n_y * g_y[q]
            steep[q] = abs(g_x[q]) + abs(g_y[q])
        if not first:
            x, y = work[8, :n], work[9, :n]
            _background(box, grounds[k], h_x, h_y, w, x, y, lanes, state)
    return away

"""Take the background's odd part, told by the ring around a spot, off its pairs' differences.

The third stage of `algorithms.extractors.frames.registration`, which says what the arrays hold.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Line = NDArray[np.float32]

_REACH, _LANES = 7, 64
_ZERO, _HALF, _ONE = np.float32(0.0), np.float32(0.5), np.float32(1.0)
#: Standard deviation of the background's slope, over the spot's own, before anything is known.
_PRIOR = 0.01
#: Standard deviations of a bend of the background from which it is one: extrapolating costs noise.
_BENT = 3.0
#: Share of a bend by which it may be another one inside the ring.
_UNKNOWN = 0.45
#: Pairs that depart by so many deviations count no more than that.
_FAR = 4.0
_TURNS = 6
#: Standard deviations of a slope from which there is a background that may bend.
_SLOPING = 1e9


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
def _lines(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, d: Line, box: Any, d_x: float, d_y: float, lines: Line
) -> int:
    """Write the window's pairs to `lines`, zero in the core; return how many are not.

    Rows: difference without what the spot's own slope explains, x, y.
    """
    columns, stride, first, above = box[3], box[4], box[5], box[6]
    across, along = np.float32(0.5 * d_x), np.float32(0.5 * d_y)
    middle = np.float32(0.5 * (columns - 1))
    rows = above + box[7]
    n = (rows * stride + _LANES - 1) // _LANES * _LANES
    r, x, y = lines[0, :n], lines[1, :n], lines[2, :n]
    x[:], y[:] = _ZERO, _ZERO
    for i in range(rows):
        at = np.float32(i - 0.5 * (box[2] - box[1]))
        part, beside = x[i * stride :], y[i * stride :]
        end = columns if i < above else first
        for j in range(end):
            part[j] = np.float32(j) - middle
            beside[j] = at
        if i >= above:
            for j in range(columns - first, columns):
                part[j] = np.float32(j) - middle
                beside[j] = at
    p = 8 + _REACH * stride
    own, up, down = s[p - 1 :], s[p - stride :], s[p + stride :]
    for q in range(n):
        r[q] = d[q] + across * (own[q + 2] - own[q]) + along * (down[q] - up[q])
    for q in range(n):
        r[q] *= _ONE if x[q] * x[q] + y[q] * y[q] > _ZERO else _ZERO
    return int(rows * columns - box[7] * (columns - 2 * first))


@compiled
def _moments(x: Line, y: Line, inverse: Any, lanes: Line, sums: Floats) -> None:
    """Write the sums of x^2, y^2, and these times rho and rho^2, ``rho = inverse (x^2 + y^2)``."""
    lanes[:] = _ZERO
    for k in range(0, x.size, _LANES):
        u, v = x[k : k + _LANES], y[k : k + _LANES]
        for j in range(_LANES):
            xx, yy = u[j] * u[j], v[j] * v[j]
            rho = (xx + yy) * inverse
            lanes[j] += xx
            lanes[j + _LANES] += yy
            lanes[j + 2 * _LANES] += xx * rho
            lanes[j + 3 * _LANES] += yy * rho
            lanes[j + 4 * _LANES] += xx * rho * rho
            lanes[j + 5 * _LANES] += yy * rho * rho
    for q in range(6):
        sums[q] = _fold(lanes[q * _LANES : (q + 1) * _LANES])


@compiled
def _right(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Line, n: int, inverse: Any, slope: Floats, limit: float, lanes: Line
) -> float:
    """Write sums of what is left times x, y, rho x and rho y to the lanes; how many are beyond."""
    a, b = np.float32(2.0 * slope[0]), np.float32(2.0 * slope[1])
    c, e = np.float32(2.0 * slope[2]), np.float32(2.0 * slope[3])
    far = np.float32(limit)
    lanes[:] = _ZERO
    for k in range(0, n, _LANES):
        r, x, y = lines[0, k : k + _LANES], lines[1, k : k + _LANES], lines[2, k : k + _LANES]
        for j in range(_LANES):
            rho = (x[j] * x[j] + y[j] * y[j]) * inverse
            left = r[j] - (a + c * rho) * x[j] - (b + e * rho) * y[j]
            lanes[j + 4 * _LANES] += _ONE if abs(left) > far else _ZERO
            left = min(far, left)
            left = max(-far, left)
            lanes[j] += left * x[j]
            lanes[j + _LANES] += left * y[j]
            lanes[j + 2 * _LANES] += left * x[j] * rho
            lanes[j + 3 * _LANES] += left * y[j] * rho
    return _fold(lanes[4 * _LANES : 5 * _LANES])


@compiled
def _solve(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Line, n: int, count: int, variance: float, prior: float, lanes: Line, slope: Floats
) -> None:
    """Fit ``difference = 2 (slope + bend |u|^2 / r^2) . u`` to the ring's pairs, all at first.

    No pair has much influence. `prior` is the variance of a slope and of a bend before anything is
    known, which counts where the frame's edge leaves few pairs.
    """
    sums = np.empty(6)
    inverse = np.float32(1.0 / slope[4])
    _moments(lines[1, :n], lines[2, :n], inverse, lanes, sums)
    scale, ridge = 4.0 / variance, 1.0 / prior
    lanes[:] = _ZERO
    for k in range(0, n, _LANES):
        part = lines[0, k : k + _LANES]
        for j in range(_LANES):
            lanes[j] += abs(part[j])
    size = _fold(lanes[:_LANES])
    least = _FAR * math.sqrt(variance)
    limit = max(least, 3.0 * size / count)
    slope[:4] = 0.0
    for _ in range(_TURNS):
        beyond = _right(lines, n, inverse, slope, limit, lanes)
        for axis in range(2):
            own, bent = sums[axis] * scale + ridge, sums[4 + axis] * scale + ridge
            mixed = sums[2 + axis] * scale
            determinant = own * bent - mixed * mixed
            right = _fold(lanes[axis * _LANES : (axis + 1) * _LANES])
            far = _fold(lanes[(2 + axis) * _LANES : (3 + axis) * _LANES])
            one = 0.5 * scale * right - slope[axis] * ridge
            two = 0.5 * scale * far - slope[2 + axis] * ridge
            slope[axis] += (bent * one - mixed * two) / determinant
            slope[2 + axis] += (own * two - mixed * one) / determinant
        if beyond == 0.0 and limit <= least:
            break  # one step solves what is linear
        limit = max(least, 0.3 * limit)
    bends = False
    for axis in range(2):
        own, bent = sums[axis] * scale + ridge, sums[4 + axis] * scale + ridge
        mixed = sums[2 + axis] * scale
        determinant = own * bent - mixed * mixed
        bends = bends or slope[2 + axis] ** 2 * determinant > _BENT * _BENT * own
        straight = slope[axis] + slope[2 + axis] * mixed / own
        bends = bends or straight * straight * own > _SLOPING * _SLOPING
    for axis in range(2):
        own, bent = sums[axis] * scale + ridge, sums[4 + axis] * scale + ridge
        mixed = sums[2 + axis] * scale
        determinant = own * bent - mixed * mixed
        if bends:
            slope[5 + axis], slope[7 + axis] = bent / determinant, own / determinant
            slope[5 + axis] += (_UNKNOWN * slope[2 + axis] * mixed / own) ** 2
        else:
            slope[axis] += slope[2 + axis] * mixed / own
            slope[5 + axis], slope[2 + axis], slope[7 + axis] = 1.0 / own, 0.0, 0.0


@compiled
def _flatten(d: Line, box: Any, slope: Floats) -> None:
    """Take the background's odd part off the core's differences."""
    columns, stride, above = box[3], box[4], box[6]
    a, b, inverse = (
        np.float32(2.0 * slope[0]),
        np.float32(2.0 * slope[1]),
        np.float32(1.0 / slope[4]),
    )
    c, e = np.float32(2.0 * slope[2]), np.float32(2.0 * slope[3])
    middle = np.float32(0.5 * (columns - 1))
    for i in range(above, above + box[7]):
        y = np.float32(i - 0.5 * (box[2] - box[1]))
        row = d[i * stride : i * stride + columns]
        for j in range(columns):
            x = np.float32(j) - middle
            rho = (x * x + y * y) * inverse
            row[j] -= (a + c * rho) * x + (b + e * rho) * y


@compiled
def flatten(  # noqa: PLR0917 - Numba takes no keyword-only ones
    todo: NDArray[np.int64],
    boxes: NDArray[np.int64],
    lights: Floats,
    s: Line,
    d: Line,
    space: Line,
    states: Floats,
    slopes: Floats,
) -> None:
    """Fit the background around the windows `todo`, take it off, and write it to `slopes` (N, 9).

    Columns: slope along x and y, bend along both, the square of the length it is told at; the
    variances of slope and bend of each axis, and their covariance.
    """
    lines = space[:3]
    lanes = np.empty(6 * _LANES, dtype=np.float32)
    for k in todo:
        state, slope = states[k], slopes[k]
        box = boxes[k]
        slope[:] = 0.0
        slope[4] = 0.25 * (box[3] * box[3] + (box[2] - box[1]) ** 2)
        count = _lines(s[k], d[k], box, state[2], state[3], lines)
        if count == 0:
            continue
        n = ((box[6] + box[7]) * box[4] + _LANES - 1) // _LANES * _LANES
        variance = 2.0 * state[0] + 1e-12
        prior = (_PRIOR / max(lights[k, 2], lights[k, 3])) ** 2
        _solve(lines, n, count, variance, prior, lanes, slope)
        _flatten(d[k], boxes[k], slope)

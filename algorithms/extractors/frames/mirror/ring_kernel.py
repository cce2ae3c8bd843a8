"""Take the background's odd part, told by the ring around a spot, off its pairs' differences.

The third stage of `mirror.registration`, which says what the arrays hold.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Line = NDArray[np.float32]

_REACH, _LANES = 7, 16
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
#: Chi squared of a step that is none.
_STILL = 1e-6
#: Standard deviations of a slope from which there is a background that may bend.
_SLOPING = 1e9


@compiled
def _fold(lanes: Line, which: int) -> float:
    """Sum of the lanes of one of several sums, halves added to halves."""
    p = which * _LANES
    for j in range(_LANES // 2):
        lanes[p + j] += lanes[p + j + _LANES // 2]
    a, b = float(lanes[p]) + lanes[p + 1], float(lanes[p + 2]) + lanes[p + 3]
    c, e = float(lanes[p + 4]) + lanes[p + 5], float(lanes[p + 6]) + lanes[p + 7]
    total: float = (a + b) + (c + e)
    return total


@compiled
def _lines(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, d: Line, box: Any, d_x: float, d_y: float, templates: Line, lines: Line
) -> None:
    """Write the window's pairs to `lines`, zero in the core.

    Rows: difference without what the spot's own slope explains, x, y. `templates` (4, L): of a
    row above the core and of one through it, which columns are of the ring, and their x.
    """
    columns, stride, first, above = box[3], box[4], box[5], box[6]
    across, along = np.float32(0.5 * d_x), np.float32(0.5 * d_y)
    rows = above + box[7]
    middle = np.float32(0.5 * (columns - 1))
    for j in range(stride):
        for i in range(4):
            templates[i, j] = _ZERO
    for j in range(columns):
        templates[0, j], templates[1, j] = _ONE, np.float32(j) - middle
    for j in range(first):
        templates[2, j], templates[2, columns - 1 - j] = _ONE, _ONE
        templates[3, j], templates[3, columns - 1 - j] = np.float32(j) - middle, middle - j
    p = 8 + _REACH * stride
    n = rows * stride
    r, own, after, up, down = lines[0], s[p - 1 :], s[p + 1 :], s[p - stride :], s[p + stride :]
    for q in range(n):
        r[q] = d[q] + across * (after[q] - own[q]) + along * (down[q] - up[q])
    _masked(lines, 0, above, stride, -0.5 * (box[2] - box[1]), templates[:2])
    _masked(lines, above, rows, stride, -0.5 * (box[2] - box[1]), templates[2:])
    for q in range(n, (n + _LANES - 1) // _LANES * _LANES):
        lines[0, q], lines[1, q], lines[2, q] = _ZERO, _ZERO, _ZERO


@compiled
def _masked(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Line, begin: int, end: int, stride: int, top: float, template: Line
) -> None:
    """Write x and y of some rows, and zero where there is no ring."""
    mask, across = template[0], template[1]
    r, x, y = lines[0], lines[1], lines[2]
    for i in range(begin, end):
        at, first = np.float32(i + top), np.uint64(i * stride)
        for j in range(stride):
            q = first + np.uint64(j)
            r[q] *= mask[j]
            x[q] = across[j]
            y[q] = at * mask[j]


@compiled
def _by_column(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, d: Line, box: Any, d_x: float, d_y: float, line: Line, columns: Line
) -> None:
    """Sum the ring's differences, without what the spot's own slope explains, down its columns.

    To `columns` (5, L): sums times 1, y, y^2 and y^3, and the largest. `line` is work space.
    """
    stride, first, above, rows = box[4], box[5], box[6], box[6] + box[7]
    across, along = np.float32(0.5 * d_x), np.float32(0.5 * d_y)
    p, n = 8 + _REACH * stride, rows * stride
    own, after, up, down = s[p - 1 :], s[p + 1 :], s[p - stride :], s[p + stride :]
    for q in range(n):
        line[q] = d[q] + across * (after[q] - own[q]) + along * (down[q] - up[q])
    for i in range(above, rows):
        for j in range(i * stride + first, i * stride + box[3] - first):
            line[j] = _ZERO
    # rows of what is contiguous: loops over others are not vectorised
    one, two, three, four, most = columns[0], columns[1], columns[2], columns[3], columns[4]
    for j in range(stride):
        one[j], two[j], three[j], four[j], most[j] = _ZERO, _ZERO, _ZERO, _ZERO, _ZERO
    for i in range(rows):
        y, begin = np.float32(i - 0.5 * (box[2] - box[1])), np.uint64(i * stride)
        for j in range(stride):
            a = line[begin + np.uint64(j)]
            one[j] += a
            most[j] = max(most[j], abs(a))
            a *= y
            two[j] += a
            a *= y
            three[j] += a
            four[j] += a * y


@compiled
def _moments(box: Any, inverse: float, columns: Line, right: Floats) -> float:
    """Write the ring's sums times x, y, rho x and rho y by its columns'; return the largest."""
    right[:] = 0.0
    largest = _ZERO
    for j in range(box[3]):
        x = j - 0.5 * (box[3] - 1)
        one, two = float(columns[0, j]), float(columns[1, j])
        right[0] += x * one
        right[1] += two
        right[2] += inverse * x * (x * x * one + columns[2, j])
        right[3] += inverse * (x * x * two + columns[3, j])
        largest = max(largest, columns[4, j])
    return float(largest)


@compiled
def _powers(box: Any, inverse: float, sums: Floats) -> None:
    """Write the sums of x^2, y^2, and these times rho and rho^2, ``rho = inverse (x^2 + y^2)``.

    Of all the window less those of the core: sums of powers of x times such of y.
    """
    columns, first, above, rows = box[3], box[5], box[6], box[6] + box[7]
    sums[:] = 0.0
    for part in range(2):
        begin, skip = (0, 0) if part == 0 else (above, first)
        sign = 1.0 if part == 0 else -1.0
        x2, x4, x6, y2, y4, y6 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for j in range(skip, columns - skip):
            u = (j - 0.5 * (columns - 1)) ** 2
            x2 += u
            x4 += u * u
            x6 += u * u * u
        for i in range(begin, rows):
            v = (i - 0.5 * (box[2] - box[1])) ** 2
            y2 += v
            y4 += v * v
            y6 += v * v * v
        x0, y0 = sign * (columns - 2 * skip), rows - begin
        sums[0] += sign * x2 * y0
        sums[1] += x0 * y2
        sums[2] += inverse * sign * (x4 * y0 + x2 * y2)
        sums[3] += inverse * (sign * x2 * y2 + x0 * y4)
        sums[4] += inverse * inverse * sign * (x6 * y0 + 2.0 * x4 * y2 + x2 * y4)
        sums[5] += inverse * inverse * (sign * (x4 * y2 + 2.0 * x2 * y4) + x0 * y6)


@compiled
def _add_left(  # noqa: PLR0917 - Numba takes no keyword-only ones
    r: Line,
    across: Line,
    along: Line,
    n: int,
    inverse: Any,
    a: Any,
    b: Any,
    c: Any,
    e: Any,
    far: Any,
    lanes: Line,
) -> None:
    """Add what `_right` sums up to the lanes, which stay in registers here."""
    for k in range(0, n, _LANES):
        for j in range(_LANES):
            q = np.uint64(k) + np.uint64(j)  # what is never negative is vectorised
            x, y = across[q], along[q]
            rho = (x * x + y * y) * inverse
            left = r[q] - (a + c * rho) * x - (b + e * rho) * y
            lanes[j + 4 * _LANES] += _ONE if abs(left) > far else _ZERO
            left = min(far, left)
            left = max(-far, left)
            lanes[j] += left * x
            lanes[j + _LANES] += left * y
            lanes[j + 2 * _LANES] += left * x * rho
            lanes[j + 3 * _LANES] += left * y * rho


@compiled
def _right(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Line, n: int, inverse: Any, slope: Floats, limit: float, lanes: Line
) -> float:
    """Write sums of what is left times x, y, rho x and rho y to the lanes; how many are beyond."""
    a, b = np.float32(2.0 * slope[0]), np.float32(2.0 * slope[1])
    c, e = np.float32(2.0 * slope[2]), np.float32(2.0 * slope[3])
    far = np.float32(limit)
    lanes[:] = _ZERO
    _add_left(lines[0], lines[1], lines[2], n, inverse, a, b, c, e, far, lanes)
    return _fold(lanes, 4)


@compiled
def _step(variance: float, prior: float, sums: Floats, right: Floats, slope: Floats) -> None:
    """Write the slope and bend of both axes that solve what is linear: no pair is far off."""
    scale, ridge = 4.0 / variance, 1.0 / prior
    for axis in range(2):
        own, bent = sums[axis] * scale + ridge, sums[4 + axis] * scale + ridge
        mixed = sums[2 + axis] * scale
        determinant = own * bent - mixed * mixed
        one, two = 0.5 * scale * right[axis], 0.5 * scale * right[2 + axis]
        slope[axis] = (bent * one - mixed * two) / determinant
        slope[2 + axis] = (own * two - mixed * one) / determinant


@compiled
def _solve_robustly(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Line,
    box: Any,
    count: int,
    variance: float,
    prior: float,
    sums: Floats,
    lanes: Line,
    slope: Floats,
) -> None:
    """Fit ``difference = 2 (slope + bend |u|^2 / r^2) . u`` to the ring's pairs, all at first.

    No pair has much influence. `prior` is the variance of a slope and of a bend before anything is
    known, which counts where the frame's edge leaves few pairs.
    """
    inverse = np.float32(1.0 / slope[4])
    n = ((box[6] + box[7]) * box[4] + _LANES - 1) // _LANES * _LANES
    scale, ridge = 4.0 / variance, 1.0 / prior
    differences = lines[0]
    lanes[:] = _ZERO
    for k in range(0, n, _LANES):
        for j in range(_LANES):
            lanes[j] += abs(differences[np.uint64(k) + np.uint64(j)])
    size = _fold(lanes, 0)
    least = _FAR * math.sqrt(variance)
    limit = max(least, 3.0 * size / count)
    slope[:4] = 0.0
    for _ in range(_TURNS):
        beyond, moved = _right(lines, n, inverse, slope, limit, lanes), 0.0
        for axis in range(2):
            own, bent = sums[axis] * scale + ridge, sums[4 + axis] * scale + ridge
            mixed = sums[2 + axis] * scale
            determinant = own * bent - mixed * mixed
            right = _fold(lanes, axis)
            far = _fold(lanes, 2 + axis)
            one = 0.5 * scale * right - slope[axis] * ridge
            two = 0.5 * scale * far - slope[2 + axis] * ridge
            step, turn = bent * one - mixed * two, own * two - mixed * one
            slope[axis] += step / determinant
            slope[2 + axis] += turn / determinant
            moved = max(moved, (step * one + turn * two) / determinant)
        if limit <= least and (beyond == 0.0 or moved < _STILL):
            break  # one step solves what is linear
        limit = max(least, 0.3 * limit)


@compiled
def _settle(variance: float, prior: float, sums: Floats, slope: Floats) -> None:
    """Take the bend out of a solution where it shows none; write how sure it is."""
    scale, ridge, bends = 4.0 / variance, 1.0 / prior, False
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
def _flatten(d: Line, box: Any, slope: Floats, across: Line) -> None:
    """Take the background's odd part off the core's differences; `across` is work space."""
    columns, stride, above = box[3], box[4], box[6]
    a, b, inverse = (
        np.float32(2.0 * slope[0]),
        np.float32(2.0 * slope[1]),
        np.float32(1.0 / slope[4]),
    )
    c, e = np.float32(2.0 * slope[2]), np.float32(2.0 * slope[3])
    for j in range(stride):
        across[j] = np.float32(j - 0.5 * (columns - 1))
    for i in range(above, above + box[7]):
        y, first = np.float32(i - 0.5 * (box[2] - box[1])), np.uint64(i * stride)
        for j in range(stride):
            x, q = across[j], first + np.uint64(j)
            rho = (x * x + y * y) * inverse
            d[q] -= (a + c * rho) * x + (b + e * rho) * y


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
    lines, columns = space[:3], space[8:13]
    lanes, sums, right = np.empty(6 * _LANES, dtype=np.float32), np.empty(6), np.empty(4)
    for k in todo:
        state, slope = states[k], slopes[k]
        box = boxes[k]
        slope[:] = 0.0
        slope[4] = 0.25 * (box[3] * box[3] + (box[2] - box[1]) ** 2)
        count = (box[6] + box[7]) * box[3] - box[7] * (box[3] - 2 * box[5])
        if count == 0:
            continue
        variance = 2.0 * state[0] + 1e-12
        prior = (_PRIOR / max(lights[k, 2], lights[k, 3])) ** 2
        _powers(box, 1.0 / slope[4], sums)
        _by_column(s[k], d[k], box, state[2], state[3], space[0], columns)
        largest = _moments(box, 1.0 / slope[4], columns, right)
        if largest <= _FAR * math.sqrt(variance):
            _step(variance, prior, sums, right, slope)
        else:
            _lines(s[k], d[k], box, state[2], state[3], space[3:7], lines)
            _solve_robustly(lines, box, count, variance, prior, sums, lanes, slope)
        _settle(variance, prior, sums, slope)
        _flatten(d[k], boxes[k], slope, space[7])

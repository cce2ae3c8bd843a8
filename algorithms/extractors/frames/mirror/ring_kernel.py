"""Take the background's odd part, from the ring around a spot, off its pairs' differences.

The third stage of `mirror.registration`, which says what the arrays hold.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.mirror.lines_kernel import LANES, ONE, REACH, ZERO, Line, fold
from algorithms.extractors.frames.mirror.records import Background, Box
from algorithms.kernels.records import Pair, Records, record

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


class Powers:
    """Sums over the ring of x^2 and y^2, and of these times rho and rho^2.

    ``rho = (x^2 + y^2) / square``, the `Background`'s.

    Attributes
    ----------
    plain, mixed, bent
        Along both axes: the squares, times rho, and times rho^2.
    """

    plain: Pair
    mixed: Pair
    bent: Pair


_POWERS = record(Powers)


@compiled
def _departures(s: Line, d: Line, box: Box, displacement: Floats, out: Line) -> None:
    """Write the window's differences without what the spot's own slope explains."""
    stride = box.stride
    across, along = np.float32(0.5 * displacement[0]), np.float32(0.5 * displacement[1])
    p = 8 + REACH * stride
    own, after, up, down = s[p - 1 :], s[p + 1 :], s[p - stride :], s[p + stride :]
    for q in range((box.above + box.rows) * stride):
        out[q] = d[q] + across * (after[q] - own[q]) + along * (down[q] - up[q])


@compiled
def _lines(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, d: Line, box: Box, displacement: Floats, templates: Line, lines: Line
) -> None:
    """Write the window's pairs to `lines`, zero in the core.

    Rows: difference without what the spot's own slope explains, x, y. `templates` (4, L): of a
    row above the core and of one through it, which columns are of the ring, and their x.
    """
    columns, stride, first, above = box.columns, box.stride, box.first, box.above
    rows = above + box.rows
    middle = np.float32(0.5 * (columns - 1))
    for j in range(stride):
        for i in range(4):
            templates[i, j] = ZERO
    for j in range(columns):
        templates[0, j], templates[1, j] = ONE, np.float32(j) - middle
    for j in range(first):
        templates[2, j], templates[2, columns - 1 - j] = ONE, ONE
        templates[3, j], templates[3, columns - 1 - j] = np.float32(j) - middle, middle - j
    n, top = rows * stride, -0.5 * (box.last - box.top)
    _departures(s, d, box, displacement, lines[0])
    _mask(lines, 0, above, stride, top, templates[:2])
    _mask(lines, above, rows, stride, top, templates[2:])
    for q in range(n, (n + LANES - 1) // LANES * LANES):
        lines[0, q], lines[1, q], lines[2, q] = ZERO, ZERO, ZERO


@compiled
def _mask(  # noqa: PLR0917 - Numba takes no keyword-only ones
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
def _sum_columns(  # noqa: PLR0917 - Numba takes no keyword-only ones
    s: Line, d: Line, box: Box, displacement: Floats, line: Line, columns: Line
) -> None:
    """Sum the ring's differences, without what the spot's own slope explains, down its columns.

    To `columns` (5, L): sums times 1, y, y^2 and y^3, and the largest. `line` is work space.
    """
    stride, first, above, rows = box.stride, box.first, box.above, box.above + box.rows
    _departures(s, d, box, displacement, line)
    for i in range(above, rows):
        for j in range(i * stride + first, i * stride + box.columns - first):
            line[j] = ZERO
    # rows of what is contiguous: loops over others are not vectorised
    one, two, three, four, most = columns[0], columns[1], columns[2], columns[3], columns[4]
    for j in range(stride):
        one[j], two[j], three[j], four[j], most[j] = ZERO, ZERO, ZERO, ZERO, ZERO
    for i in range(rows):
        y, begin = np.float32(i - 0.5 * (box.last - box.top)), np.uint64(i * stride)
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
def _moments(box: Box, inverse: float, columns: Line, right: Floats) -> float:
    """Write the ring's sums times x, y, rho x and rho y by its columns'; return the largest."""
    right[:] = 0.0
    largest = ZERO
    for j in range(box.columns):
        x = j - 0.5 * (box.columns - 1)
        one, two = float(columns[0, j]), float(columns[1, j])
        right[0] += x * one
        right[1] += two
        right[2] += inverse * x * (x * x * one + columns[2, j])
        right[3] += inverse * (x * x * two + columns[3, j])
        largest = max(largest, columns[4, j])
    return float(largest)


@compiled
def _powers(box: Box, inverse: float, powers: Powers) -> None:
    """Write the sums of powers over the ring: those of all the window less those of the core.

    Each is made of sums of powers of x times such of y.
    """
    columns, first, above, rows = box.columns, box.first, box.above, box.above + box.rows
    powers.plain[:], powers.mixed[:], powers.bent[:] = 0.0, 0.0, 0.0
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
            v = (i - 0.5 * (box.last - box.top)) ** 2
            y2 += v
            y4 += v * v
            y6 += v * v * v
        x0, y0 = sign * (columns - 2 * skip), rows - begin
        powers.plain[0] += sign * x2 * y0
        powers.plain[1] += x0 * y2
        powers.mixed[0] += inverse * sign * (x4 * y0 + x2 * y2)
        powers.mixed[1] += inverse * (sign * x2 * y2 + x0 * y4)
        powers.bent[0] += inverse * inverse * sign * (x6 * y0 + 2.0 * x4 * y2 + x2 * y4)
        powers.bent[1] += inverse * inverse * (sign * (x4 * y2 + 2.0 * x2 * y4) + x0 * y6)


@compiled
def _add_rest(  # noqa: PLR0917 - Numba takes no keyword-only ones
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
    for k in range(0, n, LANES):
        for j in range(LANES):
            q = np.uint64(k) + np.uint64(j)  # what is never negative is vectorised
            x, y = across[q], along[q]
            rho = (x * x + y * y) * inverse
            left = r[q] - (a + c * rho) * x - (b + e * rho) * y
            lanes[j + 4 * LANES] += ONE if abs(left) > far else ZERO
            left = min(far, left)
            left = max(-far, left)
            lanes[j] += left * x
            lanes[j + LANES] += left * y
            lanes[j + 2 * LANES] += left * x * rho
            lanes[j + 3 * LANES] += left * y * rho


@compiled
def _right(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Line, n: int, inverse: Any, ground: Background, limit: float, lanes: Line
) -> float:
    """Write sums of what is left times x, y, rho x and rho y to the lanes; how many are beyond."""
    a, b = np.float32(2.0 * ground.slope[0]), np.float32(2.0 * ground.slope[1])
    c, e = np.float32(2.0 * ground.bend[0]), np.float32(2.0 * ground.bend[1])
    far = np.float32(limit)
    lanes[:] = ZERO
    _add_rest(lines[0], lines[1], lines[2], n, inverse, a, b, c, e, far, lanes)
    return fold(lanes, 4, LANES)


@compiled
def _equations(
    powers: Powers, axis: int, variance: float, prior: float
) -> tuple[float, float, float, float]:
    """Return what solves an axis' slope and bend: own, bent, mixed and their determinant."""
    scale, ridge = 4.0 / variance, 1.0 / prior
    own, bent = powers.plain[axis] * scale + ridge, powers.bent[axis] * scale + ridge
    mixed = powers.mixed[axis] * scale
    return own, bent, mixed, own * bent - mixed * mixed


@compiled
def _step(variance: float, prior: float, powers: Powers, right: Floats, ground: Background) -> None:
    """Write the slope and bend of both axes that solve what is linear: no pair is far off."""
    scale = 4.0 / variance
    for axis in range(2):
        own, bent, mixed, determinant = _equations(powers, axis, variance, prior)
        one, two = 0.5 * scale * right[axis], 0.5 * scale * right[2 + axis]
        ground.slope[axis] = (bent * one - mixed * two) / determinant
        ground.bend[axis] = (own * two - mixed * one) / determinant


@compiled
def _solve_robustly(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Line,
    box: Box,
    count: int,
    variance: float,
    prior: float,
    powers: Powers,
    lanes: Line,
    ground: Background,
) -> None:
    """Fit ``difference = 2 (slope + bend |u|^2 / r^2) . u`` to the ring's pairs, all at first.

    No pair has much influence. `prior` is the variance of a slope and of a bend before anything is
    known, which counts where the frame's edge leaves few pairs.
    """
    inverse = np.float32(1.0 / ground.square)
    n = ((box.above + box.rows) * box.stride + LANES - 1) // LANES * LANES
    scale, ridge = 4.0 / variance, 1.0 / prior
    differences = lines[0]
    lanes[:] = ZERO
    for k in range(0, n, LANES):
        for j in range(LANES):
            lanes[j] += abs(differences[np.uint64(k) + np.uint64(j)])
    size = fold(lanes, 0, LANES)
    least = _FAR * math.sqrt(variance)
    limit = max(least, 3.0 * size / count)
    ground.slope[:], ground.bend[:] = 0.0, 0.0
    for _ in range(_TURNS):
        beyond, moved = _right(lines, n, inverse, ground, limit, lanes), 0.0
        for axis in range(2):
            own, bent, mixed, determinant = _equations(powers, axis, variance, prior)
            right = fold(lanes, axis, LANES)
            far = fold(lanes, 2 + axis, LANES)
            one = 0.5 * scale * right - ground.slope[axis] * ridge
            two = 0.5 * scale * far - ground.bend[axis] * ridge
            step, turn = bent * one - mixed * two, own * two - mixed * one
            ground.slope[axis] += step / determinant
            ground.bend[axis] += turn / determinant
            moved = max(moved, (step * one + turn * two) / determinant)
        if limit <= least and (beyond == 0.0 or moved < _STILL):
            break  # one step solves what is linear
        limit = max(least, 0.3 * limit)


@compiled
def _settle(variance: float, prior: float, powers: Powers, ground: Background) -> None:
    """Take the bend out of a solution where it shows none; write how sure it is."""
    slope, bend, bends = ground.slope, ground.bend, False
    for axis in range(2):
        own, _, mixed, determinant = _equations(powers, axis, variance, prior)
        bends = bends or bend[axis] ** 2 * determinant > _BENT * _BENT * own
        straight = slope[axis] + bend[axis] * mixed / own
        bends = bends or straight * straight * own > _SLOPING * _SLOPING
    for axis in range(2):
        own, bent, mixed, determinant = _equations(powers, axis, variance, prior)
        if bends:
            ground.slope_variance[axis] = bent / determinant
            ground.bend_variance[axis] = own / determinant
            ground.slope_variance[axis] += (_UNKNOWN * bend[axis] * mixed / own) ** 2
        else:
            slope[axis] += bend[axis] * mixed / own
            ground.slope_variance[axis] = 1.0 / own
            bend[axis], ground.bend_variance[axis] = 0.0, 0.0


@compiled
def _flatten(d: Line, box: Box, ground: Background, across: Line) -> None:
    """Take the background's odd part off the core's differences; `across` is work space."""
    columns, stride, above = box.columns, box.stride, box.above
    a, b = np.float32(2.0 * ground.slope[0]), np.float32(2.0 * ground.slope[1])
    c, e = np.float32(2.0 * ground.bend[0]), np.float32(2.0 * ground.bend[1])
    inverse = np.float32(1.0 / ground.square)
    for j in range(stride):
        across[j] = np.float32(j - 0.5 * (columns - 1))
    for i in range(above, above + box.rows):
        y, first = np.float32(i - 0.5 * (box.last - box.top)), np.uint64(i * stride)
        for j in range(stride):
            x, q = across[j], first + np.uint64(j)
            rho = (x * x + y * y) * inverse
            d[q] -= (a + c * rho) * x + (b + e * rho) * y


@compiled
def flatten(  # noqa: PLR0917 - Numba takes no keyword-only ones
    todo: NDArray[np.int64],
    boxes: Records,
    lights: Records,
    s: Line,
    d: Line,
    space: Line,
    states: Records,
    grounds: Records,
) -> None:
    """Fit the background around the windows `todo`, take it off, and write it to `grounds`."""
    lines, columns = space[:3], space[8:13]
    lanes, right = np.empty(6 * LANES, dtype=np.float32), np.empty(4)
    # a compiled record does not keep its array, which is freed after its last use
    kept_powers = np.empty(1, dtype=_POWERS)
    for k in todo:
        powers = kept_powers[0]
        state, ground, box, half = states[k], grounds[k], boxes[k], lights[k].half
        width, height = box.columns, box.last - box.top
        ground.slope[:], ground.bend[:] = 0.0, 0.0
        ground.slope_variance[:], ground.bend_variance[:] = 0.0, 0.0
        ground.square = 0.25 * (width * width + height**2)
        count = (box.above + box.rows) * width - box.rows * (width - 2 * box.first)
        if count == 0:
            continue
        variance = 2.0 * state.dark + 1e-12
        prior = (_PRIOR / max(half[0], half[1])) ** 2
        _powers(box, 1.0 / ground.square, powers)
        _sum_columns(s[k], d[k], box, state.d, space[0], columns)
        largest = _moments(box, 1.0 / ground.square, columns, right)
        if largest <= _FAR * math.sqrt(variance):
            _step(variance, prior, powers, right, ground)
        else:
            _lines(s[k], d[k], box, state.d, space[3:7], lines)
            _solve_robustly(lines, box, count, variance, prior, powers, lanes, ground)
        _settle(variance, prior, powers, ground)
        _flatten(d[k], box, ground, space[7])

"""Least-squares fit of a row of equal images at known distances to a line of pixels.

An image is a function of ``u``, the distance from its middle in half widths: one in the middle,
about a half at ``u = 1``, and zero beyond `_FAR`. Lines are (R, L) float64; S spots belong to G
groups that shift together.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.cholesky import solve
from algorithms.kernels.copies import copy_row

Counts = NDArray[np.int64]

#: Images by number, and what gives them their half at u = 1.
RATIONAL, GAUSSIAN, DIFFRACTION = 0, 1, 2
_HALF_GAUSSIAN = math.log(2.0)
_HALF_SINC = 1.3915573782515103  # sin(x)^2 / x^2 = 1/2
#: Half widths beyond which an image is dark.
_FAR = 8.0
#: Ratios of a step to the one before from which on, and up to which, the rest of a series of such
#: steps is taken at once.
_SLOW, _SLOWEST = 0.3, 0.95
#: Times that the pixels of a fit are selected anew before it is taken as it is.
_ROUNDS = 3
#: Largest step of a shift, half widths: further out an image has no slope to go by.
_STRIDE = 0.5
_DEPENDENT = 1e-10  # pivot over diagonal below which a parameter is not determined


@compiled
def image_of(u: float, kind: int, c: Floats) -> tuple[float, float]:
    """Value and slope of an image; `c` (6,) are the rational one's coefficients."""
    if kind == RATIONAL:
        w = u * u
        top = (c[0] * w + c[1]) * w + c[2]
        bottom = (c[3] * w + c[4]) * w + c[5]
        value = top / bottom
        slope = 2.0 * u * ((2.0 * c[0] * w + c[1]) - value * (2.0 * c[3] * w + c[4])) / bottom
        return value, slope
    if kind == GAUSSIAN:
        value = math.exp(-_HALF_GAUSSIAN * u * u)
        return value, -2.0 * _HALF_GAUSSIAN * u * value
    x = _HALF_SINC * u
    if abs(x) < 1e-4:
        return 1.0 - x * x / 3.0, -2.0 * x / 3.0 * _HALF_SINC
    sinc = math.sin(x) / x
    return sinc * sinc, 2.0 * sinc * (math.cos(x) - sinc) / x * _HALF_SINC


@compiled
def image_type(
    places: Floats, groups: Counts, halves: Floats, shifts: Floats, overlap: float
) -> tuple[int, int]:
    """Spots of the two groups that overlap most, as indices; -1 where none do."""
    closest = overlap
    first = -1
    second = -1
    for i in range(places.size):
        for j in range(i + 1, places.size):
            if groups[i] != groups[j]:
                away = abs(places[i] + shifts[groups[i]] - places[j] - shifts[groups[j]])
                away /= 0.5 * (halves[i] + halves[j])
                if away < closest:
                    closest = away
                    first = i
                    second = j
    return first, second


@compiled
def _pixels(place: float, around: float, far: float, length: int) -> tuple[int, int]:
    """First pixel within `far` of a spot whose shift is `around`, and the one after the last."""
    middle = place + around
    first, end = max(math.floor(middle - far), 0), min(math.floor(middle + far) + 2, length)
    while first < end and abs(first - place - around) > far:
        first += 1
    while first < end and abs(end - 1 - place - around) > far:
        end -= 1
    return first, end


@compiled
def _product(one: Floats, other: Floats) -> float:
    """Sum of products, pixel by pixel."""
    total = 0.0
    for n in range(one.size):
        total += one[n] * other[n]
    return total


@compiled
def _add_image(  # noqa: PLR0917 - Numba takes no keyword-only ones
    pixels: Floats,
    place: float,
    shift: float,
    half: float,
    amplitude: float,
    kind: int,
    c: Floats,
    model: Floats,
    by_amplitude: Floats,
    by_shift: Floats,
) -> None:
    """Add a spot to the model at some pixels, and to its derivatives."""
    for n in range(pixels.size):
        value, slope = image_of((pixels[n] - place - shift) / half, kind, c)
        model[n] += amplitude * value
        by_amplitude[n] += value
        by_shift[n] -= amplitude * slope / half


@compiled
def normal_equations(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: Floats,
    floor: float,
    places: Floats,
    groups: Counts,
    halves: Floats,
    column: Counts,
    kind: int,
    c: Floats,
    around: Floats,
    found: Floats,
    matrix: Floats,
    right: Floats,
) -> None:
    """Fill ``Q^T Q`` (lower half) and ``Q^T d_beta`` at the parameters `found`.

    Those are the amplitudes, spot i's at ``column[i]``, and then the groups' shifts. A spot's
    pixels are those within `_FAR` of its place at the parameters `around`.
    """
    size = found.size
    amplitudes = column.max() + 1
    middles = np.empty(places.size)
    spans = np.empty((places.size, 2), dtype=np.int64)
    begin, end = row.size, 0
    for i in range(places.size):
        shift = around[amplitudes + groups[i]]
        middles[i] = places[i] + shift
        spans[i] = _pixels(places[i], shift, _FAR * halves[i], row.size)
        if spans[i, 0] < spans[i, 1]:
            begin, end = min(begin, spans[i, 0]), max(end, spans[i, 1])
    wide = max(end - begin, 0)
    pixels = np.arange(begin, begin + wide).astype(np.float64)
    model, q = np.zeros(wide), np.zeros((size, wide))
    # pixels from the first to the last one that depends on each parameter
    firsts, ends = np.full(size, wide), np.zeros(size, dtype=np.int64)
    for i in np.argsort(middles):
        first, last = spans[i, 0] - begin, spans[i, 1] - begin
        if first < last:
            one, group = column[i], amplitudes + groups[i]
            here = slice(first, last)
            _add_image(
                pixels[here],
                places[i],
                found[group],
                halves[i],
                found[one],
                kind,
                c,
                model[here],
                q[one, here],
                q[group, here],
            )
            for parameter in (one, group):
                firsts[parameter] = min(firsts[parameter], first)
                ends[parameter] = max(ends[parameter], last)
    beta = row[begin : begin + wide] - floor - model
    for i in range(size):
        right[i] = _product(q[i, firsts[i] : ends[i]], beta[firsts[i] : ends[i]])
        for j in range(i + 1):
            first, last = max(firsts[i], firsts[j]), min(ends[i], ends[j])
            matrix[i, j] = _product(q[i, first:last], q[j, first:last]) if first < last else 0.0


@compiled
def same_pixels(  # noqa: PLR0917 - Numba takes no keyword-only ones
    places: Floats, groups: Counts, halves: Floats, amplitudes: int, one: Floats, other: Floats
) -> bool:
    """Whether all spots have the same pixels at two sets of parameters."""
    for i in range(places.size):
        first = places[i] + one[amplitudes + groups[i]]
        second = places[i] + other[amplitudes + groups[i]]
        far = _FAR * halves[i]
        if math.ceil(first - far) != math.ceil(second - far):
            return False
        if math.floor(first + far) != math.floor(second + far):
            return False
    return True


@compiled
def _iterate(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: Floats,
    floor: float,
    places: Floats,
    groups: Counts,
    halves: Floats,
    column: Counts,
    kind: int,
    c: Floats,
    tolerance: float,
    iterations: int,
    found: Floats,
    matrix: Floats,
    right: Floats,
) -> bool:
    """Move `found` by Gauss-Newton steps, and say whether they end near the start.

    The pixels that count stay the same until the steps end, and are then selected anew: selected at
    every step, one on the border may come and go for ever. Where the image is not quite the
    light's, steps shrink by a constant ratio; once they do, the rest of their series is taken at
    once.
    """
    count = column.max() + 1
    size = found.size
    start = found.copy()
    around = found.copy()
    widest = halves.max()
    before = np.zeros(size)
    rounds = 0
    for _ in range(iterations):
        normal_equations(
            row, floor, places, groups, halves, column, kind, c, around, found, matrix, right
        )
        if not solve(matrix[:size, :size], right[:size], _DEPENDENT):
            return False
        along = 0.0
        square = 0.0
        ended = True
        for i in range(size):
            step = right[i]
            scale = abs(found[i] + step)
            if i >= count:
                step = min(max(step, -_STRIDE * widest), _STRIDE * widest)
                scale = widest
                along += step * before[i]
                square += before[i] * before[i]
            found[i] += step
            before[i] = step
            ended = ended and abs(step) <= tolerance * scale
            if i >= count and not abs(found[i] - start[i]) <= 2.0 * widest:
                return False
        if ended:
            rounds += 1
            if rounds == _ROUNDS or same_pixels(places, groups, halves, count, around, found):
                return True
            copy_row(found, around)
            before[:] = 0.0
        elif _SLOW * square < along < _SLOWEST * square:
            more = along / (square - along)
            for i in range(count, size):
                found[i] += min(max(more * before[i], -_STRIDE * widest), _STRIDE * widest)
            before[:] = 0.0
    return False


@compiled
def fit_images(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Floats,
    floors: Floats,
    starts: Floats,
    places: Floats,
    groups: Counts,
    halves: Floats,
    kind: int,
    c: Floats,
    overlap: float,
    tolerance: float,
    iterations: int,
    out: Floats,
    pairs: Counts,
) -> None:
    """Write the groups' shifts to `out` (R, G), and to `pairs` (R, 2) the spots that overlap.

    Starts at shifts `starts` (R, G); `halves` (R, S) are the spots' half widths. NaN where the
    fit does not end, an amplitude is not positive, or a shift goes further than a spot's width
    from its start or a spot off the line.
    """
    spots = places.size
    kinds = starts.shape[1]
    matrix = np.empty((spots + kinds, spots + kinds))
    right = np.empty(spots + kinds)
    column = np.empty(spots, dtype=np.int64)
    shifts = np.empty(kinds)
    length = lines.shape[1]
    for r in range(len(lines)):
        out[r] = np.nan
        pairs[r] = -1
        if not np.isfinite(starts[r]).all():
            continue
        copy_row(starts[r], shifts)
        good = True
        for _ in range(2):  # the peaks that overlap, as at the start and then as fitted
            first, second = image_type(places, groups, halves[r], shifts, overlap)
            if first == pairs[r, 0] and second == pairs[r, 1] and not math.isnan(out[r, 0]):
                break
            pairs[r, 0] = first
            pairs[r, 1] = second
            count = 0
            for i in range(spots):
                column[i] = column[first] if i == second else count
                count += i != second
            found = np.empty(count + kinds)
            for i in range(spots):
                at = round(places[i] + shifts[groups[i]])
                found[column[i]] = lines[r, min(max(at, 0), length - 1)] - floors[r]
            copy_row(shifts, found[count:])
            good = _iterate(
                lines[r],
                floors[r],
                places,
                groups,
                halves[r],
                column,
                kind,
                c,
                tolerance,
                iterations,
                found,
                matrix,
                right,
            )
            for i in range(spots):
                at = places[i] + found[count + groups[i]]
                good = good and found[column[i]] > 0 and -0.5 <= at <= length - 0.5
            if not good:
                break
            copy_row(found[count:], shifts)
            copy_row(shifts, out[r])
        if not good:
            out[r] = np.nan


def number_items(image: str) -> Any:
    """Return an image's number by its name."""
    return {"rational": RATIONAL, "gaussian": GAUSSIAN, "diffraction": DIFFRACTION}[image]

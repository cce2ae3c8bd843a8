"""Compiled diffraction of rectangles: running integrals of slits, cell by cell.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.copies import copy_row
from benchmark.simulator.kernels.fresnel import between_nodes, cubic_shares, is_inside

Complex = tuple[float, float]
Four = tuple[float, float, float, float]
Three = tuple[float, float, float]
#: (4, R, M) running integrals of slit patterns, of a thin foil, how a thick one differs, what a
#: bend adds, and edges at two depths (`slit_integrals`); the first row's Fresnel number, rows a
#: unit of it, and steps a half width.
Slits = tuple[Floats, float, float, float]


@compiled
def _blended_row(out: Floats, slits: Slits, number: float, shares: Three) -> None:
    """Interpolate running integrals for this Fresnel number, within the table's.

    As far to either side of the slit's middle, where they are 0, as `out` (odd) is long. `shares`
    are a thick foil's softness, the bend a half width, and by how much J differs at the edges.
    """
    both, first_number, per_row, _ = slits
    sums, soft, bent, apart = both[0], both[1], both[2], both[3]
    place = min(max((number - first_number) * per_row, 0.0), sums.shape[0] - 1.0)
    first = min(max(int(place), 1), sums.shape[0] - 3)
    a, b, c, d = cubic_shares(place - first)
    middle = out.shape[0] // 2
    one, two, three, four = sums[first - 1], sums[first], sums[first + 1], sums[first + 2]
    for i in range(middle + 1):
        odd = a * one[i] + b * two[i] + c * three[i] + d * four[i]
        out[middle - i], out[middle + i] = -odd, odd
    if shares[0] != 0.0:
        one, two, three, four = soft[first - 1], soft[first], soft[first + 1], soft[first + 2]
        for i in range(middle + 1):
            odd = shares[0] * (a * one[i] + b * two[i] + c * three[i] + d * four[i])
            out[middle - i] -= odd
            out[middle + i] += odd
    for table, share in ((bent, shares[1]), (apart, shares[2])):
        if share == 0.0:
            continue
        one, two, three, four = table[first - 1], table[first], table[first + 1], table[first + 2]
        for i in range(1, middle + 1):
            even = share * (a * one[i] + b * two[i] + c * three[i] + d * four[i])
            out[middle - i] += even
            out[middle + i] += even


@compiled
def _means(  # noqa: PLR0917 - Numba takes no keyword-only ones
    out: Floats, row: Floats, scale: Four, cells: Complex, weight: float, work: Floats
) -> None:
    """Add a pattern's means over cells, times a weight.

    Parameters
    ----------
    out
        (M,) cells.
    row
        Running integral in half widths, from one far side to the other.
    scale
        Half width, how far the middle of the slit is filled evenly, steps a half width, and how
        the pattern is bent: half the second derivative of the landing point over J squared.
    cells
        Edge of the first, seen from the slit's middle, and their size.
    weight
        Of the means.
    work
        (2, M + 1 or more), overwritten.
    """
    half, gap, per, bend = scale
    start, size = cells
    values, places = work[0], work[1]
    last = row.shape[0] - 1
    middle = last // 2
    horizon = 0.5 / bend if bend != 0.0 else 0.0
    # in three loops: the look-up cannot be vectorised, the arithmetic can
    for i in range(out.shape[0] + 1):
        place = start + i * size
        # no light from so far out: it would have to come in below the horizon
        place = horizon if 2.0 * bend * place > 1.0 else place
        # far away patterns keep their shape in direction cosines; edges stay where they are
        place -= bend * place * place
        values[i] = min(max(place, -gap), gap)
        steps = np.true_divide(place - values[i], half) * per + middle
        places[i] = min(max(steps, 0.0), 2.0 * middle)
    for i in range(out.shape[0] + 1):
        cell = int(places[i])
        below = row[cell]
        share = (places[i] - cell) * (row[min(cell + 1, last)] - below)
        values[i] += half * (below + share)
    for i in range(out.shape[0]):
        out[i] += np.true_divide(weight * (values[i + 1] - values[i]), size)


@compiled
def _turning(number: float) -> float:
    """How far a pattern of this Fresnel number is turning, not shadow (`RoundPattern.share`)."""
    return 1.0 / (1.0 + (number / 0.42) ** 2)


@compiled
def _used(far: float, slits: Slits) -> int:
    """How many of a row's values are read as far as this from the middle, in half widths."""
    used: int = min(max(int(far * slits[3]), 1) + 3, slits[0].shape[2])
    return 2 * used - 1


@compiled
def _products(
    out: Floats, sample: Floats, spectrum: Floats, disc: Floats, widths: tuple[Slits, Slits]
) -> None:
    """Add the light of one rectangle to cells along its sides.

    Parameters
    ----------
    out
        (rows, columns) of cells.
    sample
        (17,) light; where the spot's middle is from the first cell's corner, along both sides;
        half sizes; change of the landing point a unit of direction cosine; the image of the unit
        disc: its semi-axis, shear and height; how the patterns are bent; a
        thick foil's share; how J differs at the edges; cell size.
    spectrum
        (L, 2) wavelengths in mm and weights.
    disc
        (S, P, 3) nodes in the unit disc, all of a strip at one height: across, height, weight.
    widths
        Patterns across and along.
    """
    rows, columns = out.shape
    strips = disc.shape[0]
    light, x0, y0, a, b, spread_x, spread_y, wide, shear, high, bend_x, bend_y = sample[:12]
    soft_x, soft_y, apart_x, apart_y, cell = sample[12:17]
    count = spectrum.shape[0] * strips
    across, along = np.zeros((count, columns)), np.zeros((count, rows))
    all_x = np.empty(2 * widths[0][0].shape[2] - 1)
    all_y = np.empty(2 * widths[1][0].shape[2] - 1)
    work = np.empty((2, max(rows, columns) + 1))
    far_x = max(abs(x0), abs(columns * cell - x0)) + wide + abs(shear)
    far_y = max(abs(y0), abs(rows * cell - y0)) + high
    far_x += abs(bend_x) * far_x * far_x
    far_y += abs(bend_y) * far_y * far_y
    most_x = widths[0][1] + (widths[0][0].shape[1] - 1) / widths[0][2]
    most_y = widths[1][1] + (widths[1][0].shape[1] - 1) / widths[1][2]
    for m in range(spectrum.shape[0]):
        wave, share = spectrum[m]
        number_x, number_y = a * a / (wave * spread_x), b * b / (wave * spread_y)
        # a wide slit is two edges of a narrower one, further apart
        half_x = a * math.sqrt(min(1.0, most_x / number_x))
        half_y = b * math.sqrt(min(1.0, most_y / number_y))
        # as far as they are read
        used_x = _used((far_x - a + half_x) / half_x, widths[0])
        used_y = _used((far_y - b + half_y) / half_y, widths[1])
        row_x, row_y = all_x[:used_x], all_y[:used_y]
        _blended_row(row_x, widths[0], number_x, (soft_x, bend_x * half_x, apart_x))
        _blended_row(row_y, widths[1], number_y, (soft_y, bend_y * half_y, apart_y))
        scale_x = half_x, a - half_x, widths[0][3], bend_x * _turning(number_x)
        scale_y = half_y, b - half_y, widths[1][3], bend_y * _turning(number_y)
        for j in range(strips):
            k = m * strips + j
            up = disc[j, 0, 1]
            _means(along[k], row_y, scale_y, (-y0 - high * up, cell), share * light, work)
            for i in range(disc.shape[1]):
                right = wide * disc[j, i, 0] + shear * up
                _means(across[k], row_x, scale_x, (-x0 - right, cell), disc[j, i, 2], work)
    for row in range(rows):
        line = out[row]
        # four at a time, one after another: what is added to stays at hand
        for k in range(0, count - 3, 4):
            a, b, c, d = along[k, row], along[k + 1, row], along[k + 2, row], along[k + 3, row]
            one, two, three, four = across[k], across[k + 1], across[k + 2], across[k + 3]
            for column in range(columns):
                more = line[column] + a * one[column] + b * two[column]
                line[column] = more + c * three[column] + d * four[column]
        for k in range(count - count % 4, count):
            here, there = along[k, row], across[k]
            for column in range(columns):
                line[column] += here * there[column]


@compiled
def _cubic(table: Floats, x: float, y: float) -> float:
    """Value of a (rows, columns) table at column x, row y (Lagrange's cubic); 0 outside."""
    if not is_inside(table, x, y):
        return 0.0
    column, row = math.floor(x), math.floor(y)
    return between_nodes(table, (column, row), cubic_shares(x - column), cubic_shares(y - row))


@compiled
def _of_cells(fine: Floats, at: Complex, turn: Complex, cells: tuple[float, int]) -> float:
    """Mean of cells over a pixel about a place, mm, turned against them by cosine and sine."""
    cell, steps = cells
    c, s = turn
    total = 0.0
    for i in range(steps):
        up = (i + 0.5 - steps / 2.0) * cell
        for j in range(steps):
            right = (j + 0.5 - steps / 2.0) * cell
            x, y = at[0] + c * right + s * up, at[1] + c * up - s * right
            total += _cubic(fine, x / cell - 0.5, y / cell - 0.5)
    return total / (steps * steps)


@compiled
def add_rectangle(
    flux: Floats,
    samples: tuple[Floats, Floats],
    optics: tuple[Floats, Floats, Floats],
    widths: tuple[Slits, Slits],
) -> None:
    """Add the products of two slits' light behind one rectangle to frames (see `add_corners`).

    Parameters
    ----------
    flux
        (N, H, W) light averaged over each pixel.
    samples
        (N, 2) middle of the spot seen from the window's first corner, mm; (N, 14) light, half
        sizes, change of the landing point a unit of direction cosine, the image of the unit disc
        (semi-axis, shear, height), how patterns are bent (a mm), a thick foil's share,
        and how much larger J is at the edges of positive coordinates, in all across and along.
    optics
        (4,) cosine and sine of the rectangle's turn, pixel pitch in mm, cells a pixel;
        (L, 2) wavelengths in mm and weights; (S, P, 3) nodes of the disc.
    widths
        Patterns across and along.
    """
    middles, shapes = samples
    turn, spectrum, disc = optics
    c, s, pitch, cells = turn
    turned = s != 0.0
    count, rows, columns = flux.shape
    cell = pitch / cells
    wide = math.ceil((abs(c) * columns + abs(s) * rows) * cells) + 8
    tall = math.ceil((abs(s) * columns + abs(c) * rows) * cells) + 8
    fine = np.empty((tall, wide)) if turned else np.empty((1, 1))
    sample = np.empty(17)
    for n in range(count):
        light, a, b = shapes[n, 0], shapes[n, 1], shapes[n, 2]
        if light == 0.0 or a <= 0.0 or b <= 0.0:
            continue
        sample[0] = light
        copy_row(shapes[n, 1:14], sample[3:16])
        x, y = middles[n]
        if turned:
            # the window's middle stands in the middle of the cells
            dx, dy = columns * pitch / 2.0 - x, rows * pitch / 2.0 - y
            mid_x, mid_y = c * dx + s * dy, c * dy - s * dx
            sample[1], sample[2] = wide * cell / 2.0 - mid_x, tall * cell / 2.0 - mid_y
            sample[16] = cell
            fine[:] = 0.0
            _products(fine, sample, spectrum, disc, widths)
        else:
            sample[1], sample[2], sample[16] = x, y, pitch
            _products(flux[n], sample, spectrum, disc, widths)
        steps = int(cells)
        for row in range(rows if turned else 0):
            for column in range(columns):
                dx, dy = (column + 0.5) * pitch - x, (row + 0.5) * pitch - y
                at = c * dx + s * dy + sample[1], c * dy - s * dx + sample[2]
                flux[n, row, column] += _of_cells(fine, at, (c, s), (cell, steps))

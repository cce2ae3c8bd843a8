"""Compiled diffraction of round apertures: frames looked up in tables.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.copies import copy_matrix, copy_row
from benchmark.simulator.kernels.fresnel import cubic_shares

Four = tuple[float, float, float, float]
Rays = tuple[float, float, float]
Sizes = tuple[Floats, Floats, Floats]
Integers = NDArray[np.int64]
Singles = NDArray[np.float32]

#: Points that are looked up together.
_W = 16


@compiled
def _blend(out: Floats, tables: Floats, place: float, slope: float) -> None:
    """Interpolate (T, ...) tables at a node coordinate by Lagrange's cubic.

    It is `place` in the middle row and grows by `slope` a row; below 0 light comes from the other
    side, and tables are turned round.
    """
    middle, last = (out.shape[0] - 1) / 2.0, tables.shape[0] - 1.0
    for row in range(out.shape[0]):
        there = place + slope * (row - middle)
        seen = row if there >= 0.0 else out.shape[0] - 1 - row
        here = min(abs(there), last)
        first = min(max(int(here), 1), tables.shape[0] - 3)
        a, b, c, d = cubic_shares(here - first)
        one, two = tables[first - 1], tables[first]
        three, four = tables[first + 1], tables[first + 2]
        for column in range(out.shape[1]):
            out[row, column] = (
                a * one[seen, column]
                + b * two[seen, column]
                + c * three[seen, column]
                + d * four[seen, column]
            )


@compiled
def _look(work: Floats, y: float, weight: float, way: Floats, last: int) -> None:
    """Find where tables hold the light at points of a line, and with which weights.

    `work` (13 W,) has first the points' x from the aperture; it is given the places' rows and
    columns, weights of four rows and of four columns (`cubic_shares`), a factor of the light and by
    how much it falls beyond the table, with the cube of the distance, as Airy's envelope does.
    `last` column of the table. Nothing is decided point by point: the compiler takes several at a
    time.
    """
    e, f, chief, row_step, column_step = way[0], way[1], way[2], way[3], way[4]
    c0, c1, c2, c3, c4 = way[5], way[6], way[7], way[8], way[9]
    limit = last - 2.0
    for k in range(_W):
        x = work[k]
        along = e * x + f * y - chief
        across = e * y - f * x
        row = (along + c0 + c1 * along * along + c2 * across * across) * row_step
        column = abs(across * max(1.0 + c3 * along, 0.0) * column_step)
        outside = max(np.true_divide(max(abs(row), column), limit), 1.0)
        row, column = np.true_divide(row, outside), np.true_divide(column, outside)
        first, second = np.floor(row), np.floor(column)
        t, u = row - first, column - second
        work[_W + k] = first
        work[2 * _W + k] = second
        work[3 * _W + k] = -t * (t - 1.0) * (t - 2.0) / 6.0
        work[4 * _W + k] = (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0
        work[5 * _W + k] = -(t + 1.0) * t * (t - 2.0) / 2.0
        work[6 * _W + k] = (t + 1.0) * t * (t - 1.0) / 6.0
        work[7 * _W + k] = -u * (u - 1.0) * (u - 2.0) / 6.0
        work[8 * _W + k] = (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0
        work[9 * _W + k] = -(u + 1.0) * u * (u - 2.0) / 2.0
        work[10 * _W + k] = (u + 1.0) * u * (u - 1.0) / 6.0
        work[11 * _W + k] = max(1.0 + c4 * along, 0.0) * weight
        work[12 * _W + k] = np.true_divide(1.0, outside * outside * outside)


@compiled
def _add_looked_up(total: Floats, table: Floats, work: Floats) -> None:
    """Add to (W or fewer,) what a half-plane table holds at the places of `_look`."""
    middle = table.shape[1] - 1
    one, two = np.uintp(1), np.uintp(2)
    for k in range(total.shape[0]):
        # without a sign: an index that cannot be below 0
        column = int(work[2 * _W + k])
        i, j = np.uintp(int(work[_W + k]) + middle - 1), np.uintp(column)
        before = np.uintp(abs(column - 1))
        a, b, c, d = work[7 * _W + k], work[8 * _W + k], work[9 * _W + k], work[10 * _W + k]
        light = 0.0
        for row in range(4):
            line = a * table[i, before] + b * table[i, j]
            line += c * table[i, j + one] + d * table[i, j + two]
            light += work[(3 + row) * _W + k] * line
            i += one
        total[k] += work[11 * _W + k] * (work[12 * _W + k] * light)


@compiled
def _way(sun: Floats, numbers: Floats, layers: Floats) -> Floats:
    """Return what `_look` needs of one sample.

    Azimuth (2), where the chief ray lands, steps a mm (2), ``c_0`` to ``c_4`` of
    `RoundPattern.seen`.
    """
    way = np.empty(10)
    sx, sy, _ = sun
    sine = math.sqrt(sx * sx + sy * sy)
    way[0], way[1] = (sx / sine, sy / sine) if sine > 0.0 else (1.0, 0.0)
    across, along = 0.0, 0.0
    for m in range(layers.shape[0]):
        square = layers[m, 1] ** 2 - sine * sine
        share = layers[m, 0] / math.sqrt(square)
        across += share
        along += share * layers[m, 1] ** 2 / square
    way[2] = sine * across
    way[3], way[4] = numbers[2] / along, numbers[3] / across
    copy_row(numbers[4:9], way[5:])
    return way


@compiled
def add_round(
    flux: Floats,
    tables: Floats,
    samples: tuple[Floats, Floats, Floats],
    optics: tuple[Floats, Floats],
) -> None:
    """Add the light behind round apertures of one size to frames.

    Parameters
    ----------
    flux
        (N, H, W) light averaged over each pixel.
    tables
        (T, 2 n + 1, n + 1) of `RoundPattern`.
    samples
        (N, 3) unit vectors to the Sun; light of a fully lit pixel times the tables' unit,
        coordinate among the tables, steps a unit of direction cosine along and across, and the six
        of `RoundPattern.seen`, together (N, 10); (N, A, 2) centres of the apertures, mm, seen from
        the window's first corner.
    optics
        (L, 2) thickness and index from the aperture down, the empty gap first; (Q, 2) nodes in a
        pixel, mm from its first edge, and their weights (sum 1).
    """
    suns, numbers, places = samples
    layers, nodes = optics
    count, rows, columns = flux.shape
    pitch = nodes[0, 0] + nodes[-1, 0]
    table = np.empty(tables.shape[1:])
    work, total = np.zeros(13 * _W), np.empty((1, _W))
    for n in range(count):
        if numbers[n, 0] == 0.0:
            continue
        way = _way(suns[n], numbers[n], layers)
        _blend(table, tables, numbers[n, 1], numbers[n, 9] / way[3])
        for m in range(places.shape[1]):
            for row in range(rows):
                y = row * pitch - places[n, m, 1]
                for start in range(0, columns, _W):
                    line = start * pitch - places[n, m, 0], y, pitch
                    _pixels(total, (table, table, table), line, (nodes, way), work)
                    for k in range(min(_W, columns - start)):
                        flux[n, row, start + k] += numbers[n, 0] * max(total[0, k], 0.0)


@compiled
def _pixels(
    total: Floats, tables: Sizes, line: Rays, seen: tuple[Floats, Floats], work: Floats
) -> None:
    """Write means (S, W or fewer) of the first S tables over pixels of a row.

    `line` is the first pixel's first corner, x and y from the hole, and the pixels' distance.
    """
    left, top, step = line
    nodes, way = seen
    total[:] = 0.0
    for i in range(nodes.shape[0]):
        for j in range(nodes.shape[0]):
            for k in range(_W):
                work[k] = k * step + nodes[j, 0] + left
            weight = nodes[i, 1] * nodes[j, 1]
            _look(work, top + nodes[i, 0], weight, way, tables[0].shape[1] - 1)
            _add_looked_up(total[0], tables[0], work)
            if total.shape[0] > 1:
                _add_looked_up(total[1], tables[1], work)
                _add_looked_up(total[2], tables[2], work)


@compiled
def _lit_columns(y: float, hole_x: float, way: Floats, reach: Floats) -> tuple[float, float]:
    """Return from where to where a row `y` below a hole lies in its spot's ellipse; 0 to 0 for not.

    Of a quadratic form in x, which is below 1 within.
    """
    ex, ey, chief = way[0], way[1], way[2]
    turn = (ex / reach[0]) ** 2 + (ey / reach[1]) ** 2
    past = ey * y - chief
    middle = (ex * ey * y / reach[1] ** 2 - ex * past / reach[0] ** 2) / turn
    rest = 1.0 - (past / reach[0]) ** 2 - (ex * y / reach[1]) ** 2
    square = middle * middle + rest / turn
    if square <= 0.0:
        return 0.0, 0.0
    half = math.sqrt(square)
    return hole_x + middle - half, hole_x + middle + half


@compiled
def add_spots(
    frame: Floats,
    tables: Sizes,
    sample: tuple[Floats, Floats, Floats],
    apertures: tuple[Floats, Integers],
    optics: tuple[Floats, Floats],
) -> None:
    """Add the light of many round apertures to one frame, each within an ellipse about its spot.

    Parameters
    ----------
    frame
        (H, W), added to: light averaged over each pixel.
    tables
        Three of (T, 2 n + 1, n + 1), of `RoundPattern`, of holes of different sizes.
    sample
        (3,) to the Sun; (10,) as of `add_round`; (2,) half axes of the ellipse along and across the
        plane of incidence, mm.
    apertures
        (A, 6) centre, mm, seen from the frame's first corner, the light it passes, and the three
        tables' shares in its own; (A, 4) boxes of pixels around the ellipses: first and past-last
        column and row.
    optics
        (L, 2) thickness and index from the aperture down, the empty gap first; (Q, 2) nodes in a
        pixel as of `add_round`.
    """
    sun, numbers, reach = sample
    holes, boxes = apertures
    layers, nodes = optics
    pitch = nodes[0, 0] + nodes[-1, 0]
    way = _way(sun, numbers, layers)
    one, two, three = _blended_sizes(tables, numbers[1], numbers[9] / way[3])
    shape = tables[0].shape[1:]
    table, work, total = np.empty(shape), np.zeros(13 * _W), np.empty((1, _W))
    for m in range(boxes.shape[0]):
        left, right, top, bottom = boxes[m]
        a, b, c = holes[m, 3], holes[m, 4], holes[m, 5]
        for i in range(shape[0]):
            for j in range(shape[1]):
                table[i, j] = a * one[i, j] + b * two[i, j] + c * three[i, j]
        for row in range(top, bottom):
            ends = _lit_columns((row + 0.5) * pitch - holes[m, 1], holes[m, 0], way, reach)
            first = max(left, math.floor(ends[0] / pitch))
            last = min(right, math.ceil(ends[1] / pitch))
            for start in range(first, last, _W):
                line = start * pitch - holes[m, 0], row * pitch - holes[m, 1], pitch
                count = min(_W, last - start)
                _pixels(total[:, :count], (table, table, table), line, (nodes, way), work)
                for k in range(count):
                    frame[row, start + k] += numbers[0] * holes[m, 2] * max(total[0, k], 0.0)


@compiled
def _blended_sizes(tables: Sizes, place: float, slope: float) -> Sizes:
    """`_blend` of each."""
    shape = tables[0].shape[1:]
    one, two, three = np.empty(shape), np.empty(shape), np.empty(shape)
    _blend(one, tables[0], place, slope)
    _blend(two, tables[1], place, slope)
    _blend(three, tables[2], place, slope)
    return one, two, three


@compiled
def _six_shares(fraction: float, out: Floats) -> None:
    """Weights of the six nodes -2 to 3 in Lagrange's quintic through them."""
    t = fraction
    a, b, c, d, e, f = t + 2.0, t + 1.0, t, t - 1.0, t - 2.0, t - 3.0
    out[0] = -b * c * d * e * f / 120.0
    out[1] = a * c * d * e * f / 24.0
    out[2] = -a * b * d * e * f / 12.0
    out[3] = a * b * c * e * f / 12.0
    out[4] = -a * b * c * d * f / 24.0
    out[5] = a * b * c * d * e / 120.0


@compiled
def _lattice(tables: Sizes, way: Floats, reach: Floats, nodes: Floats, corner: Rays) -> Singles:
    """(3, Y, X) means of each table over a pixel about each point of a lattice around a spot.

    `corner` is the first point, x and y from the hole, and the points' distance. In single
    precision, 1e-7 of the peak: every hole reads all of it.
    """
    left, top, spacing = corner
    ex, ey, chief = way[0], way[1], way[2]
    half = 0.5 * (nodes[0, 0] + nodes[-1, 0])
    # a pixel at the ellipse's end may lie outside by its own size
    far = 2.0 * half + 4.0 * spacing
    width = math.ceil(2.0 * (chief * ex - left) / spacing) + 2
    height = math.ceil(2.0 * (chief * ey - top) / spacing) + 2
    out = np.zeros((3, height, width), dtype=np.float32)
    work, total = np.zeros(13 * _W), np.empty((3, _W))
    for row in range(height):
        y = top + row * spacing
        for start in range(0, width, _W):
            count, lit = min(_W, width - start), False
            for k in range(count):
                x = left + (start + k) * spacing
                past, beside = ex * x + ey * y - chief, ex * y - ey * x
                lit |= (past / (reach[0] + far)) ** 2 + (beside / (reach[1] + far)) ** 2 <= 1.0
            if lit:
                line = left + start * spacing - half, y - half, spacing
                _pixels(total, tables, line, (nodes, way), work)
                copy_matrix(total[:, :count], out[:, row, start : start + count])
    return out


@compiled
def add_spots_alike(
    frame: Floats,
    tables: Sizes,
    sample: tuple[Floats, Floats, Floats],
    apertures: tuple[Floats, Integers],
    optics: tuple[Floats, Floats, int],
) -> None:
    """`add_spots` for many holes: looked up once, on a lattice.

    The mean over a pixel about a point is the same for every hole, seen from its middle; where a
    hole's pixels lie between the points, along both axes alike, it is interpolated. `optics` has
    one number more, points of the lattice a pixel.
    """
    sun, numbers, reach = sample
    holes, boxes = apertures
    layers, nodes, steps = optics
    pitch = nodes[0, 0] + nodes[-1, 0]
    spacing = pitch / steps
    way = _way(sun, numbers, layers)
    far = pitch + 5.0 * spacing
    wide = math.sqrt((reach[0] * way[0]) ** 2 + (reach[1] * way[1]) ** 2) + far
    high = math.sqrt((reach[0] * way[1]) ** 2 + (reach[1] * way[0]) ** 2) + far
    corner = way[2] * way[0] - wide, way[2] * way[1] - high, spacing
    sizes = _blended_sizes(tables, numbers[1], numbers[9] / way[3])
    lattice = _lattice(sizes, way, reach, nodes, corner)
    down, over = np.empty(6), np.empty(6)
    shares = np.empty((3, 6), dtype=np.float32)
    line = np.empty(lattice.shape[2], dtype=np.float32)
    for m in range(boxes.shape[0]):
        left, right, top, bottom = boxes[m]
        # of the frame's first pixel on the lattice; all others are whole points further
        beside = (0.5 * pitch - holes[m, 0] - corner[0]) / spacing
        below = (0.5 * pitch - holes[m, 1] - corner[1]) / spacing
        first_column, first_row = math.floor(beside), math.floor(below)
        _six_shares(beside - first_column, over)
        _six_shares(below - first_row, down)
        for size in range(3):
            for k in range(6):
                shares[size, k] = holes[m, 3 + size] * down[k]
        a, b, c, d, e, f = over[0], over[1], over[2], over[3], over[4], over[5]
        for row in range(top, bottom):
            ends = _lit_columns((row + 0.5) * pitch - holes[m, 1], holes[m, 0], way, reach)
            first = max(left, math.floor(ends[0] / pitch))
            last = min(right, math.ceil(ends[1] / pitch))
            if last <= first:
                continue
            count = steps * (last - 1 - first) + 6
            level, begin = first_row + steps * row - 2, first_column + steps * first - 2
            end = begin + count
            line[:count] = 0.0
            for size in range(3):
                for k in range(0, 6, 3):
                    g, h, i = shares[size, k], shares[size, k + 1], shares[size, k + 2]
                    # sliced one by one: contiguous for the compiler
                    one = lattice[size, level + k, begin:end]
                    two = lattice[size, level + k + 1, begin:end]
                    three = lattice[size, level + k + 2, begin:end]
                    for j in range(count):
                        line[j] += g * one[j] + h * two[j] + i * three[j]
            for column in range(last - first):
                k = steps * column
                total = (a * line[k] + b * line[k + 1]) + (c * line[k + 2] + d * line[k + 3])
                total += e * line[k + 4] + f * line[k + 5]
                frame[row, first + column] += numbers[0] * holes[m, 2] * max(total, 0.0)

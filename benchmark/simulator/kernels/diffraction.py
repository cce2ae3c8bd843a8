"""Compiled diffraction of round apertures: frames looked up in tables.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Four = tuple[float, float, float, float]
Rays = tuple[float, float, float]
Sizes = tuple[Floats, Floats, Floats]
Integers = NDArray[np.int64]
Singles = NDArray[np.float32]


@compiled
def _shares(fraction: float) -> Four:
    """Weights of the four nodes -1, 0, 1, 2 in Lagrange's cubic through them."""
    t = fraction
    return (
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    )


@compiled
def _blended(out: Floats, tables: Floats, place: float, slope: float) -> None:
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
        a, b, c, d = _shares(here - first)
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
def _across(table: Floats, row: int, before: int, column: int, shares: Four) -> float:
    """Interpolate a row of a table between four columns, of which the first is `before`."""
    near = shares[0] * table[row, before] + shares[1] * table[row, column]
    return float(near + (shares[2] * table[row, column + 1] + shares[3] * table[row, column + 2]))


@compiled
def _looked_up(table: Floats, along: float, across: float) -> float:
    """Value of a half-plane table at steps (along, across) from its middle.

    Beyond its edge light falls with the cube of the distance, as Airy's envelope does.
    """
    reach = table.shape[1] - 1
    across = abs(across)
    fade, far = 1.0, max(abs(along), across)
    if far > reach - 2.0:
        outside = far / (reach - 2.0)
        fade = 1.0 / (outside * outside * outside)
        along, across = along / outside, across / outside
    row, column = math.floor(along), math.floor(across)
    t0, t1, t2, t3 = _shares(along - row)
    over = _shares(across - column)
    row += reach
    before = abs(column - 1)
    first = _across(table, row - 1, before, column, over)
    second = _across(table, row, before, column, over)
    third = _across(table, row + 1, before, column, over)
    fourth = _across(table, row + 2, before, column, over)
    return float(fade * (t0 * first + t1 * second + t2 * third + t3 * fourth))


@compiled
def _seen(x: float, y: float, way: Floats) -> Rays:
    """Place in the tables, in steps, of a point seen from an aperture, and a factor of its light.

    `way` is of `_way`.
    """
    along = way[0] * x + way[1] * y - way[2]
    across = way[0] * y - way[1] * x
    row = (along + way[5] + way[6] * along * along + way[7] * across * across) * way[3]
    column = across * max(1.0 + way[8] * along, 0.0) * way[4]
    return row, column, max(1.0 + way[9] * along, 0.0)


@compiled
def _way(sun: Floats, numbers: Floats, layers: Floats) -> Floats:
    """Return what `_seen` needs of one sample.

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
    way[5:] = numbers[4:9]
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
    for n in range(count):
        if numbers[n, 0] == 0.0:
            continue
        way = _way(suns[n], numbers[n], layers)
        _blended(table, tables, numbers[n, 1], numbers[n, 9] / way[3])
        for m in range(places.shape[1]):
            for row in range(rows):
                for column in range(columns):
                    total = 0.0
                    for i in range(nodes.shape[0]):
                        y = row * pitch + nodes[i, 0] - places[n, m, 1]
                        for j in range(nodes.shape[0]):
                            x = column * pitch + nodes[j, 0] - places[n, m, 0]
                            along, across, factor = _seen(x, y, way)
                            factor *= nodes[i, 1] * nodes[j, 1]
                            total += factor * _looked_up(table, along, across)
                    flux[n, row, column] += numbers[n, 0] * max(total, 0.0)


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
    table = np.empty(shape)
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
            for column in range(first, last):
                total = 0.0
                for i in range(nodes.shape[0]):
                    y = row * pitch + nodes[i, 0] - holes[m, 1]
                    for j in range(nodes.shape[0]):
                        x = column * pitch + nodes[j, 0] - holes[m, 0]
                        along, across, factor = _seen(x, y, way)
                        factor *= nodes[i, 1] * nodes[j, 1]
                        total += factor * _looked_up(table, along, across)
                frame[row, column] += numbers[0] * holes[m, 2] * max(total, 0.0)


@compiled
def _blended_sizes(tables: Sizes, place: float, slope: float) -> Sizes:
    """`_blended` of each."""
    shape = tables[0].shape[1:]
    one, two, three = np.empty(shape), np.empty(shape), np.empty(shape)
    _blended(one, tables[0], place, slope)
    _blended(two, tables[1], place, slope)
    _blended(three, tables[2], place, slope)
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
def _looked_up_sizes(tables: Sizes, along: float, across: float) -> Rays:
    """`_looked_up` of three tables at one place, found once."""
    small, drawn, large = tables
    reach = small.shape[1] - 1
    across = abs(across)
    fade, far = 1.0, max(abs(along), across)
    if far > reach - 2.0:
        outside = far / (reach - 2.0)
        fade = 1.0 / (outside * outside * outside)
        along, across = along / outside, across / outside
    first, column = math.floor(along), math.floor(across)
    down, over = _shares(along - first), _shares(across - column)
    before = abs(column - 1)
    one, two, three = 0.0, 0.0, 0.0
    for k in range(4):
        row, share = first + reach + k - 1, fade * down[k]
        one += share * _across(small, row, before, column, over)
        two += share * _across(drawn, row, before, column, over)
        three += share * _across(large, row, before, column, over)
    return one, two, three


@compiled
def _lattice(tables: Sizes, way: Floats, reach: Floats, nodes: Floats, corner: Rays) -> Singles:
    """(3, Y, X) means of each table over a pixel about each point of a lattice around a spot.

    `corner` is the first point, x and y from the hole, and the points' distance. In single
    precision, 1e-7 of the peak: every hole reads all of it.
    """
    left, top, spacing = corner
    ex, ey, chief = way[0], way[1], way[2]
    half = 0.5 * (nodes[0, 0] + nodes[-1, 0])
    # a pixel at the ellipse's end may lie outside by its own size, and is interpolated
    far = 2.0 * half + 4.0 * spacing
    width = math.ceil(2.0 * (chief * ex - left) / spacing) + 2
    height = math.ceil(2.0 * (chief * ey - top) / spacing) + 2
    out = np.zeros((3, height, width), dtype=np.float32)
    for row in range(height):
        for column in range(width):
            y, x = top + row * spacing, left + column * spacing
            past, beside = ex * x + ey * y - chief, ex * y - ey * x
            if (past / (reach[0] + far)) ** 2 + (beside / (reach[1] + far)) ** 2 > 1.0:
                continue
            one, two, three = 0.0, 0.0, 0.0
            for i in range(nodes.shape[0]):
                for j in range(nodes.shape[0]):
                    along, across, factor = _seen(
                        x + nodes[j, 0] - half, y + nodes[i, 0] - half, way
                    )
                    factor *= nodes[i, 1] * nodes[j, 1]
                    light = _looked_up_sizes(tables, along, across)
                    one += factor * light[0]
                    two += factor * light[1]
                    three += factor * light[2]
            out[0, row, column], out[1, row, column], out[2, row, column] = one, two, three
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

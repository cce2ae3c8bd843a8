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
Integers = NDArray[np.int64]


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
    u0, u1, u2, u3 = _shares(across - column)
    row += reach
    before = abs(column - 1)
    # written out: this is where the time goes
    first = u0 * table[row - 1, before] + u1 * table[row - 1, column]
    first += u2 * table[row - 1, column + 1] + u3 * table[row - 1, column + 2]
    second = u0 * table[row, before] + u1 * table[row, column]
    second += u2 * table[row, column + 1] + u3 * table[row, column + 2]
    third = u0 * table[row + 1, before] + u1 * table[row + 1, column]
    third += u2 * table[row + 1, column + 1] + u3 * table[row + 1, column + 2]
    fourth = u0 * table[row + 2, before] + u1 * table[row + 2, column]
    fourth += u2 * table[row + 2, column + 1] + u3 * table[row + 2, column + 2]
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
def add_spots(
    frame: Floats,
    tables: tuple[Floats, Floats],
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
        Two of (T, 2 n + 1, n + 1), of `RoundPattern`: of a smaller and of a larger hole.
    sample
        (3,) to the Sun; (10,) as of `add_round`; (2,) half axes of the ellipse along and across the
        plane of incidence, mm.
    apertures
        (A, 4) centre, mm, seen from the frame's first corner, where the hole lies between the
        smaller and the larger one, and the light it passes; (A, 4) boxes of pixels around the
        ellipses: first and past-last column and row.
    optics
        (L, 2) thickness and index from the aperture down, the empty gap first; (Q, 2) nodes in a
        pixel as of `add_round`.
    """
    sun, numbers, reach = sample
    holes, boxes = apertures
    layers, nodes = optics
    pitch = nodes[0, 0] + nodes[-1, 0]
    shape = tables[0].shape[1:]
    table, small, large = np.empty(shape), np.empty(shape), np.empty(shape)
    way = _way(sun, numbers, layers)
    _blended(small, tables[0], numbers[1], numbers[9] / way[3])
    _blended(large, tables[1], numbers[1], numbers[9] / way[3])
    ex, ey, chief = way[0], way[1], way[2]
    turn = (ex / reach[0]) ** 2 + (ey / reach[1]) ** 2
    for m in range(boxes.shape[0]):
        left, right, top, bottom = boxes[m]
        for i in range(shape[0]):
            for j in range(shape[1]):
                table[i, j] = small[i, j] + holes[m, 2] * (large[i, j] - small[i, j])
        for row in range(top, bottom):
            # columns within the ellipse: where a quadratic form in x stays below 1
            y = (row + 0.5) * pitch - holes[m, 1]
            past = ey * y - chief
            middle = (ex * ey * y / reach[1] ** 2 - ex * past / reach[0] ** 2) / turn
            rest = 1.0 - (past / reach[0]) ** 2 - (ex * y / reach[1]) ** 2
            square = middle * middle + rest / turn
            if square <= 0.0:
                continue
            half = math.sqrt(square)
            middle += holes[m, 0]
            first = max(left, math.floor((middle - half) / pitch))
            last = min(right, math.ceil((middle + half) / pitch))
            for column in range(first, last):
                total = 0.0
                for i in range(nodes.shape[0]):
                    y = row * pitch + nodes[i, 0] - holes[m, 1]
                    for j in range(nodes.shape[0]):
                        x = column * pitch + nodes[j, 0] - holes[m, 0]
                        along, across, factor = _seen(x, y, way)
                        factor *= nodes[i, 1] * nodes[j, 1]
                        total += factor * _looked_up(table, along, across)
                frame[row, column] += numbers[0] * holes[m, 3] * max(total, 0.0)

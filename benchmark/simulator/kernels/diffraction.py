"""Compiled diffraction of round apertures: tables, and frames looked up in them.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

Four = tuple[float, float, float, float]
Rays = tuple[float, float, float]


@compiled
def squared_sums(
    out: Floats, radial: Floats, sines: Floats, number: float, side_on: Floats
) -> None:
    """Write ``|sum_j exp(i pi N (x - q_j)^2) B_j(y)|^2`` for all x, y: (R, T).

    `side_on` (2, J, T) holds real and imaginary parts of B.
    """
    width = side_on.shape[2]
    real, imaginary = np.empty(width), np.empty(width)
    for row in range(out.shape[0]):
        real[:] = 0.0
        imaginary[:] = 0.0
        for j in range(sines.shape[0]):
            phase = math.pi * number * (radial[row] - sines[j]) ** 2
            c, s = math.cos(phase), math.sin(phase)
            first, second = side_on[0, j], side_on[1, j]
            for column in range(width):
                real[column] += c * first[column] - s * second[column]
                imaginary[column] += c * second[column] + s * first[column]
        for column in range(width):
            out[row, column] = real[column] ** 2 + imaginary[column] ** 2


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
def spread_over_sun(
    out: Floats, quadrant: Floats, shifts: Floats, weights: Floats, margin: int
) -> None:
    """Fill ``sum_k w_k G(v - v_k)`` on half the plane from one quadrant of a symmetric G.

    Parameters
    ----------
    out
        (2 n + 1, n + 1): along from -n to n, across from 0 to n.
    quadrant
        (n + margin + 1, n + margin + 1).
    shifts
        (K, 2) in steps of the grid, less than `margin` - 2.
    """
    size = 2 * margin + 1
    stencil = np.zeros((size, size))
    for k in range(weights.shape[0]):
        first, second = math.floor(-shifts[k, 0]), math.floor(-shifts[k, 1])
        along = _shares(-shifts[k, 0] - first)
        across = _shares(-shifts[k, 1] - second)
        for i in range(4):
            for j in range(4):
                place = margin + first + i - 1, margin + second + j - 1
                stencil[place] += weights[k] * along[i] * across[j]
    reach = out.shape[1] - 1
    for row in range(out.shape[0]):
        for column in range(out.shape[1]):
            total = 0.0
            for i in range(size):
                from_row = abs(row - reach + i - margin)
                for j in range(size):
                    total += stencil[i, j] * quadrant[from_row, abs(column + j - margin)]
            out[row, column] = total


@compiled
def _blended(out: Floats, tables: Floats, place: float) -> None:
    """Interpolate (T, ...) tables at the node coordinate `place` by Lagrange's cubic."""
    first = min(max(int(place), 1), tables.shape[0] - 3)
    a, b, c, d = _shares(place - first)
    one, two = tables[first - 1], tables[first]
    three, four = tables[first + 1], tables[first + 2]
    for row in range(out.shape[0]):
        for column in range(out.shape[1]):
            out[row, column] = (
                a * one[row, column]
                + b * two[row, column]
                + c * three[row, column]
                + d * four[row, column]
            )


@compiled
def _looked_up(table: Floats, along: float, across: float) -> float:
    """Value of a half-plane table at steps (along, across) from its middle.

    Beyond the table's edge it falls with the cube of the distance, as Airy's envelope does.
    """
    reach = table.shape[1] - 1
    across = abs(across)
    outside = max(abs(along), across) / (reach - 2.0)
    fade = 1.0
    if outside > 1.0:
        fade = 1.0 / (outside * outside * outside)
        along, across = along / outside, across / outside
    row, column = math.floor(along), math.floor(across)
    t0, t1, t2, t3 = _shares(along - row)
    u0, u1, u2, u3 = _shares(across - column)
    row += reach
    before = abs(column - 1)
    total = 0.0
    for i, share in ((-1, t0), (0, t1), (1, t2), (2, t3)):
        line = table[row + i]
        total += share * (
            u0 * line[before] + u1 * line[column] + u2 * line[column + 1] + u3 * line[column + 2]
        )
    return fade * total


@compiled
def _reach(sine: float, layers: Floats) -> Rays:
    """Where a ray lands at this sine of incidence: distance, its derivative, distance / sine.

    `layers` are rows (thickness, index), the empty gap first.
    """
    tangential, radial = 0.0, 0.0
    for m in range(layers.shape[0]):
        square = layers[m, 1] ** 2 - sine * sine
        share = layers[m, 0] / math.sqrt(square)
        tangential += share
        radial += share * layers[m, 1] ** 2 / square
    return sine * tangential, radial, tangential


@compiled
def _sine(distance: float, height: float, layers: Floats) -> float:
    """Sine of incidence of the ray that lands this far out (Newton on `_reach`)."""
    sine = distance / math.sqrt(distance * distance + height * height)
    for _ in range(30):
        found, slope, _ = _reach(sine, layers)
        step = (distance - found) / slope
        sine = min(sine + step, (sine + 1.0) / 2.0)
        if abs(step) < 1e-14:
            break
    return sine


@compiled
def _arriving(x: float, y: float, height: float, layers: Floats) -> Rays:
    """Direction cosines of the light from the aperture to (x, y), and what they spread by.

    The last is the cosine behind the aperture over ``J_r J_t``: how much of the light leaving it
    goes to a unit of the detector's area.
    """
    if layers.shape[0] == 1:
        scale = 1.0 / math.sqrt(x * x + y * y + height * height)
        cosine = height * scale
        square = cosine * cosine
        return x * scale, y * scale, square * cosine * scale * scale
    sine = _sine(math.sqrt(x * x + y * y), height, layers)
    _, slope, scale = _reach(sine, layers)
    return x / scale, y / scale, math.sqrt(1.0 - sine * sine) / (slope * scale)


@compiled
def add_round(
    flux: Floats,
    tables: Floats,
    samples: tuple[Floats, Floats, Floats],
    optics: tuple[Floats, Floats, bool],
) -> None:
    """Add the light behind round apertures of one size to frames.

    Parameters
    ----------
    flux
        (N, H, W) light averaged over each pixel.
    tables
        (T, 2 n + 1, n + 1) of `RoundPattern`.
    samples
        (N, 3) unit vectors to the Sun; (N, 4) light of a fully lit pixel times the tables' unit,
        coordinate among the tables, steps a unit of direction cosine along and across; (N, A, 2)
        centres of the apertures, mm, seen from the window's first corner.
    optics
        (L, 2) thickness and index from the aperture down, the empty gap first; (Q, 2) Gauss nodes
        in a pixel, mm from its first edge, and their weights (sum 1); whether positions are
        measured in direction cosines about the aperture, or in millimetres about the chief ray.
    """
    sun, numbers, places = samples
    layers, nodes, by_cosines = optics
    count, rows, columns = flux.shape
    pitch = nodes[0, 0] + nodes[-1, 0]
    height = 0.0
    for m in range(layers.shape[0]):
        height += layers[m, 0]
    table = np.empty(tables.shape[1:])
    for n in range(count):
        if numbers[n, 0] == 0.0:
            continue
        _blended(table, tables, numbers[n, 1])
        sx, sy, cosine = sun[n]
        sine = math.sqrt(sx * sx + sy * sy)
        ex, ey = (sx / sine, sy / sine) if sine > 0.0 else (1.0, 0.0)
        chief, radial, tangential = _reach(sine, layers)
        here = radial * tangential / cosine
        for m in range(places.shape[1]):
            for row in range(rows):
                for column in range(columns):
                    total = 0.0
                    for i in range(nodes.shape[0]):
                        y = row * pitch + nodes[i, 0] - places[n, m, 1]
                        for j in range(nodes.shape[0]):
                            x = column * pitch + nodes[j, 0] - places[n, m, 0]
                            weight = nodes[i, 1] * nodes[j, 1]
                            if by_cosines:
                                px, py, spreading = _arriving(x, y, height, layers)
                                weight *= here * spreading
                                px, py = px - sx, py - sy
                                along, across = ex * px + ey * py, ex * py - ey * px
                            else:
                                along = (ex * x + ey * y - chief) / radial
                                across = (ex * y - ey * x) / tangential
                            total += weight * _looked_up(
                                table, along * numbers[n, 2], across * numbers[n, 3]
                            )
                    flux[n, row, column] += numbers[n, 0] * max(total, 0.0)

"""Compiled parts of the tables of round apertures: `RoundPattern` is made of them.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from benchmark.simulator.kernels.fresnel import cubic_shares

Four = tuple[float, float, float, float]


@compiled
def squared_sums(
    out: Floats, radial: Floats, places: Floats, number: float, side_on: Floats
) -> None:
    """Write ``|sum_j (exp(i pi N (x - q_j)^2) + exp(i pi N (x + q_j)^2)) B_j(y)|^2``: (R, T).

    `places` (J,) are the q; `side_on` (2, J, T) holds real and imaginary parts of B.
    """
    width = side_on.shape[2]
    real, imaginary = np.empty(width), np.empty(width)
    for row in range(out.shape[0]):
        real[:] = 0.0
        imaginary[:] = 0.0
        for j in range(places.shape[0]):
            one = math.pi * number * (radial[row] - places[j]) ** 2
            two = math.pi * number * (radial[row] + places[j]) ** 2
            c, s = math.cos(one) + math.cos(two), math.sin(one) + math.sin(two)
            first, second = side_on[0, j], side_on[1, j]
            for column in range(width):
                real[column] += c * first[column] - s * second[column]
                imaginary[column] += c * second[column] + s * first[column]
        for column in range(width):
            out[row, column] = real[column] ** 2 + imaginary[column] ** 2


@compiled
def skewed_sums(
    out: tuple[Floats, Floats],
    radial: Floats,
    places: Floats,
    numbers: Floats,
    side_on: Floats,
) -> None:
    """Write what `squared_sums` does, and how it changes to first order.

    Parameters
    ----------
    out
        Two of (R, T); the second is odd along the radial axis.
    radial
        (R,) places.
    places
        (J,) distances of the pairs of strips from the middle.
    numbers
        (7,) Fresnel numbers along and across; what the cubic phase has along, and across; by which
        share J is larger on the positive side, along and across; half waves from a strip at which
        all that fades out.
    side_on
        (4, J + 1, T) real and imaginary parts of B, and of B with the square of the distance across
        in its integral; last of the strip over the middle.
    """
    light, skew = out
    along, across, third, beside, more, other, most = numbers
    width, middle = side_on.shape[2], side_on[:, places.shape[0]]
    sums = np.empty((4, width))
    for row in range(light.shape[0]):
        # the strip over the middle takes back the step between both sides
        rho = radial[row]
        phase, waves = math.pi * along * rho * rho, along * rho * rho / most
        real = math.exp(-waves * waves) * more * rho
        c, s = real * math.cos(phase), real * math.sin(phase)
        for column in range(width):
            sums[0, column] = 0.0
            sums[1, column] = 0.0
            sums[2, column] = c * middle[0, column] - s * middle[1, column]
            sums[3, column] = c * middle[1, column] + s * middle[0, column]
        for j in range(places.shape[0]):
            # of both strips of the pair: what multiplies B, its change, and the second integral
            c, s, real, imaginary, square, turned_square = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for side in (-1.0, 1.0):
                rho = radial[row] - side * places[j]
                phase = math.pi * along * rho * rho
                waves = along * rho * rho / most
                fade = math.exp(-waves * waves)
                cosine, sine = math.cos(phase), math.sin(phase)
                less = -fade * ((3.0 * third + beside) * rho + side * (more + other)) / 2.0
                slope = -fade * math.pi * along * rho * rho * (third * rho + side * more)
                bent = -fade * math.pi * across * (beside * rho + side * other)
                c += cosine
                s += sine
                real += less * cosine - slope * sine
                imaginary += less * sine + slope * cosine
                square -= bent * sine
                turned_square += bent * cosine
            # sliced one by one: contiguous for the compiler
            one, two, three, four = side_on[0, j], side_on[1, j], side_on[2, j], side_on[3, j]
            for column in range(width):
                f, g, h, k = one[column], two[column], three[column], four[column]
                sums[0, column] += c * f - s * g
                sums[1, column] += c * g + s * f
                sums[2, column] += (real * f - imaginary * g) + (square * h - turned_square * k)
                sums[3, column] += (real * g + imaginary * f) + (square * k + turned_square * h)
        for column in range(width):
            light[row, column] = sums[0, column] ** 2 + sums[1, column] ** 2
            skew[row, column] = 2.0 * (
                sums[0, column] * sums[2, column] + sums[1, column] * sums[3, column]
            )


@compiled
def strip_fields(
    out: Floats,
    strips: tuple[Floats, Floats, Floats, Floats, Floats],
    numbers: tuple[float, float],
    integrals: tuple[Floats, Floats, Floats, Floats],
) -> None:
    """Write the fields of strips across an opening, in closed form.

    Parameters
    ----------
    out
        (2 or 4, J, T): as of `benchmark.simulator.optics.diffraction.Strips`.
    strips
        (T,) places across; (J,) half heights, weights, and what rims take away, both parts.
    numbers
        ``sqrt(2 N_t)`` and N_t.
    integrals
        (J, T) Fresnel's S and C from the strips' lower ends, and from the upper ones.
    """
    places, heights, weights, lost, lost_turned = strips
    root, across = numbers
    s_below, c_below, s_above, c_above = integrals
    skewed, scale = out.shape[0] == 4, 2.0 * math.pi * across
    for j in range(heights.shape[0]):
        dimmed = lost[j] != 0.0 or lost_turned[j] != 0.0
        for column in range(places.shape[0]):
            real = weights[j] * (c_below[j, column] - c_above[j, column])
            imaginary = weights[j] * (s_below[j, column] - s_above[j, column])
            if skewed or dimmed:
                below, above = places[column] + heights[j], places[column] - heights[j]
                one = math.pi / 2.0 * (root * below) ** 2
                two = math.pi / 2.0 * (root * above) ** 2
                c_one, s_one = math.cos(one), math.sin(one)
                c_two, s_two = math.cos(two), math.sin(two)
                c, s = c_one + c_two, s_one + s_two
                real -= lost[j] * c - lost_turned[j] * s
                imaginary -= lost[j] * s + lost_turned[j] * c
            out[0, j, column], out[1, j, column] = real, imaginary
            if skewed:
                size = root * weights[j]
                c = size * (below * c_one - above * c_two) - real
                s = size * (below * s_one - above * s_two) - imaginary
                # over 2 i pi N_t
                out[2, j, column], out[3, j, column] = s / scale, -c / scale


@compiled
def turn(cosines: Floats, sines: Floats, argument: Floats) -> None:
    """Write ``exp(i pi u^2 / 2)`` of every argument u; (R, T) each."""
    for row in range(argument.shape[0]):
        for column in range(argument.shape[1]):
            phase = math.pi / 2.0 * argument[row, column] ** 2
            cosines[row, column] = math.cos(phase)
            sines[row, column] = math.sin(phase)


@compiled
def stencil(shifts: Floats, weights: Floats, cell: tuple[Floats, Floats], margin: int) -> Floats:
    """Weights (2 margin + 1, 2 margin + 1) of a grid's values around a node, by cubics.

    `shifts` (K, 2), in steps of the grid, `weights` (K,) of each; `cell` (C, 2) and (C,): every
    shift has all of these, less than `margin` - 2 together.
    """
    size = 2 * margin + 1
    found = np.zeros((size, size))
    places, shares = cell
    for k in range(weights.shape[0]):
        for m in range(shares.shape[0]):
            x, y = shifts[k, 0] + places[m, 0], shifts[k, 1] + places[m, 1]
            first, second = math.floor(-x), math.floor(-y)
            weight = weights[k] * shares[m]
            a, b, c, d = cubic_shares(-x - first)
            e, f, g, h = cubic_shares(-y - second)
            row, column = margin + first - 1, margin + second - 1
            for i, share in enumerate((a, b, c, d)):
                line = found[row + i]
                line[column] += weight * share * e
                line[column + 1] += weight * share * f
                line[column + 2] += weight * share * g
                line[column + 3] += weight * share * h
    return found

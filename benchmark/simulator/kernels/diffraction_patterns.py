"""Compiled parts of the tables of round apertures: `RoundPattern` is made of them.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

Four = tuple[float, float, float, float]


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
def skewed_sums(
    out: Floats, radial: Floats, strips: Floats, numbers: Floats, side_on: Floats
) -> None:
    """Write how `squared_sums` change to first order: (R, T).

    Parameters
    ----------
    out
        Odd along the radial axis.
    radial
        (R,) places.
    strips
        (2, J) places of the strips, and on which side of the opening each lies, -1 or 1.
    numbers
        (7,) Fresnel numbers along and across; what the cubic phase has along, and across; by which
        share J is larger on side 1, along and across; half waves from a strip at which all that
        fades out.
    side_on
        (4, J + 1, T) real and imaginary parts of B, and of B with the square of the distance
        across in its integral; last the strip over the middle.
    """
    along, across, third, beside, more, other, most = numbers
    width, count = side_on.shape[2], strips.shape[1]
    sums = np.empty((4, width))
    for row in range(out.shape[0]):
        sums[:] = 0.0
        for j in range(count + 1):
            # the last one takes back the step between both sides
            place = strips[0, j] if j < count else 0.0
            rho = radial[row] - place
            phase = math.pi * along * rho * rho
            waves = along * rho * rho / most
            fade = math.exp(-waves * waves)
            c, s = math.cos(phase), math.sin(phase)
            if j < count:
                side = strips[1, j]
                real = -fade * ((3.0 * third + beside) * rho + side * (more + other)) / 2.0
                slope = -fade * math.pi * along * rho * rho * (third * rho + side * more)
                square = -fade * math.pi * across * (beside * rho + side * other)
            else:
                real, slope, square = fade * more * radial[row], 0.0, 0.0
            first, second = side_on[0, j], side_on[1, j]
            third_part, fourth = side_on[2, j], side_on[3, j]
            keep = 1.0 if j < count else 0.0
            for column in range(width):
                a = c * first[column] - s * second[column]
                b = c * second[column] + s * first[column]
                sums[0, column] += keep * a
                sums[1, column] += keep * b
                sums[2, column] += real * a - slope * b
                sums[3, column] += real * b + slope * a
                a = c * third_part[column] - s * fourth[column]
                b = c * fourth[column] + s * third_part[column]
                sums[2, column] -= square * b
                sums[3, column] += square * a
        for column in range(width):
            out[row, column] = 2.0 * (
                sums[0, column] * sums[2, column] + sums[1, column] * sums[3, column]
            )


@compiled
def turned(cosines: Floats, sines: Floats, argument: Floats) -> None:
    """Write ``exp(i pi u^2 / 2)`` of every argument u; (R, T) each."""
    for row in range(argument.shape[0]):
        for column in range(argument.shape[1]):
            phase = math.pi / 2.0 * argument[row, column] ** 2
            cosines[row, column] = math.cos(phase)
            sines[row, column] = math.sin(phase)


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
def _stencil(shifts: Floats, weights: Floats, margin: int) -> Floats:
    """Weights (2 margin + 1, 2 margin + 1) of the grid's values around a node, by cubics."""
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
    return stencil


@compiled
def spread_over_sun(
    out: Floats, light: Floats, shifts: Floats, weights: Floats, margin: int
) -> None:
    """Fill ``sum_k w_k G(v - v_k)`` on half the plane, G even across.

    Parameters
    ----------
    out
        (2 n + 1, n + 1): along from -n to n, across from 0 to n.
    light
        (2 (n + margin) + 1, n + margin + 1) values of G as `out`.
    shifts
        (K, 2) in steps of the grid, less than `margin` - 2.
    """
    stencil = _stencil(shifts, weights, margin)
    size = stencil.shape[0]
    reach = out.shape[1] - 1
    # with its mirror image to the left, so that the innermost loop runs straight on
    side = np.empty((light.shape[0], light.shape[1] + margin))
    for row in range(light.shape[0]):
        for column in range(light.shape[1] + margin):
            side[row, column] = light[row, abs(column - margin)]
    out[:] = 0.0
    for row in range(out.shape[0]):
        to = out[row]
        for i in range(size):
            line = side[row + i]
            for j in range(size):
                weight = stencil[i, j]
                if weight != 0.0:
                    part = line[j : j + reach + 1]
                    for column in range(reach + 1):
                        to[column] += weight * part[column]

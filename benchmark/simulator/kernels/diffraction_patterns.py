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
    stencil = _stencil(shifts, weights, margin)
    size = stencil.shape[0]
    reach = out.shape[1] - 1
    # with its mirror image to the left, so that the innermost loop runs straight on
    side = np.empty((quadrant.shape[0], quadrant.shape[1] + margin))
    for row in range(quadrant.shape[0]):
        for column in range(quadrant.shape[1] + margin):
            side[row, column] = quadrant[row, abs(column - margin)]
    out[:] = 0.0
    for row in range(out.shape[0]):
        to = out[row]
        for i in range(size):
            line = side[abs(row - reach + i - margin)]
            for j in range(size):
                weight = stencil[i, j]
                if weight != 0.0:
                    part = line[j : j + reach + 1]
                    for column in range(reach + 1):
                        to[column] += weight * part[column]

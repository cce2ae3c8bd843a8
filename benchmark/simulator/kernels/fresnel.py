"""Compiled Fresnel integrals, and the cubic that tables are interpolated by.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

from algorithms.compiled import compiled
from algorithms.contract import Floats

Four = tuple[float, float, float, float]
#: (2, M) auxiliary functions of the Fresnel integrals from -1 step on, and steps a unit.
Table = tuple[Floats, float]


@compiled
def cubic_shares(fraction: float) -> Four:
    """Weights of the four nodes -1, 0, 1, 2 in Lagrange's cubic through them."""
    t = fraction
    return (
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    )


@compiled
def is_inside(table: Floats, x: float, y: float) -> bool:
    """Say whether (rows, columns) have all four nodes a side about column x, row y."""
    column, row = math.floor(x), math.floor(y)
    return bool(1 <= column <= table.shape[1] - 3 and 1 <= row <= table.shape[0] - 3)


@compiled
def between_nodes(table: Floats, at: tuple[int, int], along: Four, down: Four) -> float:
    """Sum of 4 x 4 values of (rows, columns) about a column and a row, by weights of both."""
    column, row = at
    a, b, c, d = along
    total = 0.0
    for i in range(4):
        line = table[row - 1 + i]
        total += down[i] * (
            a * line[column - 1] + b * line[column] + c * line[column + 1] + d * line[column + 2]
        )
    return total


@compiled
def fresnel(u: float, table: Table) -> Four:
    """Fresnel's C and S of u by their smooth auxiliary functions, and ``exp(i pi u^2 / 2)``.

    Beyond the table the asymptotic series is used.
    """
    auxiliary, per_unit = table
    size = abs(u)
    place = size * per_unit + 1.0
    if place < auxiliary.shape[1] - 3.0:
        first = int(place)
        a, b, c, d = cubic_shares(place - first)
        line = auxiliary[0]
        f = a * line[first - 1] + b * line[first] + c * line[first + 1] + d * line[first + 2]
        line = auxiliary[1]
        g = a * line[first - 1] + b * line[first] + c * line[first + 1] + d * line[first + 2]
    else:
        q = 1.0 / (math.pi * size * size) ** 2
        f = (1.0 - 3.0 * q) / (math.pi * size)
        g = (1.0 - 15.0 * q) / (math.pi * math.pi * size * size * size)
    phase = math.pi / 2.0 * size * size
    sine, cosine = math.sin(phase), math.cos(phase)
    re, im = 0.5 + f * sine - g * cosine, 0.5 - f * cosine - g * sine
    return (re, im, cosine, sine) if u >= 0.0 else (-re, -im, cosine, sine)

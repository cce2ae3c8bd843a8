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

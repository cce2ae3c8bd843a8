"""Compiled profiles of stray light, averaged over pixels (loaded on first use: Numba).

Only additions, products, quotients and square roots: the same numbers on every machine.
"""

from __future__ import annotations

import math

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Gauss nodes of a pixel along one axis, from its centre.
_NODE = 0.5 / math.sqrt(3.0)
#: Pixels farther from the image than this take the profile at their centre; with the profile's
#: fall by the cube of the distance r the error is 9 / (24 r^2) of the value there.
_FAR_PX = 24.0


@compiled
def add_aureole(frame: Floats, x: float, y: float, radius: float, share: float) -> None:
    """Add to a frame (H, W) the share of `flare.Aureole` light that each pixel gets."""
    peak = share / (2.0 * math.pi * radius * radius)
    scale = 1.0 / (radius * radius)
    rows, columns = frame.shape
    for row in range(rows):
        dy = row - y
        line = frame[row]
        for column in range(columns):
            dx = column - x
            base = 1.0 + (dx * dx + dy * dy) * scale
            line[column] += peak / (base * math.sqrt(base))
    left, right = max(math.ceil(x - _FAR_PX), 0), min(math.floor(x + _FAR_PX) + 1, columns)
    top, bottom = max(math.ceil(y - _FAR_PX), 0), min(math.floor(y + _FAR_PX) + 1, rows)
    for row in range(top, bottom):
        for column in range(left, right):
            dx, dy = column - x, row - y
            base = 1.0 + (dx * dx + dy * dy) * scale
            total = -1.0 / (base * math.sqrt(base))
            for sign_y in (-_NODE, _NODE):
                for sign_x in (-_NODE, _NODE):
                    u, v = dx + sign_x, dy + sign_y
                    base = 1.0 + (u * u + v * v) * scale
                    total += 0.25 / (base * math.sqrt(base))
            frame[row, column] += peak * total


@compiled
def add_disc(frame: Floats, x: float, y: float, radius: float, share: float) -> None:
    """Add an even disc of light; its rim is a ramp of one pixel."""
    level = share / (math.pi * radius * radius)
    rows, columns = frame.shape
    left, right = max(math.floor(x - radius), 0), min(math.ceil(x + radius) + 1, columns)
    top, bottom = max(math.floor(y - radius), 0), min(math.ceil(y + radius) + 1, rows)
    for row in range(top, bottom):
        for column in range(left, right):
            dx, dy = column - x, row - y
            inside = radius - math.sqrt(dx * dx + dy * dy) + 0.5
            frame[row, column] += level * min(max(inside, 0.0), 1.0)


@compiled
def add_streak(
    frame: Floats,
    centre: tuple[float, float],
    axis: tuple[float, float],
    size: tuple[float, float],
    share: float,
) -> None:
    """Add a product of Lorentz profiles: centre, axis, half widths along and across."""
    x, y = centre
    c, s = axis
    length, width = size
    peak = 0.25 * share / (math.pi * math.pi * length * width)
    rows, columns = frame.shape
    for sign_y in (-_NODE, _NODE):
        for sign_x in (-_NODE, _NODE):
            for row in range(rows):
                dy = row + sign_y - y
                for column in range(columns):
                    dx = column + sign_x - x
                    along, across = (c * dx + s * dy) / length, (c * dy - s * dx) / width
                    frame[row, column] += peak / ((1.0 + along * along) * (1.0 + across * across))

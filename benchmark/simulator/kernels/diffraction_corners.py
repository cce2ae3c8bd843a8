"""What the coupling of both axes adds at the corners of a rectangle: light from tables.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from benchmark.simulator.kernels.fresnel import between_nodes, cubic_shares, is_inside

Complex = tuple[float, float]
Four = tuple[float, float, float, float]


@compiled
def _corners(patches: Floats, tables: Floats, places: Complex) -> None:
    """Interpolate (K, M, M) patches at a place among (T, T, K, M, M) incidences (cubic)."""
    nodes = tables.shape[0]
    patches[:] = 0.0
    first = min(max(int(places[0]), 1), nodes - 3)
    other = min(max(int(places[1]), 1), nodes - 3)
    outer, inner = cubic_shares(places[0] - first), cubic_shares(places[1] - other)
    size = tables.shape[3]
    for i in range(4):
        for j in range(4):
            share = outer[i] * inner[j]
            table = tables[first - 1 + i, other - 1 + j]
            for kind in range(table.shape[0]):
                for row in range(size):
                    for column in range(size):
                        patches[kind, row, column] += share * table[kind, row, column]


@compiled
def _weights(fraction: float) -> Four:
    """Weights of the coefficients of a cubic B-spline at nodes -1, 0, 1, 2."""
    t, rest = fraction, 1.0 - fraction
    return (
        rest * rest * rest / 6.0,
        2.0 / 3.0 - t * t * (1.0 - 0.5 * t),
        2.0 / 3.0 - rest * rest * (1.0 - 0.5 * rest),
        t * t * t / 6.0,
    )


@compiled
def _spline(table: Floats, x: float, y: float) -> float:
    """Value of the spline of (rows, columns) coefficients at column x, row y; 0 outside."""
    if not is_inside(table, x, y):
        return 0.0
    column, row = math.floor(x), math.floor(y)
    return between_nodes(table, (column, row), _weights(x - column), _weights(y - row))


@compiled
def _add_in_rows(out: Floats, patch: Floats, first: Complex, steps: Complex) -> None:
    """Add a patch to (rows, columns) of pixels along its sides.

    `first` is the column and the row of the patch at the first pixel, `steps` those a pixel.
    """
    size, columns = patch.shape[0], out.shape[1]
    line = np.empty(size)
    # of every column once: where it reads the patch, and how its four nodes share
    places, weights = np.empty(columns, np.int64), np.empty((columns, 4))
    begin, end = columns, 0
    for column in range(columns):
        x = first[0] + column * steps[0]
        left = math.floor(x)
        places[column] = left
        if 1 <= left <= size - 3:
            begin, end = min(begin, column), column + 1
            a, b, c, d = _weights(x - left)
            weights[column, 0], weights[column, 1] = a, b
            weights[column, 2], weights[column, 3] = c, d
    for row in range(out.shape[0]):
        y = first[1] + row * steps[1]
        low = math.floor(y)
        if low < 1 or low > size - 3:
            continue
        a, b, c, d = _weights(y - low)
        for i in range(size):
            line[i] = (
                a * patch[low - 1, i]
                + b * patch[low, i]
                + c * patch[low + 1, i]
                + d * patch[low + 2, i]
            )
        for column in range(begin, end):
            left = places[column]
            total = weights[column, 0] * line[left - 1] + weights[column, 1] * line[left]
            total += weights[column, 2] * line[left + 1] + weights[column, 3] * line[left + 2]
            out[row, column] += total


@compiled
def _add_patch(out: Floats, patch: Floats, turn: Four, first: Four, ways: Four) -> None:
    """Add a patch to pixels.

    Parameters
    ----------
    out
        (rows, columns).
    patch
        (M, M).
    turn
        Cosine and sine of the rectangle's turn; steps of the patch a mm, across and along.
    first
        x and y of the first pixel's centre, seen from the spot's middle, mm; how far the patch
        stands from there, across and along its own ways, mm.
    ways
        Signs of its columns and rows; pixel pitch, mm.
    """
    c, s, unit_x, unit_y = turn
    x, y, off_x, off_y = first
    along_x, along_y, pitch, _ = ways
    along_x, along_y = along_x * unit_x, along_y * unit_y
    middle = (patch.shape[0] - 1) / 2.0
    start_x, start_y = middle - off_x * unit_x, middle - off_y * unit_y
    if s == 0.0 and c == 1.0:
        start = start_x + along_x * x, start_y + along_y * y
        _add_in_rows(out, patch, start, (along_x * pitch, along_y * pitch))
        return
    for row in range(out.shape[0]):
        for column in range(out.shape[1]):
            dx, dy = x + column * pitch, y + row * pitch
            w, v = c * dx + s * dy, c * dy - s * dx
            out[row, column] += _spline(patch, start_x + along_x * w, start_y + along_y * v)


@compiled
def _some(tables: Floats, places: Complex) -> bool:
    """Whether any of the tables between which `_corners` interpolates has anything."""
    first = min(max(int(places[0]), 1), tables.shape[0] - 3)
    other = min(max(int(places[1]), 1), tables.shape[1] - 3)
    middle = tables.shape[3] // 2
    for i in range(4):
        for j in range(4):
            line = tables[first - 1 + i, other - 1 + j, 0, middle]
            for column in range(line.shape[0]):
                if line[column] != 0.0:
                    return True
    return False


@compiled
def add_corners(
    flux: Floats,
    samples: tuple[Floats, Floats, Floats],
    turn: Floats,
    corners: tuple[Floats, Floats, Floats, float],
) -> None:
    """Add to frames what coupling adds at the four corners of a rectangle.

    Every corner adds its own, wherever the pixel, and every end what its two corners lack where
    they lie so near that fringes between them outlast the Sun and the pixel: light is continuous
    in the Sun. All four corners share nothing beyond that.

    Parameters
    ----------
    flux
        (N, H, W) light averaged over each pixel.
    samples
        (N, 2) middle of the spot seen from the window's first corner, mm; (N, 6) light, half
        sizes, change of the landing point a unit of direction cosine, what couples both, -1 to 1;
        (N, 4) coordinates among the corners' and among the ends' incidences.
    turn
        (3,) cosine and sine of the rectangle's turn, pixel pitch in mm.
    corners
        (T, T, 2, M, M) what corners add; (U, U, 1, L, L) what both ends along the rectangle and
        what both across it add, U = 0 where that is nothing; steps a root of millimetres.
    """
    middles, shapes, places = samples
    c, s, pitch = turn
    tables, along, across, per_root = corners
    patches, end = np.empty(tables.shape[2:]), np.empty((1, *along.shape[3:]))
    side = np.empty((1, *across.shape[3:]))
    for n in range(flux.shape[0]):
        light, a, b, spread_x, spread_y, coupling = shapes[n]
        if light == 0.0 or a <= 0.0 or b <= 0.0 or coupling == 0.0:
            continue
        _corners(patches, tables, (places[n, 0], places[n, 1]))
        patches *= light
        scale = c, s, per_root / math.sqrt(spread_x), per_root / math.sqrt(spread_y)
        x, y = pitch / 2.0 - middles[n, 0], pitch / 2.0 - middles[n, 1]
        for i in range(4):
            way_x, way_y = 2.0 * (i // 2) - 1.0, 2.0 * (i % 2) - 1.0
            kind = 0 if (way_x == way_y) == (coupling > 0.0) else 1
            _add_patch(flux[n], patches[kind], scale, (x, y, a, b), (way_x, way_y, pitch, 0.0))
        # an end is the other one turned by half a turn; negative coupling mirrors both
        mirror = 1.0 if coupling > 0.0 else -1.0
        place = places[n, 2], places[n, 3]
        if along.shape[0] > 0 and _some(along, place):
            _corners(end, along, place)
            end *= light
            for way in (-1.0, 1.0):
                ways = mirror * way, way, pitch, 0.0
                _add_patch(flux[n], end[0], scale, (x, y, 0.0, b), ways)
        if across.shape[0] > 0 and _some(across, place):
            _corners(side, across, place)
            side *= light
            for way in (-1.0, 1.0):
                ways = way, mirror * way, pitch, 0.0
                _add_patch(flux[n], side[0], scale, (x, y, a, 0.0), ways)

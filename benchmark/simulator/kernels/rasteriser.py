"""Compiled rendering of displaced apertures on a pixel grid (loaded on first use: Numba).

What an aperture covers of every pixel follows exactly from its boundary: each piece of it between
two grid lines adds the area on its right, in closed form, to an accumulation buffer (differences
first, one running sum a row at the end). Boundaries are straight sides and arcs of circles; an
aperture of two displaced round rims is bounded by one arc of each.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Integers = NDArray[np.int64]
#: Centre and radius of a round rim.
Circle = tuple[float, float, float]
#: Where a piece of boundary starts and ends, upwards: x, y, x, y.
Piece = tuple[float, float, float, float]

#: Squared sines of half an arc below which a series, or its start, gives the area between arc and
#: chord.
_SHORT, _SHORTER = 0.04, 0.001


@compiled
def _bulge(square: float) -> float:
    """Area between an arc and its chord over the squared radius.

    `square` is that of the sine of half the arc.
    """
    if square > _SHORT:
        sine = math.sqrt(min(square, 1.0))
        return math.asin(sine) - sine * math.sqrt(max(1.0 - square, 0.0))
    # 2 C(2k, k) / 4^k / (2k + 3) at the power 2k + 3: what is left out is below 1e-12
    series = 2.0 / 3.0 + square * (0.2 + square * (3.0 / 28.0))
    if square > _SHORTER:
        rest = 5.0 / 72.0 + square * (35.0 / 704.0 + square * (63.0 / 1664.0))
        series += square * square * square * rest
    return math.sqrt(square) * square * series


@compiled
def _put(line: Floats, column: int, piece: Piece, extra: float, weight: float) -> None:
    """Add a piece of boundary within one column to a row of differences (W + 2 long).

    `extra` is the area between the piece and its chord, counted to the right.
    """
    if column >= line.shape[0] - 2:
        return
    x0, y0, x1, y1 = piece
    height = y1 - y0
    if column < 0:
        line[0] += weight * height
        return
    area = ((x0 + x1) / 2.0 - column) * height + extra
    line[column] += weight * (height - area)
    line[column + 1] += weight * area


@compiled
def _cut(piece: Piece, x: float, y: float) -> tuple[Piece, Piece]:
    """Split a piece at a point of it; rounding must not turn a part upside down."""
    y = min(max(y, piece[1]), piece[3])
    return (piece[0], piece[1], x, y), (x, y, piece[2], piece[3])


@compiled
def _first_column(piece: Piece) -> int:
    """Column in which a piece starts; one that leaves to the left starts left of a grid line."""
    column = math.floor(piece[0])
    return column - 1 if piece[2] < piece[0] == column else column


@compiled
def _beyond(column: int, piece: Piece) -> bool:
    """Whether a piece goes on past the column it starts in."""
    return piece[2] > column + 1.0 or piece[2] < column


@compiled
def _row_of_side(line: Floats, piece: Piece, weight: float) -> None:
    """Add a straight piece of boundary within one row."""
    column = _first_column(piece)
    turn = 1 if piece[2] > piece[0] else -1
    slope = (piece[3] - piece[1]) / (piece[2] - piece[0]) if piece[2] != piece[0] else 0.0
    while _beyond(column, piece):
        edge = float(column + 1 if turn > 0 else column)
        part, piece = _cut(piece, edge, piece[1] + slope * (edge - piece[0]))
        _put(line, column, part, 0.0, weight)
        column += turn
    _put(line, column, piece, 0.0, weight)


@compiled
def _side(differences: Floats, piece: Piece, weight: float) -> None:
    """Add a straight side, upwards, to the rows of differences (H, W + 2)."""
    low, high = max(piece[1], 0.0), min(piece[3], float(differences.shape[0]))
    if low >= high:
        return
    slope = (piece[2] - piece[0]) / (piece[3] - piece[1])
    for row in range(math.floor(low), math.ceil(high)):
        y0, y1 = max(low, float(row)), min(high, row + 1.0)
        x0, x1 = piece[0] + slope * (y0 - piece[1]), piece[0] + slope * (y1 - piece[1])
        _row_of_side(differences[row], (x0, y0, x1, y1), weight)


@compiled
def _box(differences: Floats, aperture: Floats, rims: Floats, weight: float) -> None:
    """Add a box: what two displaced ones have in common is a box again."""
    _, x, y, a, b, c, s = aperture
    dx, dy = rims[1, 0] - rims[0, 0], rims[1, 1] - rims[0, 1]
    a, b = a - abs(c * dx + s * dy) / 2.0, b - abs(c * dy - s * dx) / 2.0
    if a <= 0.0 or b <= 0.0:
        return
    x, y = x + (rims[0, 0] + rims[1, 0]) / 2.0, y + (rims[0, 1] + rims[1, 1]) / 2.0
    for p, q, r, t in ((a, -b, a, b), (a, b, -a, b), (-a, b, -a, -b), (-a, -b, a, -b)):
        x0, y0, x1, y1 = c * p - s * q, s * p + c * q, c * r - s * t, s * r + c * t
        # counterclockwise: what goes up bounds the box on the right
        if y1 > y0:
            _side(differences, (x + x0, y + y0, x + x1, y + y1), -weight)
        elif y1 < y0:
            _side(differences, (x + x1, y + y1, x + x0, y + y0), weight)


@compiled
def _row_of_arc(
    line: Floats, circle: Circle, ways: tuple[float, float], piece: Piece, weight: float
) -> None:
    """Add a piece of a quarter circle within one row; `ways` as in `_quarter`."""
    x, y, radius = circle
    column = _first_column(piece)
    turn = 1 if piece[2] > piece[0] else -1
    last = False
    while not last:
        last = not _beyond(column, piece)
        part = piece
        if not last:
            edge = float(column + 1 if turn > 0 else column)
            off = edge - x
            height = math.sqrt(max((radius - off) * (radius + off), 0.0))
            part, piece = _cut(piece, edge, y + ways[1] * height)
        across, up = part[2] - part[0], part[3] - part[1]
        square = (across * across + up * up) / (4.0 * radius * radius)
        _put(line, column, part, ways[0] * radius * radius * _bulge(square), weight)
        column += turn


@compiled
def _quarter(
    differences: Floats,
    circle: Circle,
    ways: tuple[float, float],
    span: tuple[float, float],
    weight: float,
) -> None:
    """Add a part of a quarter circle between two heights over its centre.

    `ways` is on which side of the centre it lies in x and in y: 1 or -1.
    """
    x, y, radius = circle
    low, high = max(y + span[0], 0.0), min(y + span[1], float(differences.shape[0]))
    if low >= high:
        return
    right, upper = ways
    square, width = radius * radius, float(differences.shape[1] - 2)
    shrink, bulge = 0.25 / square, right * square
    x1 = x + right * math.sqrt(max(square - (low - y) * (low - y), 0.0))
    for row in range(math.floor(low), math.ceil(high)):
        line = differences[row]
        y0, y1, x0 = max(low, float(row)), min(high, row + 1.0), x1
        x1 = x + right * math.sqrt(max(square - (y1 - y) * (y1 - y), 0.0))
        if min(x0, x1) < 0.0 or max(x0, x1) >= width:
            _row_of_arc(line, circle, ways, (x0, y0, x1, y1), weight)
            continue
        # the same within the window, free of its limits: most of the time goes here
        column, last = math.floor(x0), math.floor(x1)
        turn = 1 if last > column else -1
        while True:
            stop_x, stop_y = x1, y1
            if column != last:
                stop_x = float(max(column, column + turn))
                edge = stop_x - x
                stop_y = y + upper * math.sqrt(max(square - edge * edge, 0.0))
                stop_y = min(max(stop_y, y0), y1)
            across, up = stop_x - x0, stop_y - y0
            area = ((x0 + stop_x) / 2.0 - column) * up
            area += bulge * _bulge((across * across + up * up) * shrink)
            line[column] += weight * (up - area)
            line[column + 1] += weight * area
            if column == last:
                break
            x0, y0 = stop_x, stop_y
            column += turn


@compiled
def _half(
    differences: Floats, circle: Circle, way: float, span: tuple[float, float], weight: float
) -> None:
    """Add a part of the right (`way` 1) or left (-1) half of a circle."""
    low, high = span
    if low < 0.0:
        _quarter(differences, circle, (way, -1.0), (low, min(high, 0.0)), -way * weight)
    if high > 0.0:
        _quarter(differences, circle, (way, 1.0), (max(low, 0.0), high), -way * weight)


@compiled
def _arc(differences: Floats, circle: Circle, ends: Piece, weight: float) -> None:
    """Add an arc of at most half a circle, counterclockwise between two points about its centre."""
    x0, y0, x1, y1 = ends
    radius = circle[2]
    if x0 >= 0.0:
        _half(differences, circle, 1.0, (y0, y1 if x1 >= 0.0 else radius), weight)
    if x1 >= 0.0 > x0:
        _half(differences, circle, 1.0, (-radius, y1), weight)
    if x0 < 0.0:
        _half(differences, circle, -1.0, (y1 if x1 < 0.0 else -radius, y0), weight)
    if x1 < 0.0 <= x0:
        _half(differences, circle, -1.0, (y1, radius), weight)


@compiled
def _hole(differences: Floats, aperture: Floats, rims: Floats, weight: float) -> None:
    """Add what two equal displaced discs have in common."""
    x, y, radius = aperture[1], aperture[2], aperture[3]
    lower = (x + rims[0, 0], y + rims[0, 1], radius)
    upper = (x + rims[1, 0], y + rims[1, 1], radius)
    dx, dy = upper[0] - lower[0], upper[1] - lower[1]
    apart = math.sqrt(dx * dx + dy * dy)
    if apart == 0.0:
        _half(differences, lower, 1.0, (-radius, radius), weight)
        _half(differences, lower, -1.0, (-radius, radius), weight)
    elif apart < 2.0 * radius:
        # half the chord between the corners, which stand square to the line of centres
        half = math.sqrt((radius - apart / 2.0) * (radius + apart / 2.0)) / apart
        px, py = -half * dy, half * dx
        dx, dy = dx / 2.0, dy / 2.0
        _arc(differences, lower, (dx - px, dy - py, dx + px, dy + py), weight)
        _arc(differences, upper, (px - dx, py - dy, -px - dx, -py - dy), weight)


@compiled
def render(flux: Floats, apertures: Floats, rims: Floats, light: Floats, origin: Floats) -> None:
    """Write the light in every pixel of every frame.

    Parameters
    ----------
    flux
        (N, H, W), overwritten: share of each pixel's area lit, times the light.
    apertures
        (A, 7) `Mask.table` in pixels.
    rims
        (2, N, K, 2) displacement of the mask's lower and upper rims, px.
    light
        (N, K) light of each of the K points of the Sun.
    origin
        (N, 2) position of the window's first corner (not its first pixel's centre), px, in the
        frame of `apertures`.
    """
    count, height, width = flux.shape
    differences = np.zeros((height, width + 2))
    paths = np.empty((2, 2))
    for n in range(count):
        differences[:] = 0.0
        for k in range(light.shape[1]):
            if light[n, k] == 0.0:
                continue
            for rim in range(2):
                for axis in range(2):
                    paths[rim, axis] = rims[rim, n, k, axis] - origin[n, axis]
            for m in range(apertures.shape[0]):
                if apertures[m, 0] > 0.5:
                    _box(differences, apertures[m], paths, light[n, k])
                else:
                    _hole(differences, apertures[m], paths, light[n, k])
        for row in range(height):
            total = 0.0
            for column in range(width):
                total += differences[row, column]
                flux[n, row, column] = max(total, 0.0)


@compiled
def add_apertures(
    frame: Floats, mask: tuple[Floats, Floats], rims: Floats, light: Floats, boxes: Integers
) -> None:
    """Add the light of many apertures to a frame, each within its own box of pixels.

    Parameters
    ----------
    frame
        (H, W), added to.
    mask
        (A, 7) apertures in pixels about the frame's middle, and (A,) the light they pass.
    rims, light
        As of `render`, of one sample.
    boxes
        (A, 4) first and past-last column and row that each lights; empty ones are left out.
    """
    apertures, passed = mask
    height, width = frame.shape
    origin = np.empty((1, 2))
    for m in range(boxes.shape[0]):
        left, right, top, bottom = boxes[m]
        if right <= left or bottom <= top:
            continue
        part = np.empty((1, bottom - top, right - left))
        origin[0, 0], origin[0, 1] = left - width / 2.0, top - height / 2.0
        render(part, apertures[m : m + 1], rims, light * passed[m], origin)
        for row in range(bottom - top):
            for column in range(right - left):
                frame[top + row, left + column] += part[0, row, column]


@compiled
def take_light(
    frame: Floats, boxes: Integers, runs: NDArray[np.int32], values: NDArray[np.float32]
) -> tuple[int, int]:
    """Move what is lit within boxes (B, 4) out of a frame, which is dark there afterwards.

    Writes runs of lit pixels (R, 2), first and past-last place in the flattened frame, and the
    light there, in single precision; returns how many of both.
    """
    width = frame.shape[1]
    count, found = 0, 0
    for b in range(boxes.shape[0]):
        for row in range(boxes[b, 2], boxes[b, 3]):
            last = -1
            for column in range(boxes[b, 0], boxes[b, 1]):
                light = frame[row, column]
                if light != 0.0:
                    place = row * width + column
                    if place != last:
                        runs[found, 0] = place
                        found += 1
                    last = place + 1
                    runs[found - 1, 1] = last
                    values[count] = light
                    frame[row, column] = 0.0
                    count += 1
    return found, count


@compiled
def put_light(
    flat: Floats, runs: NDArray[np.int32], values: NDArray[np.float32], factor: float
) -> None:
    """Write the light of runs, as of `take_light`, times a factor to a flattened frame."""
    start = 0
    for first, last in runs:
        for place in range(last - first):
            flat[first + place] = values[start + place] * factor
        start += last - first

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

#: Nodes of the rays through glass, over the distance at which they land.
_RAYS = 512


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
def _rays(layers: Floats, farthest: float) -> Floats:
    """Rays through the layers, (M, 2) by the distance at which they land.

    Distance over sine, and cosine behind the aperture over ``J_r J_t``; the first node is the
    mirror image of the third, so that a cubic goes through zero distance. The last two lie beyond
    `farthest`. Cubic interpolation is good to ``3/128 (d / h)^4``, d from node to node, h the
    height: below 1e-9 up to a distance of 6 h.
    """
    height = 0.0
    for m in range(layers.shape[0]):
        height += layers[m, 0]
    rays = np.empty((_RAYS + 4, 2))
    step = farthest / _RAYS
    for i in range(1, _RAYS + 4):
        sine = _sine((i - 1) * step, height, layers)
        _, slope, scale = _reach(sine, layers)
        rays[i, 0] = scale
        rays[i, 1] = math.sqrt(1.0 - sine * sine) / (slope * scale)
    rays[0] = rays[2]
    return rays


@compiled
def _arriving(x: float, y: float, rays: Floats, per_mm: float, height: float) -> Rays:
    """Direction cosines of the light from the aperture to (x, y), and what they spread by.

    The last is the cosine behind the aperture over ``J_r J_t``: how much of the light leaving it
    goes to a unit of the detector's area. Without glass `rays` is empty.
    """
    if rays.shape[0] == 0:
        scale = 1.0 / math.sqrt(x * x + y * y + height * height)
        cosine = height * scale
        square = cosine * cosine
        return x * scale, y * scale, square * cosine * scale * scale
    place = math.sqrt(x * x + y * y) * per_mm
    node = min(int(place), _RAYS)
    a, b, c, d = _shares(place - node)
    scale, spread = 0.0, 0.0
    for i, share in ((0, a), (1, b), (2, c), (3, d)):
        scale += share * rays[node + i, 0]
        spread += share * rays[node + i, 1]
    return x / scale, y / scale, spread


@compiled
def _seen(x: float, y: float, way: Floats, rays: Floats) -> Rays:
    """Place in the tables, in steps, of a point seen from an aperture, and a factor of its light.

    `way` is of `_way`.
    """
    along = (way[0] * x + way[1] * y - way[4]) / way[5]
    across = (way[0] * y - way[1] * x) / way[6]
    factor = 1.0
    if way[8] > 0.0:
        px, py, spreading = _arriving(x, y, rays, way[11], way[12])
        px, py = px - way[2], py - way[3]
        along += way[8] * (way[0] * px + way[1] * py - along)
        across += way[8] * (way[0] * py - way[1] * px - across)
        factor += way[8] * (way[7] * spreading - 1.0)
    return along * way[9], across * way[10], factor


@compiled
def _way(sun: Floats, numbers: Floats, share: float, layers: Floats, per_mm: float) -> Floats:
    """Return what `_seen` needs of one sample.

    Azimuth (2), cosines of the chief ray (2), where it lands, J_r, J_t, the inverse of how its
    light spreads, share of the direction cosines, steps a unit (2), nodes of rays a mm, height.
    """
    way = np.empty(13)
    sx, sy, cosine = sun
    sine = math.sqrt(sx * sx + sy * sy)
    way[0], way[1] = (sx / sine, sy / sine) if sine > 0.0 else (1.0, 0.0)
    way[2], way[3] = sx, sy
    way[4], way[5], way[6] = _reach(sine, layers)
    way[7] = way[5] * way[6] / cosine
    way[8], way[9], way[10] = share, numbers[2], numbers[3]
    way[11], way[12] = per_mm, 0.0
    for m in range(layers.shape[0]):
        way[12] += layers[m, 0]
    return way


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
        coordinate among the tables, steps a unit of direction cosine along and across, or (N, 5)
        with `RoundPattern.share` at the end; (N, A, 2) centres of the apertures, mm, seen from the
        window's first corner.
    optics
        (L, 2) thickness and index from the aperture down, the empty gap first; (Q, 2) nodes in a
        pixel, mm from its first edge, and their weights (sum 1); where the samples do not say it,
        whether positions are measured in direction cosines about the aperture, or in millimetres
        about the chief ray.
    """
    suns, numbers, places = samples
    layers, nodes, by_cosines = optics
    count, rows, columns = flux.shape
    pitch = nodes[0, 0] + nodes[-1, 0]
    table = np.empty(tables.shape[1:])
    farthest = math.sqrt(2.0) * (np.abs(places).max() + pitch * max(rows, columns))
    rays = _rays(layers, farthest) if layers.shape[0] > 1 else np.empty((0, 2))
    for n in range(count):
        if numbers[n, 0] == 0.0:
            continue
        _blended(table, tables, numbers[n, 1])
        share = numbers[n, 4] if numbers.shape[1] > 4 else (1.0 if by_cosines else 0.0)
        way = _way(suns[n], numbers[n], share, layers, _RAYS / farthest)
        for m in range(places.shape[1]):
            for row in range(rows):
                for column in range(columns):
                    total = 0.0
                    for i in range(nodes.shape[0]):
                        y = row * pitch + nodes[i, 0] - places[n, m, 1]
                        for j in range(nodes.shape[0]):
                            x = column * pitch + nodes[j, 0] - places[n, m, 0]
                            along, across, factor = _seen(x, y, way, rays)
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
        (3,) to the Sun; (5,) as of `add_round`; (2,) half axes of the ellipse along and across the
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
    _blended(small, tables[0], numbers[1])
    _blended(large, tables[1], numbers[1])
    farthest = math.sqrt(2.0) * (np.abs(holes[:, :2]).max() + pitch * max(frame.shape))
    rays = _rays(layers, farthest) if layers.shape[0] > 1 else np.empty((0, 2))
    way = _way(sun, numbers, numbers[4], layers, _RAYS / farthest)
    ex, ey, chief = way[0], way[1], way[4]
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
                        along, across, factor = _seen(x, y, way, rays)
                        factor *= nodes[i, 1] * nodes[j, 1]
                        total += factor * _looked_up(table, along, across)
                frame[row, column] += numbers[0] * holes[m, 3] * max(total, 0.0)

"""Compiled diffraction of slits on the pixels of linear arrays (loaded on first use: Numba).

Patterns of `slit_patterns`, which slits of one shape share, are looked up at the edges of every
pixel for every chord of the Sun. Lengths are in pixels, but within a pattern.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Pair = tuple[float, float]
Four = tuple[float, float, float, float]
#: Middle of a shadow on the array's axis, its half width there, slope of its edges (u over v),
#: share of the pixels' height between its ends, and how much higher than the plate's middle the
#: light comes from.
Shadow = tuple[float, float, float, float, float]
#: Cosine and sine of the plate's inclination, its thickness, offset along u and v, and half the
#: height of the array.
Plate = tuple[float, float, float, float, float, float]
#: Step, end of the pattern's grid that may be looked up, and factor of its tail.
Extent = tuple[float, float, float]

#: Light that comes in more obliquely than 88.9 deg is none.
_LEAST_COSINE = 0.02


@compiled
def _light(direction: Floats, layers: Floats) -> Pair:
    """Length of a ray's landing point over its horizontal direction, and the light it brings.

    `layers` are rows (thickness, index) from the mask down, the empty gap first. The light is the
    cosine of incidence times what all surfaces pass of unpolarised light.
    """
    sine2 = direction[0] ** 2 + direction[1] ** 2
    scale = layers[0, 0] / direction[2]
    before, cosine = 1.0, direction[2]
    across, along = 1.0, 1.0
    for m in range(1, layers.shape[0] + 1):
        last = m == layers.shape[0]
        index = 1.0 if last else layers[m, 1]
        inside = math.sqrt(index * index - sine2) / index
        if not last:
            scale += layers[m, 0] / (index * inside)
        if index != before:
            one, two = before * cosine, index * inside
            across *= 1.0 - ((one - two) / (one + two)) ** 2
            one, two = index * cosine, before * inside
            along *= 1.0 - ((one - two) / (one + two)) ** 2
        before, cosine = index, inside
    return scale, direction[2] * (across + along) / 2.0


@compiled
def _spread(axis: Floats, sun: Floats, layers: Floats, thickness: float, shadow: Pair) -> Four:
    """Return how a shadow spreads along the array, of a slope and from a mask raised so far.

    ``J``; by what share of a distance x from an edge the cubic term of the phase moves a fringe,
    over x; ``J`` of the foil; how far apart the foil's rims appear. Fill `axis` with the direction
    on the sky, square to `sun`, in which the shadow moves fastest.
    """
    slope, raised = shadow
    sine2 = sun[0] ** 2 + sun[1] ** 2
    along = sun[0] - slope * sun[1]
    normal2 = 1.0 + slope * slope
    plain, turned, curved = 0.0, 0.0, 0.0
    for m in range(layers.shape[0]):
        depth = layers[m, 0] + (raised if m == 0 else 0.0)
        square = layers[m, 1] ** 2 - sine2
        share = depth / math.sqrt(square)
        plain += share
        turned += share / square
        curved += share / (square * square) * (square + along * along / normal2)
    axis[0] = plain + turned * along * sun[0]
    axis[1] = -slope * plain + turned * along * sun[1]
    spread = axis[0] - slope * axis[1]
    cubic = -0.5 * along * normal2 * curved / (spread * spread)
    beside = axis[0] * sun[0] + axis[1] * sun[1]
    axis[0] -= beside * sun[0]
    axis[1] -= beside * sun[1]
    axis[2] = -beside * sun[2]
    axis /= math.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
    foil = thickness / sun[2] * (normal2 + along * along / sun[2] ** 2)
    return spread, cubic, foil, thickness * abs(along) / sun[2]


@compiled
def _along(sun: Floats, layers: Floats, slope: float, raised: float) -> float:
    """``J`` along the array of `_spread`, alone."""
    sine2 = sun[0] ** 2 + sun[1] ** 2
    along2 = (sun[0] - slope * sun[1]) ** 2
    found = 0.0
    for m in range(layers.shape[0]):
        depth = layers[m, 0] + (raised if m == 0 else 0.0)
        square = layers[m, 1] ** 2 - sine2
        found += depth / math.sqrt(square) * (1.0 + slope * slope + along2 / square)
    return found


@compiled
def _points(
    rays: Floats,
    chords: Floats,
    frame: tuple[Floats, Floats, Floats],
    slope: float,
    raised: float,
) -> None:
    """Fill (2 Q, 6) rays: displacement and tangents along and across the array, light, ``J``.

    `frame` has the Sun's middle, the axis that chords stand across, and the layers; `slope` and
    `raised` are those of `_spread`.
    """
    sun, axis, layers = frame
    other = np.array(
        (
            sun[1] * axis[2] - sun[2] * axis[1],
            sun[2] * axis[0] - sun[0] * axis[2],
            sun[0] * axis[1] - sun[1] * axis[0],
        )
    )
    direction = np.empty(3)
    for q in range(chords.shape[0]):
        x, y, share = chords[q]
        for side in range(2):
            beside = y if side == 1 else -y
            onward = math.sqrt(1.0 - x * x - y * y)
            for i in range(3):
                direction[i] = onward * sun[i] + x * axis[i] + beside * other[i]
            ray = rays[2 * q + side]
            ray[:] = 0.0
            if direction[2] < _LEAST_COSINE:
                continue
            scale, light = _light(direction, layers)
            ray[0], ray[1] = scale * direction[0], scale * direction[1]
            ray[2], ray[3] = direction[0] / direction[2], direction[1] / direction[2]
            ray[4] = share * light / 2.0
            ray[5] = _along(direction, layers, slope, raised)


@compiled
def _shadow(slit: Floats, ray: Floats, plate: Plate) -> Shadow:
    """Where the light of one slit falls; a half width of 0 where nothing gets through."""
    _, x, y, a, b, c, s = slit
    flat, rise, thickness, offset_u, offset_v, half = plate
    tangent_u, tangent_v = ray[2], ray[3]
    # where the plate's own axes end up: a point (p, q) of it is q * rise higher
    across_u, across_v = rise * tangent_u, flat + rise * tangent_v
    wide_u, wide_v = c + s * across_u, s * across_v
    long_u, long_v = c * across_u - s, c * across_v
    turn = wide_u * long_v - wide_v * long_u
    if turn <= 0.0 or long_v <= 0.0:
        return 0.0, 0.0, 0.0, 0.0, 0.0
    # of the upper rim against the lower one; the thickness stands along the plate's own normal
    du, dv = thickness * flat * tangent_u, thickness * (flat * tangent_v - rise)
    a = max(a - abs(du * long_v - dv * long_u) / turn / 2.0, 0.0)
    b = max(b - abs(wide_u * dv - wide_v * du) / turn / 2.0, 0.0)
    u = x + y * across_u + ray[0] + offset_u
    v = y * across_v + ray[1] + offset_v
    slope = long_u / long_v
    low, high = max(v - b * long_v, -half), min(v + b * long_v, half)
    share = max(high - low, 0.0) / (2.0 * half)
    raised = rise * (y - v / long_v * c)
    return u - v * slope, a * turn / long_v, slope, share, raised


@compiled
def _before(place: float, pattern: Floats, sums: Floats, extent: Extent) -> float:
    """Light up to a place, from the grid's beginning."""
    step, end, tail = extent
    if abs(place) < end:
        along = (place + end) / step
        cell = int(along)
        t = along - cell
        rise = sums[cell + 1] - sums[cell]
        first, last = step * pattern[cell] - rise, rise - step * pattern[cell + 1]
        return float(sums[cell] + t * rise + t * (1.0 - t) * ((1.0 - t) * first + t * last))
    size = abs(place)
    beyond = 1.0 / (end - 1.0) + 1.0 / (end + 1.0) - 1.0 / (size - 1.0) - 1.0 / (size + 1.0)
    return float(sums[-1] + tail * beyond if place > 0.0 else sums[0] - tail * beyond)


@compiled
def _add_near(
    line: Floats,
    span: tuple[int, int],
    nodes: Floats,
    dead: float,
    shape: tuple[Floats, Extent],
) -> None:
    """Add the light of all chords to a span of pixels.

    `nodes` (Q, 4): middle, half width, light, by what share its ``J`` exceeds the pattern's.
    """
    pattern, extent = shape
    here, total = np.empty(pattern.shape[1]), np.empty(pattern.shape[1])
    for q in range(nodes.shape[0]):
        middle, width, light, excess = nodes[q]
        if light == 0.0:
            continue
        for i in range(here.shape[0]):
            here[i] = pattern[0, i] + excess * pattern[2, i]
            total[i] = pattern[1, i] + excess * pattern[3, i]
        light *= width / (1.0 - 2.0 * dead)
        end = _before((span[0] - middle) / width, here, total, extent)
        for pixel in range(span[0], span[1]):
            start = end
            if dead > 0.0:
                start = _before((pixel + dead - middle) / width, here, total, extent)
            end = _before((pixel + 1.0 - dead - middle) / width, here, total, extent)
            line[pixel] += light * (end - start)


@compiled
def _add_far(line: Floats, span: tuple[int, int], node: tuple[float, float, float]) -> None:
    """Add a tail - middle, half width, light times its factor - to all but a span of pixels."""
    middle, width, light = node
    for part in range(2):
        first = 0 if part == 0 else span[1]
        last = span[0] if part == 0 else line.shape[0]
        for pixel in range(first, last):
            square = ((pixel + 0.5 - middle) / width) ** 2
            line[pixel] += light * 2.0 * (square + 1.0) / (square - 1.0) ** 2


@compiled
def _chief(ray: Floats, sun: Floats, layers: Floats) -> None:
    """Fill the ray from the Sun's middle as `_points` does the others', without light and ``J``."""
    scale, _ = _light(sun, layers)
    ray[0], ray[1] = scale * sun[0], scale * sun[1]
    ray[2], ray[3] = sun[0] / sun[2], sun[1] / sun[2]


@compiled
def shapes(out: Floats, slits: Floats, sun: Floats, layers: Floats, plate: Plate) -> None:
    """Fill (N, G, 6): half width of each shape of slit along the array, and a row of `patterns`.

    Zeros where no light gets through; parameters as in `expose_diffracted`, `slits` one a shape.
    """
    axis, chief = np.empty(3), np.empty(6)
    out[:] = 0.0
    for n in range(out.shape[0]):
        if sun[n, 2] < _LEAST_COSINE:
            continue
        _chief(chief, sun[n], layers)
        for g in range(slits.shape[0]):
            _, size, slope, _, raised = _shadow(slits[g], chief, plate)
            if size <= 0.0:
                continue
            spread = _spread(axis, sun[n], layers, plate[2], (slope, raised))
            out[n, g, 0] = size
            out[n, g, 1] = spread[0] / size**2
            out[n, g, 2] = spread[1] * size
            out[n, g, 3] = spread[2] / size**2
            out[n, g, 4] = spread[3] / size
            out[n, g, 5] = abs(slope) * plate[5] / size


@compiled
def _nodes(nodes: Floats, slit: Floats, rays: Floats, plate: Plate, scale: float) -> Four:
    """Fill (Q, 4) chords of one slit for `_add_near`; return their ends, middle and light.

    `scale` is ``J`` over the squared half width of the pattern.
    """
    total, moment, left, right = 0.0, 0.0, math.inf, -math.inf
    for q in range(nodes.shape[0]):
        one, two = _shadow(slit, rays[2 * q], plate), _shadow(slit, rays[2 * q + 1], plate)
        first, second = one[3] * rays[2 * q, 4], two[3] * rays[2 * q + 1, 4]
        light = first + second
        nodes[q, 2] = light
        if light == 0.0 or min(one[1], two[1]) <= 0.0:
            nodes[q, 2] = 0.0
            continue
        middle = (first * one[0] + second * two[0]) / light
        width = (first * one[1] + second * two[1]) / light
        wide = (first * rays[2 * q, 5] + second * rays[2 * q + 1, 5]) / light
        nodes[q, 0], nodes[q, 1] = middle, width
        nodes[q, 3] = wide / scale / width**2 - 1.0
        total += light
        moment += light * middle
        left, right = min(left, middle), max(right, middle)
    return left, right, moment / total if total > 0.0 else 0.0, total


@compiled
def expose_diffracted(
    flux: Floats,
    slits: tuple[Floats, NDArray[np.int64]],
    suns: tuple[Floats, Floats, Floats],
    patterns: tuple[Floats, NDArray[np.int64], NDArray[np.int64], Floats],
    numbers: tuple[float, float, float, Plate],
) -> None:
    """Write the light on every pixel of one array, sample by sample.

    Parameters
    ----------
    flux
        (N, W), overwritten: light averaged over each pixel's sensitive area.
    slits
        (A, 7) `Mask.table` in pixels, u along the array, v across it, those of one shape and slant
        one after the other; (G + 1,) where each shape begins.
    suns
        (N, 3) unit vectors to the Sun's middle, along u, v and the boresight; (Q, 3) `chords`;
        (L, 2) thickness in pixels and index of what lies between the foil's middle and the
        detector, the empty gap first.
    patterns
        (4, total) `patterns`, their `grids` (N G, 3) and beginnings (N G,), and (N, G, 6) `shapes`.
    numbers
        Position of the array's first edge, px; share of a pixel's length that is sensitive; mean
        wavelength, px; the plate: cosine and sine of its inclination, its thickness, its offset
        along u and v, and half the height of the array, px.
    """
    table, firsts = slits
    sun, chords, layers = suns
    known, grids, starts, shape = patterns
    edge, fill, wavelength, plate = numbers
    dead, width = (1.0 - fill) / 2.0, flux.shape[1]
    rays, nodes = np.empty((2 * chords.shape[0], 6)), np.empty((chords.shape[0], 4))
    axis, chief = np.empty(3), np.empty(6)
    flux[:] = 0.0
    for n in range(flux.shape[0]):
        for g in range(firsts.shape[0] - 1):
            steps, ends, _ = grids[n * shape.shape[1] + g]
            if steps == 0:
                continue
            start = starts[n * shape.shape[1] + g]
            pattern = known[:, start : start + 2 * ends + 1]
            size, scale = shape[n, g, 0], shape[n, g, 1]
            tail = wavelength * scale / (4.0 * math.pi * math.pi)
            extent = (1.0 / steps, ends / steps, tail)
            _chief(chief, sun[n], layers)
            _, _, slope, _, raised = _shadow(table[firsts[g]], chief, plate)
            _spread(axis, sun[n], layers, plate[2], (slope, raised))
            _points(rays, chords, (sun[n], axis, layers), slope, raised)
            for m in range(firsts[g], firsts[g + 1]):
                left, right, middle, light = _nodes(nodes, table[m], rays, plate, scale)
                if light == 0.0:
                    continue
                nodes[:, 0] -= edge
                reach = size * extent[1]
                low = min(max(math.floor(left - edge - reach), 0), width)
                high = min(max(math.ceil(right - edge + reach), low), width)
                if high > low:
                    _add_near(flux[n], (low, high), nodes, dead, (pattern, extent))
                _add_far(flux[n], (low, high), (middle - edge, size, light * tail))

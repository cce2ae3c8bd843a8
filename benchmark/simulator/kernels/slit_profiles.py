"""Compiled diffraction of slits on the pixels of linear arrays (loaded on first use: Numba).

The pattern of an endless slit (`slit_diffraction`) is summed over the spectrum on a fine grid once
a sample and shape of slit; slits of one shape share it. Its running integral, smoothed by the
slant of the shadow over the height of the pixels, is looked up at the edges of every pixel for
every chord of the Sun. Lengths are in pixels, but within a pattern: there the slit's edges are at
-1 and 1, and the open light is 1.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

Pair = tuple[float, float]
#: Middle of a shadow on the array's axis, its half width there, slope of its edges (u over v),
#: share of the pixels' height between its ends, and how much higher than the plate's middle the
#: light comes from.
Shadow = tuple[float, float, float, float, float]
#: Cosine and sine of the plate's inclination, its thickness, offset along u and v, and half the
#: height of the array.
Plate = tuple[float, float, float, float, float, float]
#: (2, M) auxiliary functions of the Fresnel integrals from -1 step on, and steps a unit.
Table = tuple[Floats, float]
#: Step, end of the pattern's grid that may be looked up, and factor of its tail.
Extent = tuple[float, float, float]

#: Values a period of the finest fringe; widths of an edge outside a shadow that are computed,
#: beyond which light falls with the square of the distance.
_FINE, _OUTSIDE = 7.0, 5.0
#: Light that comes in more obliquely than 88.9 deg is none.
_LEAST_COSINE = 0.02


@compiled
def _fresnel(u: float, table: Table) -> Pair:
    """Fresnel's C and S of u >= 0 by their smooth auxiliary functions f and g.

    As in `diffraction_slits`: kernels call only their own file (see `compiled`).
    """
    auxiliary, per_unit = table
    place = u * per_unit + 1.0
    if place < auxiliary.shape[1] - 3.0:
        first = int(place)
        t = place - first
        a, b = -t * (t - 1.0) * (t - 2.0) / 6.0, (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0
        c, d = -(t + 1.0) * t * (t - 2.0) / 2.0, (t + 1.0) * t * (t - 1.0) / 6.0
        line = auxiliary[0]
        f = a * line[first - 1] + b * line[first] + c * line[first + 1] + d * line[first + 2]
        line = auxiliary[1]
        g = a * line[first - 1] + b * line[first] + c * line[first + 1] + d * line[first + 2]
    else:
        q = 1.0 / (math.pi * u * u) ** 2
        f = (1.0 - 3.0 * q) / (math.pi * u)
        g = (1.0 - 15.0 * q) / (math.pi * math.pi * u * u * u)
    phase = math.pi / 2.0 * u * u
    sine, cosine = math.sin(phase), math.cos(phase)
    return 0.5 + f * sine - g * cosine, 0.5 - f * cosine - g * sine


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
def _spread(axis: Floats, sun: Floats, layers: Floats, slope: float, raised: float) -> float:
    """Return ``J`` along the array for a shadow of this slope, from a mask raised this far.

    Fill `axis` with the direction on the sky, square to `sun`, in which the shadow moves fastest.
    """
    sine2 = sun[0] ** 2 + sun[1] ** 2
    radial, tangential = 0.0, 0.0
    for m in range(layers.shape[0]):
        thickness = layers[m, 0] + (raised if m == 0 else 0.0)
        square = layers[m, 1] ** 2 - sine2
        share = thickness / math.sqrt(square)
        tangential += share
        radial += share * layers[m, 1] ** 2 / square
    excess = 0.0  # of J_r over J_t, times the share of the shadow's normal along r
    if sine2 > 0.0:
        excess = (radial - tangential) * (sun[0] - slope * sun[1]) / sine2
    axis[0] = tangential + excess * sun[0]
    axis[1] = -slope * tangential + excess * sun[1]
    found = axis[0] - slope * axis[1]
    beside = axis[0] * sun[0] + axis[1] * sun[1]
    axis[0] -= beside * sun[0]
    axis[1] -= beside * sun[1]
    axis[2] = -beside * sun[2]
    axis /= math.sqrt(axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2)
    return float(found)


@compiled
def _points(rays: Floats, chords: Floats, frame: tuple[Floats, Floats, Floats]) -> None:
    """Fill (2 Q, 5) rays: displacement and tangents along and across the array, light.

    `frame` has the Sun's middle, the axis that chords stand across, and the layers.
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
def _intensity(light: Floats, spread: float, steps: int, spectrum: Floats, table: Table) -> float:
    """Fill the pattern from its middle on, `steps` a half width; return the factor of its tail.

    `spread` is ``J`` over the squared half width.
    """
    count = light.shape[0]
    real, imaginary = np.empty(count + steps), np.empty(count + steps)
    light[:] = 0.0
    tail = 0.0
    for m in range(spectrum.shape[0]):
        number = 1.0 / (spectrum[m, 0] * spread)
        weight = spectrum[m, 1]
        tail += weight / (4.0 * math.pi * math.pi * number)
        unit = math.sqrt(2.0 * number) / steps
        for i in range(count + steps):
            real[i], imaginary[i] = _fresnel(i * unit, table)
        for i in range(count):
            before = abs(i - steps)
            sign = 1.0 if i >= steps else -1.0
            re = real[i + steps] - sign * real[before]
            im = imaginary[i + steps] - sign * imaginary[before]
            light[i] += weight * (re * re + im * im) / 2.0
    return tail


@compiled
def _pattern(
    spread: float, shear: float, spectrum: Floats, table: Table
) -> tuple[Floats, Floats, Extent]:
    """Return a slit's pattern from its middle on, and its running integral, sheared.

    `shear` is by how much the shadow moves over half the pixels' height. The running integral is
    exact for cubics; where the shear is less than half a step, its second derivative stands for it.
    """
    shortest, longest = spectrum[0, 0], spectrum[-1, 0]
    steps = max(math.ceil(2.0 * _FINE / (shortest * spread)), 4)
    middle = math.sqrt(shortest * longest)
    ends = math.ceil((1.0 + _OUTSIDE * math.sqrt(middle * spread)) * steps)
    step = 1.0 / steps
    count = ends + math.ceil(shear * steps) + 4
    light, single = np.empty(count), np.empty(count - 1)
    tail = _intensity(light, spread, steps, spectrum, table)
    single[0] = 0.0
    for i in range(count - 2):
        inner = 13.0 * (light[i] + light[i + 1]) - light[abs(i - 1)] - light[i + 2]
        single[i + 1] = single[i] + step * inner / 24.0
    extent = (step, ends * step, tail)
    if shear == 0.0:
        return light, single, extent
    out, sums = np.empty(ends + 2), np.empty(ends + 2)
    if shear < step / 2.0:
        square = shear * shear / 6.0
        for i in range(ends + 2):
            before, after = light[abs(i - 1)], light[i + 1]
            out[i] = light[i] + square * (before - 2.0 * light[i] + after) / (step * step)
            sums[i] = single[i] + square * (after - before) / (2.0 * step)
        sums[0] = 0.0
        return out, sums, extent
    double = np.empty(count - 1)
    double[0] = 0.0
    for i in range(count - 2):
        rise = (single[i] + single[i + 1]) / 2.0 + step * (light[i] - light[i + 1]) / 12.0
        double[i + 1] = double[i] + step * rise
    for i in range(ends + 2):
        after = _integrals(light, single, double, i * step + shear, step)
        before = _integrals(light, single, double, abs(i * step - shear), step)
        sign = 1.0 if i * step >= shear else -1.0
        out[i] = (after[0] - sign * before[0]) / (2.0 * shear)
        sums[i] = (after[1] - before[1]) / (2.0 * shear)
    return out, sums, extent


@compiled
def _integrals(light: Floats, single: Floats, double: Floats, place: float, step: float) -> Pair:
    """First and second running integral of a pattern at a place (Hermite's cubic for the first)."""
    cell = min(int(place / step), single.shape[0] - 2)
    t = place / step - cell
    rise = single[cell + 1] - single[cell]
    first, last = step * light[cell] - rise, rise - step * light[cell + 1]
    value = single[cell] + t * rise + t * (1.0 - t) * ((1.0 - t) * first + t * last)
    # the cubic's integral from the cell's beginning
    t2 = t * t
    inner = single[cell] * t + rise * t2 / 2.0
    inner += first * t2 * (0.5 - 2.0 * t / 3.0 + t2 / 4.0) + last * t2 * t * (1.0 / 3.0 - t / 4.0)
    return value, double[cell] + step * inner


@compiled
def _before(place: float, pattern: Floats, sums: Floats, extent: Extent) -> float:
    """Light between a slit's middle and a place, negative to the left."""
    step, end, tail = extent
    size = abs(place)
    if size < end:
        cell = int(size / step)
        t = size / step - cell
        rise = sums[cell + 1] - sums[cell]
        first, last = step * pattern[cell] - rise, rise - step * pattern[cell + 1]
        value = sums[cell] + t * rise + t * (1.0 - t) * ((1.0 - t) * first + t * last)
    else:
        inside = 1.0 / (end - 1.0) + 1.0 / (end + 1.0)
        inside -= 1.0 / (size - 1.0) + 1.0 / (size + 1.0)
        value = sums[round(end / step)] + tail * inside
    return float(value) if place >= 0.0 else -float(value)


@compiled
def _add_near(
    line: Floats,
    span: tuple[int, int],
    nodes: Floats,
    dead: float,
    shape: tuple[Floats, Floats, Extent],
) -> None:
    """Add the light of all chords (Q, 3) - middle, half width, light - to a span of pixels."""
    pattern, sums, extent = shape
    for q in range(nodes.shape[0]):
        middle, width, light = nodes[q]
        if light == 0.0:
            continue
        light *= width / (1.0 - 2.0 * dead)
        end = _before((span[0] - middle) / width, pattern, sums, extent)
        for pixel in range(span[0], span[1]):
            start = end
            if dead > 0.0:
                start = _before((pixel + dead - middle) / width, pattern, sums, extent)
            end = _before((pixel + 1.0 - dead - middle) / width, pattern, sums, extent)
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
def expose_diffracted(
    flux: Floats,
    slits: Floats,
    suns: tuple[Floats, Floats],
    optics: tuple[Floats, Floats, Table],
    numbers: tuple[float, float, Plate],
) -> None:
    """Write the light on every pixel of one array, sample by sample.

    Parameters
    ----------
    flux
        (N, W), overwritten: light averaged over each pixel's sensitive area.
    slits
        (A, 7) `Mask.table` in pixels, u along the array, v across it; slits of one shape and slant
        one after the other share their pattern.
    suns
        (N, 3) unit vectors to the Sun's middle, along u, v and the boresight; (Q, 3) `chords`.
    optics
        (L, 2) thickness in pixels and index of what lies between the foil's middle and the
        detector, the empty gap first; (S, 2) wavelengths in pixels, rising, and weights; the table
        of the Fresnel integrals.
    numbers
        Position of the array's first edge, px; share of a pixel's length that is sensitive;
        the plate: cosine and sine of its inclination, its thickness, its offset along u and v, and
        half the height of the array, px.
    """
    sun, chords = suns
    layers, spectrum, table = optics
    edge, fill, plate = numbers
    dead, half = (1.0 - fill) / 2.0, plate[5]
    width = flux.shape[1]
    rays, nodes = np.empty((2 * chords.shape[0], 5)), np.empty((chords.shape[0], 3))
    axis, chief = np.empty(3), np.empty(5)
    middle = math.sqrt(spectrum[0, 0] * spectrum[-1, 0])
    for n in range(flux.shape[0]):
        line = flux[n]
        line[:] = 0.0
        if sun[n, 2] < _LEAST_COSINE:
            continue
        scale, _ = _light(sun[n], layers)
        chief[0], chief[1] = scale * sun[n, 0], scale * sun[n, 1]
        chief[2], chief[3] = sun[n, 0] / sun[n, 2], sun[n, 1] / sun[n, 2]
        known = False
        pattern, sums, extent = np.empty(0), np.empty(0), (0.0, 0.0, 0.0)
        spread, size = 0.0, 0.0
        for m in range(slits.shape[0]):
            slit = slits[m]
            place, wide, slope, _, raised = _shadow(slit, chief, plate)
            if wide <= 0.0:
                continue
            other = m == 0 or slit[3] != slits[m - 1, 3] or slit[6] != slits[m - 1, 6]
            if other or size == 0.0:
                size, known = wide, False
                spread = _spread(axis, sun[n], layers, slope, raised)
                _points(rays, chords, (sun[n], axis, layers))
            total, left, right = 0.0, place, place
            for q in range(chords.shape[0]):
                one, two = _shadow(slit, rays[2 * q], plate), _shadow(slit, rays[2 * q + 1], plate)
                first, second = one[3] * rays[2 * q, 4], two[3] * rays[2 * q + 1, 4]
                light = first + second
                nodes[q, 2] = light
                if light == 0.0:
                    continue
                total += light
                nodes[q, 0] = (first * one[0] + second * two[0]) / light - edge
                nodes[q, 1] = (first * one[1] + second * two[1]) / light
                left, right = min(left, nodes[q, 0] + edge), max(right, nodes[q, 0] + edge)
            if total == 0.0:
                continue
            reach = size + _OUTSIDE * math.sqrt(middle * spread)
            start = min(max(math.floor(left - edge - reach), 0), width)
            stop = min(max(math.ceil(right - edge + reach), start), width)
            if stop > start:
                if not known:
                    shear = abs(slope) * half / size
                    pattern, sums, extent = _pattern(
                        spread / size**2, shear, spectrum, table
                    )
                    known = True
                _add_near(line, (start, stop), nodes, dead, (pattern, sums, extent))
            tail = 0.0
            for k in range(spectrum.shape[0]):
                tail += spectrum[k, 1] * spectrum[k, 0]
            tail *= spread / size**2 / (4.0 * math.pi * math.pi)
            _add_far(line, (start, stop), (place - edge, size, total * tail))

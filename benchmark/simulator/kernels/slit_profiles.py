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
Four = tuple[float, float, float, float]
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

#: Values a period of the finest fringe, but so many a half width at least; widths of an edge outside a shadow that are computed,
#: beyond which light falls with the square of the distance.
_FINE, _COARSEST, _OUTSIDE = 3.0, 8, 4.5
#: Light that comes in more obliquely than 88.9 deg is none.
_LEAST_COSINE = 0.02


@compiled
def _fresnel(u: float, table: Table) -> Four:
    """Fresnel's C and S of u by their smooth auxiliary functions f and g, and ``exp(i pi u^2 / 2)``.

    As in `diffraction_slits`: kernels call only their own file (see `compiled`).
    """
    auxiliary, per_unit = table
    size = abs(u)
    place = size * per_unit + 1.0
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
        q = 1.0 / (math.pi * size * size) ** 2
        f = (1.0 - 3.0 * q) / (math.pi * size)
        g = (1.0 - 15.0 * q) / (math.pi * math.pi * size * size * size)
    phase = math.pi / 2.0 * size * size
    sine, cosine = math.sin(phase), math.cos(phase)
    re, im = 0.5 + f * sine - g * cosine, 0.5 - f * cosine - g * sine
    return (re, im, cosine, sine) if u >= 0.0 else (-re, -im, cosine, sine)


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
def _spread(
    axis: Floats, sun: Floats, layers: Floats, thickness: float, slope: float, raised: float
) -> Four:
    """Return how a shadow of this slope spreads along the array, from a mask raised this far.

    ``J``; by what share of a distance x from an edge the cubic term of the phase moves a fringe,
    over x; ``J`` of the foil; how far apart the foil's rims appear. Fill `axis` with the direction
    on the sky, square to `sun`, in which the shadow moves fastest.
    """
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
def _rim(foil: float, apart: float, wavelength: float, table: Table) -> Pair:
    """Amplitude that a foil's outer rim cuts off the light bent around its inner one, summed up.

    A length, complex: the shadow's edge stands as much farther inside. Rims `apart` in the light's
    view, ``J = foil`` one above the other, spread light over a width of their own.
    """
    if foil == 0.0:
        return 0.0, 0.0
    size = math.sqrt(wavelength * foil)
    u = apart * math.sqrt(2.0) / size
    c, s, cosine, sine = _fresnel(u, table)
    # (i / pi) exp(i pi u^2 / 2) - u ((1 + i) / 2 - F(u)), turned by -45 deg
    re, im = -sine / math.pi - u * (0.5 - c), cosine / math.pi - u * (0.5 - s)
    half = size / 2.0 / math.sqrt(2.0)
    return half * (re + im), half * (im - re)


@compiled
def _intensity(
    light: Floats, spread: Four, steps: int, spectrum: Floats, table: Table
) -> float:
    """Fill (2, M) light about the middle, M odd, `steps` a half width; return the tail's factor.

    The second row is how light changes with the logarithm of ``J``. `spread` is `_spread` with
    lengths in half widths.
    """
    wide, cubic, foil, apart = spread
    reach = light.shape[1] // 2 + steps
    parts = np.empty((5, 2 * reach + 1))
    light[:] = 0.0
    tail = 0.0
    for m in range(spectrum.shape[0]):
        wavelength, weight = spectrum[m]
        tail += weight * wavelength * wide / (4.0 * math.pi * math.pi)
        unit = math.sqrt(2.0 / (wavelength * wide))
        for i in range(parts.shape[1]):
            place = (i - reach) / steps
            u = unit * place * (1.0 + cubic * place)
            here = _fresnel(u, table)
            for k in range(4):
                parts[k, i] = here[k]
            parts[4, i] = u
        # of each edge's wave: what the cubic term adds to it, and what the foil takes from it
        more = -cubic / (math.pi * unit)
        cut_re, cut_im = _rim(foil, apart, wavelength, table)
        cut_re, cut_im = unit * cut_re, unit * cut_im
        sharp = math.sqrt(2.0 * foil / wide)
        for i in range(light.shape[1]):
            j = i + 2 * steps
            cosine, sine, u = parts[2, j], parts[3, j], parts[4, j]
            turn_re, turn_im = u * cosine, u * sine
            share = 1.0 / (1.0 + sharp * abs(u))
            one, two = share * cut_re, more - share * cut_im
            re = parts[0, j] - one * cosine - two * sine
            im = parts[1, j] - one * sine + two * cosine
            cosine, sine, u = parts[2, i], parts[3, i], parts[4, i]
            turn_re -= u * cosine
            turn_im -= u * sine
            share = 1.0 / (1.0 + sharp * abs(u))
            one, two = share * cut_re, more + share * cut_im
            re -= parts[0, i] + one * cosine - two * sine
            im -= parts[1, i] + one * sine + two * cosine
            light[0, i] += weight * (re * re + im * im) / 2.0
            light[1, i] -= weight * (re * turn_re + im * turn_im) / 2.0
    return tail


@compiled
def _pattern(
    spread: Four, shear: float, spectrum: Floats, table: Table
) -> tuple[Floats, Floats, Extent]:
    """Return a slit's pattern and its running integral.

    Each (2, M): itself, and how it changes with the logarithm of ``J``. `shear` is by how much the
    shadow moves over half the pixels' height.
    """
    shortest, middle = spectrum[0, 0], math.sqrt(spectrum[0, 0] * spectrum[-1, 0])
    steps = max(math.ceil(2.0 * _FINE / (shortest * spread[0])), _COARSEST)
    ends = math.ceil((1.0 + _OUTSIDE * math.sqrt(middle * spread[0])) * steps)
    step = 1.0 / steps
    more = math.ceil(shear * steps) + 2
    count = 2 * (ends + more) + 1
    # the fringes' order must not turn back
    cubic = 0.2 * steps / (ends + more + steps)
    cubic = max(min(spread[1], cubic), -cubic)
    light = np.empty((2, count))
    tail = _intensity(light, (spread[0], cubic, spread[2], spread[3]), steps, spectrum, table)
    out, sums = np.empty((2, 2 * ends + 1)), np.empty((2, 2 * ends + 1))
    for k in range(2):
        _sheared(out[k], sums[k], light[k], shear, step)
    return out, sums, (step, ends * step, tail)


@compiled
def _sheared(out: Floats, sums: Floats, light: Floats, shear: float, step: float) -> None:
    """Fill a pattern sheared by so much on either side, and its running integral.

    The integral is exact for cubics; where the shear is less than half a step, the second
    derivative stands for it.
    """
    count = light.shape[0]
    more = (count - out.shape[0]) // 2
    single = np.zeros(count)
    for i in range(1, count - 2):
        inner = 13.0 * (light[i] + light[i + 1]) - light[i - 1] - light[i + 2]
        single[i + 1] = single[i] + step * inner / 24.0
    single[count - 1] = single[count - 2]
    if shear < step / 2.0:
        square = shear * shear / 6.0
        for i in range(out.shape[0]):
            j = i + more
            bend = light[j - 1] - 2.0 * light[j] + light[j + 1]
            out[i] = light[j] + square * bend / (step * step)
            sums[i] = single[j] + square * (light[j + 1] - light[j - 1]) / (2.0 * step)
        return
    double = np.zeros(count)
    for i in range(count - 1):
        rise = (single[i] + single[i + 1]) / 2.0 + step * (light[i] - light[i + 1]) / 12.0
        double[i + 1] = double[i] + step * rise
    for i in range(out.shape[0]):
        place = (i + more) * step
        after = _integrals(light, single, double, place + shear, step)
        before = _integrals(light, single, double, place - shear, step)
        out[i] = (after[0] - before[0]) / (2.0 * shear)
        sums[i] = (after[1] - before[1]) / (2.0 * shear)


@compiled
def _integrals(light: Floats, single: Floats, double: Floats, place: float, step: float) -> Pair:
    """First and second running integral of a pattern at a place (Hermite's cubic for the first)."""
    cell = int(place / step)
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
    shape: tuple[Floats, Floats, Extent],
) -> None:
    """Add the light of all chords to a span of pixels.

    `nodes` (Q, 4): middle, half width, light, by what share its ``J`` exceeds the pattern's.
    """
    pattern, sums, extent = shape
    here, total = np.empty(pattern.shape[1]), np.empty(pattern.shape[1])
    for q in range(nodes.shape[0]):
        middle, width, light, excess = nodes[q]
        if light == 0.0:
            continue
        for i in range(here.shape[0]):
            here[i] = pattern[0, i] + excess * pattern[1, i]
            total[i] = sums[0, i] + excess * sums[1, i]
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
    rays, nodes = np.empty((2 * chords.shape[0], 6)), np.empty((chords.shape[0], 4))
    axis, chief = np.empty(3), np.empty(6)
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
        pattern, sums, extent = np.empty((2, 0)), np.empty((2, 0)), (0.0, 0.0, 0.0)
        spread, size = (0.0, 0.0, 0.0, 0.0), 0.0
        for m in range(slits.shape[0]):
            slit = slits[m]
            place, wide, slope, _, raised = _shadow(slit, chief, plate)
            if wide <= 0.0:
                continue
            other = m == 0 or slit[3] != slits[m - 1, 3] or slit[6] != slits[m - 1, 6]
            if other or size == 0.0:
                size, known = wide, False
                spread = _spread(axis, sun[n], layers, plate[2], slope, raised)
                _points(rays, chords, (sun[n], axis, layers), slope, raised)
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
                wider = (first * rays[2 * q, 5] + second * rays[2 * q + 1, 5]) / light
                nodes[q, 3] = wider / spread[0] * (size / nodes[q, 1]) ** 2 - 1.0
                left, right = min(left, nodes[q, 0] + edge), max(right, nodes[q, 0] + edge)
            if total == 0.0:
                continue
            reach = size + _OUTSIDE * math.sqrt(middle * spread[0])
            start = min(max(math.floor(left - edge - reach), 0), width)
            stop = min(max(math.ceil(right - edge + reach), start), width)
            if stop > start:
                if not known:
                    shear = abs(slope) * half / size
                    scaled = (
                        spread[0] / size**2,
                        spread[1] * size,
                        spread[2] / size**2,
                        spread[3] / size,
                    )
                    pattern, sums, extent = _pattern(scaled, shear, spectrum, table)
                    known = True
                _add_near(line, (start, stop), nodes, dead, (pattern, sums, extent))
            tail = 0.0
            for k in range(spectrum.shape[0]):
                tail += spectrum[k, 1] * spectrum[k, 0]
            tail *= spread[0] / size**2 / (4.0 * math.pi * math.pi)
            _add_far(line, (start, stop), (place - edge, size, total * tail))

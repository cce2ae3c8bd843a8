"""Fits of a slit's diffracted image to the pixels of a line, one spot at a time.

Lengths are pixels of the line. An image is even about its middle: it is kept for places from 0 on,
with its first and second integrals and its slope to the next place, `light` (n, 4): what a pixel or
a slanted slit averages is a difference of those.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.cholesky import solve

Bools = NDArray[np.bool_]

#: Samples of the Fresnel integrals a unit of their argument.
FRESNEL_STEPS = 256
#: Light's own noise at the brightest pixel over that of reading, as variances: sets the weights,
#: on which the place depends little.
_PHOTONS = 5.0
#: How much of a pixel's width is expected to be deaf, or added by crosstalk, as a deviation: where
#: noise tells less than that, the width stays near a pixel's.
_WIDTH = 0.2
_WIDTHS = (1.0, 0.5, 1.5)
#: A width held at its value weighs by this; where it takes all but this of the light, it is.
_HELD, _DIMMER = 1e9, 0.25
_STEPS = 150
#: Pivot over diagonal below which an unknown is not determined.
_DEPENDENT = 1e-12
_LEAST_PART = 0.3
#: Steps after which what the width is expected to be weighs the same in all that follow.
_WEIGHED = 3
_SETTLED_PX = 1e-12
_SETTLED_WIDTH = 1e-9


@compiled
def _fresnel(u: float, table: Floats) -> tuple[float, float]:
    """Fresnel integrals C and S of u >= 0: cubic between samples, asymptotic beyond them."""
    place = u * FRESNEL_STEPS
    i = int(place)
    if i + 1 >= len(table):
        f, g = 1.0 / (math.pi * u), 1.0 / (math.pi**2 * u**3)
        cosine, sine = math.cos(0.5 * math.pi * u * u), math.sin(0.5 * math.pi * u * u)
        return 0.5 + f * sine - g * cosine, 0.5 - f * cosine - g * sine
    t, step = place - i, 1.0 / FRESNEL_STEPS
    even, odd = t * t * (3.0 - 2.0 * t), t * (1.0 - t)
    c = table[i, 0] + even * (table[i + 1, 0] - table[i, 0])
    s = table[i, 1] + even * (table[i + 1, 1] - table[i, 1])
    c += odd * step * ((1.0 - t) * table[i, 2] - t * table[i + 1, 2])
    s += odd * step * ((1.0 - t) * table[i, 3] - t * table[i + 1, 3])
    return c, s


@compiled
def _image(  # noqa: PLR0917 - Numba takes no keyword-only ones
    light: Floats,
    step: float,
    half: float,
    spread: float,
    blur: float,
    waves: Floats,
    chords: Floats,
    table: Floats,
) -> None:
    """Write what a slit of half width `half` casts, its integrals from the middle on and its slope.

    Light of wavelength l spreads over ``sqrt(l spread)``; the Sun blurs by `blur` on each side.
    """
    n = len(light)
    sharp = np.zeros(n)
    for w in range(len(waves)):
        scale = math.sqrt(2.0 / (waves[w, 0] * spread))
        for i in range(n):
            c, s = _fresnel(scale * (half + i * step), table)
            other = half - i * step
            d, e = _fresnel(scale * abs(other), table)
            if other < 0.0:
                d, e = -d, -e
            sharp[i] += waves[w, 1] * 0.5 * ((c + d) ** 2 + (s + e) ** 2)
    rims = chords[:, 0] * blur / step
    for i in range(n):
        total = 0.0
        for q in range(len(chords)):
            place = abs(i + rims[q])
            k = int(place)
            if k + 1 < n:
                total += chords[q, 1] * (sharp[k] + (place - k) * (sharp[k + 1] - sharp[k]))
        light[i, 0] = total
    light[0, 1] = light[0, 2] = light[n - 1, 3] = 0.0
    for i in range(1, n):
        before, here = light[i - 1, 0], light[i, 0]
        light[i - 1, 3] = (here - before) / step
        light[i, 1] = light[i - 1, 1] + 0.5 * step * (before + here)
        rise = light[i - 1, 1] * step + step * step * (before / 3.0 + here / 6.0)
        light[i, 2] = light[i - 1, 2] + rise


@compiled
def _at(light: Floats, step: float, place: float) -> tuple[float, float, float]:
    """Light at a place and its first and second integrals, linear between samples."""
    far = abs(place) / step
    i, n = int(far), len(light)
    if i + 1 >= n:
        here, slope, t = 0.0, 0.0, 0.0
        first = light[n - 1, 1]
        second = light[n - 1, 2] + (far - (n - 1)) * step * first
    else:
        t = (far - i) * step
        here, first, slope = light[i, 0], light[i, 1], light[i, 3]
        second = light[i, 2] + first * t + here * t * t / 2.0 + slope * t * t * t / 6.0
        first = first + here * t + 0.5 * slope * t * t
    return here + slope * t, -first if place < 0.0 else first, second


@compiled
def _terms(
    light: Floats, step: float, place: float, width: float, slanted: bool
) -> tuple[float, float, float]:
    """Return a pixel's light, and its derivatives by the spot's place and by `width`.

    `width` is the part of a pixel that is sensitive or, behind a slanted slit, what the height of
    the pixels spreads its image over.
    """
    if not slanted:
        low, left, _ = _at(light, step, place - 0.5 * width)
        high, right, _ = _at(light, step, place + 0.5 * width)
        return right - left, low - high, 0.5 * (low + high)
    pixel_left, pixel_right, box = place - 0.5, place + 0.5, width
    _, pa, a = _at(light, step, pixel_right + 0.5 * box)
    _, pb, b = _at(light, step, pixel_right - 0.5 * box)
    _, pc, c = _at(light, step, pixel_left + 0.5 * box)
    _, pd, d = _at(light, step, pixel_left - 0.5 * box)
    total = a - b
    total -= c - d
    mean = total / box
    return mean, (pb - pa + pc - pd) / box, (0.5 * (pa + pb - pc - pd) - mean) / box


@compiled
def _pattern(  # noqa: PLR0917 - Numba takes no keyword-only ones
    terms: Floats,
    lit: Bools,
    centres: Floats,
    reach: int,
    width: float,
    slanted: bool,
    light: Floats,
    step: float,
) -> None:
    """Write what slits at `centres` cast on each pixel (L, 3), and by what it changes."""
    terms[:] = 0.0
    for centre in centres:
        middle = math.floor(centre + 0.5)
        for x in range(max(middle - reach, 0), min(middle + reach, len(terms) - 1) + 1):
            if lit[x]:
                cast, by_place, by_width = _terms(light, step, x - centre, width, slanted)
                terms[x, 0] += cast
                terms[x, 1] += by_place
                terms[x, 2] += by_width


@compiled
def _equations(  # noqa: PLR0917 - Numba takes no keyword-only ones
    line: Floats,
    terms: Floats,
    pixels: NDArray[np.int64],
    peak: float,
    matrix: Floats,
    vector: Floats,
) -> float:
    """Write the normal equations of light, place, width and background; return the sum of squares.

    Noise grows with the light that is expected, against that of `peak`.
    """
    v0 = v1 = v2 = v3 = square = 0.0
    m00 = m10 = m11 = m20 = m21 = m22 = m30 = m31 = m32 = m33 = 0.0
    for x in pixels:
        cast, by_place, by_width, seen = terms[x, 0], terms[x, 1], terms[x, 2], line[x]
        weight = 1.0 / (1.0 + _PHOTONS * max(cast, 0.0) / peak)
        square += weight * seen**2
        light, place, wide = weight * cast, weight * by_place, weight * by_width
        v0 += light * seen
        v1 += place * seen
        v2 += wide * seen
        v3 += weight * seen
        m00 += light * cast
        m10 += place * cast
        m11 += place * by_place
        m20 += wide * cast
        m21 += wide * by_place
        m22 += wide * by_width
        m30 += weight * cast
        m31 += weight * by_place
        m32 += weight * by_width
        m33 += weight
    vector[0], vector[1], vector[2], vector[3] = v0, v1, v2, v3
    matrix[0, 0] = m00
    matrix[1, 0], matrix[1, 1] = m10, m11
    matrix[2, 0], matrix[2, 1], matrix[2, 2] = m20, m21, m22
    matrix[3, 0], matrix[3, 1], matrix[3, 2], matrix[3, 3] = m30, m31, m32, m33
    return float(square)


@compiled
def _shift(  # noqa: C901, PLR0917 - one fit; Numba takes no keyword-only ones
    line: Floats,
    starts: Floats,
    reach: int,
    widths: tuple[float, float, float],
    slanted: bool,
    light: Floats,
    step: float,
    terms: Floats,
    lit: Bools,
) -> float:
    """How far spots lie from their `starts` by least squares; NaN where that does not converge.

    `widths` are the first to be tried, the least and the largest.
    """
    lit[:] = False
    for start in starts:
        middle = math.floor(start + 0.5)
        lit[max(middle - reach, 0) : middle + reach + 1] = True
    pixels = np.flatnonzero(lit)
    width, least, most = widths
    shift, last, part, bright, firm, held = 0.0, 0.0, 1.0, 0.0, 0.0, not slanted
    matrix, vector = np.empty((4, 4)), np.empty(4)
    peak, _, _ = _terms(light, step, 0.0, width, slanted)
    for turn in range(_STEPS):
        _pattern(terms, lit, starts + shift, reach + 1, width, slanted, light, step)
        square = _equations(line, terms, pixels, peak, matrix, vector)
        if not slanted:
            matrix[2, 2] += _HELD * matrix[0, 0] if held else firm
            vector[2] += firm * bright * (1.0 - width)
        explained = vector.copy()
        if not solve(matrix, vector, _DEPENDENT) or not abs(shift) < reach:
            return math.nan
        if turn == 0:
            bright, held = vector[0], False
        if not vector[0] > _DIMMER * bright:
            if held or turn == 0:
                return math.nan
            held = True  # light and width cannot be distinguished: a pixel is as wide as it is
            continue
        if turn < _WEIGHED:
            noise = max(square - (explained * vector).sum(), 0.0) / max(len(pixels) - 4, 1)
            firm = noise / (bright * _WIDTH) ** 2
        move = max(-1.0, min(1.0, vector[1] / vector[0]))
        wider = max(-0.3 * width, min(0.3 * width, vector[2] / vector[0]))
        wider = max(least, min(most, width + wider)) - width
        if move * last < 0.0:  # to and fro: shorter steps end it
            part = max(_LEAST_PART, 0.7 * part)
        last = part * move
        shift += last
        width += part * wider
        if turn > _WEIGHED and abs(last) < _SETTLED_PX and abs(wider) < _SETTLED_WIDTH:
            return float(shift)
    return math.nan


@compiled
def add_shifts(  # noqa: PLR0917 - Numba takes no keyword-only ones
    shifts: Floats,
    lines: Floats,
    slits: Floats,
    shapes: Floats,
    reach: int,
    waves: Floats,
    chords: Floats,
    table: Floats,
) -> None:
    """Add to `shifts` (R, G) how far the spots on lines (R, L) lie from there.

    Parameters
    ----------
    shifts
        Of the spots of each slant; NaN where no light is, or where a fit does not converge.
    slits
        (S, 3): place at zero shift, slant's number in G, and 1 where the height of the pixels
        widens the spot, else 0.
    shapes
        (R, G, 3): half width, spread (what a wavelength is multiplied by before the root), blur.
    reach
        Pixels on each side of a spot that are fitted.
    waves, chords
        (W, 2) wavelengths and (Q, 2) chords of the Sun in units of its radius, with weights.
    table
        (M, 4) Fresnel integrals and their derivatives, `FRESNEL_STEPS` a unit.
    """
    shortest = waves[:, 0].min()
    terms, lit = np.empty((lines.shape[1], 3)), np.empty(lines.shape[1], dtype=np.bool_)
    for r in range(len(lines)):
        for g in range(shifts.shape[1]):
            half, spread, blur = shapes[r, g]
            if not (math.isfinite(shifts[r, g]) and half > 0.0 and spread > 0.0):
                shifts[r, g] = math.nan
                continue
            mine = slits[slits[:, 1] == g]
            slanted = mine[0, 2] > 0.0
            step = min(0.25, math.sqrt(shortest * spread) / 24.0)
            length = 2.0 * reach + 4.0 if slanted else reach + 3.0
            light = np.empty((int(length / step) + 2, 4))
            _image(light, step, half, spread, blur, waves, chords, table)
            widths = (0.5 * half, 0.05, 2.0 * reach) if slanted else _WIDTHS
            starts = mine[:, 0] + shifts[r, g]
            shifts[r, g] += _shift(
                lines[r], starts, reach, widths, slanted, light, step, terms, lit
            )

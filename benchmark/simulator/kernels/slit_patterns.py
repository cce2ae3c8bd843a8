"""Compiled patterns of endless slits, summed over a spectrum (loaded on first use: Numba).

`slit_diffraction` has the physics. A pattern is made on a grid of its own for every sample and
shape of slit. In lengths of a half width, the slit's edges are at -1 and 1; the open light is 1.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from benchmark.simulator.kernels.fresnel import Table, fresnel

Pair = tuple[float, float]
Four = tuple[float, float, float, float]

#: Values a period of the finest fringe, but so many a half width at least; widths of an edge
#: outside a shadow that are computed, beyond which light falls with the square of the distance.
_FINE, _COARSEST, _OUTSIDE = 4.0, 8, 4.5


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
    c, s, cosine, sine = fresnel(u, table)
    # (i / pi) exp(i pi u^2 / 2) - u ((1 + i) / 2 - F(u)), turned by -45 deg
    re, im = -sine / math.pi - u * (0.5 - c), cosine / math.pi - u * (0.5 - s)
    half = size / 2.0 / math.sqrt(2.0)
    return half * (re + im), half * (im - re)


@compiled
def _intensity(light: Floats, spread: Four, steps: int, spectrum: Floats, table: Table) -> None:
    """Fill (2, M) light about the middle, M odd, `steps` a half width.

    The second row is how light changes with the logarithm of ``J``. `spread` is a row of
    `patterns` but for its shear.
    """
    wide, cubic, foil, apart = spread
    reach = light.shape[1] // 2 + steps
    parts = np.empty((5, 2 * reach + 1))
    light[:] = 0.0
    for m in range(spectrum.shape[0]):
        wavelength, weight = spectrum[m]
        unit = math.sqrt(2.0 / (wavelength * wide))
        for i in range(parts.shape[1]):
            place = (i - reach) / steps
            u = unit * place * (1.0 + cubic * place)
            here = fresnel(u, table)
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
def _shear(out: Floats, sums: Floats, light: Floats, shear: float, step: float) -> None:
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
def grids(out: NDArray[np.int64], shapes: Floats, spectrum: Floats) -> None:
    """Fill (M, 3) grids for `patterns`: steps a half width, steps to either end, and spare ones.

    No steps where the first column of `shapes` is 0: no light.
    """
    shortest, middle = spectrum[0, 0], math.sqrt(spectrum[0, 0] * spectrum[-1, 0])
    for m in range(out.shape[0]):
        wide, shear = shapes[m, 0], shapes[m, 4]
        out[m] = 0
        if wide > 0.0:
            steps = max(math.ceil(2.0 * _FINE / (shortest * wide)), _COARSEST)
            out[m, 0] = steps
            out[m, 1] = math.ceil((1.0 + shear + _OUTSIDE * math.sqrt(middle * wide)) * steps)
            out[m, 2] = math.ceil(shear * steps) + 2


@compiled
def patterns(
    out: Floats,
    found: tuple[NDArray[np.int64], NDArray[np.int64]],
    shapes: Floats,
    spectrum: Floats,
    table: Table,
) -> None:
    """Fill patterns one after the other, (4, total): light, its integral, and how both change.

    The third and fourth row are derivatives by the logarithm of ``J``.

    Parameters
    ----------
    out
        Overwritten; 2 ends + 1 columns a shape.
    found
        (M, 3) `grids`; (M,) where the columns of each shape begin.
    shapes
        (M, 5) ``J`` along the array over the squared half width; by what share of a distance from
        an edge, in half widths, the cubic term of the phase moves a fringe, over that distance;
        ``J`` of the foil; how far apart its rims appear; by how much the shadow moves over half the
        pixels' height.
    spectrum
        (S, 2) wavelengths in the unit of the half width squared over ``J``, and weights.
    table
        Of the Fresnel integrals.
    """
    grid, starts = found
    for m in range(shapes.shape[0]):
        steps, ends, more = grid[m]
        if steps == 0:
            continue
        # the fringes' order must not turn back
        limit = 0.2 * steps / (ends + more + steps)
        cubic = max(min(shapes[m, 1], limit), -limit)
        light = np.empty((2, 2 * (ends + more) + 1))
        spread = (shapes[m, 0], cubic, shapes[m, 2], shapes[m, 3])
        _intensity(light, spread, steps, spectrum, table)
        start, stop = starts[m], starts[m] + 2 * ends + 1
        for k in range(2):
            one, two = out[2 * k, start:stop], out[2 * k + 1, start:stop]
            _shear(one, two, light[k], shapes[m, 4], 1.0 / steps)

"""Compiled diffraction of rectangles and slits: Fresnel integrals, pixel by pixel.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

Complex = tuple[float, float]
#: (2, M) auxiliary functions of the Fresnel integrals from -1 step on, and steps a unit.
Table = tuple[Floats, float]


@compiled
def _shares(fraction: float) -> tuple[float, float, float, float]:
    """Weights of the four nodes -1, 0, 1, 2 in Lagrange's cubic, as `diffraction.shares`.

    A copy: kernels call only their own file (see `compiled`).
    """
    t = fraction
    return (
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    )


@compiled
def _fresnel(u: float, table: Table) -> Complex:
    """Fresnel's C and S of u by their smooth auxiliary functions f and g.

    Beyond the table the asymptotic series is used.
    """
    auxiliary, per_unit = table
    size = abs(u)
    place = size * per_unit + 1.0
    if place < auxiliary.shape[1] - 3.0:
        first = int(place)
        a, b, c, d = _shares(place - first)
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
    re = 0.5 + f * sine - g * cosine
    im = 0.5 - f * cosine - g * sine
    return (re, im) if u >= 0.0 else (-re, -im)


@compiled
def _slit(position: float, number: float, table: Table) -> float:
    """As `diffraction.slit_intensity`."""
    root = math.sqrt(2.0 * number)
    re, im = _fresnel(root * (position + 1.0), table)
    other_re, other_im = _fresnel(root * (position - 1.0), table)
    return float(((re - other_re) ** 2 + (im - other_im) ** 2) / 2.0)


@compiled
def intensities(out: Floats, positions: Floats, number: float, table: Table) -> None:
    """`diffraction.slit_intensity` at (M,) positions, from the table the frames use."""
    for n in range(out.shape[0]):
        out[n] = _slit(positions[n], number, table)


@compiled
def _sums(profiles: Floats, span: Complex, half: float, number: float, table: Table) -> float:
    """Fill (2, M) a slit's profile at equal steps over a span, and its running integral.

    Span and half width in one unit; the integral starts at the second value and is exact for
    cubics. Returns the step.
    """
    profile, sums = profiles
    count = profile.shape[0]
    step = (span[1] - span[0]) / (count - 3)
    for i in range(count):
        profile[i] = _slit((span[0] + (i - 1) * step) / half, number, table)
    sums[1] = 0.0
    for i in range(1, count - 2):
        inner = 13.0 * (profile[i] + profile[i + 1]) - profile[i - 1] - profile[i + 2]
        sums[i + 1] = sums[i] + step * inner / 24.0
    return float(step)


@compiled
def _per_pixel(out: Floats, profiles: Floats, step: float, start: float, pitch: float) -> None:
    """Means of a profile over pixels, from its running integral (Hermite's cubic between).

    `start` is the first pixel's edge, seen from where the integral starts.
    """
    profile, sums = profiles
    before = 0.0
    for column in range(-1, out.shape[0]):
        place = (start + (column + 1) * pitch) / step
        cell = min(max(int(place), 0), sums.shape[0] - 4)
        t = place - cell
        cell += 1
        rise = sums[cell + 1] - sums[cell]
        first, last = step * profile[cell] - rise, rise - step * profile[cell + 1]
        value = sums[cell] + t * rise + t * (1.0 - t) * ((1.0 - t) * first + t * last)
        if column >= 0:
            out[column] = (value - before) / pitch
        before = value


@compiled
def add_rectangle(
    flux: Floats,
    samples: tuple[Floats, Floats, Floats, Floats],
    sizes: Floats,
    spectrum: Floats,
    table: Table,
) -> None:
    """Add the light behind one rectangle, its sides along the pixel rows, to frames.

    Parameters
    ----------
    flux
        (N, H, W) light averaged over each pixel.
    samples
        (N, K, 2) landing points through the aperture's centre, mm, and (N, K) light, of each of
        the K points of the Sun; (N, 2) the window's first corner, mm; (N, 2) change of the
        landing point a unit of direction cosine along x and y, mm.
    sizes
        (3,) half width, half height, pixel pitch, mm.
    spectrum
        (L, 2) wavelengths in mm and weights.
    table
        For `_fresnel`.
    """
    spots, light, corner, spread = samples
    count, rows, columns = flux.shape
    pitch = sizes[2]
    across, along = np.empty(columns), np.empty(rows)
    for n in range(count):
        if light[n].max() == 0.0:
            continue
        first_x, first_y = corner[n, 0] - spots[n, :, 0].max(), corner[n, 1] - spots[n, :, 1].max()
        last_x = corner[n, 0] + columns * pitch - spots[n, :, 0].min()
        last_y = corner[n, 1] + rows * pitch - spots[n, :, 1].min()
        for m in range(spectrum.shape[0]):
            wavelength, weight = spectrum[m]
            # eight values a period of the finest fringe, eight a pixel
            fine_x = min(pitch, wavelength * spread[n, 0] / (2.0 * sizes[0])) / 8.0
            fine_y = min(pitch, wavelength * spread[n, 1] / (2.0 * sizes[1])) / 8.0
            by_x = np.zeros((2, math.ceil((last_x - first_x) / fine_x) + 4))
            by_y = np.zeros((2, math.ceil((last_y - first_y) / fine_y) + 4))
            number = sizes[0] ** 2 / (wavelength * spread[n, 0])
            step_x = _sums(by_x, (first_x, last_x), sizes[0], number, table)
            number = sizes[1] ** 2 / (wavelength * spread[n, 1])
            step_y = _sums(by_y, (first_y, last_y), sizes[1], number, table)
            for k in range(light.shape[1]):
                if light[n, k] == 0.0:
                    continue
                start_x = corner[n, 0] - spots[n, k, 0] - first_x
                start_y = corner[n, 1] - spots[n, k, 1] - first_y
                _per_pixel(across, by_x, step_x, start_x, pitch)
                _per_pixel(along, by_y, step_y, start_y, pitch)
                share = weight * light[n, k]
                for row in range(rows):
                    here = share * along[row]
                    for column in range(columns):
                        flux[n, row, column] += here * across[column]

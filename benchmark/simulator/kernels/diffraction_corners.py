"""What the coupling of both axes adds at the corners of a rectangle: tables, and light from them.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

Complex = tuple[float, float]
Four = tuple[float, float, float, float]
Three = tuple[float, float, float]


@compiled
def _coupled(fx: float, fy: float, spreads: Three, spectrum: Floats) -> Four:
    """Return what coupling adds to the transform of a corner's light at a frequency.

    Real and imaginary part, for positive and for negative coupling; neither frequency may be 0.
    """
    jw, jv, jc = spreads
    unit = -1.0 / (4.0 * math.pi * math.pi * fx * fy)
    near = fx * abs(jw * fx) + fy * abs(jv * fy)
    moved = fx * abs(jw * fx + jc * fy) + fy * abs(jv * fy + jc * fx)
    other = fx * abs(jw * fx - jc * fy) + fy * abs(jv * fy - jc * fx)
    a, b, c, d = 0.0, 0.0, 0.0, 0.0
    for m in range(spectrum.shape[0]):
        wave, share = math.pi * spectrum[m, 0], unit * spectrum[m, 1]
        cosine, sine = math.cos(wave * near), math.sin(wave * near)
        a += share * (math.cos(wave * moved) - cosine)
        b += share * (math.sin(wave * moved) - sine)
        c += share * (math.cos(wave * other) - cosine)
        d += share * (math.sin(wave * other) - sine)
    return a, b, c, d


@compiled
def _disc(p: float, q: float, radial: Floats) -> float:
    """Transform of the unit disc, from a table; 0 beyond it."""
    cycles = 16.0 * math.sqrt(p * p + q * q)
    cell = int(cycles)
    if cell >= radial.shape[0] - 1:
        return 0.0
    return float(radial[cell] + (cycles - cell) * (radial[cell + 1] - radial[cell]))


@compiled
def _box(cycles: float) -> float:
    """Transform of a pixel, at a frequency in cycles a pixel other than 0."""
    return math.sin(math.pi * cycles) / (math.pi * cycles)


@compiled
def corner_patches(
    out: Floats, design: Floats, spectrum: Floats, radial: Floats, grid: Floats
) -> None:
    """Fill (2, M, M) what the coupling of both axes adds about a corner, all others far off.

    In units of the open light, Sun, spectrum and pixels included. Intensity has a Fourier
    transform in closed form: a rectangle and itself, moved by ``lambda J f``, share a rectangle.
    The sines of its sides are two exponentials each: a term for every corner.

    Parameters
    ----------
    out
        Opening at negative coordinates; first where coupling is positive, then where negative.
    design
        (8,) ``J_ww, J_vv, J_wv`` in mm; the disc's image: semi-axis, shear, height; pixel pitch
        in mm; steps a root of millimetres.
    spectrum
        (L, 2) wavelengths in mm and weights.
    radial
        (Z,) transform of the unit disc at equal steps of 1/16 of its cycles a radius.
    grid
        (3,) steps of frequency across and along, and the largest frequency, a mm.
    """
    jw, jv, jc, wide, shear, high, pitch, per_root = design
    step_x, step_y, most = grid
    size = out.shape[1]
    reach, tall = int(most / step_x), int(most / step_y)
    x, y = np.empty(size), np.empty(size)
    for i in range(size):
        at = (i - (size - 1) / 2.0) / per_root
        x[i], y[i] = at * math.sqrt(jw), at * math.sqrt(jv)
    # frequencies lie half a step off 0, where the transform of one corner jumps; across only
    # positive ones: it is Hermitian
    cosines, sines = np.empty((2 * tall, size)), np.empty((2 * tall, size))
    for j in range(2 * tall):
        for i in range(size):
            phase = 2.0 * math.pi * (j - tall + 0.5) * step_y * y[i]
            cosines[j, i], sines[j, i] = math.cos(phase), math.sin(phase)
    sums = np.zeros((4, reach, size))
    for k in range(reach):
        fx = (k + 0.5) * step_x
        for j in range(2 * tall):
            fy = (j - tall + 0.5) * step_y
            first = _disc(wide * fx, high * fy + shear * fx, radial)
            second = _disc(wide * fx, high * fy - shear * fx, radial)
            if first == 0.0 and second == 0.0:
                continue
            box = _box(fx * pitch) * _box(fy * pitch)
            a, b, c, d = _coupled(fx, fy, (jw, jv, jc), spectrum)
            a, b, c, d = first * box * a, first * box * b, second * box * c, second * box * d
            for i in range(size):
                cosine, sine = cosines[j, i], sines[j, i]
                sums[0, k, i] += a * cosine - b * sine
                sums[1, k, i] += a * sine + b * cosine
                sums[2, k, i] += c * cosine - d * sine
                sums[3, k, i] += c * sine + d * cosine
    for kind in range(2):
        _from_frequencies(out[kind], (sums[2 * kind], sums[2 * kind + 1]), x, (step_x, step_y))


@compiled
def _from_frequencies(out: Floats, parts: tuple[Floats, Floats], x: Floats, steps: Complex) -> None:
    """Write a corner from sums along one axis, over positive frequencies across."""
    re, im = parts
    step_x, step_y = steps
    out[:] = 0.0
    size = x.shape[0]
    for k in range(re.shape[0]):
        for column in range(size):
            phase = 2.0 * math.pi * (k + 0.5) * step_x * x[column]
            cosine = 2.0 * step_x * step_y * math.cos(phase)
            sine = 2.0 * step_x * step_y * math.sin(phase)
            for row in range(size):
                out[row, column] += cosine * re[k, row] - sine * im[k, row]


@compiled
def _shares(fraction: float) -> Four:
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
def _corners(patches: Floats, tables: Floats, places: Complex) -> None:
    """Interpolate (2, M, M) corners at a place among (T, T, 2, M, M) incidences (cubic)."""
    nodes = tables.shape[0]
    patches[:] = 0.0
    first = min(max(int(places[0]), 1), nodes - 3)
    other = min(max(int(places[1]), 1), nodes - 3)
    outer, inner = _shares(places[0] - first), _shares(places[1] - other)
    size = tables.shape[3]
    for i in range(4):
        for j in range(4):
            share = outer[i] * inner[j]
            table = tables[first - 1 + i, other - 1 + j]
            for kind in range(2):
                for row in range(size):
                    for column in range(size):
                        patches[kind, row, column] += share * table[kind, row, column]


@compiled
def _cubic(table: Floats, x: float, y: float) -> float:
    """Value of a (rows, columns) table at column x, row y (Lagrange's cubic); 0 outside."""
    column, row = math.floor(x), math.floor(y)
    if column < 1 or row < 1 or column > table.shape[1] - 3 or row > table.shape[0] - 3:
        return 0.0
    a, b, c, d = _shares(x - column)
    shares = _shares(y - row)
    total = 0.0
    for i in range(4):
        line = table[row - 1 + i]
        total += shares[i] * (
            a * line[column - 1] + b * line[column] + c * line[column + 1] + d * line[column + 2]
        )
    return total


@compiled
def _add_in_rows(
    out: Floats, patches: Floats, places: Four, steps: Complex, kinds: tuple[int, int]
) -> None:
    """Add all four corners to (rows, columns) of pixels along the sides.

    `places` are x and y of the first pixel's centre, seen from the spot's middle, and half sizes,
    `steps` the pitch, all in steps of the patches; `kinds` of corners on the rising and on the
    falling diagonal.
    """
    size = patches.shape[1]
    middle = (size - 1) / 2.0
    line = np.empty(size)
    for row in range(out.shape[0]):
        for along in (-1.0, 1.0):
            y = along * (places[1] + row * steps[1]) - places[3] + middle
            low = math.floor(y)
            if low < 1 or low > size - 3:
                continue
            a, b, c, d = _shares(y - low)
            for across in (-1.0, 1.0):
                patch = patches[kinds[0] if across == along else kinds[1]]
                for i in range(size):
                    line[i] = (
                        a * patch[low - 1, i]
                        + b * patch[low, i]
                        + c * patch[low + 1, i]
                        + d * patch[low + 2, i]
                    )
                for column in range(out.shape[1]):
                    x = across * (places[0] + column * steps[0]) - places[2] + middle
                    left = math.floor(x)
                    if 1 <= left <= size - 3:
                        shares = _shares(x - left)
                        total = shares[0] * line[left - 1] + shares[1] * line[left]
                        total += shares[2] * line[left + 1] + shares[3] * line[left + 2]
                        out[row, column] += total


@compiled
def add_corners(
    flux: Floats,
    samples: tuple[Floats, Floats, Floats],
    turn: Floats,
    corners: tuple[Floats, float],
) -> None:
    """Add to frames what coupling adds at the four corners of a rectangle.

    Every corner adds its own, wherever the pixel: light is continuous in the Sun. Where two
    corners lie so near that fringes between them outlast the Sun and the pixel, those are left
    out: 0.004 of the open light behind a hole of 0.2 mm, 2 mm high, at 55 deg along both sides;
    behind a slit of 0.1 mm, 1.2 mm high, 0.007 at 45 deg and 0.05 at 60.

    Parameters
    ----------
    flux
        (N, H, W) light averaged over each pixel.
    samples
        (N, 2) middle of the spot seen from the window's first corner, mm; (N, 6) light, half
        sizes, change of the landing point a unit of direction cosine, what couples both, -1 to 1;
        (N, 2) coordinates among the corners' incidences.
    turn
        (3,) cosine and sine of the rectangle's turn, pixel pitch in mm.
    corners
        (T, T, 2, M, M) what corners add, and their steps a root of millimetres.
    """
    middles, shapes, places = samples
    c, s, pitch = turn
    tables, per_root = corners
    size = tables.shape[3]
    middle = (size - 1) / 2.0
    patches = np.empty((2, size, size))
    for n in range(flux.shape[0]):
        light, a, b, spread_x, spread_y, coupling = shapes[n]
        if light == 0.0 or a <= 0.0 or b <= 0.0 or coupling == 0.0:
            continue
        _corners(patches, tables, (places[n, 0], places[n, 1]))
        patches *= light
        unit_x, unit_y = per_root / math.sqrt(spread_x), per_root / math.sqrt(spread_y)
        kinds = (0, 1) if coupling > 0.0 else (1, 0)
        x, y = pitch / 2.0 - middles[n, 0], pitch / 2.0 - middles[n, 1]
        if s == 0.0 and c == 1.0:
            first = x * unit_x, y * unit_y, a * unit_x, b * unit_y
            _add_in_rows(flux[n], patches, first, (pitch * unit_x, pitch * unit_y), kinds)
            continue
        for row in range(flux.shape[1]):
            for column in range(flux.shape[2]):
                dx, dy = x + column * pitch, y + row * pitch
                w, v = (c * dx + s * dy) * unit_x, (c * dy - s * dx) * unit_y
                for i in range(4):
                    across, along = 2.0 * (i // 2) - 1.0, 2.0 * (i % 2) - 1.0
                    flux[n, row, column] += _cubic(
                        patches[kinds[0] if across == along else kinds[1]],
                        across * w - a * unit_x + middle,
                        along * v - b * unit_y + middle,
                    )

"""Tables of what the coupling of both axes adds at the corners of a rectangle.

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
#: Share of a wave that Sun and pixels leave, below which an end does without it.
_FAINT = 1e-3


@compiled
def _couple(fx: float, fy: float, spreads: Three, spectrum: Floats) -> Four:
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
def _spline(cycles: float) -> float:
    """Transform of a cubic B-spline's values at the nodes, at so many cycles a step.

    Light over it are the coefficients of the spline through all nodes.
    """
    return (2.0 + math.cos(2.0 * math.pi * cycles)) / 3.0


@compiled
def _nodes(size: int, spread: float, per_root: float) -> Floats:
    """Places (M,) of nodes about 0, so many to the root of a spread."""
    places = np.empty(size)
    for i in range(size):
        at = (i - (size - 1) / 2.0) / per_root
        places[i] = at * math.sqrt(spread)
    return places


@compiled
def _waves(tall: int, step: float, y: Floats) -> tuple[Floats, Floats]:
    """Cosines and sines (2 tall, M) of waves at places y.

    Frequencies lie half a step off 0, where the transform of one corner jumps; across only
    positive ones count: it is Hermitian.
    """
    size = y.shape[0]
    cosines, sines = np.empty((2 * tall, size)), np.empty((2 * tall, size))
    for j in range(2 * tall):
        for i in range(size):
            phase = 2.0 * math.pi * (j - tall + 0.5) * step * y[i]
            cosines[j, i], sines[j, i] = math.cos(phase), math.sin(phase)
    return cosines, sines


@compiled
def corner_patches(
    out: Floats, design: Floats, spectrum: Floats, radial: Floats, grid: Floats
) -> None:
    """Fill (2, M, M) what the coupling of both axes adds about a corner, all others far off.

    In units of the open light, Sun, spectrum and pixels included, as the coefficients of a cubic
    spline: between nodes, Lagrange's cubic blurred fringes by 1 % of peak. Intensity has a Fourier
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
    x, y = _nodes(size, jw, per_root), _nodes(size, jv, per_root)
    node_x, node_y = x[1] - x[0], y[1] - y[0]
    cosines, sines = _waves(tall, step_y, y)
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
            box /= _spline(fx * node_x) * _spline(fy * node_y)
            a, b, c, d = _couple(fx, fy, (jw, jv, jc), spectrum)
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
def _lost(fx: float, fy: float, spreads: Four, spectrum: Floats) -> Complex:
    """Return what two corners so close together lack of two lone ones, at a frequency.

    Where light of a rectangle is moved by more than its size it has nothing in common with itself;
    corners by themselves do not know.
    """
    jw, jv, jc, size = spreads
    moved = abs(jw * fx + jc * fy), abs(jv * fy + jc * fx)
    near = abs(jw * fx), abs(jv * fy)
    unit = 1.0 / (2.0 * math.pi * math.pi * fx * fy)
    re, im = 0.0, 0.0
    for m in range(spectrum.shape[0]):
        wave, share = spectrum[m, 0], unit * spectrum[m, 1]
        if wave * moved[0] > size:
            sine = share * math.sin(math.pi * fx * (size - wave * moved[0]))
            re += sine * math.sin(math.pi * fy * wave * moved[1])
            im -= sine * math.cos(math.pi * fy * wave * moved[1])
        if wave * near[0] > size:
            sine = share * math.sin(math.pi * fx * (size - wave * near[0]))
            re -= sine * math.sin(math.pi * fy * wave * near[1])
            im += sine * math.cos(math.pi * fy * wave * near[1])
    return re, im


@compiled
def end_patch(out: Floats, design: Floats, spectrum: Floats, radial: Floats, grid: Floats) -> None:
    """Fill (M, M) what lacks of two lone corners at the end of a slit, where they lie close by.

    Units and parameters as of `corner_patches`, but that `design` (9,) ends with the slit's full
    width, coupling is positive, columns count from the slit's middle, and rows from its end.
    """
    jw, jv, jc, wide, shear, high, pitch, per_root, width = design
    step_x, step_y, most = grid
    size = out.shape[1]
    reach, tall = int(most / step_x), int(most / step_y)
    longest = 0.0
    for m in range(spectrum.shape[0]):
        longest = max(longest, spectrum[m, 0])
    x, y = _nodes(size, jw, per_root), _nodes(size, jv, per_root)
    node_x, node_y = x[1] - x[0], y[1] - y[0]
    cosines, sines = _waves(tall, step_y, y)
    sums = np.zeros((2, reach, size))
    for k in range(reach):
        fx = (k + 0.5) * step_x
        for j in range(2 * tall):
            fy = (j - tall + 0.5) * step_y
            if longest * max(abs(jw * fx + jc * fy), jw * fx) <= width:
                continue
            light = _disc(wide * fx, high * fy + shear * fx, radial)
            light *= _box(fx * pitch) * _box(fy * pitch)
            if abs(light) < _FAINT:
                continue
            light /= _spline(fx * node_x) * _spline(fy * node_y)
            a, b = _lost(fx, fy, (jw, jv, jc, width), spectrum)
            a, b = light * a, light * b
            for i in range(size):
                cosine, sine = cosines[j, i], sines[j, i]
                sums[0, k, i] += a * cosine - b * sine
                sums[1, k, i] += a * sine + b * cosine
    _from_frequencies(out, (sums[0], sums[1]), x, (step_x, step_y))


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

"""Compiled tables of what the coupling of both axes adds at the corners of a rectangle.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

Complex = tuple[float, float]


@compiled
def _overlap(frequency: float, length: float) -> float:
    """Fourier integral over a length; the length itself at frequency 0."""
    if length <= 0.0:
        return 0.0
    if frequency == 0.0:
        return length
    return math.sin(math.pi * frequency * length) / (math.pi * frequency)


@compiled
def _coupled(fx: float, fy: float, design: Floats, spectrum: Floats) -> float:
    """Return what coupling adds to the transform of a rectangle's light at a frequency."""
    a, b, jw, jv, jc = design[:5]
    total = 0.0
    for m in range(spectrum.shape[0]):
        wave, share = spectrum[m]
        near = abs(jw * fx) * wave, abs(jv * fy) * wave
        moved = abs(jw * fx + jc * fy) * wave, abs(jv * fy + jc * fx) * wave
        total += share * (
            _overlap(fx, 2.0 * a - moved[0]) * _overlap(fy, 2.0 * b - moved[1])
            - _overlap(fx, 2.0 * a - near[0]) * _overlap(fy, 2.0 * b - near[1])
        )
    return total


@compiled
def corner_patches(
    out: Floats, design: Floats, spectrum: Floats, radial: Floats, grid: Floats
) -> None:
    """Fill (2, M, M) what the coupling of both axes adds about the corners of a rectangle.

    In units of the open light, Sun, spectrum and pixels included. Intensity has a Fourier
    transform in closed form: a rectangle and itself, moved by ``lambda J f``, share a rectangle.

    Parameters
    ----------
    out
        First where both coordinates grow with the coupling, then where one of them does.
    design
        (10,) half sizes; ``J_ww, J_vv, J_wv`` in mm; the disc's image: semi-axis, shear, height;
        pixel pitch in mm; steps a root of millimetres.
    spectrum
        (L, 2) wavelengths in mm and weights.
    radial
        (Z,) transform of the unit disc at equal steps of 1/16 of its cycles a radius.
    grid
        (3,) steps of frequency across and along, and the largest frequency, a mm.
    """
    a, b, jw, jv, _, wide, shear, high, pitch, per_root = design
    step_x, step_y, most = grid
    size = out.shape[1]
    reach, tall = int(most / step_x), int(most / step_y)
    x, y = np.empty(size), np.empty(size)
    for i in range(size):
        at = (i - (size - 1) / 2.0) / per_root
        x[i], y[i] = a + at * math.sqrt(jw), b + at * math.sqrt(jv)
    # frequencies across from 0 on, along of both signs: the transform is real and even
    even, odd = np.zeros((reach + 1, size)), np.zeros((reach + 1, size))
    cosines, sines = np.empty((2 * tall + 1, size)), np.empty((2 * tall + 1, size))
    for j in range(2 * tall + 1):
        for i in range(size):
            phase = 2.0 * math.pi * (j - tall) * step_y * y[i]
            cosines[j, i], sines[j, i] = math.cos(phase), math.sin(phase)
    for k in range(reach + 1):
        fx = k * step_x
        box_x = _overlap(fx * pitch, 1.0)
        for j in range(2 * tall + 1):
            fy = (j - tall) * step_y
            p, q = wide * fx, shear * fx + high * fy
            cycles = 16.0 * math.sqrt(p * p + q * q)
            cell = int(cycles)
            if cell >= radial.shape[0] - 1:
                continue
            disc = radial[cell] + (cycles - cell) * (radial[cell + 1] - radial[cell])
            total = _coupled(fx, fy, design, spectrum)
            total *= disc * box_x * _overlap(fy * pitch, 1.0)
            for i in range(size):
                even[k, i] += total * cosines[j, i]
                odd[k, i] += total * sines[j, i]
    _from_frequencies(out, (even, odd), x, (step_x, step_y))


@compiled
def _from_frequencies(out: Floats, parts: tuple[Floats, Floats], x: Floats, steps: Complex) -> None:
    """Write both kinds of corner from sums along one axis, over frequencies across."""
    even, odd = parts
    step_x, step_y = steps
    out[:] = 0.0
    size = x.shape[0]
    for k in range(even.shape[0]):
        twice = step_x * step_y if k == 0 else 2.0 * step_x * step_y
        for column in range(size):
            phase = 2.0 * math.pi * k * step_x * x[column]
            cosine, sine = twice * math.cos(phase), twice * math.sin(phase)
            for row in range(size):
                plain, crossed = cosine * even[k, row], sine * odd[k, row]
                out[0, row, column] += plain - crossed
                out[1, row, column] += plain + crossed

"""Compiled running integrals of the light behind slits: tables of `rectangle_patterns`.

Loaded on first use (Numba).
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from benchmark.simulator.kernels.fresnel import Table, fresnel

Complex = tuple[float, float]
Four = tuple[float, float, float, float]
#: Half waves from an edge at which its terms of first order fade out: fringes further out have
#: turned by more than they describe, and neither Sun nor colours leave any.
_SKEWED = 8.0


@compiled
def _slit(position: float, number: float, softness: float, table: Table) -> float:
    """Intensity behind an endless slit, in units of the open light.

    At a position in units of the slit's half width, for a Fresnel number of the half width.
    `softness` moves both edges inwards by an imaginary length, in the Fresnel integrals' unit.
    """
    root = math.sqrt(2.0 * number)
    re, im, _, _ = fresnel(root * (position + 1.0), table)
    other_re, other_im, _, _ = fresnel(root * (position - 1.0), table)
    re, im = re - other_re, im - other_im
    if softness > 0.0:
        # each edge adds -i softness exp(i pi w^2 / 2)
        for side in (-1.0, 1.0):
            phase = math.pi * number * (position + side) ** 2
            re += softness * math.sin(phase)
            im -= softness * math.cos(phase)
    return float((re * re + im * im) / 2.0)


@compiled
def running_integrals(
    sums: Floats, numbers: Floats, step: float, softness: float, table: Table
) -> None:
    """Fill (R, M) the light behind slits from their middle to equal steps of a half width.

    Parameters
    ----------
    sums
        Overwritten; exact where a pattern is cubic over three steps.
    numbers
        (R,) Fresnel numbers of the half width.
    step
        In half widths.
    softness
        Of the edges, as of `_slit`.
    table
        For `fresnel`.
    """
    profile = np.empty(sums.shape[1] + 2)
    for row in range(sums.shape[0]):
        for i in range(profile.shape[0]):
            profile[i] = _slit((i - 1) * step, numbers[row], softness, table)
        sums[row, 0] = 0.0
        for i in range(1, sums.shape[1]):
            inner = 13.0 * (profile[i] + profile[i + 1]) - profile[i - 1] - profile[i + 2]
            sums[row, i] = sums[row, i - 1] + step * inner / 24.0


@compiled
def _skew(position: float, number: float, table: Table) -> Complex:
    """Return how a slit's intensity changes to first order, at a place as of `_slit`.

    For a bend of one a half width (`rectangle_patterns.bend`), and for edges of which the one at
    +1 has J larger, and the one at -1 J smaller, by one of it.
    """
    root = math.sqrt(2.0 * number)
    first, second = position + 1.0, position - 1.0
    re, im, _, _ = fresnel(root * first, table)
    other_re, other_im, _, _ = fresnel(root * second, table)
    re, im = (re - other_re) / root, (im - other_im) / root
    bent_re, bent_im, apart_re, apart_im = 0.0, 0.0, 0.0, 0.0
    for side, rho in ((1.0, first), (-1.0, second)):
        phase = math.pi * number * rho * rho
        waves = number * rho * rho / _SKEWED
        sign = side * math.exp(-waves * waves)
        cosine, sine = sign * math.cos(phase), sign * math.sin(phase)
        # integral of -(rho + 2 pi i N rho^3 / 3) exp(i pi N rho^2)
        bent_re -= (rho * rho * cosine + sine / (2.0 * math.pi * number)) / 3.0
        bent_im -= (rho * rho * sine - cosine / (2.0 * math.pi * number)) / 3.0
        apart_re += 0.5 * side * rho * cosine
        apart_im += 0.5 * side * rho * sine
    bent, apart = re * bent_re + im * bent_im, re * apart_re + im * apart_im
    return 2.0 * number * bent, 2.0 * number * apart


@compiled
def skew_integrals(sums: Floats, numbers: Floats, step: float, table: Table) -> None:
    """Fill (2, R, M) what `_skew` adds to running integrals, as of `running_integrals`.

    Of the bend only what is left of it when places are bent as in `diffraction_slits`.
    """
    size = sums.shape[2]
    one, other, plain = np.empty(size + 2), np.empty(size + 2), np.empty(size)
    for row in range(sums.shape[1]):
        number = numbers[row]
        turning = 1.0 / (1.0 + (number / 0.42) ** 2)
        for i in range(size + 2):
            one[i], other[i] = _skew((i - 1) * step, number, table)
        for i in range(size):
            place = i * step
            waves = number * place * place / _SKEWED
            share = turning * math.exp(-waves * waves)
            plain[i] = share * place * place * _slit(place, number, 0.0, table)
        bent, apart = 0.0, 0.0
        for i in range(size):
            if i > 0:
                bent += step * (13.0 * (one[i] + one[i + 1]) - one[i - 1] - one[i + 2]) / 24.0
                apart += (
                    step * (13.0 * (other[i] + other[i + 1]) - other[i - 1] - other[i + 2]) / 24.0
                )
            sums[0, row, i] = bent + plain[i]
            sums[1, row, i] = apart

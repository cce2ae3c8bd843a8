"""Polynomials of one and of two variables, and Sun vectors of tangents, many rows at a time."""

from __future__ import annotations

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

_BLOCK = 128
"""Rows that stay in the first cache; inner loops run along them, several at a time."""


@compiled
def axis_values(scaled: Floats, powers: Floats, out: Floats) -> None:
    """Values (N,) of ``sum_k powers_k u^k`` at u (N,), into `out`.

    Parameters
    ----------
    scaled : ndarray, shape (N,)
        u.
    powers : ndarray, shape (n + 1,)
        n at least 1.
    out : ndarray, shape (N,)
        Overwritten.
    """
    degree = len(powers) - 1
    for start in range(0, len(scaled), _BLOCK):
        size = min(_BLOCK, len(scaled) - start)
        u, value = scaled[start : start + size], out[start : start + size]
        highest = powers[degree]
        for i in range(size):
            value[i] = highest
        for k in range(degree - 1, -1, -1):
            power = powers[k]
            for i in range(size):
                value[i] = value[i] * u[i] + power


@compiled
def surface_values(x: Floats, y: Floats, powers: Floats, out: Floats) -> None:
    """Values (2, N) of ``sum_jk powers_ajk x^k y^j``, j + k <= n, into `out`.

    Parameters
    ----------
    x, y : ndarray, shape (N,)
        Scaled features.
    powers : ndarray, shape (2, n + 1, n + 1)
        Of both surfaces; n at least 1.
    out : ndarray, shape (2, N)
        Overwritten.
    """
    degree = powers.shape[1] - 1
    row = np.empty(_BLOCK)
    for start in range(0, len(x), _BLOCK):
        size = min(_BLOCK, len(x) - start)
        u, v = x[start : start + size], y[start : start + size]
        for surface in range(2):
            value = out[surface, start : start + size]
            highest = powers[surface, degree, 0]
            for i in range(size):
                value[i] = highest
            for j in range(degree - 1, -1, -1):
                first, second = powers[surface, j, degree - j], powers[surface, j, degree - j - 1]
                for i in range(size):
                    row[i] = first * u[i] + second
                for k in range(degree - j - 2, -1, -1):
                    power = powers[surface, j, k]
                    for i in range(size):
                        row[i] = row[i] * u[i] + power
                for i in range(size):
                    value[i] = value[i] * v[i] + row[i]


@compiled
def series_values(scaled: Floats, half: Floats, coefficients: Floats, out: Floats) -> None:
    """Values (N,) of a line and a Fourier series by Clenshaw's recurrence, into `out`.

    Parameters
    ----------
    scaled : ndarray, shape (N,)
        u, which the line is of.
    half : ndarray, shape (N,)
        Tangents of half the fundamental's angle at u; they give its sine and cosine.
    coefficients : ndarray, shape (2 + 2 N,)
        Of 1, u, and cosine and sine of each harmonic; N at least 1.
    out : ndarray, shape (N,)
        Overwritten.
    """
    cosine, sine = np.empty(_BLOCK), np.empty(_BLOCK)
    even, even_after = np.empty(_BLOCK), np.empty(_BLOCK)
    odd, odd_after = np.empty(_BLOCK), np.empty(_BLOCK)
    level, slope = coefficients[0], coefficients[1]
    for start in range(0, len(scaled), _BLOCK):
        size = min(_BLOCK, len(scaled) - start)
        u, tangent = scaled[start : start + size], half[start : start + size]
        value = out[start : start + size]
        for i in range(size):
            share = np.divide(1.0, 1.0 + tangent[i] * tangent[i])
            cosine[i] = 2.0 * share - 1.0
            sine[i] = 2.0 * tangent[i] * share
            even[i] = even_after[i] = odd[i] = odd_after[i] = 0.0
        # b_n = c_n + 2 cos(t) b_(n+1) - b_(n+2)
        for n in range(len(coefficients) - 2, 1, -2):
            a, b = coefficients[n], coefficients[n + 1]
            for i in range(size):
                twice = 2.0 * cosine[i]
                before = even[i]
                even[i] = a + twice * before - even_after[i]
                even_after[i] = before
                before = odd[i]
                odd[i] = b + twice * before - odd_after[i]
                odd_after[i] = before
        for i in range(size):
            wave = cosine[i] * even[i] - even_after[i] + sine[i] * odd[i]
            value[i] = level + slope * u[i] + wave


@compiled
def unit_vectors(
    values: Floats, limit: float, tan_alpha: Floats, tan_beta: Floats, sun: Floats
) -> None:
    """Sun vectors (N, 3) of tangents (N,) each, into `sun`, with `sun_from_tangents`' arithmetic.

    Parameters
    ----------
    values : ndarray, shape (2, N)
        What the tangents are of.
    limit : float
        Size that either value must stay below; a NaN row where it does not.
    tan_alpha, tan_beta : ndarray, shape (N,)
        Tangents.
    sun : ndarray, shape (N, 3)
        Overwritten.
    """
    length, quotient = np.empty(_BLOCK), np.empty((3, _BLOCK))
    for start in range(0, len(tan_alpha), _BLOCK):
        size = min(_BLOCK, len(tan_alpha) - start)
        first, second = values[0, start : start + size], values[1, start : start + size]
        alpha, beta = tan_alpha[start : start + size], tan_beta[start : start + size]
        for i in range(size):
            root = np.sqrt(alpha[i] * alpha[i] + beta[i] * beta[i] + 1.0)
            inside = (abs(first[i]) < limit) & (abs(second[i]) < limit) & (root < np.inf)
            length[i] = root if inside else np.nan
        # NumPy's quotients: Python's would ask each divisor whether it is zero
        x, y, z = quotient[0], quotient[1], quotient[2]
        for i in range(size):
            x[i] = np.divide(beta[i], length[i])
            y[i] = np.divide(alpha[i], length[i])
            z[i] = np.divide(1.0, length[i])
        for i in range(size):
            sun[start + i, 0] = x[i]
            sun[start + i, 1] = y[i]
            sun[start + i, 2] = z[i]

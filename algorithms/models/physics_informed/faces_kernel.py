"""The direction that best explains the signals of faces, sample by sample."""

from __future__ import annotations

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

ITERATIONS = 100
"""Most steps towards a direction; ten are usual."""

#: Smallest step, over its vector, that is still taken.
_AT_REST = 1e-13
#: Of the equations' diagonal, over its mean, at the first step, at least and at most.
_FIRST_DAMPING, _LEAST_DAMPING, _MOST_DAMPING = 1e-4, 1e-12, 1e6
#: Rise of the sum of squares, relative, that is still none: rounding must not choose the path.
_EQUAL = 1e-12
#: Width of the bend between dark and lit, over the face's noise: the equations are smooth there,
#: so that steps come to rest where the least sum is, on every processor.
_BEND = 0.5
#: Widths from the bend at which a double has no place for it.
_STRAIGHT = 40.0
#: Of the equations of the first vector, so that what is open is nothing.
_LEAST_START = 1e-6
#: What the first vector is moved by, over its length: between two dark faces the signals have two
#: solutions, one to each side, and a start on the ridge between them leaves the side to rounding.
_ASIDE = (6e-4, 5e-4, 7e-4)
#: Signal over noise from which a face counts as lit.
_LIT = 3.0
#: Largest cosine that is looked for: signals may exceed the calibration's.
_MOST_COSINE = 1.2


@compiled
def explain(
    light: Floats,
    told: tuple[Floats, Floats, Floats, float],
    vectors: Floats,
    equations: Floats,
) -> None:
    """Solve for the vectors of all samples, by Levenberg-Marquardt with a damping of each.

    Parameters
    ----------
    light : ndarray, shape (N, K)
        Signals less what they are in the dark.
    told : tuple
        Normals (K, 3), coefficients (K, 4) of the responses to the cosine of incidence, noise (K,)
        of each face, positive, and spread of the light's strength.
    vectors : ndarray, shape (N, 3)
        Overwritten by vectors along the Sun, as long as the light is strong; a NaN row where no
        face is lit.
    equations : ndarray, shape (N, 3, 3)
        Overwritten by the normal equations there.
    """
    normal, right = np.empty((3, 3)), np.empty(3)
    trial, on_trial = np.empty((3, 3)), np.empty(3)
    vector, tried, step = np.empty(3), np.empty(3), np.empty(3)
    for sample in range(len(light)):
        signals = light[sample]
        if not _start(signals, told, normal, right, vector):
            vectors[sample] = np.nan
            equations[sample] = np.nan
            continue
        cost = _equations(vector, signals, told, normal, right)
        damping = _FIRST_DAMPING
        for _ in range(ITERATIONS):
            size = damping * (normal[0, 0] + normal[1, 1] + normal[2, 2])
            _solve(normal, size, right, step)
            for k in range(3):
                tried[k] = vector[k] + step[k]
            here = _square(vector)
            found = _equations(tried, signals, told, trial, on_trial)
            if found <= cost * (1.0 + _EQUAL):
                vector[:], normal[:], right[:], cost = tried, trial, on_trial, found
                damping = max(damping / 10.0, _LEAST_DAMPING)
            else:
                damping = min(damping * 10.0, _MOST_DAMPING)
            if _square(step) <= _AT_REST**2 * here:
                break
        vectors[sample] = vector
        equations[sample] = normal


@compiled
def invert(signal: Floats, coefficients: Floats) -> Floats:
    """Cosines (N,) in [0, 1.2] at which a response (4,) gives signals (N,)."""
    cosine = np.empty(len(signal))
    for i in range(len(signal)):
        cosine[i] = _inverted(signal[i], coefficients)
    return cosine


@compiled
def _inverted(signal: float, coefficients: Floats) -> float:
    """Cosine at which a response gives a signal, by Newton's steps."""
    b0, b1, b2, b3 = coefficients
    cosine = min(max(_quotient(signal, b0 + b1 + b2 + b3), 0.0), _MOST_COSINE)
    for _ in range(6):
        value = ((b3 * cosine + b2) * cosine + b1) * cosine + b0
        slope = max((3.0 * b3 * cosine + 2.0 * b2) * cosine + b1, 0.1 * b1)
        cosine = min(max(cosine - _quotient(value - signal, slope), 0.0), _MOST_COSINE)
    return cosine


@compiled
def _start(
    light: Floats,
    told: tuple[Floats, Floats, Floats, float],
    normal: Floats,
    right: Floats,
    vector: Floats,
) -> bool:
    """Fit a vector (3,) to the lit faces' cosines; False where no face is lit.

    A component that no lit face determines starts near zero, since the faces along it are dark.
    """
    normals, responses, noise, _ = told
    normal[:] = 0.0
    right[:] = 0.0
    lit = False
    for face in range(len(normals)):
        if not light[face] > _LIT * noise[face]:
            continue
        lit = True
        _add(normal, right, normals[face], _inverted(light[face], responses[face]))
    _solve(normal, _LEAST_START, right, vector)
    length = np.sqrt(_square(vector))
    for k in range(3):
        vector[k] += length * _ASIDE[k]
    return lit


@compiled
def _equations(
    vector: Floats,
    light: Floats,
    told: tuple[Floats, Floats, Floats, float],
    normal: Floats,
    right: Floats,
) -> float:
    """Write normal equations (3, 3) and right sides (3,) at a vector; return the sum of squares.

    The vector's direction is the Sun's, its length the light's strength.
    """
    normals, responses, noise, level_spread = told
    normal[:] = 0.0
    right[:] = 0.0
    cost = 0.0
    level = np.sqrt(_square(vector))
    x, y, z = (
        _quotient(vector[0], level),
        _quotient(vector[1], level),
        _quotient(vector[2], level),
    )
    row = np.empty(3)
    for face in range(len(normals)):
        a, b, c = normals[face]
        cosine = x * a + y * b + z * c
        value, slope = bend_and_slope(cosine, responses[face], _BEND * noise[face])
        residual = (light[face] - level * value) / noise[face]
        # of level * f(n . v / level): f s + f' (n - c s)
        row[0] = (value * x + slope * (a - cosine * x)) / noise[face]
        row[1] = (value * y + slope * (b - cosine * y)) / noise[face]
        row[2] = (value * z + slope * (c - cosine * z)) / noise[face]
        _add(normal, right, row, residual)
        cost += residual * residual
    row[0], row[1], row[2] = x / level_spread, y / level_spread, z / level_spread
    residual = (1.0 - level) / level_spread
    _add(normal, right, row, residual)
    return float(cost + residual * residual)


@compiled
def bend_and_slope(cosine: float, coefficients: Floats, width: float) -> tuple[float, float]:
    """Response at a cosine of incidence, bent softly to nothing in the dark; its derivative.

    Behind the face the cubic goes on as a straight line, so that there is no jump; a value v
    becomes ``w log(1 + exp(v / w))`` of width w, in the signals' unit.
    """
    b0, b1, b2, b3 = coefficients
    front = max(cosine, 0.0)
    # a line that rises towards the front, whatever the fit says of grazing light
    rise = max(b1, 0.1 * (b0 + b1 + b2 + b3))
    value = ((b3 * front + b2) * front + b1) * front + b0 + rise * (cosine - front)
    slope = (3.0 * b3 * front + 2.0 * b2) * front + b1 if cosine > 0 else rise
    ratio = value / width
    if ratio > _STRAIGHT:
        return width * ratio, slope
    if ratio < -_STRAIGHT:
        return 0.0, 0.0
    decay = np.exp(-abs(ratio))
    share = (1.0 if ratio > 0 else decay) / (1.0 + decay)
    return width * (max(ratio, 0.0) + np.log1p(decay)), slope * share


@compiled
def _add(normal: Floats, right: Floats, row: Floats, residual: float) -> None:
    """Add one equation, derivatives `row` (3,) and a residual, in place."""
    for i in range(3):
        right[i] += row[i] * residual
        for j in range(i, 3):
            normal[i, j] += row[i] * row[j]
            normal[j, i] = normal[i, j]


@compiled
def _solve(matrix: Floats, more: float, right: Floats, solution: Floats) -> None:
    """Solve symmetric equations (3, 3), `more` added to the diagonal; NaN where singular."""
    a, b, c = matrix[0, 0] + more, matrix[0, 1], matrix[0, 2]
    d, e, f = matrix[1, 1] + more, matrix[1, 2], matrix[2, 2] + more
    first, second, third = d * f - e * e, c * e - b * f, b * e - c * d
    determinant = a * first + b * second + c * third
    if determinant == 0.0 or not np.isfinite(determinant):
        solution[:] = np.nan
        return
    first, second, third = first / determinant, second / determinant, third / determinant
    middle, last = (a * f - c * c) / determinant, (a * d - b * b) / determinant
    beside = (b * c - a * e) / determinant
    solution[0] = first * right[0] + second * right[1] + third * right[2]
    solution[1] = second * right[0] + middle * right[1] + beside * right[2]
    solution[2] = third * right[0] + beside * right[1] + last * right[2]


@compiled
def _square(vector: Floats) -> float:
    return float(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])


@compiled
def _quotient(one: float, other: float) -> float:
    return one / other if other != 0.0 else np.nan

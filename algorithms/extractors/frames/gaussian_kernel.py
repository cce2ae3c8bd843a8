"""Least-squares fit of a Gaussian spot to whole frames, by separable sums.

Model and derivatives are products of a function of x and one of y, so the normal matrix needs
sums over one axis only, and the frame is read once an iteration.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.cholesky import solve

_PARAMETERS = 6  # amplitude, x, y, sigma x, sigma y, background
#: Widths within which pixels are lit; pixels beyond that tell the noise of a dark one.
_LIT, _TELL = 3.0, 30.0
_DEPENDENT = 1e-14  # pivot over diagonal below which a parameter is not determined


@compiled
def _start(frame: NDArray[Any], p: Floats) -> bool:
    """Guess the parameters from the pixels brighter than half; False where there is no spot."""
    height, width = frame.shape
    border = 0.0
    for j in range(width):
        border += float(frame[0, j]) + float(frame[height - 1, j])
    for i in range(height):
        border += float(frame[i, 0]) + float(frame[i, width - 1])
    border /= 2 * (height + width)
    peak = -np.inf
    for i in range(height):
        for j in range(width):
            peak = max(peak, float(frame[i, j]))
    if not peak > border:
        return False
    cut = border + 0.5 * (peak - border)
    pixels = 0
    sum_x = 0.0
    sum_y = 0.0
    for i in range(height):
        for j in range(width):
            if frame[i, j] > cut:
                pixels += 1
                sum_x += j
                sum_y += i
    p[0] = peak - border
    p[1] = sum_x / pixels
    p[2] = sum_y / pixels
    # Brighter than half: an ellipse of radius sigma sqrt(2 ln 2).
    p[3] = max(math.sqrt(pixels / (math.pi * 2 * math.log(2.0))), 0.5)
    p[4] = p[3]
    p[5] = border
    return True


@compiled
def _factors(p: Floats, axis: int, f: Floats) -> None:
    """Write the Gaussian along an axis and its derivatives by centre and sigma (3, L)."""
    centre, sigma = p[1 + axis], p[3 + axis]
    for j in range(f.shape[1]):
        t = (j - centre) / sigma
        g = math.exp(-0.5 * t * t)
        f[0, j] = g
        f[1, j] = g * t / sigma
        f[2, j] = g * t * t / sigma


@compiled
def _residual_sums(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any], p: Floats, x: Floats, y: Floats, along: Floats, projected: Floats
) -> float:
    """Return the sum of squared residuals; `projected` (6,) their products with derivatives."""
    height, width = frame.shape
    for m in range(4):
        for j in range(width):
            along[m, j] = 0.0
    squares, light, light_x, light_y = along[0], along[1], along[2], along[3]
    for i in range(height):
        row = frame[i]
        scale = p[0] * y[0, i]
        g0, g1, g2 = y[0, i], y[1, i], y[2, i]
        for j in range(width):
            e = row[j] - p[5] - scale * x[0, j]
            squares[j] += e * e
            light[j] += g0 * e
            light_x[j] += g1 * e
            light_y[j] += g2 * e
            along[4, j] += e
    total = 0.0
    for m in range(_PARAMETERS):
        projected[m] = 0.0
    for j in range(width):
        total += squares[j]
        projected[0] += x[0, j] * light[j]
        projected[1] += p[0] * x[1, j] * light[j]
        projected[2] += p[0] * x[0, j] * light_x[j]
        projected[3] += p[0] * x[2, j] * light[j]
        projected[4] += p[0] * x[0, j] * light_y[j]
        projected[5] += along[4, j]
        along[4, j] = 0.0
    return total


@compiled
def _normal_matrix(p: Floats, x: Floats, y: Floats, matrix: Floats) -> None:
    """Products of the six derivatives summed over the frame, from sums along each axis."""
    # Which factor of each axis a derivative holds; the background's is one.
    of_x = (0, 1, 0, 2, 0, 3)
    of_y = (0, 0, 1, 0, 2, 3)
    gram_x = np.empty((4, 4))
    gram_y = np.empty((4, 4))
    for f, gram in ((x, gram_x), (y, gram_y)):
        for a in range(4):
            for b in range(a, 4):
                total = 0.0
                for j in range(f.shape[1]):
                    left = f[a, j] if a < 3 else 1.0
                    total += left * (f[b, j] if b < 3 else 1.0)
                gram[a, b] = total
                gram[b, a] = total
    for a in range(_PARAMETERS):
        for b in range(_PARAMETERS):
            scale = (p[0] if 0 < a < 5 else 1.0) * (p[0] if 0 < b < 5 else 1.0)
            matrix[a, b] = scale * gram_x[of_x[a], of_x[b]] * gram_y[of_y[a], of_y[b]]


@compiled
def _step(matrix: Floats, right: Floats, damping: float, work: Floats, step: Floats) -> bool:
    """Solve (matrix + damping diagonal) step = right; False where not definite."""
    for a in range(_PARAMETERS):
        for b in range(_PARAMETERS):
            work[a, b] = matrix[a, b]
        work[a, a] = (1.0 + damping) * matrix[a, a]
        step[a] = right[a]
    return solve(work, step, _DEPENDENT)


@compiled
def fit_gaussians(  # noqa: C901 - one loop, its kernel's steps in order
    frames: NDArray[Any], tolerance: float, limit: int, out: Floats
) -> None:
    """Write amplitude, x, y, sigma x, sigma y, background to `out` (N, 6), by Levenberg-Marquardt.

    Converged when a step moves the centre and both widths by less than `tolerance` px. NaN rows
    where there is no spot or no convergence within `limit` steps.
    """
    count, height, width = frames.shape
    x = np.empty((3, width))
    y = np.empty((3, height))
    along = np.zeros((5, width))
    p = np.empty(_PARAMETERS)
    tried = np.empty(_PARAMETERS)
    right = np.empty(_PARAMETERS)
    tried_right = np.empty(_PARAMETERS)
    step = np.empty(_PARAMETERS)
    normal = np.empty((2, _PARAMETERS, _PARAMETERS))
    matrix, work = normal[0], normal[1]
    for k in range(count):
        frame = frames[k]
        out[k] = np.nan
        if not _start(frame, p):
            continue
        _factors(p, 0, x)
        _factors(p, 1, y)
        error = _residual_sums(frame, p, x, y, along, right)
        _normal_matrix(p, x, y, matrix)
        damping = 1e-3
        for _ in range(limit):
            if not _step(matrix, right, damping, work, step):
                damping = max(10 * damping, 1e-6)
                continue
            for m in range(_PARAMETERS):
                tried[m] = p[m] + step[m]
            largest = max(abs(step[1]), abs(step[2]), abs(step[3]), abs(step[4]))
            better = False
            if tried[3] > 0.05 and tried[4] > 0.05:
                _factors(tried, 0, x)
                _factors(tried, 1, y)
                found = _residual_sums(frame, tried, x, y, along, tried_right)
                better = found <= error
            if better:
                error = found
                for m in range(_PARAMETERS):
                    p[m] = tried[m]
                    right[m] = tried_right[m]
                damping *= 0.1
            if largest < tolerance:
                for m in range(_PARAMETERS):
                    out[k, m] = p[m]
                break
            if better:
                _normal_matrix(p, x, y, matrix)
            else:
                damping *= 10


@compiled
def _own_noise(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any], p: Floats, x: Floats, y: Floats, dark: float, gain: float
) -> tuple[float, float, float]:
    """Variance of a dark pixel, what light adds, and what lit ones depart by over their variance.

    Of what the fit `p` leaves: within three of its widths pixels are lit. `dark` and `gain` are the
    variances that the last of the three is over.
    """
    lit, light, unlit = 0.0, 0.0, 0.0
    lit_squares, dark_squares, misfit = 0.0, 0.0, 0.0
    for i in range(frame.shape[0]):
        v = ((i - p[2]) / p[4]) ** 2
        for j in range(frame.shape[1]):
            own = p[0] * x[0, j] * y[0, i]
            e = frame[i, j] - p[5] - own
            if v + ((j - p[1]) / p[3]) ** 2 < _LIT * _LIT:
                lit += 1.0
                light += own
                lit_squares += e * e
                misfit += e * e / (dark + gain * own)
            else:
                unlit += 1.0
                dark_squares += e * e
    own_dark = dark_squares / unlit if unlit >= _TELL else dark
    own_gain = max(lit_squares - lit * own_dark, 0.0) / light if light > 0.0 else 0.0
    return own_dark, own_gain, misfit / max(lit, 1.0)


@compiled
def covariances(
    frames: NDArray[Any], fits: Floats, noise: Floats, misfit: float, out: Floats
) -> None:
    """Write the covariance of the centres of `fits` (N, 6) to `out` (N, 2, 2).

    With N the normal matrix, g a pixel's derivatives and v its variance, ``N^-1 (sum v g g^T)
    N^-1``: pixels count alike in the fit, whatever their noise. v is what pixels of `frames`
    (N, H, W) depart from the fit by.

    `noise` (N, 2) is the variance of a dark pixel, and what a unit of light adds to it, as seen
    without any fit; NaN or zero for those that are passed over. Where lit pixels depart by a mean
    square of more than `misfit` of that, the light is no Gaussian, and the covariance NaN.
    """
    _, height, width = frames.shape
    x, y = np.empty((3, width)), np.empty((3, height))
    right = np.zeros(_PARAMETERS)
    normal = np.empty((2, _PARAMETERS, _PARAMETERS))
    matrix, work = normal[0], normal[1]
    moves = np.empty((2, _PARAMETERS))
    for k in range(len(fits)):
        out[k] = np.nan
        p = fits[k]
        if not (noise[k, 0] > 0.0 and np.isfinite(p[0])):
            continue
        _factors(p, 0, x)
        _factors(p, 1, y)
        dark, gain, departs = _own_noise(frames[k], p, x, y, noise[k, 0], noise[k, 1])
        if departs > misfit:
            continue
        _normal_matrix(p, x, y, matrix)
        good = True
        for axis in range(2):
            right[:] = 0.0
            right[1 + axis] = 1.0
            good = good and _step(matrix, right, 0.0, work, moves[axis])
        if not good:
            continue
        a, b = moves[0], moves[1]
        xx, yy, xy = 0.0, 0.0, 0.0
        for i in range(height):
            g, g_1, g_2 = y[0, i], p[0] * y[1, i], p[0] * y[2, i]
            for j in range(width):
                light = x[0, j] * g
                d_1, d_3 = p[0] * x[1, j] * g, p[0] * x[2, j] * g
                d_2, d_4 = x[0, j] * g_1, x[0, j] * g_2
                u = a[0] * light + a[1] * d_1 + a[2] * d_2 + a[3] * d_3 + a[4] * d_4 + a[5]
                v = b[0] * light + b[1] * d_1 + b[2] * d_2 + b[3] * d_3 + b[4] * d_4 + b[5]
                variance = dark + gain * p[0] * light
                xx += variance * u * u
                yy += variance * v * v
                xy += variance * u * v
        out[k, 0, 0], out[k, 1, 1] = xx, yy
        out[k, 0, 1], out[k, 1, 0] = xy, xy

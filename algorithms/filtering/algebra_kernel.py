"""Kalman algebra on batches of small matrices: prediction, update in Joseph's form, spreads.

All arrays are (B, ...), float64; B are Monte-Carlo runs, or hypotheses of one run.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.cholesky import backward, factor, forward


@compiled
def predict(covariance: Floats, transition: Floats, noise: Floats) -> Floats:
    """``F P F' + Q`` (B, n, n), symmetric to the last bit; Q (n, n) for all."""
    count, n = covariance.shape[0], covariance.shape[1]
    out = np.empty((count, n, n))
    half = np.empty((n, n))
    for b in range(count):
        half[:] = 0.0
        for i in range(n):
            for k in range(n):
                f = transition[b, i, k]
                if f != 0.0:
                    for j in range(n):
                        half[i, j] += f * covariance[b, k, j]
        for i in range(n):
            for j in range(i + 1):
                total = 0.5 * (noise[i, j] + noise[j, i])
                for k in range(n):
                    total += half[i, k] * transition[b, j, k]
                out[b, i, j] = total
                out[b, j, i] = total
    return out


@compiled
def innovation_covariance(covariance: Floats, sensitivity: Floats, noise: Floats) -> Floats:
    """``H P H' + R`` (B, m, m)."""
    count, m, n = sensitivity.shape
    out = np.empty((count, m, m))
    half = np.empty((m, n))
    for b in range(count):
        half[:] = 0.0
        for i in range(m):
            for k in range(n):
                h = sensitivity[b, i, k]
                if h != 0.0:
                    for j in range(n):
                        half[i, j] += h * covariance[b, k, j]
        for i in range(m):
            for j in range(i + 1):
                total = 0.5 * (noise[b, i, j] + noise[b, j, i])
                for k in range(n):
                    total += half[i, k] * sensitivity[b, j, k]
                out[b, i, j] = total
                out[b, j, i] = total
    return out


@compiled
def _factor(root: Floats) -> None:
    """Replace the lower half of a covariance by its root; NaN throughout where there is none."""
    if not factor(root, 0.0):
        root[:] = np.nan


@compiled
def _whiten(root: Floats, innovation: Floats, white: Floats) -> tuple[float, float]:
    """Write an innovation (m,) in units of its deviations; return its square and log-likelihood.

    `root` is its covariance, which its root replaces.
    """
    _factor(root)
    white[:] = innovation
    forward(root, white)
    squares, determinant = 0.0, 0.0
    for i in range(white.size):
        squares += white[i] * white[i]
        determinant += 2.0 * math.log(root[i, i])
    return squares, -0.5 * (squares + determinant + white.size * math.log(2.0 * math.pi))


@compiled
def update(  # noqa: C901, PLR0912 - one pass, nothing allocated between
    covariance: Floats,
    sensitivity: Floats,
    noise: Floats,
    innovation: Floats,
    estimated: Floats,
) -> tuple[Floats, Floats, Floats, Floats]:
    """Step (B, n), covariance in Joseph's form, squared innovation (B,), log-likelihood (B,).

    `estimated` (n,) is 1 where the gain counts and 0 where an error is only considered. A NaN in
    an innovation leaves its run as it is, with NaN of both numbers.
    """
    count, m, n = sensitivity.shape
    step, out = np.zeros((count, n)), covariance.copy()
    squared, likelihood = np.full(count, np.nan), np.full(count, np.nan)
    shape = np.empty((n, m))  # P H'
    gain, white = np.empty((n, m)), np.empty(m)
    left, half = np.empty((n, n)), np.empty((n, n))
    root = np.empty((m, m))
    for b in range(count):
        if not np.isfinite(innovation[b]).all():
            continue
        for i in range(n):
            for j in range(m):
                total = 0.0
                for k in range(n):
                    total += covariance[b, i, k] * sensitivity[b, j, k]
                shape[i, j] = total
        for i in range(m):
            for j in range(i + 1):
                total = 0.5 * (noise[b, i, j] + noise[b, j, i])
                for k in range(n):
                    total += sensitivity[b, i, k] * shape[k, j]
                root[i, j] = total
        squared[b], likelihood[b] = _whiten(root, innovation[b], white)
        gain[:] = shape
        for i in range(n):  # rows of K = P H' S^-1 by the two triangles
            forward(root, gain[i])
            backward(root, gain[i])
            for j in range(m):
                gain[i, j] *= estimated[i]
                step[b, i] += gain[i, j] * innovation[b, j]
        for i in range(n):
            for j in range(n):
                total = 1.0 if i == j else 0.0
                for k in range(m):
                    total -= gain[i, k] * sensitivity[b, k, j]
                left[i, j] = total
        half[:] = 0.0
        for i in range(n):
            for k in range(n):
                f = left[i, k]
                if f != 0.0:
                    for j in range(n):
                        half[i, j] += f * covariance[b, k, j]
        for i in range(n):
            for j in range(i + 1):
                total = 0.0
                for k in range(n):
                    total += half[i, k] * left[j, k]
                for k in range(m):
                    for q in range(m):
                        total += gain[i, k] * noise[b, k, q] * gain[j, q]
                out[b, i, j] = total
                out[b, j, i] = total
    return step, out, squared, likelihood


@compiled
def innovation_likelihood(spread: Floats, innovation: Floats) -> tuple[Floats, Floats]:
    """Squared innovation (B,) in units of its covariance (B, m, m), and its log-likelihood (B,)."""
    count, m = innovation.shape
    squared, likelihood = np.full(count, np.nan), np.full(count, np.nan)
    root, white = np.zeros((m, m)), np.empty(m)
    for b in range(count):
        root[:] = spread[b]
        squares, log_likelihood = _whiten(root, innovation[b], white)
        if math.isfinite(squares):
            squared[b], likelihood[b] = squares, log_likelihood
    return squared, likelihood


@compiled
def update_by_points(
    covariance: Floats, crossed: Floats, spread: Floats, innovation: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """As `update`, of sigma points: ``K = C S^-1``, ``P - K S K'``; C (B, n, m), S (B, m, m)."""
    count, n, m = crossed.shape
    step, out = np.zeros((count, n)), covariance.copy()
    squared, likelihood = np.full(count, np.nan), np.full(count, np.nan)
    half, white, root = np.empty((n, m)), np.empty(m), np.empty((m, m))
    for b in range(count):
        if not np.isfinite(innovation[b]).all():
            continue
        root[:] = spread[b]
        squared[b], likelihood[b] = _whiten(root, innovation[b], white)
        half[:] = crossed[b]
        for i in range(n):  # C L'^-1, whose square is K S K'
            forward(root, half[i])
            for j in range(m):
                step[b, i] += half[i, j] * white[j]
        for i in range(n):
            for j in range(i + 1):
                total = covariance[b, i, j]
                for k in range(m):
                    total -= half[i, k] * half[j, k]
                out[b, i, j] = total
                out[b, j, i] = total
    return step, out, squared, likelihood


@compiled
def cross(first: Floats, second: Floats, weights: Floats) -> Floats:
    """``sum_p w_p a_p b_p'`` (B, n, m) of deviations (B, p, n) and (B, p, m)."""
    count, points, n = first.shape
    m = second.shape[2]
    out = np.zeros((count, n, m))
    for b in range(count):
        for p in range(points):
            for i in range(n):
                f = weights[p] * first[b, p, i]
                for j in range(m):
                    out[b, i, j] += f * second[b, p, j]
    return out


@compiled
def sigma_errors(covariance: Floats, scale: float) -> Floats:
    """(B, 2 n + 1, n): none, then `scale` times each column of a root of P, then their opposites.

    NaN throughout where P has no root.
    """
    count, n = covariance.shape[0], covariance.shape[1]
    out = np.zeros((count, 2 * n + 1, n))
    root = np.zeros((n, n))
    for b in range(count):
        root[:] = covariance[b]
        _factor(root)
        for p in range(n):
            for i in range(p, n):
                out[b, 1 + p, i] = scale * root[i, p]
                out[b, 1 + n + p, i] = -scale * root[i, p]
    return out


@compiled
def centre(values: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Weighted means (B, q) of points (B, p, q), and the points less their mean."""
    count, points, size = values.shape
    mean, off = np.zeros((count, size)), np.empty((count, points, size))
    for b in range(count):
        for p in range(points):
            for i in range(size):
                mean[b, i] += weights[p] * values[b, p, i]
        for p in range(points):
            for i in range(size):
                off[b, p, i] = values[b, p, i] - mean[b, i]
    return mean, off

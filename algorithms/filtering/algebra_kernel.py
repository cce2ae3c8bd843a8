"""Kalman algebra on batches of small matrices: prediction, update in Joseph's form, spreads.

All arrays are (B, ...), float64; B are Monte-Carlo runs, or hypotheses of one run.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.cholesky import factor, forward
from algorithms.kernels.copies import copy_matrix, copy_row


@compiled
def _sandwich(outer: Floats, inner: Floats, half: Floats, out: Floats) -> None:
    """Add ``A P A'`` to the lower half of `out` (m, m), and mirror it; `half` (m, n) is scratch.

    Every number is a sum in the order of the columns of A, however many lanes a processor has.
    """
    m, n = outer.shape
    turned = outer.T.copy()
    half[:] = 0.0
    for i in range(m):
        for k in range(n):
            f = outer[i, k]
            if f != 0.0:
                for j in range(n):
                    half[i, j] += f * inner[k, j]
    for i in range(m):
        for k in range(n):
            f = half[i, k]
            for j in range(i + 1):
                out[i, j] += f * turned[k, j]
        for j in range(i):
            out[j, i] = out[i, j]


@compiled
def _symmetric(matrix: Floats, out: Floats) -> None:
    """Write the mean of a square matrix and its transpose into the lower half of `out`."""
    for i in range(len(matrix)):
        for j in range(i + 1):
            out[i, j] = 0.5 * (matrix[i, j] + matrix[j, i])


@compiled
def predict(covariance: Floats, transition: Floats, noise: Floats) -> Floats:
    """``F P F' + Q`` (B, n, n), symmetric to the last bit; Q (n, n) for all."""
    out, half = np.empty_like(covariance), np.empty_like(noise)
    for b in range(len(covariance)):
        _symmetric(noise, out[b])
        _sandwich(transition[b], covariance[b], half, out[b])
    return out


@compiled
def innovation_covariance(covariance: Floats, sensitivity: Floats, noise: Floats) -> Floats:
    """``H P H' + R`` (B, m, m)."""
    out, half = np.empty_like(noise), np.empty(sensitivity.shape[1:])
    for b in range(len(covariance)):
        _symmetric(noise[b], out[b])
        _sandwich(sensitivity[b], covariance[b], half, out[b])
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
    copy_row(innovation, white)
    forward(root, white)
    squares, determinant = 0.0, 0.0
    for i in range(white.size):
        squares += white[i] * white[i]
        determinant += 2.0 * math.log(root[i, i])
    return squares, -0.5 * (squares + determinant + white.size * math.log(2.0 * math.pi))


@compiled
def innovation_likelihood(spread: Floats, innovation: Floats) -> tuple[Floats, Floats]:
    """Squared innovation (B,) in units of its covariance (B, m, m), and its log-likelihood (B,)."""
    count, m = innovation.shape
    squared, likelihood = np.full(count, np.nan), np.full(count, np.nan)
    root, white = np.zeros((m, m)), np.empty(m)
    for b in range(count):
        copy_matrix(spread[b], root)
        squares, log_likelihood = _whiten(root, innovation[b], white)
        if math.isfinite(squares):
            squared[b], likelihood[b] = squares, log_likelihood
    return squared, likelihood


@compiled
def _solve_columns(root: Floats, columns: Floats) -> None:
    """Solve ``L L' x = c`` in place for every column c of (m, n); L is the lower half of `root`."""
    m, n = columns.shape
    for i in range(m):
        for k in range(i):
            for j in range(n):
                columns[i, j] -= root[i, k] * columns[k, j]
        for j in range(n):
            columns[i, j] /= root[i, i]
    for i in range(m - 1, -1, -1):
        for k in range(i + 1, m):
            for j in range(n):
                columns[i, j] -= root[k, i] * columns[k, j]
        for j in range(n):
            columns[i, j] /= root[i, i]


@compiled
def _add_noise(gain: Floats, noise: Floats, out: Floats) -> None:
    """Add ``K R K'`` to `out` (n, n), of the gain's transpose (m, n); most of R is nothing."""
    m, n = gain.shape
    for i in range(n):
        for k in range(m):
            for q in range(m):
                if noise[k, q] != 0.0:
                    f = gain[k, i] * noise[k, q]
                    for j in range(i + 1):
                        out[i, j] += f * gain[q, j]
        for j in range(i):
            out[j, i] = out[i, j]


@compiled
def _spread_over(noise: Floats, steps: Floats, out: Floats) -> bool:
    """Write the covariance that white errors would have to tell as little as correlated ones.

    A mean of many readings whose errors are correlated over some steps (m,) has as many times the
    variance that it would have of white ones. Return whether any last for more than one.
    """
    for i in range(len(steps)):
        for j in range(len(steps)):
            out[i, j] = noise[i, j] * (math.sqrt(steps[i]) * math.sqrt(steps[j]))
    return bool((steps > 1.0).any())


@compiled
def update(  # noqa: C901, PLR0912, PLR0917 - one pass, nothing allocated between
    covariance: Floats,
    sensitivity: Floats,
    noise: Floats,
    steps: Floats,
    innovation: Floats,
    estimated: Floats,
) -> tuple[Floats, Floats, Floats, Floats]:
    """Step (B, n), covariance in Joseph's form, squared innovation (B,), log-likelihood (B,).

    `steps` (m,) are those over which errors of readings are correlated. `estimated` (n,) is 1 where
    the gain counts and 0 where an error is only considered. A NaN in an innovation leaves its run
    as it is, with NaN of both numbers.
    """
    count, m, n = sensitivity.shape
    step, out = np.zeros((count, n)), covariance.copy()
    squared, likelihood = np.full(count, np.nan), np.full(count, np.nan)
    gain, white = np.empty((m, n)), np.empty(m)  # of the gain K, as of P H', the transpose
    left, half = np.empty((n, n)), np.empty((n, n))
    root, spread = np.empty((m, m)), np.empty((m, m))
    lasting = False
    for b in range(count):
        if not np.isfinite(innovation[b]).all():
            continue
        lasting = _spread_over(noise[b], steps, spread)
        seen, across = sensitivity[b], covariance[b].T.copy()
        gain[:] = 0.0
        for j in range(m):
            for k in range(n):
                for i in range(n):
                    gain[j, i] += across[k, i] * seen[j, k]
        _symmetric(spread, root)
        shape = gain.T.copy()
        for i in range(m):
            for k in range(n):
                for j in range(i + 1):
                    root[i, j] += seen[i, k] * shape[k, j]
        squared[b], likelihood[b] = _whiten(root, innovation[b], white)
        _solve_columns(root, gain)  # K' = S^-1 H P
        for j in range(m):
            for i in range(n):
                gain[j, i] *= estimated[i]
                step[b, i] += gain[j, i] * innovation[b, j]
        left[:] = 0.0
        for i in range(n):
            left[i, i] = 1.0
            for k in range(m):
                for j in range(n):
                    left[i, j] -= gain[k, i] * seen[k, j]
        out[b] = 0.0
        _sandwich(left, covariance[b], half, out[b])
        _add_noise(gain, spread, out[b])
    if lasting:  # a reading is as far off as readings are
        own = innovation_covariance(covariance, sensitivity, noise)
        squared, likelihood = innovation_likelihood(own, innovation)
    return step, out, squared, likelihood


@compiled
def update_by_points(  # noqa: C901, PLR0917 - one pass, nothing allocated between
    covariance: Floats,
    crossed: Floats,
    spread: Floats,
    noise: Floats,
    steps: Floats,
    innovation: Floats,
    estimated: Floats,
) -> tuple[Floats, Floats, Floats, Floats]:
    """As `update`, of sigma points: ``K = C S^-1``, ``P - K S K'``; C (B, n, m).

    S is `spread` (B, m, m) of the points' readings, and the noise. What is known of errors that
    are only considered stays; of all the rest the gain is the best.
    """
    count, n, m = crossed.shape
    step, out = np.zeros((count, n)), covariance.copy()
    squared, likelihood = np.full(count, np.nan), np.full(count, np.nan)
    half, white, root = np.empty((n, m)), np.empty(m), np.empty((m, m))
    lasting = False
    for b in range(count):
        if not np.isfinite(innovation[b]).all():
            continue
        lasting = _spread_over(noise[b], steps, root)
        for i in range(m):
            for j in range(m):
                root[i, j] += spread[b, i, j]
        squared[b], likelihood[b] = _whiten(root, innovation[b], white)
        copy_matrix(crossed[b], half)
        for i in range(n):  # C L'^-1, whose square is K S K'
            forward(root, half[i])
            for j in range(m):
                step[b, i] += half[i, j] * white[j]
            if estimated[i] == 0.0:
                step[b, i] = 0.0
        for i in range(n):
            for j in range(i + 1):
                if estimated[i] == 0.0 and estimated[j] == 0.0:
                    continue
                total = covariance[b, i, j]
                for k in range(m):
                    total -= half[i, k] * half[j, k]
                out[b, i, j] = total
                out[b, j, i] = total
    if lasting:
        squared, likelihood = innovation_likelihood(spread + noise, innovation)
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
        copy_matrix(covariance[b], root)
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

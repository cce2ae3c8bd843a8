"""Noise of readings that follows what the readings tell, and mixtures of hypotheses about it.

All arrays are (B, ...), float64, as in `algorithms.filtering.algebra_kernel`.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.filtering.algebra_kernel import innovation_covariance
from algorithms.kernels.copies import copy_matrix


@compiled
def adapt(  # noqa: PLR0917 - one pass
    noise: Floats,
    covariance: Floats,
    sensitivity: Floats,
    residual: Floats,
    squared: Floats,
    window: float,
    least: Floats,
    most: Floats,
) -> Floats:
    """``R + (e e' + H P H' - R) / window`` (B, m, m), its diagonal from `least` to `most` (m,).

    The noise stays where a residual e (B, m) or the squared innovation (B,) is not finite.
    """
    count, m = residual.shape
    left = np.empty_like(noise)
    for b in range(count):
        for i in range(m):
            for j in range(m):
                left[b, i, j] = residual[b, i] * residual[b, j]
    out = innovation_covariance(covariance, sensitivity, left)
    high = np.empty(m)
    for b in range(count):
        if not (np.isfinite(residual[b]).all() and math.isfinite(squared[b])):
            copy_matrix(noise[b], out[b])
            continue
        for i in range(m):
            for j in range(m):
                out[b, i, j] = noise[b, i, j] + (out[b, i, j] - noise[b, i, j]) / window
            ratio = most[i] / out[b, i, i] if out[b, i, i] != 0.0 else np.inf
            high[i] = np.sqrt(min(ratio, 1.0))
        for i in range(m):
            # rows and columns together: what is lowered on the diagonal alone has no root
            for j in range(m):
                out[b, i, j] *= high[i] * high[j]
            out[b, i, i] = max(out[b, i, i], least[i])
    return out


@compiled
def raise_noise(
    noise: Floats, covariance: Floats, sensitivity: Floats, innovation: Floats, limit: float
) -> Floats:
    """Noise (B, m, m), raised where an innovation is beyond `limit` standard deviations (Huber)."""
    out = noise.copy()
    spread = innovation_covariance(covariance, sensitivity, noise)
    for b in range(len(innovation)):
        for i in range(innovation.shape[1]):
            deviation = np.sqrt(spread[b, i, i])
            size = abs(innovation[b, i]) / deviation if deviation != 0.0 else np.inf
            if size > limit:
                out[b, i, i] += spread[b, i, i] * (size / limit - 1.0)
    return out


@compiled
def mix(weights: Floats, errors: Floats, covariance: Floats) -> tuple[Floats, Floats]:
    """Mean (B, n) of hypotheses, and its covariance: theirs, and of what they are apart.

    Weights (B, H), errors (B, H, n), covariances (B, H, n, n).
    """
    count, number, n = errors.shape
    mean, out = np.zeros((count, n)), np.zeros((count, n, n))
    apart = np.empty(n)
    for b in range(count):
        for h in range(number):
            for i in range(n):
                mean[b, i] += weights[b, h] * errors[b, h, i]
        for h in range(number):
            for i in range(n):
                apart[i] = errors[b, h, i] - mean[b, i]
            for i in range(n):
                for j in range(n):
                    own = covariance[b, h, i, j] + apart[i] * apart[j]
                    out[b, i, j] += weights[b, h] * own
    return mean, out

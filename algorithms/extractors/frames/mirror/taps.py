"""Filters of `algorithms.extractors.frames.mirror.fit_kernel`, and the noise that they share.

Numbers alone: what is compiled with them is not compiled anew when they change.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats

#: Taps n = 1 .. 6 of ``sum t_n (S(u + n) - S(u - n))``, as ``t = sum TAPS[q] d^(2 q)``: of all such
#: filters exact to third order, the one that is nearest to ``2 tan(pi k d) / d`` for edges as
#: soft as half a pixel.
TAPS = np.array(
    [
        [0.9246398, -0.3624963, 0.1562918, -0.0589719, 0.0162817, -0.0023405],
        [0.2622294, -0.2387220, 0.1137634, -0.0443487, 0.0124225, -0.0017989],
        [0.1112456, -0.1298026, 0.0820968, -0.0349416, 0.0101683, -0.0015010],
        [0.0518314, -0.0676519, 0.0497708, -0.0240701, 0.0074510, -0.0011357],
    ]
)
#: Slope along one axis by four pixels, mean along the other by three, of the sharpest weighting.
SLOPE_1, SLOPE_2, BESIDE, MIDDLE = 2.0 / 3.0, -1.0 / 12.0, 1.0 / 6.0, 2.0 / 3.0
#: Levels of smoothing of the weighting, by binomials 2, 4 ... px apart.
LEVELS = 5


def noise_of_levels() -> tuple[Floats, Floats]:
    """Of each level's weighting along x: sum of squared taps, and products with rows of `TAPS`."""
    squares, products = np.empty(LEVELS), np.empty((LEVELS, len(TAPS)))
    smooth = np.array([1.0])
    for level in range(LEVELS):
        if level > 0:
            binomial = np.zeros(2 ** (level + 1) + 1)
            binomial[[0, 2**level, -1]] = 0.25, 0.5, 0.25
            smooth = np.convolve(smooth, binomial)
        slope = np.convolve(smooth, [-SLOPE_2, -SLOPE_1, 0.0, SLOPE_1, SLOPE_2])
        mean = np.convolve(smooth, [BESIDE, MIDDLE, BESIDE])
        squares[level] = np.sum(slope**2) * np.sum(mean**2)
        middle = len(slope) // 2
        reach = min(TAPS.shape[1], middle)
        taps = slope[middle + 1 : middle + 1 + reach]
        products[level] = 2.0 * (TAPS[:, :reach] @ taps) * mean[len(mean) // 2]
    return squares, products


def noise_of_slopes() -> tuple[Floats, Floats]:
    """Of white noise in the slopes of `TAPS`, as polynomials in d^2.

    Half its variance over that of the means, and what neighbours along the slope have in common.
    """
    own, common = np.zeros(2 * len(TAPS) - 1), np.zeros(2 * len(TAPS) - 1)
    for q, one in enumerate(TAPS):
        for r, other in enumerate(TAPS):
            own[q + r] += one @ other
            common[q + r] += one[1:] @ other[:-1]  # t_0 is none, and -t_1 has t_1 two pixels away
    return own, common

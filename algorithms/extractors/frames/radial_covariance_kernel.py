"""How sure matched estimates of round spots' centres are.

What `radial_kernel.matched_centres` finds is looked at once more, about the centres found.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.radial_kernel import (
    NEAR,
    PROFILE,
    RUNNING,
    SUMS,
    border,
    most_rings,
    pixels_near,
    profile_of,
    ring_sums,
    rings_of,
    running_sums,
)

#: Lit pixels below which what rings show of the profile is not what light falls off by.
_RESOLVED = 32.0


@compiled
def _sure(  # noqa: PLR0917 - Numba takes no keyword-only ones
    pixels: Floats, scale: float, profile: Floats, noise: Floats, misfit: float, out: Floats
) -> None:
    """Write the covariance (2, 2) of a step's end, where pixels depart as much as their noise."""
    c_, s_, r_, u_ = pixels[0], pixels[1], pixels[2], pixels[3]
    a_xx, a_xy, a_yy = 0.0, 0.0, 0.0
    b_xx, b_xy, b_yy = 0.0, 0.0, 0.0
    squares = 0.0
    for p in range(r_.size):
        c, s, r = c_[p], s_[p], r_[p]
        at = profile[np.uint32(r * scale)]
        light = at[0] + (at[1] + at[2] * r) * r
        variance = noise[0] + noise[1] * max(light, 0.0)
        squares += (u_[p] - light) ** 2 / variance
        c_own, s_own = c - at[5], s - at[6]
        a_xx += at[4] * c * c_own
        a_xy += at[4] * 0.5 * (c * s_own + s * c_own)
        a_yy += at[4] * s * s_own
        weight = at[3] * at[3] * variance
        b_xx += weight * c_own * c_own
        b_xy += weight * c_own * s_own
        b_yy += weight * s_own * s_own
    determinant = a_xx * a_yy - a_xy * a_xy
    if squares > misfit * r_.size or not determinant > 1e-12 * a_xx * a_yy:
        return
    a, b, d = a_yy / determinant, -a_xy / determinant, a_xx / determinant
    out[0, 0] = a * a * b_xx + 2.0 * a * b * b_xy + b * b * b_yy
    out[1, 1] = b * b * b_xx + 2.0 * b * d * b_xy + d * d * b_yy
    out[0, 1] = a * b * b_xx + (a * d + b * b) * b_xy + b * d * b_yy
    out[1, 0] = out[0, 1]


@compiled
def matched_covariances(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    maxima: NDArray[Any],
    centres: Floats,
    noises: Floats,
    misfit: float,
    out: Floats,
) -> None:
    """Write the covariance of centres to `out` (N, 2, 2); NaN where the profile does not fit.

    So it is where a spot has too few pixels for rings to show its profile.

    Parameters
    ----------
    frames, maxima
        As for `matched_centres`.
    centres
        (N, 4), as it writes them.
    noises
        (N, 2) variance of a dark pixel, and what a unit of light adds to it; NaN for those that are
        passed over.
    misfit
        Mean square of what the spot's pixels depart from the profile by, over their variance, above
        which it is not that of the spot.
    """
    count, height, width = frames.shape
    most = most_rings(height, width)
    pixels = np.empty((4, height * width))
    sums = np.empty((most, SUMS))
    profile = np.empty((most, PROFILE))
    running = np.empty((RUNNING, most + 2 * NEAR + 1))
    lines = np.empty((7, most + 2 * NEAR))
    for k in range(count):
        out[k] = np.nan
        x, y, radius = centres[k, 0], centres[k, 1], centres[k, 3]
        if not (math.isfinite(x) and math.isfinite(noises[k, 0])):
            continue
        if math.pi * radius * radius < _RESOLVED:
            continue
        base, noise = border(frames[k])
        reach, ring, scale, rings = rings_of(radius, float(maxima[k].max()) - base, noise)
        sums[:rings] = 0.0
        near = pixels_near(frames[k], x, y, base, reach, pixels)
        ring_sums(pixels, near, scale, sums)
        running_sums(sums, rings, running)
        profile_of(sums, running, rings, ring, noise, lines, profile)
        _sure(pixels[:, :near], scale, profile, noises[k], misfit, out[k])

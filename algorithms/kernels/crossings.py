"""Midpoints between the outermost crossings of many thresholds on profiles."""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats


@compiled
def threshold_midpoints(  # noqa: PLR0917 - Numba takes no keyword-only ones
    profiles: Floats,
    floors: Floats,
    accuracy: float,
    lowest: float,
    highest: float,
    between: bool,
    out: Floats,
) -> None:
    """Write the mean midpoint of each profile (N, L) to `out` (N,); NaN where none is crossed.

    Thresholds lie evenly between the fractions `lowest` and `highest` of the profile's height
    above its floor (N,), their number is the least above ``sigma sqrt(e) / accuracy``. With
    `between`, a crossing is interpolated between its two entries.
    """
    count, length = profiles.shape
    for k in range(count):
        out[k] = np.nan
        p = profiles[k]
        floor = floors[k]
        peak = p[0]
        area = 0.0
        for j in range(length):
            peak = max(peak, p[j])
            area += p[j] - floor
        height = peak - floor
        if not (height > 0 and area > 0 and math.isfinite(area)):
            continue
        sigma = area / (height * math.sqrt(2 * math.pi))
        thresholds = int(sigma * math.sqrt(math.e) / accuracy) + 1
        spacing = (highest - lowest) * height / thresholds
        i = 0
        j = length - 1
        total = 0.0
        crossed = 0
        for m in range(thresholds):
            threshold = floor + lowest * height + (m + 0.5) * spacing
            # Thresholds rise, so the first entry above one is never before that of the last.
            while p[i] <= threshold:
                i += 1
            while p[j] <= threshold:
                j -= 1
            if i == 0 or j == length - 1:
                continue
            h = float(i)
            g = float(j)
            if between:
                h -= (p[i] - threshold) / (p[i] - p[i - 1])
                g += (p[j] - threshold) / (p[j] - p[j + 1])
            total += 0.5 * (h + g)
            crossed += 1
        if crossed > 0:
            out[k] = total / crossed

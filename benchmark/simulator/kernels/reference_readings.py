"""Compiled dark and flat readings of a whole detector (loaded on first use: Numba)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Six = tuple[float, float, float, float, float, float]


@compiled
def add_reading(
    total: Floats,
    level: tuple[Floats, Floats],
    noise: tuple[NDArray[np.float32], Floats],
    columns: tuple[Floats, Floats],
    numbers: Six,
) -> None:
    """Add the digital numbers of one reading of every pixel.

    Parameters
    ----------
    total
        (H, W), added to.
    level
        (H, W) mean electrons, and the standard deviation of their Gaussian noise.
    noise
        (H, W) normal values; and the noise of the counts of dim pixels, row by row.
    columns
        (W,) electrons that amplifiers add: always, and in this reading.
    numbers
        Mean electrons below which a pixel is dim; full well; by how much of itself an electron's
        share falls with every electron more; electrons a digital number; offset and largest
        digital number.
    """
    mean, deviation = level
    normal, counted = noise
    offsets, shared = columns
    dim, full_well, bend, per_dn, offset, top = numbers
    if per_dn == 0.0:
        # said once, so that no pixel has to be looked at for it
        raise ZeroDivisionError("electrons a digital number must not be 0")
    line, k = np.empty(total.shape[1]), 0
    for row in range(total.shape[0]):
        means, deviations, normals, sums = mean[row], deviation[row], normal[row], total[row]
        for column in range(line.shape[0]):
            line[column] = deviations[column] * normals[column] + means[column]
        if k < counted.shape[0]:
            for column in range(line.shape[0]):
                if means[column] < dim:
                    line[column] += counted[k]
                    k += 1
        for column in range(line.shape[0]):
            value = min(line[column], full_well)
            value = value * (1.0 - bend * value) + offsets[column] + shared[column]
            value = np.rint(offset + value / per_dn)
            sums[column] += min(max(value, 0.0), top)

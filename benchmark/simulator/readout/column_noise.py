"""Noise that all pixels of a column share: `CommonNoise`, for bounds.

A column's amplifier adds the same to every pixel it reads, so that readings of one column are
correlated: their covariance is diagonal but for one term of rank one a column.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.readout.references import References


@dataclass(frozen=True)
class CommonNoise:
    """Noise that elements of a signal share.

    Attributes
    ----------
    group
        (M,) or (N, M): in which group each element is, from 0; elements of a group share theirs. A
        number: elements are rows of so many columns, one after another, and columns are groups.
    deviation
        Standard deviation of it, in units of the signal; other groups' are independent.
    """

    group: NDArray[np.int64] | int
    deviation: float


def column_deviation_e(detector: PixelArray, references: References | None) -> float:
    """Return the standard deviation of what a column's pixels share and nobody knows, electrons.

    The noise; and where the unit is known by `references` alone, what they leave of the column's
    offset, too. Every reading of them has column noise of its own, which no number of rows
    averages; all else that they have does average, over the rows.
    """
    noise, offset = detector.shared_noise_e, detector.errors.column_offset_e
    if references is None or detector.rows == 1 or not offset:
        return noise
    readings = references.flats + references.darks
    unknown = offset**2
    if readings:
        # the harmonic sum of prior and mean reading; nothing where columns have no noise
        unknown = offset**2 * noise**2 / (noise**2 + readings * offset**2)
    return float(np.sqrt(noise**2 + unknown))


def column_noise(
    detector: PixelArray, columns: NDArray[np.int64] | int, references: References | None
) -> CommonNoise | None:
    """Return what pixels in these columns share, in digital numbers; None for nothing."""
    deviation = column_deviation_e(detector, references)
    return CommonNoise(columns, deviation / detector.gain_e_per_dn) if deviation else None


def window_noise(
    detector: PixelArray, shape: tuple[int, ...], references: References | None
) -> CommonNoise | None:
    """`column_noise` of frames or windows of a shape (N, H, W)."""
    return column_noise(detector, shape[2], references)

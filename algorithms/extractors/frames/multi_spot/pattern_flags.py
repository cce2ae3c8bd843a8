"""Why a method of many spots has no answer: nothing found, or a pattern that may be several."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.aperture_pattern import Pattern
from algorithms.measurement import Measurement, QualityFlag


def find_pattern_flags(features: Floats, pattern: Pattern) -> NDArray[np.int64]:
    """Return the flags (N,) of answers (N, 2) from a pattern found in their frames.

    AMBIGUOUS_PATTERN where another displacement explains the frame nearly as well, whether or not
    there is an answer; NO_SPOT where there is none for another reason.
    """
    nothing = np.where(np.isnan(features[:, 0]), int(QualityFlag.NO_SPOT), 0)
    return np.where(pattern.ambiguous, int(QualityFlag.AMBIGUOUS_PATTERN), nothing).astype(np.int64)


def without_covariance(features: Floats, pattern: Pattern) -> Measurement:
    """Return what `Extractor.measure` gives of a method that states no covariance."""
    n, f = features.shape
    return Measurement(features, np.full((n, f, f), np.nan), find_pattern_flags(features, pattern))

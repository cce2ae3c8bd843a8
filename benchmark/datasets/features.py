"""Features of corrected observations: what an extractor is given, without all of it at once."""

from __future__ import annotations

import numpy as np

from algorithms.contract import Extractor, Floats
from algorithms.pipeline import extracted
from algorithms.references import ReferenceCorrection
from benchmark.contract import Samples

#: Bytes of corrected observations from which on they are made so many samples at a time.
LARGE_BYTES, FEW = 256 * 2**20, 16
_FRAME = 2


def features_of(
    extractor: Extractor, samples: Samples, by: ReferenceCorrection | None = None
) -> Floats:
    """Return what an extractor finds in samples (N, F), corrected first.

    Parameters
    ----------
    extractor
        Made for the sensor.
    samples
        As they were read.
    by
        Their `benchmark.datasets.corrected.correction`; None leaves them as they are.
    """
    count, origin = len(samples.sun), samples.origin_px
    large = by is not None and 8 * np.asarray(samples.observations).size > LARGE_BYTES
    step = FEW if large else max(count, 1)
    found = []
    for rows in (slice(start, start + step) for start in range(0, max(count, 1), step)):
        read, first = samples.observations[rows], None if origin is None else origin[rows]
        if by is not None:
            read = by.corrected(read, first if by.dark.ndim == _FRAME else None)
        found.append(extracted(extractor, read, first))
    return found[0] if len(found) == 1 else np.concatenate(found)

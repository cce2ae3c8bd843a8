"""Features of corrected observations: what an extractor is given, without all of it at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from algorithms.contract import Extractor, Floats
from algorithms.pipeline import extract_features
from algorithms.references import ReferenceCorrection

if TYPE_CHECKING:
    from benchmark.datasets.samples import Samples

#: Bytes of corrected observations above which they are made in parts, and bytes of a part.
_LARGE_BYTES, _PART_BYTES = 256 * 2**20, 16 * 2**20
_FRAME = 2


def features_of(
    extractor: Extractor, samples: Samples, by: ReferenceCorrection | None = None
) -> Floats:
    """Return what an extractor finds in samples (N, F), corrected first."""
    count, origin = len(samples.sun), samples.origin_px
    size, step = 8 * np.asarray(samples.observations).size, count
    if by is not None and size > _LARGE_BYTES:
        step = max(1, count * _PART_BYTES // size)
    found = []
    for rows in (slice(start, start + step) for start in range(0, count, step)):
        read, first = samples.observations[rows], None if origin is None else origin[rows]
        if by is not None:
            read = by.correct(read, first if by.dark.ndim == _FRAME else None)
        found.append(extract_features(extractor, read, first))
    return found[0] if len(found) == 1 else np.concatenate(found)

"""The stage of features: readings are corrected, and extractors look at them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from algorithms.contract import Extractor, Floats
from algorithms.pipeline import extract_features
from benchmark.datasets.corrected import correct
from benchmark.running.stages import ConditionData, Corrections, RenderedData

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset
    from benchmark.datasets.samples import Samples

#: Bytes from which on corrected observations are not kept but made again for each extractor, some
#: samples at a time: so few that they are still in a processor's cache when they are looked at,
#: and that their memory is used again (glibc returns blocks of 32 MiB to the system).
_CORRECTED_BYTES = 256 * 2**20
_BATCH_BYTES = 8 * 2**20


def correct_readings(made: RenderedData, preset: Preset) -> ConditionData:
    """Return data as extractors get them."""
    splits = dict(made.data.splits)
    left = _corrected_once(splits, made.corrections)
    return replace(made.data, preset=preset, splits=splits, corrections=left)


def found_features(data: ConditionData, extractor: Extractor, split: str) -> Floats:
    """Return what an extractor finds in a split (N, F), found once for all who ask."""
    place = type(extractor), split
    if place not in data.features:
        samples, by = data.splits[split], data.corrections.get(split)
        step = len(samples.sun)
        if by is not None:
            step = max(1, _BATCH_BYTES // (8 * int(np.prod(samples.observations.shape[1:]))))
        parts = (_part(samples, start, start + step) for start in range(0, len(samples.sun), step))
        seen = (correct(by, part) for part in parts)
        found = [extract_features(extractor, one.observations, one.origin_px) for one in seen]
        data.features[place] = found[0] if len(found) == 1 else np.concatenate(found)
    return data.features[place]


def _part(samples: Samples, start: int, stop: int) -> Samples:
    """Return some of the samples, as extractors look at them."""
    rows = slice(start, stop)
    origin = samples.origin_px
    return cast(
        "Samples",
        replace(
            cast("Any", samples),
            observations=samples.observations[rows],
            sun=samples.sun[rows],
            origin_px=None if origin is None else origin[rows],
            context=None,
            true_sun=None,
        ),
    )


def _corrected_once(splits: dict[str, Samples], by: Corrections) -> Corrections:
    """Put corrected samples in the place of those read; return what is left to correct by."""
    size = 8 * sum(np.asarray(samples.observations).size for samples in splits.values())
    later = by if size > _CORRECTED_BYTES else {}
    for split, samples in splits.items():
        if not later:
            splits[split] = correct(by.get(split), samples)
        # methods share them, and what they find in them
        np.asarray(splits[split].observations).flags.writeable = False
    return later

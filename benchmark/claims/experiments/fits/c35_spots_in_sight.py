"""C35: a network shown only Suns whose spots are all in sight, or all Suns (Rufino2009b).

Frames of `cmos-multi-aperture` are read by MCAM, which finds every aperture's spot. In S-FOV mode
calibration (given the true directions) and test are those frames that show all 100 spots, in X-FOV
mode all frames. Both train `ann` on the displacement of the whole pattern, averaged over the spots
there are. The third line is X-FOV with the plain mean of the spots in sight as the network's input,
as the study has it, which jumps by half a pitch where a row of spots leaves. Field is the share of
the test Suns that get an answer. Nobody's apertures are dark here, so MCAM need not allow for that
(`faulty_lines`): else it takes the frames whose outer rows are out of sight for ambiguous ones.
Poses stand every 10 degrees instead of 12, so that some are at the edge of either field.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.multiple_centroids import (
    MultipleCentroids,
    mean_displacement,
)
from algorithms.models.neural_network.axis_networks import AxisNetworks
from benchmark.claims.benches import ConditionView, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.fits.poses import Poses, errors
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.fields import AngleField
from benchmark.datasets.standard import cmos_multi_aperture

PLACES = ("all 100", "81 or 90")


@dataclass(frozen=True)
class _Frames:
    """What MCAM reads of a split: both kinds of features, and which frames show every spot."""

    displaced: Poses
    averaged: Poses
    whole: NDArray[np.bool_]


def trial(number: int) -> Trial:
    """Measure one unit."""
    directions = AngleField(60.0, steps=13, test_samples=100)
    seen = ConditionView(
        with_true_directions(replace(cmos_multi_aperture.PRESET, directions=directions)),
        unit=number,
    )
    known, asked = (_read(seen, split) for split in ("calibration", "test"))
    narrow = np.full(len(asked.whole), math.nan)
    narrow[asked.whole] = errors(
        AxisNetworks(), known.displaced.select(known.whole), asked.displaced.select(asked.whole)
    )
    wide = errors(AxisNetworks(), known.displaced, asked.displaced)
    plain = errors(AxisNetworks(), known.averaged, asked.averaged)
    return Trial(
        {
            "field": ratio(_answered(wide), _answered(narrow)),
            "accuracy": ratio(rms(narrow), rms(wide)),
        },
        {
            name: (PLACES, [rms(found, asked.whole), rms(found, ~asked.whole)])
            for name, found in (
                ("S-FOV", narrow),
                ("X-FOV", wide),
                ("X-FOV, plain mean of the spots", plain),
            )
        },
    )


def _read(seen: ConditionView, split: str) -> _Frames:
    method = replace(MultipleCentroids.for_sensor(seen.preset.geometry), faulty_lines=0)
    samples = seen.samples(split)
    spots = method.spots(samples.observations)
    there = np.isfinite(spots[..., 0])
    apertures = np.array(method.apertures_px)
    return _Frames(
        Poses(mean_displacement(spots, apertures), samples.sun),
        Poses(_mean(spots, there), samples.sun),
        np.asarray(there.all(axis=1)),
    )


def _mean(spots: Floats, there: NDArray[np.bool_]) -> Floats:
    """Mean (N, 2) of the spots (N, A, 2) there are; NaN for none."""
    count = there.sum(axis=1)[:, None]
    sums = np.where(there[..., None], spots, 0.0).sum(axis=1)
    return np.where(count > 0, sums / np.maximum(count, 1), math.nan)


def _answered(found: Floats) -> float:
    return float(np.isfinite(found).mean())

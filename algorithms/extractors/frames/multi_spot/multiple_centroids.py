"""Centroids of many spots, averaged (MCAM)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
)
from algorithms.documented import documented
from algorithms.extractors.frames.multi_spot.aperture_design import PATTERN_NEEDS
from algorithms.extractors.frames.multi_spot.aperture_pattern import (
    Levels,
    Pattern,
    lattice,
)
from algorithms.extractors.frames.multi_spot.mask_spots import MaskSpots
from algorithms.inputs import Frames, as_frames


@documented
@dataclass(frozen=True)
class MultipleCentroids(MaskSpots, Extractor):
    """Mean of the thresholded centroids of all whole spots, each less its aperture's place.

    Every aperture of the mask repeats the measurement, so noise falls with the square root of the
    number of apertures. The pattern tells which aperture belongs to which spot, so spots may be
    missing or cut by the edge, and the mask may be larger than the detector.

    Parameters
    ----------
    threshold : float
        The fraction mu, in (0, 1), of the spots' brightness above the background. The survey
        gives no value; 0.3 is ours, as for BCTM.

    Notes
    -----
    Implements: alg:MCAM (fe:mcam, Rufino2009b): ``I' = max(I - mu I_max, 0)``, ``x_n = sum(x I') /
    sum(I')`` in each segment n, ``x_avg = sum(x_n) / N``. The survey prints x over rows; corrected
    because x runs along columns here. mu counts from the background, the median of every so many
    pixels, and I_max is a brightness that rows of half a spot reach, so that hot pixels do not set
    it: ours. The printed algorithm knows the number of segments; here segments are sets of
    touching pixels. Segments at the edge are left out, and segments smaller than 0.4 of an
    aperture or much larger than its image. The displacements on which most pairs of spot and
    aperture agree are compared by their dark apertures and unexplained spots.

    Failure: a NaN row for a frame that is dark, without contrast, holds a NaN or infinity, or
    whose spots rise less than five times its noise; where fewer than 0.3 of the apertures that
    should be seen are; and where two displacements explain the frame alike (two suns, part of a
    code that several sub-fields share), or one of them with no more than `faulty_lines` faults. A
    grid of which an edge is doubled in full light, the other one out of view, makes the very frame
    of a grid moved by a pitch: it is answered so, and `measure` says AMBIGUOUS_PATTERN wherever
    that may be; with one more of `faulty_lines` there is no answer. If all spots have the same
    sub-pixel position, they share the bias of the threshold, and averaging does not reduce it.

    Cost: 2 operations per pixel, 8 in rows with spots, and 20 per pair of spot and aperture.

    Examples
    --------
    >>> from algorithms.examples import mask_frame
    >>> frames, holes = mask_frame(23.4, 18.8)
    >>> MultipleCentroids(holes).extract(frames).round(1)
    array([[23.3, 18.9]])
    """

    about: ClassVar = AboutExtractor(
        name="mcam",
        taxonomy="MCAM",
        studies=("Rufino2009b",),
        labels=("fe:mcam", "alg:MCAM"),
        origin="survey",
        version=3,
        needs=PATTERN_NEEDS,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    def extract(self, observations: ArrayLike) -> Floats:
        """Averaged positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        return self._read(as_frames(observations))[0][0]

    def spots(self, observations: ArrayLike) -> Floats:
        """Centroids (N, A, 2) of each aperture's spot in frames (N, H, W), px.

        NaN where a spot is missing, cut or not where it should be, and for the whole of a frame
        in which the pattern is not found. ValueError on wrong input.
        """
        return self._read(as_frames(observations))[1].spots

    def _locate(self, frames: Frames, levels: Levels, pattern: Pattern) -> tuple[Floats]:
        del frames, levels
        return (mean_displacement(pattern.spots, lattice(self.apertures_px).apertures),)


def mean_displacement(spots: Floats, apertures: Floats) -> Floats:
    """Mean (N, 2) over the spots (N, A, 2) there are of spot less aperture (A, 3)."""
    away = spots - apertures[:, :2]
    seen = ~np.isnan(away)
    number = seen.sum(axis=1)
    total = np.where(seen, away, 0.0).sum(axis=1)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)

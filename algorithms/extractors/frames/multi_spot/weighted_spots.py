"""Beyond the survey: the centres of many spots by their common image, combined by weight."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
)
from algorithms.documented import documented
from algorithms.extractors.frames.multi_spot.aperture_design import PATTERN_NEEDS, design_pattern
from algorithms.extractors.frames.multi_spot.aperture_pattern import (
    Levels,
    Pattern,
    lattice,
)
from algorithms.extractors.frames.multi_spot.mask_spots import MaskSpots
from algorithms.extractors.frames.multi_spot.pattern_flags import find_pattern_flags
from algorithms.extractors.frames.single_light import (
    check_agreement,
    frames_to_measure,
    longest_px_of,
    require_light,
)
from algorithms.inputs import Frames, as_frames
from algorithms.measurement import Measurement

#: What diffraction and the rims of holes may add to a spot's width, px.
_RIM_PX = 2.0


@documented
@dataclass(frozen=True)
class WeightedSpots(MaskSpots, Extractor):
    """Mean of the centres of all whole spots, each located by the mean image of all spots.

    The pattern tells which aperture belongs to which spot. The radial profile is averaged over all
    spots, and each spot is located by its best fit to this profile; spots are weighted by their
    variances, and those that disagree are left out. The fit has no bias from the sub-pixel
    position, so N spots are sqrt(N) times as precise as one even if all have the same sub-pixel
    position.

    Parameters
    ----------
    longest_px : float or None
        With one aperture, the longest half axis that the outline of its spot has, px, positive;
        None if the design does not give it. See `algorithms.extractors.frames.mirror.extractor`.

    Notes
    -----
    Implements: nothing printed in the survey. With C the second moments of the light above the
    threshold, of all spots, ``rho^2 = sqrt(det C) u^T C^-1 u`` makes them round. The profile
    p(rho) is a smooth cubic spline through the pixels of all spots, each over the spot's share of
    the light, less its background; a step d of a centre solves ``sum(h g g^T p' / v) d = -sum(h g
    (I - p) / v)``, g the slope of rho, h that of p averaged over more than a pixel. A profile of
    rho is symmetric about the middle, and so are the answers for every symmetric image, of
    whatever outline. The variance v grows with the light by the factor that explains how lit
    pixels scatter. The background is that beyond the spots' rims, with a slope where it shows one.
    Pixels six deviations off are left out; so are spots of which the misfit or the place is far
    from the others' median. Where places scatter more than noise explains, by two deviations,
    apertures are off: their variance is added to each. Moments, noise and that factor are those of
    the median spot: light beside one or two that is no spot's own changes nothing for the others.

    What a spline of 0.65 px misses of sharp rims or rings does not average where all spots fall
    alike on the pixels: 0.0003 px of a disc seven pixels wide, 0.001 to 0.002 px of strong rings.

    Failure: a NaN row where the pattern is not found, as for MCAM, and where no spot's centre can
    be fitted. With less than four spots none can be determined to be the wrong one; with one
    aperture, also where registration (`algorithms.extractors.frames.mirror`) does not find one
    whole symmetric light within half a pixel of the answer.

    Cost: as MCAM, and some 150 operations per pixel of the spots' surroundings.

    Examples
    --------
    >>> from algorithms.examples import mask_frame
    >>> frames, holes = mask_frame(23.4, 18.8)
    >>> WeightedSpots(holes).extract(frames).round(1)
    array([[23.4, 18.8]])
    """

    about: ClassVar = AboutExtractor(
        name="weighted-spots",
        taxonomy="None",
        origin="ours",
        version=3,
        needs=PATTERN_NEEDS,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    faulty_lines: int = 1
    longest_px: float | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        require_light(self.about.name, "spot", self.longest_px)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's mask.

        UnsuitableDesignError where its light is no spots.
        """
        design = design_pattern(geometry, cls.about.name)
        return cls(**design, longest_px=longest_px_of(geometry))

    def extract(self, observations: ArrayLike) -> Floats:
        """Weighted positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        return self._read(as_frames(observations))[0][0]

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Positions, covariances and flags of frames (N, H, W) or of one.

        The covariance is that of the weighted mean, x and y apart; with one aperture none is
        stated, for no other spot tells noise from what a profile misses of the image.
        AMBIGUOUS_PATTERN where another identity of the spots explains a frame nearly as well. Bad
        pixels are replaced by their neighbours.
        """
        frames = frames_to_measure(observations, bad, self.about.name)
        (found, _, sure), pattern = self._read(frames)
        covariance = np.zeros((len(found), 2, 2))
        covariance[:, [0, 1], [0, 1]] = sure
        covariance[np.isnan(sure[:, 0]) | np.isnan(found[:, 0])] = np.nan
        return Measurement(found, covariance, find_pattern_flags(found, pattern))

    def _locate(
        self, frames: Frames, levels: Levels, pattern: Pattern
    ) -> tuple[Floats, Floats, Floats]:
        """Positions (N, 2), centres (N, A, 2) and variances of positions (N, 2)."""
        from algorithms.extractors.frames.multi_spot import combination_kernel  # noqa: PLC0415 - Numba, at first use

        centres, variances, misfits = self._centres(frames, levels, pattern.spots)
        known = lattice(self.apertures_px).apertures
        found, sure = np.empty((2, len(frames), 2))
        used = np.empty((len(frames), len(known)), dtype=np.bool_)
        combination_kernel.combine(centres, variances, misfits, known, found, sure, used)
        centres[~used] = np.nan
        if len(known) == 1:  # no others say which light it is
            place = known[0, :2]
            found = check_agreement(frames, found + place, longest_px=self.longest_px) - place
            centres[np.isnan(found[:, 0])] = np.nan
            sure[:] = np.nan
        return found, centres, sure

    def _centres(
        self, frames: NDArray[Any], levels: Levels, starts: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Centres (N, A, 2) of spots, their variances and misfits (N, A), from rough ones.

        Any estimator of single spots that gives these can stand here.
        """
        from algorithms.extractors.frames.multi_spot import (  # noqa: PLC0415 - Numba, at first use
            shared_profile_kernel,
            spot_pixels_kernel,
        )

        height, width = frames.shape[1:]
        known = lattice(self.apertures_px)
        size = float(known.apertures[:, 2].max()) + self.blur_px + _RIM_PX
        room = min(known.nearest_px, float(height + width)) / 2.0
        # a spot's pixels and its surroundings', elongated as spots of great incidence are
        most = min((math.ceil(2.0 * size) + 9) ** 2, height * width)
        pixels = np.empty((6, starts.shape[1] * most))
        form = np.empty(1, dtype=spot_pixels_kernel.FORM)[0]
        centres = np.full_like(starts, np.nan)
        variances, misfits = np.full((2, *starts.shape[:2]), np.nan)
        for k, frame in enumerate(frames):
            seen = np.flatnonzero(np.isfinite(starts[k, :, 0]))
            if not len(seen):
                continue
            spots, ends, lights = starts[k, seen], np.empty_like(seen), np.empty(len(seen))
            if spot_pixels_kernel.spot_pixels(
                frame,
                levels.threshold[k],
                levels.floor[k],
                spots,
                size,
                room,
                pixels,
                ends,
                lights,
                form,
            ):
                own, off = np.empty((2, len(seen)))
                shared_profile_kernel.shared_profile(pixels, ends, lights, spots, form, own, off)
                centres[k, seen], variances[k, seen], misfits[k, seen] = spots, own, off
        return centres, variances, misfits

"""Beyond the survey: spots of a mask seen at once, located under moving windows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

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
from algorithms.extractors.frames.multi_spot.aperture_pattern import Levels, Pattern, lattice
from algorithms.extractors.frames.multi_spot.mask_spots import MaskSpots
from algorithms.extractors.frames.multi_spot.spot_windows import window_centres
from algorithms.inputs import Frames, as_frames
from algorithms.spot_arrays import require_seen_at_once
from algorithms.spot_lists import SPOT_COLUMNS, spot_columns

#: Half of what is summed around a spot, over the least distance of two apertures.
_ROOM = 0.55
#: Width of the windows over that of the spots.
_FACTOR = 1.5
#: Spots farther than this from the median displacement, px, or of less of its light are none.
_ASTRAY, _DIM = 1.5, 0.2


@documented
@dataclass(frozen=True)
class WindowedArray(MaskSpots, Extractor):
    """First moment of every aperture's spot under a Gaussian window centred on it.

    The pattern tells where each aperture's spot has to be; a window there moves until the light
    under it has no first moment about its middle. Dim spots count as well, so that hardly a spot
    enters or leaves the list from frame to frame.

    Notes
    -----
    Implements: nothing printed in the survey. The pattern is that of MCAM; the window is that of
    `WindowedList`. A spot is left out where its window does not settle within the frame or ends
    1.5 px from the median displacement, and where it has not a fifth of the median light.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px, light)`` of the spot of each of A
    apertures (N, 3 A), in the mask's order, zeros where it is not seen; pixel centres at integers,
    light the sum under the window.

    Failure: a NaN row where the pattern is not found, as for MCAM, and where no spot is left.

    Cost: as MCAM, and 20 operations per pixel of the windows and step, 20 to 40 steps.

    Examples
    --------
    >>> from algorithms.examples import mask_frame
    >>> frames, holes = mask_frame(23.4, 18.8)
    >>> WindowedArray(holes).extract(frames).reshape(-1, 3)[:2, :2].round(1)
    array([[15.4, 12.8],
           [31.4, 13.8]])
    """

    about: ClassVar = AboutExtractor(
        name="windowed-array",
        taxonomy="None",
        origin="ours",
        needs=(*PATTERN_NEEDS, "apertures", "centre_px"),
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOTS,
    )

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the columns, three an aperture."""
        return spot_columns(len(self.apertures_px))

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's mask.

        UnsuitableDesignError where its light is no spots, or its mask is larger than the detector.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        require_seen_at_once(geometry, cls.about.name)
        return cls(**design_pattern(geometry, cls.about.name))

    def extract(self, observations: ArrayLike) -> Floats:
        """Spots (N, 3 A), three columns each, of frames (N, H, W); ValueError on wrong input."""
        return self._read(as_frames(observations))[0][0]

    def spots(self, observations: ArrayLike) -> Floats:
        """Positions (N, A, 2) of each aperture's spot in frames (N, H, W), px; NaN for none."""
        lists = self.extract(observations).reshape(-1, len(self.apertures_px), SPOT_COLUMNS)
        return np.where(lists[:, :, 2:] > 0.0, lists[:, :, :2], np.nan)

    def _locate(
        self, frames: Frames, levels: Levels, pattern: Pattern
    ) -> tuple[NDArray[np.float64]]:
        drawn = np.array(self.apertures_px)
        cap = _ROOM * min(lattice(self.apertures_px).nearest_px, float(max(frames.shape[1:])))
        deviation = max(float(np.median(drawn[:, 2])) / 4.0, 1.0)
        found = np.zeros((len(frames), len(drawn), SPOT_COLUMNS))
        seen = np.isfinite(pattern.displacement[:, 0])
        for k in np.flatnonzero(seen):
            starts = drawn[:, :2] + pattern.displacement[k]
            spots = window_centres(frames[k], levels.floor[k], starts, deviation, cap, _FACTOR)
            light, away = np.nan_to_num(spots[:, 2]), spots[:, :2] - drawn[:, :2]
            near = light > _DIM * np.median(light)
            seen[k] = near.any()
            if seen[k]:
                near &= np.hypot(*(away - np.median(away[near], axis=0)).T) < _ASTRAY
                found[k, near] = spots[near]
        found[~seen] = np.nan
        return (found.reshape(len(frames), -1),)

"""Every whole spot of a frame by itself, for models that read the mask's code (BCTM)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
)
from algorithms.extractors.frames.multi_spot.aperture_design import (
    PATTERN_NEEDS,
    design_pattern,
)
from algorithms.extractors.frames.multi_spot.aperture_pattern import (
    Apertures,
    frame_levels,
    room_for_spots,
)
from algorithms.inputs import as_frames
from algorithms.parameters import require_positive, require_within
from algorithms.spot_lists import SPOT_COLUMNS, list_length, spot_columns

#: Pixels of a spot above the threshold, over those of its aperture: the least of the smallest,
#: which may gather its light, the most of the largest with the Sun's image, which grows with
#: incidence.
_AREAS = (0.15, 6.0)
_LEAST_PIXELS = 4.0
#: Spots that a frame may have before none are listed, for each that is kept.
_ROOM = 4


@dataclass(frozen=True)
class SpotList(Extractor):
    """Thresholded centroid and total light of every whole spot of a frame.

    The threshold of BCTM divides a frame into segments; the spot in each segment is located
    separately. A model of the mask's code then matches spots with apertures.

    Parameters
    ----------
    apertures_px : tuple of (x, y, width)
        Positions of the apertures of the mask, px from its middle, and their widths, which
        determine the size of spots.
    spots : int
        Length of the list, at least 1. If there are more spots, the brightest are kept.
    blur_px : float
        Width of the Sun's image behind a hole, px, not negative; it limits the size of a spot.
    threshold : float
        The fraction mu, in (0, 1), of the spots' brightness above the background.

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: alg:BCTM (fe:bctm) in every segment of a frame, as the coded sensors of Wei2013,
    Wei2014, Wang2015, Wei2017, Zhang2021 and Zhang2022a use it: ``I' = max(I - mu I_max, 0)``, ``x
    = sum(x I') / sum(I')``. mu counts from the background, the median of every so many pixels.
    Segments are sets of touching pixels above mu of a brightness that rows of half a spot reach;
    then I_max is each spot's own, the mean of its brightest quarter, so that light goes as the
    aperture's area, and a hot pixel sets neither: ours. Segments at the edge of the frame are left
    out, and segments smaller than 0.15 of the smallest aperture or much larger than the image of
    the largest.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px, light)`` of each spot (N, 3 spots), in
    the order their first pixels are read, pixel centres at integers, light the sum of I'; zeros
    after the last.

    Failure: a NaN row for a frame that is dark, without contrast, holds a NaN or infinity, whose
    spots rise less than five times its noise, or that has no whole spot.

    Cost: 2 operations per pixel, 8 in rows with spots.

    References
    ----------
    Wei2013, Wei2014, Wang2015, Wei2017, Zhang2021, Zhang2022a; survey fe:bctm, alg:BCTM.

    Examples
    --------
    >>> from algorithms.examples import mask_frame
    >>> frames, holes = mask_frame(23, 18)
    >>> SpotList(holes, spots=5).extract(frames).reshape(5, 3)[:, :2].round(1)
    array([[15., 12.],
           [31., 13.],
           [32., 24.],
           [16., 25.],
           [ 0.,  0.]])
    """

    about: ClassVar = AboutExtractor(
        name="spot-list",
        taxonomy="BCTM",
        studies=("Wei2013", "Wei2014", "Wang2015", "Wei2017", "Zhang2021", "Zhang2022a"),
        labels=("fe:bctm", "alg:BCTM"),
        origin="survey",
        needs=(*PATTERN_NEEDS, "apertures", "centre_px"),
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOTS,
    )

    apertures_px: Apertures = field(repr=False)
    spots: int
    blur_px: float = 0.0
    threshold: float = 0.3

    def __post_init__(self) -> None:
        by, rows = self.about.name, np.array(self.apertures_px, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != SPOT_COLUMNS or not np.isfinite(rows).all():
            raise ValueError(f"{by}: apertures_px must be rows of finite x, y, width; got {rows}")
        require_positive(by, spots=self.spots, narrowest_aperture_px=float(rows[:, 2].min()))
        if not (math.isfinite(self.blur_px) and self.blur_px >= 0):
            raise ValueError(f"{by}: blur_px must be finite, not negative; got {self.blur_px!r}")
        require_within(by, "(0, 1)", threshold=self.threshold)

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the columns, three a spot."""
        return spot_columns(self.spots)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's mask.

        UnsuitableDesignError where its light is no spots, or its whole mask is seen at once.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        design = design_pattern(geometry, cls.about.name)
        return cls(
            apertures_px=design["apertures_px"],
            spots=list_length(geometry, cls.about.name),
            blur_px=design["blur_px"],
        )

    def extract(self, observations: ArrayLike) -> Floats:
        """Spots (N, 3 spots), three columns each, of frames (N, H, W); ValueError if wrong."""
        from algorithms.extractors.frames.multi_spot import (  # noqa: PLC0415 - Numba, at first use
            own_threshold_kernel,
            spots_kernel,
        )

        frames = as_frames(observations)
        count, height, width = frames.shape
        levels = frame_levels(frames, self.apertures_px, self.threshold)
        widths = np.array([width for _, _, width in self.apertures_px])
        least = max(_AREAS[0] * math.pi / 4.0 * float(widths.min()) ** 2, _LEAST_PIXELS)
        most = max(_AREAS[1] * (float(widths.max()) + self.blur_px) ** 2, 2.0 * least)
        room = min(_ROOM * self.spots, int(height * width / least) + 1)
        seen = room_for_spots(count, room, cuts=0)
        spots_kernel.segment(frames, levels.maxima, levels.threshold, least, most, seen)
        listed = np.ascontiguousarray(seen.spots[:, :, [0, 1, 3]])
        counts = np.maximum(seen.counts, 0)
        own_threshold_kernel.own_threshold(
            frames, levels.floor, levels.threshold, self.threshold, least, most, counts, listed
        )
        found = np.zeros((count, self.spots, SPOT_COLUMNS))
        for row, spots, number in zip(found, listed, counts.tolist(), strict=True):
            kept = np.arange(number)
            if number > self.spots:  # the brightest, in their order
                kept = np.sort(np.argsort(-spots[:number, 2], kind="stable")[: self.spots])
            row[: len(kept)] = spots[kept]
        rows = found.reshape(count, -1)
        rows[counts == 0] = np.nan
        return rows

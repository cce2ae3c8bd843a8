"""Beyond the survey: every whole spot of a frame, located under a window that moves with it."""

from __future__ import annotations

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
from algorithms.documented import documented
from algorithms.extractors.frames.multi_spot.aperture_pattern import (
    Apertures,
    frame_levels,
    nearest_distance,
)
from algorithms.extractors.frames.multi_spot.spot_list import SpotList
from algorithms.extractors.frames.multi_spot.spot_windows import window_centres
from algorithms.inputs import as_frames
from algorithms.spot_lists import SPOT_COLUMNS, spot_columns

#: Half of what is summed around a spot, over the least distance of two apertures.
_ROOM = 0.55
#: Width of the windows over that of the spots.
_FACTOR = 1.2


@documented
@dataclass(frozen=True)
class WindowedList(Extractor):
    """First moment of every whole spot of a frame under a Gaussian window centred on it.

    A window moves until the light under it has no first moment about its middle. All windows of a
    frame have the shape of the frame's spots, so that noise far from a spot has no weight and the
    spot's place on the pixels has hardly any effect.

    Parameters
    ----------
    apertures_px : tuple of (x, y, width)
        Positions of the apertures of the mask, px from its middle, and their widths.
    spots : int
        Length of the list, at least 1. If there are more spots, the brightest are kept.
    blur_px : float
        Width of the Sun's image behind a hole, px, not negative; it limits the size of a spot.
    threshold : float
        The fraction, in (0, 1), of the spots' brightness above the background at which spots are
        told apart.

    Notes
    -----
    Implements: nothing printed in the survey. Spots are those of `SpotList`; the centre c solves
    ``sum(w(x - c) C^-1 (x - c) (I - b)) = 0`` by Newton's method, ``w(u) = exp(-u^T C^-1 u / 2)``,
    b the median of every so many pixels. C is 1.2^2 times the covariance of the Gaussian whose
    second moments under itself are those of the mean spot of the frame; at an edge it shrinks. The
    window is even: the centre has no bias for any point-symmetric spot, except that pixels sample
    light finer than they are, which costs some thousandths of a pixel for spots two pixels wide.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px, light)`` of each spot (N, 3 spots), in
    the order their first pixels are read, pixel centres at integers; zeros after the last.

    Failure: a NaN row as for `SpotList`. A spot whose window does not settle, or that the edge is
    too near to, keeps its thresholded centroid.

    Cost: that of `SpotList`, and 20 operations per pixel of the windows and step, 20 to 40 steps.

    Examples
    --------
    >>> from algorithms.examples import mask_frame
    >>> frames, holes = mask_frame(23, 18)
    >>> WindowedList(holes, spots=5).extract(frames).reshape(5, 3)[:, :2].round(1)
    array([[15., 12.],
           [31., 13.],
           [32., 24.],
           [16., 25.],
           [ 0.,  0.]])
    """

    about: ClassVar = AboutExtractor(
        name="windowed-list",
        taxonomy="None",
        origin="ours",
        needs=SpotList.about.needs,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOTS,
    )

    apertures_px: Apertures = field(repr=False)
    spots: int
    blur_px: float = 0.0
    threshold: float = 0.3

    def __post_init__(self) -> None:
        self._thresholded()

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the columns, three a spot."""
        return spot_columns(self.spots)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's mask.

        UnsuitableDesignError where its light is no spots, or its whole mask is seen at once.
        """
        same = SpotList.for_sensor(geometry)
        return cls(same.apertures_px, same.spots, same.blur_px)

    def extract(self, observations: ArrayLike) -> Floats:
        """Spots (N, 3 spots), three columns each, of frames (N, H, W); ValueError if wrong."""
        rows = self._thresholded().extract(observations)
        frames = as_frames(observations)
        floors = frame_levels(frames, self.apertures_px, self.threshold).floor
        drawn, size = np.array(self.apertures_px), float(max(frames.shape[1:]))
        cap = _ROOM * min(nearest_distance(drawn), size)
        deviation = max(float(np.median(drawn[:, 2])) / 4.0, 1.0)
        lists = rows.reshape(len(rows), -1, SPOT_COLUMNS)
        for frame, floor, row in zip(frames, floors, lists, strict=True):
            lit = row[:, 2] > 0.0
            if lit.any():
                centres = window_centres(frame, floor, row[lit, :2], deviation, cap, _FACTOR)[:, :2]
                row[lit, :2] = np.where(np.isnan(centres), row[lit, :2], centres)
        return rows

    def _thresholded(self) -> SpotList:
        try:
            return SpotList(self.apertures_px, self.spots, self.blur_px, self.threshold)
        except ValueError as error:
            raise ValueError(str(error).replace(SpotList.about.name, self.about.name)) from error

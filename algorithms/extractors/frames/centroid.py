"""First moments of a frame: plain (BCM), above a threshold (BCTM), of the smoothed frame (IFM)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import AboutExtractor, Extractor, FeatureKind, Floats, Observation
from algorithms.documented import documented
from algorithms.extractors.frames.background import (
    Background,
    background_level,
)
from algorithms.extractors.frames.windows import Windows, follow_spot, require_window
from algorithms.inputs import as_frames
from algorithms.parameters import require_choice
from algorithms.row_arithmetic import quotient_rows

#: Standard deviations of the dark pixels that light must exceed: none of a million does by noise.
_DEVIATIONS = 6.0


@documented
@dataclass(frozen=True)
class BasicCentroid(Extractor):
    """Intensity-weighted mean position of all light in the frame.

    The method is simple and has sub-pixel resolution, but background and noise pull the result
    towards the centre of the frame.

    Parameters
    ----------
    background : {"none", "border", "median"}
        Level subtracted from every pixel before the sums. Pixels below it count as negative, so
        that noise averages out. The published method subtracts nothing.

    Notes
    -----
    Implements: alg:BCM (fe:bcm, Chang2008): ``x_c = sum(x I) / sum(I)``, ``y_c = sum(y I) /
    sum(I)``. The survey prints x over rows; corrected because x runs along columns here.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark (sum not positive), without contrast (all dark or
    all saturated) or holds a NaN or infinity, or whose centroid falls outside it (pixels of both
    signs that almost cancel). A second spot, or one cut by the edge, shifts the answer undetected.

    Cost: 4 operations per pixel, one pass.

    Examples
    --------
    >>> from algorithms.examples import spot_frame
    >>> frames = spot_frame(12.3, 9.8)
    >>> BasicCentroid().extract(frames).round(2)
    array([[12.3,  9.8]])
    >>> BasicCentroid(background="median").extract(frames + 50).round(2)
    array([[12.3,  9.8]])
    """

    about: ClassVar = AboutExtractor(
        name="bcm",
        taxonomy="BCM",
        studies=("Chang2008",),
        labels=("fe:bcm", "alg:BCM"),
        origin="survey",
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    background: Background = "none"
    window_px: int | None = None

    def __post_init__(self) -> None:
        require_choice(self.about.name, Background, background=self.background)
        require_window(self.window_px, self.about.name)

    def extract(self, observations: ArrayLike) -> Floats:
        """Centroids (N, 2) of frames (N, H, W); ValueError on wrong input."""
        frames = as_frames(observations)
        return _box_centroids(frames, self.background, self.window_px, reach=0)


@documented
@dataclass(frozen=True)
class ThresholdedCentroid(Extractor):
    """Our variant of BCTM: intensity-weighted mean position of the light above a threshold.

    The threshold is subtracted and negative values are set to zero, so that background and noise
    below it have no effect, and light just above it has little weight.

    Parameters
    ----------
    threshold : float or None
        The fraction mu of the maximum, in [0, 1), taken above the background. The survey gives no
        value. None (our variant) uses a threshold six standard deviations above the mean of the
        frame's dark sides. A lower threshold lets noise in, a higher one loses light at the rim of
        the spot.
    background : {"none", "border", "median"}
        Level subtracted from every pixel first. The published method subtracts nothing.

    Notes
    -----
    Implements: alg:BCTM (fe:bctm, He2005): ``I' = max(I - mu I_max, 0)``, ``x_c = sum(x I') /
    sum(I')``, ``y_c = sum(y I') / sum(I')``. The survey prints x over rows; corrected because x
    runs along columns here. With a background b the threshold is ``b + mu (I_max - b)``. Without a
    fraction it is ``mu I_max = m + 6 s``, m and s the mean and the standard deviation of one of
    the frame's sides: the second lowest of the four, as light or hot pixels may lie on the others.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark (maximum not above background or threshold),
    without contrast (all dark or all saturated) or holds a NaN or infinity; without a fraction
    also where light lies along three sides. Pixels brighter than the threshold outside the spot (a
    second spot, a hot pixel, with a fraction noise at low signal) are averaged in without notice.

    Cost: 1 operation per pixel for the maxima, 3 per pixel of the sides, 6 per pixel in rows that
    hold a pixel above the threshold; integer sums are exact.

    Examples
    --------
    >>> from algorithms.examples import spot_frame
    >>> frames = spot_frame(12.3, 9.8)
    >>> ThresholdedCentroid().extract(frames + 50).round(2)
    array([[12.3,  9.8]])
    """

    about: ClassVar = AboutExtractor(
        name="bctm",
        taxonomy="BCTM",
        studies=("He2005",),
        labels=("fe:bctm", "alg:BCTM"),
        origin="survey",
        version=2,
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    threshold: float | None = None
    background: Background = "none"
    window_px: int | None = None

    def __post_init__(self) -> None:
        if self.threshold is not None and not 0.0 <= self.threshold < 1.0:
            raise ValueError(
                f"{self.about.name}: threshold must be None or in [0, 1); got {self.threshold!r}"
            )
        require_choice(self.about.name, Background, background=self.background)
        require_window(self.window_px, self.about.name)

    def extract(self, observations: ArrayLike) -> Floats:
        """Centroids (N, 2) of frames (N, H, W); ValueError on wrong input."""
        from algorithms.kernels import moments, narrow_moments  # noqa: PLC0415 - Numba, at first use

        frames = as_frames(observations)
        shape = frames.shape[1:]
        if self.threshold is None and self.window_px is None and narrow_moments.narrow(frames):
            sums, cut = np.empty((len(frames), 6), dtype=np.int64), np.empty(len(frames))
            narrow_moments.light_above_dark(frames, _DEVIATIONS, cut, sums)
            return _ratio(sums, cut - np.floor(cut))  # without contrast there is no light
        zero = moments.zero_of(frames)
        maxima = np.empty(frames.shape[:2], dtype=frames.dtype)
        moments.row_maxima(frames, maxima)
        peak = maxima.max(axis=1).astype(np.float64)
        with np.errstate(invalid="ignore"):  # an infinite pixel: the frame is unusable below
            if self.threshold is None:
                cut = moments.dark_levels(frames, _DEVIATIONS)
            else:
                base = background_level(frames, self.background)
                cut = base + self.threshold * (peak - base)
            usable = ~moments.unusable_frames(frames) & (peak > cut)
        cut[~usable] = 0.0
        # Integer frames are summed above the whole part of the threshold, exactly; the rest is
        # taken off the sums.
        level = np.floor(cut).astype(np.int64) if zero.dtype == np.int64 else cut
        sums = np.empty((len(frames), 6), dtype=zero.dtype)

        def centroid(windows: Windows) -> Floats:
            moments.moments_above(frames, maxima, level, windows, sums)
            return _ratio(sums, cut - level)

        if self.window_px is None:
            found = centroid(moments.whole_frame(frames))
        else:
            start = moments.first_brightest(frames, maxima)
            found = follow_spot(start, self.window_px, shape, centroid)
        return _inside(found, usable, shape)


@documented
@dataclass(frozen=True)
class FilteredCentroid(Extractor):
    """Intensity-weighted mean position of the frame smoothed by a 3 x 3 mean.

    The frame is smoothed with a 3 x 3 mean (zero outside the frame), and the centroid of the
    smoothed frame is computed. Both steps are linear, so over the whole frame the result differs
    from BCM only by the light in the outermost pixels; smoothing helps only inside a window.

    Parameters
    ----------
    background : {"none", "border", "median"}
        Level subtracted from every pixel before smoothing; residuals below it count negative.
        The published method subtracts nothing.
    window_px : int or None
        Odd side, at least 3, of a square window of the smoothed frame that starts on the brightest
        pixel and moves to its own centroid until it no longer changes; None sums the whole frame,
        as published.

    Notes
    -----
    Implements: alg:IFM (fe:ifm, Chang2008): ``I_mn = (1/9) sum_{i=m-1..m+1} sum_{j=n-1..n+1}
    I_ij`` with zeros outside, then alg:BCM. The survey prints the zero only for ``i, j < 1``;
    corrected because the far edges need it too. The survey prints x over rows; corrected because x
    runs along columns here. The smoothed frame is not computed; each pixel enters the sums as
    often as it lies in a box.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark (sum not positive), without contrast (all dark or
    all saturated) or holds a NaN or infinity, or whose centroid falls outside it (pixels of both
    signs that almost cancel).

    Cost: 4 operations per pixel, one pass.

    Examples
    --------
    >>> from algorithms.examples import spot_frame
    >>> frames = spot_frame(12.3, 9.8)
    >>> FilteredCentroid(window_px=11).extract(frames).round(2)
    array([[12.29,  9.81]])
    """

    about: ClassVar = AboutExtractor(
        name="ifm",
        taxonomy="IFM",
        studies=("Chang2008",),
        labels=("fe:ifm", "alg:IFM"),
        origin="survey",
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    background: Background = "none"
    window_px: int | None = None

    def __post_init__(self) -> None:
        require_choice(self.about.name, Background, background=self.background)
        require_window(self.window_px, self.about.name)

    def extract(self, observations: ArrayLike) -> Floats:
        """Centroids (N, 2) of frames (N, H, W); ValueError on wrong input."""
        frames = as_frames(observations)
        return _box_centroids(frames, self.background, self.window_px, reach=1)


def _box_centroids(
    frames: NDArray[Any], background: Background, window_px: int | None, reach: int
) -> Floats:
    """Centroids (N, 2) of frames summed over boxes of ``2 reach + 1`` pixels a side."""
    from algorithms.kernels import moments, narrow_moments  # noqa: PLC0415 - Numba, at first use

    zero = moments.zero_of(frames)
    base = background_level(frames, background)
    sums = np.empty((len(frames), 6), dtype=zero.dtype)

    def centroid(windows: Windows) -> Floats:
        moments.box_moments(frames, windows, reach, zero, sums)
        return _ratio(sums, base)

    if window_px is None and narrow_moments.narrow(frames):
        narrow_moments.whole_moments(frames, reach, sums)
        found = _ratio(sums, base)
    elif window_px is None:
        found = centroid(moments.whole_frame(frames))
    else:
        maxima = np.empty(frames.shape[:2], dtype=frames.dtype)
        moments.row_maxima(frames, maxima)
        start = moments.first_brightest(frames, maxima)
        found = follow_spot(start, window_px, frames.shape[1:], centroid)
    return _inside(found, ~moments.unusable_frames(frames), frames.shape[1:])


def _inside(found: Floats, usable: NDArray[np.bool_], shape: tuple[int, int]) -> Floats:
    """Centroids (N, 2) of usable frames; a NaN row where it falls outside the frame."""
    edge = np.array([shape[1] - 0.5, shape[0] - 0.5])
    inside = ((found >= -0.5) & (found <= edge)).all(axis=1)
    return np.where((usable & inside)[:, None], found, np.nan)


def _ratio(sums: NDArray[Any], offset: Floats) -> Floats:
    """(x, y) from a kernel's sums (N, 6), `offset` (N,) taken off every pixel summed.

    A NaN row where the light left is not positive.
    """
    with np.errstate(invalid="ignore", over="ignore"):  # infinite pixels: those frames are NaN
        light, light_x, light_y = (sums[:, :3] - offset[:, None] * sums[:, 3:]).T
        found = (light > 0) & np.isfinite(light)
        return quotient_rows(np.column_stack([light_x, light_y]), light, found)

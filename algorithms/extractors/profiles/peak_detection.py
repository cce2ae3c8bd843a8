"""Whole-pixel positions of the brightest light: on lines behind slits and on frames (PD)."""

from __future__ import annotations

from dataclasses import dataclass
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
from algorithms.extractors.profiles.single_spot import require_one_spot, spot_size_px
from algorithms.extractors.profiles.slit_lines import NEEDS, SlitLines, dark_level
from algorithms.inputs import as_frames
from algorithms.parameters import require_positive


@documented
@dataclass(frozen=True)
class PeakDetection(SlitLines):
    """Brightest pixel of a line; behind several slits, the brightest position of their pattern.

    The position of the pattern is the shift at which its darkest slit is brightest. A wrong shift
    misses at least one slit, so equally spaced slits are not confused. The resolution is one
    pixel; within a uniformly lit spot the answer depends on noise.

    Parameters
    ----------
    alone : bool
        Whether to return NaN if other light is at least half as bright as the darkest pixel of the
        pattern (a second Sun, noise alone, a hot pixel). This check is ours; the published method
        always answers.

    Notes
    -----
    Implements: alg:PDsp, alg:PDmp (fe:peak, Enright2006b): ``n_peak = argmax_n I[n]``, and
    ``n_peak = argmax_n min_i I[n + d_i]`` with the offsets d_i of the slits, to whole pixels;
    ``tau = n_peak`` in pixels (Delta X = 1). Slits of one slant are one pattern; with two slants,
    whose patterns shift against each other, the two maxima with the largest sum count among those
    that a Sun in the field explains and that keep all spots apart. If several maxima within a
    slit's width are equal (a saturated spot), the answer is the middle between the first and the
    last.

    Failure: a NaN row for a profile without contrast (all dark or all saturated), one that holds a
    NaN or infinity, and behind two slants where no Sun in the field explains two patterns apart.
    Noise alone, a second Sun, a hot pixel, and a slit's spot that is missing, off the line or
    covered by another's give a place without notice, unless `alone` is asked for.

    Cost: 1 operation per pixel and slit, and the median of each line.

    Examples
    --------
    >>> from algorithms.examples import slit_profiles
    >>> profiles, design = slit_profiles(43.3, 36.8)
    >>> PeakDetection(**design).extract(profiles)
    array([[43., 37.]])
    """

    about: ClassVar = AboutExtractor(
        name="pd",
        taxonomy="PD",
        studies=("Enright2006b",),
        labels=("fe:peak", "alg:PDsp", "alg:PDmp"),
        origin="survey",
        needs=NEEDS,
        version=2,
        observation=Observation.PROFILES,
        kind=FeatureKind.SPOT,
    )

    alone: bool = False

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in profiles (N, A L); ValueError on wrong input."""
        lines = self.lines(observations)
        floors = dark_level(lines) if self.alone else lines.min(axis=1)
        return self.spots(self.locate(lines, floors, smooth=False, alone=self.alone))


@documented
@dataclass(frozen=True)
class FramePeak(Extractor):
    """Brightest pixel of a frame with one spot.

    The simplest feature and a baseline for the others. Within a uniformly lit spot the answer
    depends on noise, so its resolution is the width of the spot.

    Parameters
    ----------
    width_px : float or None
        Width of the widest spot: maxima further apart are two spots. None tells none apart.

    Notes
    -----
    Implements: alg:PDsp (fe:peak, Enright2006b) on both axes at once: ``(x_c, y_c) = argmax I(x,
    y)``. If several pixels share the maximum, the answer is the middle of the box around them,
    which is the centre of a saturated spot.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark (maximum not positive), without contrast (all dark
    or all saturated) or holds a NaN or infinity, and where equal maxima are further apart than
    `width_px`. A second spot that is darker, a hot pixel and noise alone cannot be recognised.

    Cost: 1 operation per pixel, and a second look at rows that hold the maximum.

    Examples
    --------
    >>> from algorithms.examples import spot_frame
    >>> frames = spot_frame(12.3, 9.8)
    >>> FramePeak().extract(frames)
    array([[12., 10.]])
    """

    about: ClassVar = AboutExtractor(
        name="pd-frame",
        taxonomy="PD",
        studies=("Enright2006b",),
        labels=("fe:peak", "alg:PDsp"),
        origin="survey",
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    width_px: float | None = None

    def __post_init__(self) -> None:
        if self.width_px is not None:
            require_positive(self.about.name, width_px=self.width_px)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method for this sensor's aperture.

        ValueError where the mask has many apertures or slits: their spots are not one.
        """
        require_one_spot(geometry, cls.about.name)
        known = (geometry.focal_length_mm, geometry.pixel_pitch_mm, geometry.half_fov_deg)
        if None in known or geometry.aperture_shape is None or geometry.aperture_width_mm is None:
            return cls()
        width, margin = spot_size_px(geometry, cls.about.name)
        return cls(width_px=width + 2.0 * margin)

    def extract(self, observations: ArrayLike) -> Floats:
        """Positions (N, 2) in frames (N, H, W); ValueError on wrong input."""
        from algorithms.kernels import moments, window_sums  # noqa: PLC0415 - Numba, at first use

        frames = as_frames(observations)
        maxima = np.empty(frames.shape[:2], dtype=frames.dtype)
        moments.row_maxima(frames, maxima)
        boxes = np.empty((len(frames), 4), dtype=np.int64)
        window_sums.boxes_of_maxima(frames, maxima, boxes)
        unusable = moments.unusable_frames(frames)
        found = (boxes[:, :2] + boxes[:, 2:]) / 2.0
        if self.width_px is not None:
            unusable |= ((boxes[:, 2:] - boxes[:, :2]) > self.width_px).any(axis=1)
        found[unusable | ~(maxima.max(axis=1) > 0)] = np.nan
        return found

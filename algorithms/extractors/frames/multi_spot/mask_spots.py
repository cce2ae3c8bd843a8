"""What methods that read the spots of a mask's pattern have in common."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import AboutExtractor, Floats, SensorGeometry
from algorithms.extractors.frames.multi_spot.aperture_design import design_pattern
from algorithms.extractors.frames.multi_spot.aperture_pattern import (
    Apertures,
    FieldPx,
    Levels,
    Pattern,
    find_pattern,
    frame_levels,
    lattice,
    nearest_distance,
)
from algorithms.extractors.frames.multi_spot.pattern_flags import without_covariance
from algorithms.extractors.frames.single_light import frames_to_measure
from algorithms.inputs import Frames, as_frames
from algorithms.measurement import Measurement
from algorithms.parameters import require_positive, require_within


@dataclass(frozen=True)
class MaskSpots:
    """Reads the spots that a mask of apertures casts, and finds which aperture cast which.

    Parameters
    ----------
    apertures_px : tuple of (x, y, width)
        Positions of the apertures of the mask, px from its middle; at least one.
    blur_px : float
        Width of the Sun's image behind a hole, px, not negative; it limits the size of a spot.
    threshold : float
        The fraction, in (0, 1), of the spots' brightness that makes a spot when the pattern is
        searched for.
    tolerance_px : float
        Largest distance of a spot from the position of its aperture, px; below a quarter of the
        smallest distance between apertures.
    faulty_lines : int
        Number of lines of apertures (columns or rows) that may be dark or doubled without a wrong
        answer, not negative. A displacement is accepted only if every other one leaves more lines
        unexplained. The survey's methods assume an intact mask (0).
    field_px : tuple of (x, y, reach) or None
        Where the pattern's middle is for a Sun on the boresight, and how far along an axis it is
        from there at the edge of the field of view, px, positive: a Sun beyond it counts as a
        faulty line. None for no such edge.

    Notes
    -----
    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers: the
    spot of an aperture over the detector's middle, seen or not.
    """

    about: ClassVar[AboutExtractor]

    apertures_px: Apertures = field(repr=False)
    blur_px: float = 0.0
    threshold: float = 0.3
    tolerance_px: float = 0.75
    faulty_lines: int = 0
    field_px: FieldPx | None = None

    def __post_init__(self) -> None:
        _require_pattern(self)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's mask.

        UnsuitableDesignError where its light is no spots.
        """
        return cls(**design_pattern(geometry, cls.about.name))

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Positions and flags of frames (N, H, W) or of one; no covariance is stated.

        AMBIGUOUS_PATTERN where another identity of the spots explains a frame nearly as well.
        Bad pixels are replaced by their neighbours.
        """
        frames = frames_to_measure(observations, bad, self.about.name)
        (found, *_), pattern = self._read(frames)
        return without_covariance(found, pattern)

    def spots(self, observations: ArrayLike) -> Floats:
        """Positions (N, A, 2) of each aperture's spot in frames (N, H, W), px.

        NaN where a spot is missing, cut or disagrees with the others, and for the whole of a frame
        in which the pattern is not found. ValueError on wrong input.
        """
        return self._read(as_frames(observations))[0][1]

    def _read(self, frames: Frames) -> tuple[tuple[Floats, ...], Pattern]:
        """Find positions (N, 2), what else `_locate` finds, and the pattern of frames."""
        levels = frame_levels(frames, self.apertures_px, self.threshold)
        pattern = self._find(frames, levels)
        return self._locate(frames, levels, pattern), pattern

    def _locate(self, frames: Frames, levels: Levels, pattern: Pattern) -> tuple[Floats, ...]:
        """Positions (N, 2) of the pattern in frames, and what else the method finds."""
        raise NotImplementedError

    def _find(self, frames: NDArray[Any], levels: Levels, *, sequence: bool = False) -> Pattern:
        """Find the pattern in frames (N, H, W), which follow each other in a sequence."""
        limits = self.blur_px, self.tolerance_px, self.faulty_lines, self.field_px, sequence
        return find_pattern(frames, levels, self.apertures_px, limits)

    def _follow(
        self, frames: NDArray[Any], follow: Callable[[NDArray[Any], Levels, Pattern], Floats]
    ) -> Floats:
        """Displacements (N, 2) of spots followed through a sequence, verified frame by frame.

        Parameters
        ----------
        frames
            (N, H, W) of `as_frames`, in the order of time.
        follow
            ``follow(frames, levels, pattern)`` follows the spots through some of the frames, of
            whose first alone it is given the pattern, and returns their displacements, NaN from
            where it lost them.

        Returns
        -------
        ndarray, shape (N, 2)
            NaN where no pattern was found. Where the pattern moves by a quarter of the least
            distance of two apertures or more, or what is followed is as far from it, the spots are
            taken anew from the pattern.
        """
        levels = frame_levels(frames, self.apertures_px, self.threshold)
        pattern = self._find(frames, levels, sequence=True)
        count = len(pattern.displacement)
        found = np.full((count, 2), np.nan)
        astray = lattice(self.apertures_px).nearest_px / 4.0
        known: NDArray[np.bool_] = np.isfinite(pattern.displacement[:, 0])
        start = 0
        while start < count:
            if not known[start]:
                start += 1
                continue
            end = start + 1
            while end < count and known[end]:
                step = pattern.displacement[end] - pattern.displacement[end - 1]
                if math.hypot(*step) >= astray:
                    break
                end += 1
            here = Pattern(
                pattern.displacement[start : start + 1],
                pattern.spots[start : start + 1],
                pattern.ambiguous[start : start + 1],
            )
            part = follow(frames[start:end], levels.part(start, end), here)
            away = np.hypot(*(part - pattern.displacement[start:end]).T)
            lost = np.flatnonzero(~(away < astray))
            done = int(lost[0]) if len(lost) else end - start
            found[start : start + done] = part[:done]
            start += max(done, 1)  # a frame in which the pattern is not followed is passed over
        return found


def _require_pattern(search: MaskSpots) -> None:
    """Raise ValueError naming the first parameter of a pattern that is out of range."""
    by, tolerance_px, field_px = search.about.name, search.tolerance_px, search.field_px
    rows = (
        np.array(search.apertures_px, dtype=np.float64) if search.apertures_px else np.empty((0, 3))
    )
    if rows.ndim != 2 or rows.shape[1] != 3 or len(rows) == 0 or not np.isfinite(rows).all():
        raise ValueError(f"{by}: apertures_px must be rows of finite x, y, width; got {rows.shape}")
    if not (rows[:, 2] > 0).all():
        raise ValueError(f"{by}: widths in apertures_px must be positive; got {rows[:, 2].min()}")
    if not (math.isfinite(search.blur_px) and search.blur_px >= 0):
        raise ValueError(f"{by}: blur_px must be finite and not negative; got {search.blur_px!r}")
    require_within(by, "(0, 1)", threshold=search.threshold)
    require_positive(by, tolerance_px=tolerance_px)
    if search.faulty_lines < 0:
        raise ValueError(f"{by}: faulty_lines must not be negative; got {search.faulty_lines!r}")
    if field_px is not None and not (
        len(field_px) == 3 and all(map(math.isfinite, field_px)) and field_px[2] > 0
    ):
        raise ValueError(
            f"{by}: field_px must be None or finite x, y and a positive reach; got {field_px!r}"
        )
    nearest = nearest_distance(rows)
    if not tolerance_px < nearest / 4.0:
        raise ValueError(
            f"{by}: tolerance_px must be below a quarter of the least distance of two apertures, "
            f"{nearest:.4g} px; got {tolerance_px!r}"
        )

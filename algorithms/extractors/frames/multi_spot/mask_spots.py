"""What methods that read the spots of a mask's pattern have in common."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Self

from numpy.typing import ArrayLike

from algorithms.contract import AboutExtractor, Floats, SensorGeometry
from algorithms.extractors.frames.multi_spot.aperture_design import design_pattern, require_pattern
from algorithms.extractors.frames.multi_spot.aperture_pattern import (
    Apertures,
    FieldPx,
    Levels,
    Pattern,
    find_pattern,
    frame_levels,
)
from algorithms.extractors.frames.multi_spot.pattern_flags import without_covariance
from algorithms.extractors.frames.single_light import frames_to_measure
from algorithms.inputs import Frames
from algorithms.measurement import Measurement


@dataclass(frozen=True)
class MaskSpots:
    """Reads the spots that a mask of apertures casts, having found which aperture cast which.

    Parameters
    ----------
    apertures_px : tuple of (x, y, width)
        The mask's apertures, px from its middle; one at least.
    blur_px : float
        Width of the Sun's image behind a hole, px, not negative: bounds the size of a spot.
    threshold : float
        The fraction, in (0, 1), of the spots' brightness that makes a spot when the pattern is
        searched for.
    tolerance_px : float
        Largest distance of a spot from its aperture's place, px; below a quarter of the least
        distance of two apertures.
    faulty_lines : int
        Lines of apertures (columns or rows) that may be dark or doubled at once without a wrong
        answer, not negative: a displacement is an answer where every other one leaves more of
        them unexplained. The survey's methods take the mask for whole, which is 0.
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
        require_pattern(self)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method with this sensor's mask.

        UnsuitableDesignError where its light is no spots.
        """
        return cls(**design_pattern(geometry, cls.about.name))

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Positions and doubts of frames (N, H, W) or of one; no covariance is stated.

        AMBIGUOUS_PATTERN where another identity of the spots explains a frame nearly as well.
        Bad pixels are replaced by their neighbours.
        """
        frames = frames_to_measure(observations, bad, self.about.name)
        (found, *_), pattern = self._read(frames)
        return without_covariance(found, pattern)

    def _read(self, frames: Frames) -> tuple[tuple[Floats, ...], Pattern]:
        """Find positions (N, 2), what else `_locate` finds, and the pattern of frames."""
        levels = frame_levels(frames, self.apertures_px, self.threshold)
        pattern = find_pattern(self, frames, levels)
        return self._locate(frames, levels, pattern), pattern

    def _locate(self, frames: Frames, levels: Levels, pattern: Pattern) -> tuple[Floats, ...]:
        """Positions (N, 2) of the pattern in frames, and what else the method finds."""
        raise NotImplementedError

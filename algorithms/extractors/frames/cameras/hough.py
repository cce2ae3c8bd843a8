"""Votes of edges for a shape: the blooming line of a CCD camera (BHT) and circles (CHT)."""

from __future__ import annotations

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
    UnsuitableDesignError,
)
from algorithms.documented import documented
from algorithms.inputs import as_frames
from algorithms.parameters import require_within

#: Step between the angles tried, degrees.
_TURN_DEG = 0.25
#: Columns of a line's row where x and y change places.
_TURNED = [1, 0, 3, 2, 4, 6, 5]


@documented
@dataclass(frozen=True)
class HoughLines(Extractor):
    """Blooming line of a saturated Sun, and the position on it from gradients of its halo.

    Charge above the full well of a CCD spills along the columns, forming a line through the Sun
    that is much longer than its image. A second line gives the position on it: here every pixel of
    the halo gives one, along its gradient; in `sun_from_blooming_lines` other cameras do.

    Parameters
    ----------
    saturated : float
        Fraction of the frame's range, in (0, 1), above which a pixel counts as full. Ours.
    tilt_deg : float
        Largest angle between line and columns that is tried, in steps of 0.25 deg, at most 90: all
        lines, as published. Zero tries the columns alone, along which charge runs unless the
        frames were turned since.
    least_votes : int
        The accumulator threshold tau, at least 2: rows that must vote for a line.
    reach_px : float
        Gradients count up to this far from the line. Ours.

    Notes
    -----
    Implements: alg:BHT (fe:ht, Liu2016): edges; ``r = x cos(theta) + y sin(theta)``; accumulator
    ``H[r, theta]``; peak above tau; intersections of all pairs of lines, averaged with weights.
    The middle between the edges of a row's full pixels votes for both of them, so that the line
    has one peak, not one a side. The peak is a parabola's, then the mean of the line's pixels:
    columns end where their overflow does, and their lengths weigh them; a half that the frame
    cuts is left out. One camera's lines are parallel; they are intersected with the lines along
    the gradients of the halo on both sides, voting along the blooming line, weighted by the
    inverse variance of each intersection. Coordinates are those of the detector, before any
    distortion correction (a window's origin is unknown here, and the correction of the
    intersection is the intersection of the corrected lines); models, and `sun_from_blooming_lines`,
    do the correction.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark or without contrast or holds a NaN or infinity,
    without a line of `least_votes` rows that is four times longer than wide (no blooming: a disc,
    noise), and where the line is found and the Sun on it not: other saturated light covers it
    (cloud), or the two sides' gradients meet the line in places 1 px apart. `lines` has the line
    then. Of two Suns the one with the longer line is found, undetected.

    Cost: 6 operations per pixel for the runs, 4 per run and angle (720 of them) and 1 per cell and
    angle, 80 per pixel within reach.

    Examples
    --------
    >>> import numpy as np
    >>> y, x = np.mgrid[:60, :44]
    >>> halo = 1500 / (1 + ((x - 21) ** 2 + (y - 30.3) ** 2) / 4) ** 1.5
    >>> halo[(abs(x - 21) <= 1) & (abs(y - 30) <= 20)] = 240
    >>> HoughLines().extract(np.minimum(halo, 240)[None]).round(1)
    array([[21. , 30.3]])
    """

    about: ClassVar = AboutExtractor(
        name="hough-lines",
        taxonomy="HT",
        studies=("Liu2016",),
        labels=("fe:ht", "alg:BHT"),
        origin="survey",
        version=2,
        needs=("lens_distortion",),
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    saturated: float = 0.8
    tilt_deg: float = 90.0
    least_votes: int = 20
    reach_px: float = 24.0

    def __post_init__(self) -> None:
        require_within(self.about.name, "(0, 1)", saturated=self.saturated)
        require_within(self.about.name, "[0, 90]", tilt_deg=self.tilt_deg)
        if self.least_votes < 2:
            raise ValueError(
                f"{self.about.name}: least_votes must be 2 or more; got {self.least_votes}"
            )
        require_within(self.about.name, "[1, 1e4]", reach_px=self.reach_px)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method for a camera; UnsuitableDesignError for designs without a lens.

        Behind a mask no pixel overflows. Which cameras bloom, the design does not say; with a CMOS
        detector no line is found. A detector's own frames need no other angle than that of its
        columns, along which charge runs: an angle that votes have to tell as well makes the place
        across the line a quarter to a half less certain.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        return cls(tilt_deg=0.0)

    def extract(self, observations: ArrayLike) -> Floats:
        """Places of the Sun (N, 2) in frames (N, H, W); ValueError on wrong input."""
        return self._found(observations)[:, 5:].copy()

    def lines(self, observations: ArrayLike) -> Floats:
        """Blooming lines (N, 5) of frames (N, H, W): ends ``x, y, x, y``, px, and votes.

        NaN rows without a line. ValueError on wrong input.
        """
        return self._found(observations)[:, :5].copy()

    def _found(self, observations: ArrayLike) -> Floats:
        from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at the first frame only

        frames = as_frames(observations)
        usable = ~moments.unusable_frames(frames)
        found = self._steep(frames, usable, 0.0, min(self.tilt_deg, 45.0))
        if self.tilt_deg > 45.0:
            turned = np.ascontiguousarray(frames.transpose(0, 2, 1))
            turned.flags.writeable = False
            flat = self._steep(turned, usable, 90.0 - self.tilt_deg, 45.0)[:, _TURNED]
            better = flat[:, 4] > np.nan_to_num(found[:, 4])
            found[better] = flat[better]
        return found

    def _steep(
        self, frames: NDArray[Any], usable: NDArray[np.bool_], least_deg: float, most_deg: float
    ) -> Floats:
        """Lines (N, 7) within these angles of the columns; of equal ones the least leaning."""
        from algorithms.extractors.frames.cameras import blooming_kernel  # noqa: PLC0415 - Numba, at the first frame only

        steps = np.arange(np.ceil(least_deg / _TURN_DEG), np.floor(most_deg / _TURN_DEG) + 1)
        turns = np.radians(_TURN_DEG * np.column_stack([steps, -steps]).ravel())
        found = np.empty((len(frames), 7))
        blooming_kernel.blooming_lines(
            frames, usable, turns, self.saturated, self.least_votes, self.reach_px, found
        )
        return found


@documented
@dataclass(frozen=True)
class HoughCircle(Extractor):
    """Circle of unknown radius that most edge pixels vote for.

    Every edge pixel votes for the centres that lie along its gradient, one for each radius. The
    centre of a circle collects the votes of its whole rim, even if parts of the rim are missing or
    the frame contains other light.

    Parameters
    ----------
    edge : float
        Gradients above this fraction of the frame's largest are edges, in (0, 1). Ours.
    threshold : float
        The accumulator threshold tau, in (0, 1]: the share of the rim, in 16 sectors, that must
        have edges.
    smallest_px : float
        Smallest radius, at least 1.
    largest_px : float or None
        Largest radius; None is half of the frame's smaller side. The survey uses radii up to the
        frame's diagonal; such circles do not fit into the frame.
    dark_first : bool
        Whether to search first for a dark circle, for cameras whose Sun may be black, and for a
        bright one only if there is none.
    sure : bool
        Whether nothing is found where another circle elsewhere has 0.8 of the best one's mean edge
        (two Suns), and no circle whose edges scatter by more than half a pixel about it. This
        check is ours; the published method always answers.

    Notes
    -----
    Implements: alg:CHT (fe:ht, Adatrao2016): edges, accumulator ``H[a, b, r]``, ``a = x - r
    cos(theta)``, ``b = y - r sin(theta)``, its maximum above tau. The angle is that of the edge's
    gradient, both ways, instead of all of them; votes count 1/r, so that circles of every size
    compare. The accumulator's highest cells are looked at again with their edges: the circle with
    the strongest mean edge around its rim wins, fitted to edges at sub-pixel places by least
    squares; where they do not fit one it stays at its cell. In our variant a bright circle must be
    bright inside its rim; otherwise it is a ghost.

    Shapes: frames (N, H, W), any unit, to ``(x_px, y_px)`` (N, 2), pixel centres at integers.

    Failure: a NaN row for a frame that is dark or without contrast or holds a NaN or infinity, and
    where no circle has enough of its rim (noise, lines, a spot more than half cut). Of two Suns
    the one with the stronger rim is found, undetected, unless `sure` is asked for. A bright round
    cloud can beat a white Sun, and blooming breaks its rim.

    Cost: 30 operations per pixel for edges, 4 an edge and radius, 500 an edge for the candidates.

    Examples
    --------
    >>> from algorithms.examples import disc_frame
    >>> frames = disc_frame(16.3, 14.8)
    >>> HoughCircle().extract(frames).round(1)
    array([[16.3, 14.8]])
    """

    about: ClassVar = AboutExtractor(
        name="hough-circle",
        taxonomy="HT",
        studies=("Adatrao2016",),
        labels=("fe:ht", "alg:CHT"),
        origin="survey",
        version=2,
        needs=("pixel_pitch_mm",),
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )

    edge: float = 0.3
    threshold: float = 0.5
    smallest_px: float = 2.0
    largest_px: float | None = None
    dark_first: bool = False
    sure: bool = False

    def __post_init__(self) -> None:
        require_within(self.about.name, "(0, 1)", edge=self.edge)
        require_within(self.about.name, "(0, 1]", threshold=self.threshold)
        if not 1.0 <= self.smallest_px < np.inf:
            raise ValueError(
                f"{self.about.name}: smallest_px must be 1 or more; got {self.smallest_px}"
            )
        if self.largest_px is not None and not self.smallest_px < self.largest_px <= 1e4:
            raise ValueError(
                f"{self.about.name}: largest_px must be None or in (smallest_px, 1e4]; "
                f"got {self.largest_px!r}"
            )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method for a camera or one round aperture; others raise UnsuitableDesignError.

        In a camera's frames edges are weak beside those of saturated pixels: a tenth counts.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        if geometry.lens_distortion is not None:
            return cls(edge=0.1, dark_first=True)
        for field in ("apertures", "slits", "code_bits"):
            if getattr(geometry, field) is not None:
                raise UnsuitableDesignError(
                    f"{cls.about.name} reads one circle; the sensor's design has {field}"
                )
        if geometry.aperture_shape != "round":
            raise UnsuitableDesignError(
                f"{cls.about.name} reads the circle of a round aperture or a camera's Sun; the "
                f"sensor's aperture_shape is {geometry.aperture_shape}"
            )
        return cls()

    def extract(self, observations: ArrayLike) -> Floats:
        """Centres (N, 2) in frames (N, H, W); ValueError on wrong input."""
        return self.circles(observations)[:, :2].copy()

    def circles(self, observations: ArrayLike) -> Floats:
        """Circles (N, 3), centre ``x, y`` and radius, px; NaN rows without one."""
        from algorithms.extractors.frames.cameras import circles_kernel  # noqa: PLC0415 - Numba, at the first frame only
        from algorithms.kernels import moments  # noqa: PLC0415 - as above

        frames = as_frames(observations)
        largest = self.largest_px or 0.5 * min(frames.shape[1:])
        found = np.empty((len(frames), 3))
        circles_kernel.best_circles(
            frames,
            ~moments.unusable_frames(frames),
            self.edge,
            self.smallest_px,
            largest,
            self.threshold,
            self.dark_first,
            self.sure,
            found,
        )
        return found

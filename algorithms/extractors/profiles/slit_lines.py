"""Lines of pixels behind slits: which light is which slit's, and what displacement it tells.

What the extractors of profiles share. A slit of slant rho has its spot at ``position + D_u + D_v
tan(rho)`` on its line, D the displacement of the mask's shadow: slits of one slant move together,
by one shift, and the shifts of all lines and slants together give D.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import ClassVar, Literal, Self, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    Floats,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.inputs import as_currents
from algorithms.measurement import Measurement, measurement_of
from algorithms.parameters import require_positive
from algorithms.row_arithmetic import medians

LineAxis = Literal["x", "y"]
Slit = tuple[float, float, float]

#: Half the angle the Sun is wide: what it blurs a shadow's edge by, rad.
_SUN_RAD = 0.00465
#: Displacements and margins allow for this much of tilt and of sampling.
_TILT_DEG = 1.5
_SAMPLING_PX = 1.5


#: What every extractor of profiles needs of a sensor's design.
NEEDS = (
    "focal_length_mm",
    "pixel_pitch_mm",
    "half_fov_deg",
    "line_axes",
    "line_pixels",
    "slits",
)


@dataclass(frozen=True)
class SlitLines:
    """Parameters of every extractor of profiles, and what they say of a profile.

    Parameters
    ----------
    line_axes : tuple of {"x", "y"}
        The detector axis along which each line lies, in the order of a profile's columns.
    line_pixels : int
        Pixels of a line, at least 1.
    slits : tuple of (float, float, float)
        Offset from the line's middle, px, tangent of the slant and width along the line, px, of
        each slit; all lines lie behind the same. At most two different slants.
    reach_px : float
        Largest displacement of the shadow on either axis, px, positive; used where slants differ.
    margin_px : float
        Widening of a spot beyond its slit on each side, px, positive.

    Notes
    -----
    Shapes: profiles (N, A L) of A lines, any unit, to ``(x_px, y_px)`` (N, 2), counted from the
    first pixel of a line whose middle is the sensor's.

    Failure: a NaN row for a profile without contrast (all dark or all saturated), one that holds
    a NaN or infinity, where a slit's spot is missing, cut by the line's end or covered by
    another's, and where light elsewhere is half as bright (a second Sun, noise alone).
    """

    about: ClassVar[AboutExtractor]

    line_axes: tuple[LineAxis, ...]
    line_pixels: int
    slits: tuple[Slit, ...]
    reach_px: float
    margin_px: float

    def __post_init__(self) -> None:
        if not self.line_axes or any(axis not in {"x", "y"} for axis in self.line_axes):
            raise ValueError(
                f"{self.about.name}: line_axes must be 'x' or 'y', one a line; got "
                f"{self.line_axes!r}"
            )
        if not self.slits:
            raise ValueError(f"{self.about.name}: slits must not be empty; got {self.slits!r}")
        require_positive(
            self.about.name,
            line_pixels=self.line_pixels,
            reach_px=self.reach_px,
            margin_px=self.margin_px,
            **{f"width of slit {i}": slit[2] for i, slit in enumerate(self.slits)},
        )
        if len(self.tangents) > 2:
            raise ValueError(
                f"{self.about.name} tells slits of at most two slants apart; got "
                f"{len(self.tangents)}"
            )
        if np.linalg.matrix_rank(self._design()) < 2:
            raise ValueError(
                f"{self.about.name} needs two coordinates: lines along x and y, or one line behind "
                f"slits of two slants; got {self.line_axes!r} and one slant"
            )

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the two output columns."""
        return ("x_px", "y_px")

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Features as `extract`, their covariance and flags; see `algorithms.measurement`."""
        extract = cast("Extractor", self).extract
        return measurement_of(extract, self.about.observation, self.about.name, observations, bad)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the method for this sensor's lines and slits.

        ValueError where a field of `needs` is None, or where the slits do not give both
        coordinates.
        """
        geometry.require(*cls.about.needs, by=cls.about.name)
        height, pitch, fov = (
            geometry.focal_length_mm,
            geometry.pixel_pitch_mm,
            geometry.half_fov_deg,
        )
        axes, pixels, slits = geometry.line_axes, geometry.line_pixels, geometry.slits
        if not (height and pitch and fov and axes and pixels and slits):
            raise UnsuitableDesignError(
                f"{cls.about.name} needs lines of pixels behind slits; got {geometry}"
            )
        drawn = tuple(
            (
                position / pitch,
                math.tan(math.radians(slant)),
                width / pitch / math.cos(math.radians(slant)),
            )
            for position, slant, width in slits
        )
        steepest = max(abs(slit[1]) for slit in drawn)
        margin = edge_margin_px(height / pitch, fov, steepest)
        return cls(axes, pixels, drawn, height / pitch * _edge_tangent(fov), margin)

    @property
    def tangents(self) -> tuple[float, ...]:
        """Tangents of the different slants: one shift each."""
        return tuple(dict.fromkeys(slit[1] for slit in self.slits))

    @property
    def groups(self) -> NDArray[np.int64]:
        """Which of `tangents` each slit (S,) has."""
        return np.array([self.tangents.index(slit[1]) for slit in self.slits], dtype=np.int64)

    @property
    def middle_px(self) -> float:
        """The line's middle, from which both coordinates are counted."""
        return (self.line_pixels - 1) / 2.0

    @property
    def half_px(self) -> int:
        """Half width of a spot's window, px: wide enough for its light, not for the next one's."""
        wide = max(slit[2] for slit in self.slits) / 2.0 + self.margin_px
        gaps = [
            abs(one[0] - other[0])
            for one, other in itertools.combinations(self.slits, 2)
            if one[1] == other[1]
        ]
        return max(min([math.ceil(wide), *(math.floor(gap / 2.0) for gap in gaps)]), 1)

    def lines(self, observations: ArrayLike) -> Floats:
        """Lines (N A, L) of profiles (N, A L); a line is zero where its profile is not finite."""
        count = len(self.line_axes)
        profiles = as_currents(observations, count * self.line_pixels, self.about.name)
        profiles[~np.isfinite(profiles).all(axis=1)] = 0.0
        return profiles.reshape(-1, self.line_pixels)

    def pattern(self) -> Floats:
        """Positions (S,) of the slits' spots on the line at zero shift, px."""
        return self.middle_px + np.array([slit[0] for slit in self.slits])

    def locate(
        self, lines: Floats, floors: Floats, *, smooth: bool = True, alone: bool = True
    ) -> Floats:
        """Shifts (N A, G) to about a pixel: where the pattern's darkest spot is brightest.

        Parameters
        ----------
        lines, floors : ndarray, shapes (N A, L) and (N A,)
            Light, and what is dark: a pattern is above it.
        smooth : bool
            Whether a spot's brightness is the mean over its slit's width, or one pixel's.
        alone : bool
            Whether light elsewhere that is half as bright leaves the pattern unsure.

        Returns
        -------
        ndarray
            NaN where no pattern stands out: nothing lit, a spot missing or off the line, light
            elsewhere.
        """
        from algorithms.kernels import slit_patterns  # noqa: PLC0415 - Numba, at first use

        width = min(slit[2] for slit in self.slits)
        box = 2 * int((width - 1.0) // 2.0) + 1 if smooth and width >= 1.0 else 1
        places = np.rint(self.pattern()).astype(np.int64)
        shifts = np.empty((len(lines), len(self.tangents)))
        slit_patterns.match(
            box_means(lines, box),
            floors,
            places,
            self.groups,
            np.array(self.tangents),
            self.reach_px,
            2.0 * self.half_px,
            # Places and shift are whole pixels here: a spot may lie up to one beside its place. A
            # mean reaches as far out as its box; one pixel may be the brightest at a spot's end.
            self.half_px + 1 + (box // 2 if smooth else math.ceil(width / 2.0))
            if alone
            else self.line_pixels,
            math.ceil(max(slit[2] for slit in self.slits)),
            shifts,
        )
        # The search counts from whole pixels: take off what the spots lie beside them on average.
        for group in range(len(self.tangents)):
            mine = self.groups == group
            shifts[:, group] += np.mean((places - self.pattern())[mine])
        return shifts

    def windows(self, lines: Floats, shifts: Floats) -> tuple[Floats, NDArray[np.int64]]:
        """Light around each spot at shifts (N A, G), and the first pixel of each window.

        Returns
        -------
        values : ndarray, shape (N A, S, 2 half_px + 1)
            NaN where a shift is NaN or the window leaves the line.
        starts : ndarray, shape (N A, S)
        """
        with np.errstate(invalid="ignore"):
            firsts = np.rint(self.pattern() + shifts[:, self.groups]) - self.half_px
            inside = (firsts >= 0) & (firsts + 2 * self.half_px < self.line_pixels)
        starts = np.where(inside, firsts, 0.0).astype(np.int64)
        columns = starts[:, :, None] + np.arange(min(2 * self.half_px + 1, self.line_pixels))
        values = np.take_along_axis(lines[:, None, :], columns, axis=2)
        values[~inside] = np.nan
        return values, starts

    def group_means(self, shifts: Floats) -> Floats:
        """Shifts (N A, G) from those of each spot (N A, S): means over the spots of a slant."""
        means = np.empty((len(shifts), len(self.tangents)))
        for group in range(len(self.tangents)):
            total = np.zeros(len(shifts))
            members = np.flatnonzero(self.groups == group)
            for spot in members:
                total = total + shifts[:, spot]
            means[:, group] = total / len(members)
        return means

    def spots(self, shifts: Floats) -> Floats:
        """Spots (N, 2) of the displacement that explains all shifts (N A, G) best."""
        given = shifts.reshape(-1, len(self.line_axes) * len(self.tangents))
        solution = np.linalg.pinv(self._design())
        found = np.empty((len(given), 2))
        for axis in range(2):
            # Term by term, so that a profile gives the same bits alone and among many.
            total = np.full(len(given), self.middle_px)
            for weight, column in zip(solution[axis], given.T, strict=True):
                total = total + weight * column
            found[:, axis] = total
        found[~np.isfinite(found).all(axis=1)] = np.nan
        return found

    def _design(self) -> Floats:
        """Rows (A G, 2): what each shift is of the displacement (D_x, D_y)."""
        return np.array(
            [
                (1.0, tangent) if axis == "x" else (tangent, 1.0)
                for axis in self.line_axes
                for tangent in self.tangents
            ]
        )


def edge_margin_px(height_px: float, half_fov_deg: float, slant_tangent: float = 0.0) -> float:
    """Return what the Sun's width adds to a spot on each side at the field's edge, px.

    A shadow's edge is blurred by the Sun's width times ``d tan(theta) = sec^2 d theta``, most
    where both angles are largest; behind a slant the other axis' blur comes in. Pixels add theirs.
    """
    edge = _edge_tangent(half_fov_deg)
    blur = height_px * _SUN_RAD * (1.0 + 2.0 * edge**2) * math.hypot(1.0, slant_tangent)
    return blur + _SAMPLING_PX


def _edge_tangent(half_fov_deg: float) -> float:
    return math.tan(math.radians(min(half_fov_deg + _TILT_DEG, 89.0)))


def dark_level(lines: Floats) -> Floats:
    """Median of each line (R,): dark while light covers less than half of it."""
    return medians(lines)


def box_means(lines: Floats, width: int) -> Floats:
    """Means over `width` (odd) pixels about each; minus infinity where they leave the line."""
    if width == 1:
        return lines
    from algorithms.kernels import slit_patterns  # noqa: PLC0415 - Numba, at first use

    means = np.empty(lines.shape)
    slit_patterns.box_means(lines, width, means)
    return means

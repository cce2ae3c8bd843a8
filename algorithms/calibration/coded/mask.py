"""Coded masks: the part that is seen, each aperture's own place, and one direction of all spots."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Self, cast

import numpy as np
from numpy.typing import ArrayLike

from algorithms.angles import tangents_from_sun
from algorithms.calibration.calibrated import Columns
from algorithms.calibration.coded.places import offsets_of, turn_of
from algorithms.calibration.coded.reading import CodeReading, MaskDrawing
from algorithms.calibration.forward import TURNS, ForwardModel
from algorithms.calibration.parametric import FreeParameter
from algorithms.contract import (
    FeatureKind,
    Floats,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
)
from algorithms.inputs import as_features
from algorithms.parameters import require_positive, require_within
from algorithms.spot_lists import SPOT_COLUMNS, detector_size_px, list_length

if TYPE_CHECKING:
    from algorithms.calibration.coded.evidence_kernel import Noise

NEEDS = (
    "focal_length_mm",
    "pixel_pitch_mm",
    "centre_px",
    "apertures",
)
"""Fields of the sensor's design that models of coded masks read."""

Apertures = tuple[tuple[float, float, float], ...]
Layers = tuple[tuple[float, float], ...]
Search = Callable[..., None]

#: Angular diameter of the Sun, rad.
_SOLAR_DIAMETER = 0.0093
#: Spacings are looked up as far as this times the largest distance to a nearest neighbour.
_REACH = 1.5
#: Power of its width that a hole's light goes with, above a fraction of its own peak: 2 for
#: shadows, more where diffraction gathers light, as behind holes near the Fresnel number of 1.
_LIGHT_POWER = 2.5
#: Widths of neighbours that differ by less, or less often, are no code.
_ONE_SIZE, _OFTEN = 0.1, 0.2
#: How far a spot reaches beyond its aperture, px, beside the Sun's image.
_RIM_PX = 2.0
#: Spots beyond so many times the median distance from the median disagree: 5 deviations.
_WORST = 4.2
#: How far a sensor may be tilted and off its design: the field of view ends as much later.
_ASTRAY_DEG = 2.0
#: Turns of a mask that a calibration looks for where the drawing's is not it, degrees.
_TURNS = tuple(sign * step / 4.0 for step in range(1, 13) for sign in (1, -1))
#: A design's tolerance is so many standard deviations of a spot; it is known as well as from so
#: many degrees of freedom. One list in so many is of a noise that the design does not tell: of a
#: wider deviation, known as from few.
_DEVIATIONS, _FREEDOM = 5.0, 30.0
_WIDE_DEVIATIONS, _WIDE_FREEDOM, _NOISY = 2.0, 4.0, 1e4
#: Spots of noisy lists may lie so many tolerances off.
_WIDEST = 4.0
#: One spot in so many is stray light. One aperture in so many is closed or not seen: of whole masks
#: and of broken ones, which are such a share.
_STRAY, _CLOSED, _BROKEN = 100.0, (100.0, 5.0), 0.1
#: Deviation of the logarithm of a width that dirt or a neighbour changes, and share of such.
_ODD = (0.35, 0.1)
#: Share of the calibration samples whose code must be read.
_ENOUGH = 0.5
#: Rounds of reading the code and placing the apertures.
_ROUNDS = 3


@dataclass
class CodedMask(ForwardModel):
    """What the models of coded masks share: a subclass writes `about` and `search`.

    Parameters
    ----------
    apertures_px : tuple of (x, y, width)
        Positions of the apertures of the mask, px from its middle; at least four.
    spots : int
        Number of spots per list, at least 3.
    focal_length_mm, pixel_pitch_mm : float
        Nominal distance from mask to detector, and distance between pixels; positive.
    centre_px : tuple of two float
        Point where the boresight meets the detector.
    size_px : tuple of two float
        Width and height of the detector, positive.
    layers : tuple of (thickness mm, index)
        Cover glass, as `algorithms.compensations.optics.refraction` has it.
    tolerance_px : float
        Largest distance of a spot from its aperture's place along an axis, positive; below half of
        what tells two spacings of the code apart.
    size_tolerance : float or None
        Largest relative error of an aperture's width estimated from the light of its spot,
        positive; None if sizes are not part of the code.
    half_fov_deg : float or None
        Edge of the field of view, in (0, 90); directions more than 2 degrees beyond it along an
        axis give NaN. None for no such edge.
    agreeing : int
        Number of spots that must agree on a position, at least 3.
    odds : float
        Required ratio of the likelihood of the best position to that of any other, at least 1. If
        spots are displaced by as much as the steps of the code, no position reaches it.
    share : float
        Share of the spots, and of the apertures in view, that must agree, in (0, 1].

    Attributes
    ----------
    turn_ : float
        Turn of the mask against the detector, degrees.
    offsets_ : ndarray, shape (A, 2)
        Offsets of the apertures from their turned places, px; 0 for those never seen.
    vector_ : ndarray, shape (6,)
        Focal length in mm, rotation and tilts about x and y in degrees, centre (x, y) in px.
    hull_ : Hull
        Cone of the calibrated directions.

    Notes
    -----
    Shapes: lists ``(x_px, y_px, light)`` of spots (N, 3 K), light 0 and last for none, to unit
    vectors (N, 3). Rows are independent: each frame is identified alone.
    """

    apertures_px: Apertures = field(repr=False)
    spots: int
    focal_length_mm: float
    pixel_pitch_mm: float
    centre_px: tuple[float, float]
    size_px: tuple[float, float]
    layers: Layers = ()
    tolerance_px: float = 0.5
    size_tolerance: float | None = None
    half_fov_deg: float | None = None
    agreeing: int = 3
    odds: float = 1e4
    share: float = 0.5

    turn_: float = field(init=False, repr=False, compare=False)
    offsets_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        by, rows = self.about.name, np.array(self.apertures_px, dtype=np.float64)
        if rows.ndim != 2 or rows.shape[1] != 3 or len(rows) < 4 or not np.isfinite(rows).all():
            raise ValueError(
                f"{by}: apertures_px must be four or more rows of finite x, y, width; "
                f"got {rows.shape}"
            )
        require_positive(
            by,
            focal_length_mm=self.focal_length_mm,
            pixel_pitch_mm=self.pixel_pitch_mm,
            narrowest_aperture_px=float(rows[:, 2].min()),
            width_px=self.size_px[0],
            height_px=self.size_px[1],
            tolerance_px=self.tolerance_px,
        )
        for name in ("spots", "agreeing"):
            if getattr(self, name) < 3:
                raise ValueError(f"{by}: {name} must be 3 or more; got {getattr(self, name)!r}")
        if self.half_fov_deg is not None and not 0.0 < self.half_fov_deg < 90.0:
            raise ValueError(f"{by}: half_fov_deg must be in (0, 90); got {self.half_fov_deg!r}")
        require_within(by, "(0, 1]", share=self.share)
        if not 1.0 <= self.odds < math.inf:
            raise ValueError(f"{by}: odds must be finite and at least 1; got {self.odds!r}")
        if self.size_tolerance is not None:
            require_positive(by, size_tolerance=self.size_tolerance)
        for layer in self.layers:
            if not (np.shape(layer) == (2,) and layer[0] > 0 and layer[1] >= 1):
                raise ValueError(
                    f"{by}: layers must be positive thicknesses with indices of at least 1; "
                    f"got {layer!r}"
                )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the unfitted model of the sensor's mask.

        UnsuitableDesignError where the detector shows all of the mask at once.
        """
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        focal, pitch = geometry.focal_length_mm, geometry.pixel_pitch_mm
        if not (focal and pitch and geometry.apertures and geometry.centre_px):
            raise UnsuitableDesignError(f"{cls.about.name} needs {', '.join(NEEDS)}")
        rows = np.round(np.array(geometry.apertures) / pitch, 6)
        return cls(
            apertures_px=tuple(tuple(row) for row in rows.tolist()),
            spots=max(list_length(geometry, cls.about.name), 3),
            focal_length_mm=focal,
            pixel_pitch_mm=pitch,
            centre_px=geometry.centre_px,
            size_px=detector_size_px(geometry, cls.about.name),
            layers=geometry.cover_glass or (),
            size_tolerance=_size_tolerance(rows),
            half_fov_deg=geometry.half_fov_deg,
        )

    @abstractmethod
    def search(self) -> Search:
        """Return the kernel that looks for the place of fewest faults."""
        ...

    def columns(self) -> int:
        """Three a spot."""
        return SPOT_COLUMNS * self.spots

    def read(self, features: ArrayLike) -> CodeReading:
        """Read the code of lists of spots (N, 3 K), by the drawing before it is fitted."""
        found = as_features(features, self.columns(), self.about.name)
        return self._read(found, self._places())

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Read the codes, place every aperture that was seen, then fit the assembly."""
        by = self.about.name
        drawn = self._drawn.places
        self.turn_, self.offsets_ = 0.0, np.zeros_like(drawn)
        seen = self._first_reading(features)
        spots = features.reshape(len(features), -1, SPOT_COLUMNS)[:, :, :2]
        for _ in range(_ROUNDS):
            self.turn_ += turn_of(spots, seen.apertures, self._places())
            self.offsets_ = np.zeros_like(drawn)
            self.offsets_ = offsets_of(spots, seen.apertures, self._places())
            seen = self._read(features, self._places())
        known = np.isfinite(seen.displacement[:, 0])
        if not known.sum() >= _ENOUGH * len(features):
            raise UnusableDataError(
                f"{by}: the mask's code is read in {known.sum()} of {len(features)} samples; is "
                "it the mask that was drawn, and does it tell its parts apart?"
            )
        super().learn(seen.displacement[known], sun[known], context)

    def answer(self, features: Floats, context: Columns) -> Floats:
        """(N, 3) unit vectors of lists of spots (N, 3 K)."""
        return super().answer(self._read(features, self._places()).displacement, context)

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance of a tangent axis that the assembly's errors make, rad^2."""
        return super().variance(self._read(features, self._places()).displacement, context)

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing: where a fit starts."""
        focal, reach = self.focal_length_mm, self.focal_length_mm / self.pixel_pitch_mm
        x, y = self.centre_px
        return (
            FreeParameter("focal_length", "mm", focal, focal),
            *TURNS,
            FreeParameter("centre_x", "px", reach, x),
            FreeParameter("centre_y", "px", reach, y),
        )

    def starts(self, features: Floats, sun: Floats, context: Columns) -> Sequence[Sequence[float]]:
        """As drawn, turned as the displacements (n, 2) are against the Sun's."""
        del context
        x, y = (features - features.mean(axis=0)).T
        beta, alpha = (tangents_from_sun(sun)[:, ::-1] - tangents_from_sun(sun)[:, ::-1].mean(0)).T
        turn = math.degrees(math.atan2(x @ alpha - y @ beta, x @ beta + y @ alpha))
        return ((self.focal_length_mm, turn, 0.0, 0.0, *self.centre_px),)

    def drawing(self) -> tuple[float, tuple[float, float]]:
        """Tangent for one pixel, and where the boresight meets the detector."""
        return self.pixel_pitch_mm / self.focal_length_mm, self.centre_px

    def cast(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) displacement of the mask's light, px, behind its cover glass."""
        squares = tangents[:, 0] ** 2 + tangents[:, 1] ** 2
        way = np.full(len(tangents), vector[0])
        for thickness, index in self.layers:
            way += thickness * (1.0 / np.sqrt(index**2 + (index**2 - 1.0) * squares) - 1.0)
        return np.asarray(vector[4:6] + tangents * (way / self.pixel_pitch_mm)[:, None])

    def _first_reading(self, features: Floats) -> CodeReading:
        """Read the codes of a mask that may be turned by a few degrees."""
        best, most = self._read(features, self._places()), 0
        most = np.isfinite(best.displacement[:, 0]).sum()
        kept = self.turn_
        for turn in _TURNS:
            if most >= _ENOUGH * len(features):
                break
            self.turn_ = turn
            trial = self._read(features, self._places())
            number = np.isfinite(trial.displacement[:, 0]).sum()
            if number > most:
                best, most, kept = trial, number, turn
        self.turn_ = kept
        return best

    def _places(self) -> Floats:
        """Places (A, 2) of the apertures, px from the mask's middle along the detector's axes."""
        drawn = self._drawn.places
        if not hasattr(self, "offsets_"):
            return drawn
        c, s = math.cos(math.radians(self.turn_)), math.sin(math.radians(self.turn_))
        turned = np.column_stack(
            [c * drawn[:, 0] - s * drawn[:, 1], s * drawn[:, 0] + c * drawn[:, 1]]
        )
        return np.asarray(turned + self.offsets_)

    def _read(self, features: Floats, places: Floats) -> CodeReading:
        from algorithms.calibration.coded import (  # noqa: PLC0415 - Numba, at first use
            evidence_kernel,
            joint_kernel,
            table,
        )

        lists = np.array(features, dtype=np.float64, order="C").reshape(
            len(features), -1, SPOT_COLUMNS
        )
        lit = lists[:, :, 2] > 0
        if (lit[:, 1:] > lit[:, :-1]).any():
            raise ValueError(f"{self.about.name}: spots without light must come last in a list")
        lists[:, :, 2] = np.log(np.where(lit, lists[:, :, 2], 1.0)) / _LIGHT_POWER
        drawn = self._drawn
        size = math.inf if self.size_tolerance is None else self.size_tolerance
        code, order = table.code_of(places, drawn.widths, drawn.reach, drawn.tolerance, size)
        counts = lit.sum(axis=1)
        found = np.empty((len(lists), 3))
        faults, verdicts = np.empty((2, len(lists)), dtype=np.int64)
        partners = np.empty(lists.shape[:2], dtype=np.int64)
        self.search()(lists, counts, code, drawn.view, self.share, found, faults)
        code, order = table.code_of(places, drawn.widths, drawn.reach, drawn.widest, math.inf)
        width = 0.0 if self.size_tolerance is None else self.size_tolerance / _DEVIATIONS
        noise = cast(
            "Noise", (*drawn.noise[:8], math.log(self.odds), *drawn.noise[8:], width, *_ODD)
        )
        rules = (self.agreeing, self.share)
        evidence_kernel.decide(
            lists, counts, code, drawn.view, rules, noise, found, partners, verdicts
        )
        apertures = np.where(partners >= 0, order[partners], -1)
        displacement = found[:, :2].copy()
        joint_kernel.joint(lists, places, apertures, _WORST, self.agreeing, displacement)
        if self.half_fov_deg is not None:
            edge = math.tan(math.radians(min(self.half_fov_deg + _ASTRAY_DEG, 89.0)))
            off = np.abs(displacement - np.array(self.centre_px)).max(axis=1)
            beyond = off > edge * self.focal_length_mm / self.pixel_pitch_mm
            displacement[beyond], apertures[beyond] = np.nan, -1
        return CodeReading(displacement, apertures, verdicts == evidence_kernel.SEVERAL)

    @cached_property
    def _drawn(self) -> MaskDrawing:
        from algorithms.calibration.coded import table  # noqa: PLC0415 - Numba, at first use

        rows = np.array(self.apertures_px)
        least, most = table.neighbours_px(rows[:, :2])
        focal = self.focal_length_mm / self.pixel_pitch_mm
        rim, sun = rows[:, 2].max() / 2.0 + _RIM_PX, _SOLAR_DIAMETER * focal / 2.0
        tolerance = min(self.tolerance_px, least / 6.0)
        area = math.log(self.size_px[0] * self.size_px[1])
        return MaskDrawing(
            rows[:, :2],
            rows[:, 2].copy(),
            _REACH * most,
            tolerance,
            min(_WIDEST * tolerance, least / 6.0),
            np.array([*self.size_px, *self.centre_px, focal, rim, sun]),
            (
                _FREEDOM,
                (tolerance / _DEVIATIONS) ** 2,
                -math.log1p(-1.0 / _NOISY),
                _WIDE_FREEDOM,
                (tolerance / _WIDE_DEVIATIONS) ** 2,
                math.log(_NOISY),
                area + math.log(_STRAY),
                math.log(_CLOSED[1]),
                math.log(float(np.prod(np.ptp(rows[:, :2], axis=0) + self.size_px))),
                area,
                math.log(_CLOSED[0]),
                _BROKEN,
            ),
        )


def _size_tolerance(rows: Floats) -> float | None:
    """Half the least step of neighbours' widths; None where few have such steps."""
    from scipy.spatial import KDTree  # noqa: PLC0415 - SciPy, where a mask is made only

    nearest = np.asarray(KDTree(rows[:, :2]).query(rows[:, :2], k=2)[1])[:, 1]
    ratio = np.abs(np.log(rows[:, 2] / rows[nearest, 2]))
    steps = ratio[ratio > _ONE_SIZE]
    return round(float(steps.min()) / 2.0, 6) if len(steps) > _OFTEN * len(rows) else None

"""Reading code dials: Gray tracks for the cell, fine tracks for the phase, both for the place.

Which angles a place means, and how a built dial's phase errs, is learnt by the models.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypedDict

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import sun_from_tangents, tangents_from_sun
from algorithms.contract import AboutModel, FeatureKind, Floats, SensorGeometry, UnusableDataError
from algorithms.parameters import require_positive, require_within

FINE_TRACKS = 4

TOLERANCE = 1e-15
"""Relative change of cost, step and gradient at which a fit stops: machine precision."""

MAX_EVALUATIONS = 200

WORST_CONDITION = 1e8
"""Scaled condition number of the Jacobian past which the data do not settle the parameters."""

_COMPLEX_STEP = 1e-30

NEEDS = ("code_bits", "code_cell_mm", "fine_period_mm", "focal_length_mm", "line_axes")
"""Fields of the sensor's geometry that a code dial's models read."""

Axes = tuple[Literal["x", "y"], ...]
Predictor = Callable[[NDArray[np.complex128]], NDArray[np.complex128]]


class DialDesign(TypedDict):
    """The drawing's numbers that a code dial's models are made from."""

    bits: int
    cell_mm: float
    period_mm: float
    focal_length_mm: float
    axes: Axes


@dataclass(frozen=True)
class DialCode:
    """Two equal dials, one an axis: coarse Gray tracks, then the fine rows F1 to F4 (eq:fourier).

    Attributes
    ----------
    bits
        Coarse tracks, most significant bit first: `2^bits` cells of `cell_mm`, numbered in Gray
        code from the dial's negative end; the middle one's edge is the dial's zero.
    cell_mm, period_mm
        Length of a cell, and period of the fine rows, longer than a cell so that a cell tells
        the period.
    focal_length_mm
        From the slit to the dials.
    axes
        Along which axis each dial lies: "x" and "y" in the order of the features.
    smallest_contrast
        Amplitude of the fine rows over their mean, below which there is no phase, in [0, 1).
    """

    bits: int
    cell_mm: float
    period_mm: float
    focal_length_mm: float
    axes: Axes
    smallest_contrast: float

    def require(self, by: str) -> None:
        """Raise ValueError naming the first number that is out of its range."""
        require_positive(
            by,
            cell_mm=self.cell_mm,
            period_mm=self.period_mm,
            focal_length_mm=self.focal_length_mm,
        )
        require_within(by, "[1, 16]", bits=self.bits)
        if not self.cell_mm < self.period_mm:
            raise ValueError(
                f"{by}: cell_mm must be below period_mm, or a cell does not tell the period; "
                f"got {self.cell_mm!r} and {self.period_mm!r}"
            )
        if sorted(self.axes) != ["x", "y"]:
            raise ValueError(f"{by}: axes must be 'x' and 'y' in either order; got {self.axes!r}")
        require_within(by, "[0, 1)", smallest_contrast=self.smallest_contrast)

    @property
    def columns(self) -> int:
        """Number of features."""
        return 2 * (self.bits + FINE_TRACKS)

    def read(self, signals: Floats) -> tuple[Floats, Floats]:
        """Places on the dials over the focal length, and fine phases, for x and for y.

        A coarse track is open where it passes more than half of what an open one would; the fine
        rows' mean is that half. ``p = atan2(F4 - F2, F3 - F1)`` is free of offsets common to a
        pair.

        Parameters
        ----------
        signals : ndarray, shape (N, columns)

        Returns
        -------
        places, phases : ndarray, shape (N, 2)
            ``tan(alpha_s)`` by the drawing and p in radians, columns x (beta) and y (alpha); NaN
            where signals are NaN, the fine rows have no contrast, or cell and phase contradict
            each other.
        """
        tracks = signals.reshape(len(signals), 2, self.bits + FINE_TRACKS)
        if self.axes == ("y", "x"):
            tracks = tracks[:, ::-1]
        fine = tracks[..., self.bits :]
        half = (fine[..., 0] + fine[..., 1] + fine[..., 2] + fine[..., 3]) / 4.0
        cosine, sine = fine[..., 2] - fine[..., 0], fine[..., 3] - fine[..., 1]
        phase = np.arctan2(sine, cosine)
        # the amplitude is half of the difference's: F3 - F1 = 2 a_1 cos p
        readable = (half > 0) & (np.hypot(cosine, sine) >= 2.0 * self.smallest_contrast * half)

        opened = tracks[..., : self.bits] > half[..., None]
        number, last = np.zeros(half.shape), np.zeros(half.shape, dtype=np.bool_)
        for bit in range(self.bits):
            last = last ^ opened[..., bit]
            number = 2.0 * number + last
        rough = (number + 0.5 - 2.0 ** (self.bits - 1)) * self.cell_mm
        exact = phase / (2.0 * np.pi) * self.period_mm
        place = exact + self.period_mm * np.rint((rough - exact) / self.period_mm)
        # half a cell is what the cell leaves open; beyond half a period it would be the wrong one
        readable &= np.abs(rough - place) <= (self.cell_mm + self.period_mm) / 4.0
        return (
            np.where(readable, place / self.focal_length_mm, np.nan),
            np.where(readable, phase, np.nan),
        )

    def calibration(self, features: Floats, sun: Floats) -> tuple[Floats, Floats, Floats]:
        """Return places, phases (`read`) and Suns of the readable samples."""
        places, phases = self.read(features)
        readable = np.isfinite(places).all(axis=1)
        return places[readable], phases[readable], sun[readable]


def dial_code(geometry: SensorGeometry, kind: FeatureKind, about: AboutModel) -> DialDesign:
    """Return the design numbers of a dial's models; UnsuitableDesignError naming what is None."""
    about.require_kind(kind)
    geometry.require(*NEEDS, by=about.name)
    return DialDesign(
        bits=geometry.code_bits or 0,
        cell_mm=geometry.code_cell_mm or 0.0,
        period_mm=geometry.fine_period_mm or 0.0,
        focal_length_mm=geometry.focal_length_mm or 0.0,
        axes=geometry.line_axes or (),
    )


def fit_tangents(predictor: Predictor, start: Floats, sun: Floats, by: str) -> Floats:
    """Parameters that bring tangents closest to the Sun's, by least squares of the angles.

    Parameters
    ----------
    predictor
        From parameters to ``(tan(beta), tan(alpha))`` (N, 2), analytic in all of them: its
        derivatives are taken by complex steps, exact to rounding.
    start : ndarray, shape (P,)
    sun : ndarray, shape (N, 3)
        In front.

    Raises
    ------
    UnusableDataError
        Where the samples do not determine every parameter, or the fit does not converge.
    """
    from scipy.optimize import least_squares  # noqa: PLC0415 - SciPy, at the first fit only

    wanted = tangents_from_sun(sun)[:, ::-1]
    slope = 1.0 / (1.0 + wanted**2)  # of the angle on its tangent

    def residuals(parameters: Floats) -> Floats:
        return ((predictor(parameters.astype(np.complex128)).real - wanted) * slope).ravel()

    def jacobian(parameters: Floats) -> Floats:
        out = np.empty((wanted.size, len(parameters)))
        for k in range(len(parameters)):
            moved = parameters.astype(np.complex128)
            moved[k] += 1j * _COMPLEX_STEP
            out[:, k] = (predictor(moved).imag / _COMPLEX_STEP * slope).ravel()
        return out

    unsettled = f"{by}: the calibration samples do not settle the {len(start)} parameters; "
    if wanted.size < len(start):
        raise UnusableDataError(f"{unsettled}{len(wanted)} samples give {wanted.size} angles")
    solution = least_squares(
        residuals,
        start,
        jac=jacobian,
        method="lm",
        ftol=TOLERANCE,
        xtol=TOLERANCE,
        gtol=TOLERANCE,
        max_nfev=MAX_EVALUATIONS,
    )
    if not solution.success or not np.isfinite(solution.x).all():
        raise UnusableDataError(f"{by}: the fit did not converge ({solution.message})")
    slopes = jacobian(solution.x)
    lengths = np.linalg.norm(slopes, axis=0)
    values = np.linalg.svd(slopes / np.where(lengths > 0, lengths, 1.0), compute_uv=False)
    if not values[-1] * WORST_CONDITION > values[0]:
        raise UnusableDataError(f"{unsettled}they must spread over the field of view")
    return np.asarray(solution.x, dtype=np.float64)


def sun_from_fractions(numerators: Floats, denominators: Floats) -> Floats:
    """Sun unit vectors (N, 3) of fractions that give ``(tan(beta), tan(alpha))``.

    A NaN row where a denominator is not positive: the direction would lie behind the detector.

    Parameters
    ----------
    numerators : ndarray, shape (N, 2)
    denominators : ndarray, shape (N, 2) or (N, 1)
    """
    front = np.where(denominators > 0, denominators, np.nan)
    return sun_from_tangents((numerators / front)[:, ::-1])

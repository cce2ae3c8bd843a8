"""`AxisCurve`: the angle in one plane as a polynomial of the reading along it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.polynomial import chebyshev

from algorithms.calibration.blocks import folds_along
from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.calibration.hull import Hull
from algorithms.calibration.orders import choose_order, errors_of_orders
from algorithms.calibration.quality import Setting
from algorithms.contract import AboutModel, FeatureKind, Floats, UnusableDataError
from algorithms.models.non_physical.regression_axes import Target, in_degrees

#: Largest degree, and samples a term takes at least.
_MOST, _PER_TERM = 15, 3
#: Cosine of the angle between boresight and plane from which the boresight counts as inside.
_INSIDE = 1e-3
#: Angle up to which tangents are fitted.
_MOST_TANGENT_DEG = 85.0


@dataclass
class AxisCurve(CalibratedModel):
    """The angle of the light in the plane of a sweep, as a polynomial of the readings along it.

    Readings (N, 2) are projected onto the direction in which they follow the angle; a sensor of one
    reading has zeros in the second place. The degree is chosen by samples left out. Answers lie in
    the plane: what lies across it was not calibrated.

    Parameters
    ----------
    target : {"angle", "tangent"}
        Output of the polynomial: the angle in degrees, or its tangent, in which the response of a
        pinhole or slit is linear.

    Attributes
    ----------
    middle_, along_ : ndarray, shape (2,)
        Of the readings: what is subtracted, and the direction of the coordinate, one of its units
        being half the calibrated range.
    ends_ : ndarray, shape (2,)
        Smallest and largest coordinate that is answered.
    start_, across_ : ndarray, shape (3,)
        Direction of angle zero, the boresight where the plane holds it, and that of 90 deg.
    coefficients_, whitening_ : ndarray
        Chebyshev coefficients, degrees, and the inverse of the design's triangular factor.

    Notes
    -----
    Failure: a NaN row for a NaN reading or beyond the calibrated range. fit raises
    UnusableDataError where samples are too few or the reading does not follow the angle.
    """

    about: ClassVar = AboutModel(
        name="polynomial-one-axis",
        taxonomy="Polynomial",
        accepts=frozenset({FeatureKind.SPOT, FeatureKind.BALANCE}),
    )
    target: Target = "angle"

    frontal: ClassVar[bool] = False
    bounded: ClassVar[bool] = False
    fewest: ClassVar[int] = 8

    middle_: Floats = field(init=False, repr=False, compare=False)
    along_: Floats = field(init=False, repr=False, compare=False)
    ends_: Floats = field(init=False, repr=False, compare=False)
    start_: Floats = field(init=False, repr=False, compare=False)
    across_: Floats = field(init=False, repr=False, compare=False)
    coefficients_: Floats = field(init=False, repr=False, compare=False)
    whitening_: Floats = field(init=False, repr=False, compare=False)
    validated_deg_: float = field(init=False, repr=False, compare=False)

    def _region(self, features: Floats, sun: Floats) -> Hull:  # noqa: ARG002 - ends do it
        return Hull(np.empty((0, 3)))

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit the polynomial to samples (n, 2) of Suns (n, 3) in one plane."""
        del context
        self.start_, self.across_ = plane_of(sun)
        angle = angles_in(sun, self.start_, self.across_)
        centred = features - features.mean(axis=0)
        slope = centred.T @ (angle - angle.mean())
        if not np.linalg.norm(slope) > 0:
            raise UnusableDataError(
                f"{self.about.name}: the reading does not change with the angle"
            )
        coordinate = features @ (slope / np.linalg.norm(slope))
        low, high = float(coordinate.min()), float(coordinate.max())
        half = (high - low) / 2.0
        self.along_ = slope / np.linalg.norm(slope) / half
        self.middle_ = self.along_ * half * (low + high) / 2.0
        u = (features - self.middle_) @ self.along_
        # as far as halfway to where the next pose would be
        step = float(np.median(np.diff(np.unique(u.round(9)))))
        self.ends_ = np.array([-1.0, 1.0]) * (1.0 + step / 2.0)
        most = min(_MOST, len(u) // _PER_TERM - 1)
        design = _terms(u, most)
        places = np.unique(u.round(9))
        between = _terms((places[1:] + places[:-1]) / 2.0, most)
        wanted = angle if self.target == "angle" else np.tan(np.radians(angle))
        if self.target == "tangent" and not np.abs(angle).max() < _MOST_TANGENT_DEG:
            raise UnusableDataError(
                f"{self.about.name}: expected angles below {_MOST_TANGENT_DEG:g} deg; got "
                f"{np.abs(angle).max():.3g}"
            )
        errors = errors_of_orders(
            design, list(range(2, most + 2)), wanted[:, None], folds_along(u), between
        )
        choice = choose_order(errors, self.about.name)
        design = design[:, : choice.order + 2]
        self.coefficients_ = np.asarray(np.linalg.lstsq(design, wanted, rcond=None)[0])
        self.whitening_ = np.asarray(np.linalg.inv(np.linalg.qr(design, mode="r")))
        self.validated_deg_ = in_degrees(choice.rms, self.target)

    def settings(self) -> Mapping[str, Setting]:
        """Give the degree chosen."""
        return {"degree": len(self.coefficients_) - 1, "target": self.target}

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, 2)."""
        del context
        u = (features - self.middle_) @ self.along_
        value = chebyshev.chebval(u, self.coefficients_)
        angle = np.radians(value) if self.target == "angle" else np.arctan(value)
        angle[~((u >= self.ends_[0]) & (u <= self.ends_[1]))] = np.nan
        return np.asarray(
            np.cos(angle)[:, None] * self.start_ + np.sin(angle)[:, None] * self.across_
        )

    def deviation_deg(self, features: Floats, context: Columns | None = None) -> Floats:  # type: ignore[override]
        """1-sigma (N,) of the angle in the plane, degrees: of residuals and of coefficients."""
        u = (np.asarray(features, dtype=np.float64) - self.middle_) @ self.along_
        terms = _terms(u, len(self.coefficients_) - 1)
        share = ((terms @ self.whitening_) ** 2).sum(axis=1)
        found = self.validated_deg_**2 + share * self.quality_.residual_rms_deg**2
        known = np.isfinite(self.predict(features, context)[:, 0])
        return np.asarray(np.sqrt(np.where(known, found, np.nan)))


def _terms(u: Floats, degree: int) -> Floats:
    """``T_k(u)`` for k = 0..degree, (N, degree + 1)."""
    return np.asarray(chebyshev.chebvander(u, degree), dtype=np.float64)


def plane_of(sun: Floats) -> tuple[Floats, Floats]:
    """Return the directions of angle zero and of 90 deg in the plane of directions (N, 3).

    Zero is the boresight where the plane holds it, else the middle of the directions; angles grow
    towards +x, or towards +y in a plane without it.
    """
    normal = np.linalg.svd(sun, full_matrices=False)[2][2]
    start = np.array([0.0, 0.0, 1.0])
    if abs(normal[2]) > _INSIDE:
        start = sun.mean(axis=0)
    start = start - (start @ normal) * normal
    start /= np.linalg.norm(start)
    across = np.cross(normal, start)
    leading = across[np.argmax(np.abs(across) > 0.1)]
    return start, across if leading > 0 else -across


def angles_in(sun: Floats, start: Floats, across: Floats) -> Floats:
    """Return the angle (N,) of directions (N, 3) in a plane, degrees."""
    return np.asarray(np.degrees(np.arctan2(sun @ across, sun @ start)))

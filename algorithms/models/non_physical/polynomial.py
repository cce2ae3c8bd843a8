"""Polynomials of the Sun angles on the features: one an axis (1-D) or in both features (2-D)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from algorithms.contract import AboutModel, Floats, Model
from algorithms.inputs import (
    as_features,
    as_frontal_calibration,
    require_fitted,
    require_samples,
)
from algorithms.models.nominal_projection import POSITIONS
from algorithms.models.non_physical.regression_axes import (
    Target,
    feature_scaling,
    require_target,
    solve_regression,
    sun_from_target,
    target_from_sun,
)

MAX_DEGREE = 15
"""Past the 11th degree nothing is gained (Chang2006); past this, rounding and overfitting rule."""


@dataclass
class AxisPolynomial(Model):
    """Each Sun angle as a polynomial of the feature of its own axis.

    Compact and fast, it follows any smooth response of one axis, but not what the other axis does
    to it.

    Parameters
    ----------
    degree : int
        Degree n, 1 to 15; the study takes the sixth.
    target : {"angle", "tangent"}
        What the polynomial gives: the angle in degrees, as published, or its tangent.
    extrapolation : float
        How far past the calibrated range of a feature predictions may go, as a fraction of half
        that range, from 0 up. Further out a polynomial says nothing.

    Attributes
    ----------
    middle_, half_range_ : ndarray, shape (2,)
        The features' scaling ``u = (feature - middle) / half_range`` onto [-1, 1].
    coefficients_ : ndarray, shape (2, n + 1)
        Chebyshev coefficients in the scaled feature, rows ``alpha`` (on y) and ``beta`` (on x).

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: model:poly (You2011), in words there: ``alpha = sum_k a_k y^k``, ``beta = sum_k
    b_k x^k``, k = 0..n. The study sweeps one axis while the other is held; here each axis is
    fitted to all samples given. Fitted in Chebyshev polynomials, which span the same functions
    without their loss of digits.

    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, for one outside the calibrated range, or where an
    angle reaches 90 degrees. fit raises UnusableDataError below n + 1 different features an axis.

    Cost: 6 (n + 1) operations and 2 tangents a sample.

    References
    ----------
    You2011; survey model:poly.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> steps = np.arange(-30, 31, 5)
    >>> sun = sun_from_angles(np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2))
    >>> spots = 200.0 * sun[:, :2] / sun[:, 2:] + (100.0, 80.0)
    >>> model = AxisPolynomial(degree=5).fit(spots, sun)
    >>> angles_from_sun(model.predict([spots[0], [900.0, 80.0]])).round(1)
    array([[-30., -30.],
           [ nan,  nan]])
    """

    about: ClassVar = AboutModel(
        name="polynomial-1d",
        taxonomy="Polynomial",
        studies=("You2011",),
        labels=("model:poly",),
        origin="survey",
        accepts=POSITIONS,
    )

    degree: int = 6
    target: Target = "angle"
    extrapolation: float = 0.05

    middle_: Floats = field(init=False, repr=False, compare=False)
    half_range_: Floats = field(init=False, repr=False, compare=False)
    coefficients_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        _require_polynomial(self.about.name, self.degree, self.extrapolation)
        require_target(self.target, self.about.name)

    def fit(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """Fit one polynomial an axis."""
        found, vectors = as_frontal_calibration(features, sun, self.about.name)
        require_samples(
            len(found), self.degree + 1, self.about.name, f"degree {self.degree} on each axis"
        )
        middle, half = feature_scaling(found, self.about.name)
        scaled = (found - middle) / half
        wanted = target_from_sun(vectors, self.target)
        coefficients = np.empty((2, self.degree + 1))
        for axis, column in ((0, 1), (1, 0)):
            design = _axis_terms(scaled[:, column], self.degree)
            coefficients[axis] = solve_regression(design, wanted[:, axis], self.about.name)
        self.middle_, self.half_range_, self.coefficients_ = middle, half, coefficients
        return self

    def predict(self, features: ArrayLike) -> Floats:
        """Sun unit vectors (N, 3) of features (N, 2)."""
        require_fitted(self, "coefficients_")
        found = as_features(features, 2, self.about.name)
        scaled = _within((found - self.middle_) / self.half_range_, self.extrapolation)
        alpha, beta = self.coefficients_
        values = np.column_stack(
            [chebyshev.chebval(scaled[:, 1], alpha), chebyshev.chebval(scaled[:, 0], beta)]
        )
        return sun_from_target(values, self.target)


@dataclass
class SurfacePolynomial(Model):
    """Each Sun angle as a polynomial surface over both features.

    The cross terms take up what turns one axis into the other: in-plane rotation, tilt and
    distortion away from the axes.

    Parameters
    ----------
    degree : int
        Total degree n, 1 to 15; 5 (21 terms) is ours.
    target : {"angle", "tangent"}
        What the polynomial gives: the angle in degrees or its tangent.
    extrapolation : float
        How far past the calibrated range of a feature predictions may go, as a fraction of half
        that range, from 0 up. Further out a polynomial says nothing.

    Attributes
    ----------
    middle_, half_range_ : ndarray, shape (2,)
        The features' scaling ``u = (feature - middle) / half_range`` onto [-1, 1].
    coefficients_ : ndarray, shape (2, (n + 1)(n + 2) / 2)
        Coefficients of ``T_i(u_x) T_j(u_y)``, i + j <= n, j fastest, rows ``alpha`` and ``beta``.

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: model:poly (Chang2006), in words there: ``alpha = sum a_ij x^i y^j``, ``beta = sum
    b_ij x^i y^j``, i + j <= n. Fitted in products of Chebyshev polynomials, which span the same
    functions without their loss of digits.

    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, for one outside the calibrated range, or where an
    angle reaches 90 degrees. fit raises UnusableDataError below (n + 1)(n + 2) / 2 samples or where
    they lie so that they do not settle every term.

    Cost: 2.5 (n + 1)(n + 2) operations and 2 tangents a sample.

    References
    ----------
    Chang2006; survey model:poly.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> steps = np.arange(-20, 21, 5)
    >>> sun = sun_from_angles(np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2))
    >>> x, y = (200.0 * sun[:, :2] / sun[:, 2:]).T
    >>> turned = np.column_stack([x - 0.1 * y, y + 0.1 * x])
    >>> model = SurfacePolynomial(degree=5).fit(turned, sun)
    >>> angles_from_sun(model.predict([turned[0], [900.0, 80.0]])).round(2)
    array([[-20., -20.],
           [ nan,  nan]])
    """

    about: ClassVar = AboutModel(
        name="polynomial-2d",
        taxonomy="Polynomial",
        studies=("Chang2006",),
        labels=("model:poly",),
        origin="survey",
        accepts=POSITIONS,
    )

    degree: int = 5
    target: Target = "angle"
    extrapolation: float = 0.05

    middle_: Floats = field(init=False, repr=False, compare=False)
    half_range_: Floats = field(init=False, repr=False, compare=False)
    coefficients_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        _require_polynomial(self.about.name, self.degree, self.extrapolation)
        require_target(self.target, self.about.name)

    def fit(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """Fit both surfaces."""
        found, vectors = as_frontal_calibration(features, sun, self.about.name)
        terms = (self.degree + 1) * (self.degree + 2) // 2
        require_samples(len(found), terms, self.about.name, f"total degree {self.degree}")
        middle, half = feature_scaling(found, self.about.name)
        design = _surface_terms((found - middle) / half, self.degree)
        wanted = target_from_sun(vectors, self.target)
        coefficients = solve_regression(design, wanted, self.about.name).T.copy()
        self.middle_, self.half_range_, self.coefficients_ = middle, half, coefficients
        return self

    def predict(self, features: ArrayLike) -> Floats:
        """Sun unit vectors (N, 3) of features (N, 2)."""
        require_fitted(self, "coefficients_")
        found = as_features(features, 2, self.about.name)
        scaled = _within((found - self.middle_) / self.half_range_, self.extrapolation)
        terms = _surface_terms(scaled, self.degree)
        # Term by term: a matrix product rounds a sample differently in batches of another size.
        values = np.zeros((len(found), 2))
        for term in range(terms.shape[1]):
            values += terms[:, term : term + 1] * self.coefficients_[:, term]
        return sun_from_target(values, self.target)


def _axis_terms(scaled: Floats, degree: int) -> Floats:
    """``T_k(u)`` for k = 0..degree, (N, degree + 1)."""
    return np.asarray(chebyshev.chebvander(scaled, degree), dtype=np.float64)


def _surface_terms(scaled: Floats, degree: int) -> Floats:
    """``T_i(u_x) T_j(u_y)`` for i + j <= degree, (N, terms)."""
    x = _axis_terms(scaled[:, 0], degree)
    y = _axis_terms(scaled[:, 1], degree)
    return np.concatenate(
        [x[:, i : i + 1] * y[:, : degree + 1 - i] for i in range(degree + 1)], axis=1
    )


def _within(scaled: Floats, extrapolation: float) -> Floats:
    """Scaled features, NaN rows past the calibrated range and its margin."""
    inside = (np.abs(scaled) <= 1.0 + extrapolation).all(axis=1, keepdims=True)
    return np.where(inside, scaled, np.nan)


def _require_polynomial(by: str, degree: int, extrapolation: float) -> None:
    if not 1 <= degree <= MAX_DEGREE:
        raise ValueError(f"{by}: degree must be from 1 to {MAX_DEGREE}; got {degree!r}")
    if not (np.isfinite(extrapolation) and extrapolation >= 0):
        raise ValueError(f"{by}: extrapolation must be 0 or more; got {extrapolation!r}")

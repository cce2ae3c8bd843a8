"""Polynomials of the Sun angles on the features: one an axis (1-D) or in both features (2-D)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.polynomial import chebyshev

from algorithms.calibration.blocks import between_poses, folds
from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.calibration.orders import choose_order, errors_of_orders
from algorithms.calibration.quality import Setting
from algorithms.contract import AboutModel, Floats
from algorithms.documented import documented
from algorithms.inputs import require_samples
from algorithms.models.nominal_projection import POSITIONS
from algorithms.models.non_physical.axis_regression import AXES, fit_axes
from algorithms.models.non_physical.regression_axes import (
    Target,
    feature_scaling,
    in_degrees,
    solve_regression,
    sun_from_target,
    target_from_sun,
)
from algorithms.parameters import require_choice, require_order

MAX_DEGREE = 15
"""Past the 11th degree nothing is gained (Chang2006); past this, rounding and overfitting rule."""


@dataclass
class _Polynomial(CalibratedModel):
    """What polynomials of features have in common.

    Parameters
    ----------
    target : {"angle", "tangent"}
        Output of the polynomial: the angle in degrees, as published, or its tangent.
    """

    degree: int | None = None
    target: Target = "angle"

    middle_: Floats = field(init=False, repr=False, compare=False)
    half_range_: Floats = field(init=False, repr=False, compare=False)
    coefficients_: Floats = field(init=False, repr=False, compare=False)
    powers_: Floats = field(init=False, repr=False, compare=False)
    whitening_: Floats = field(init=False, repr=False, compare=False)
    validated_deg_: float | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        by, degree = self.about.name, self.degree
        require_order(by, MAX_DEGREE, degree=degree)
        require_choice(by, Target, target=self.target)


@documented
@dataclass
class AxisPolynomial(_Polynomial):
    """Each Sun angle as a polynomial of the feature of its own axis.

    The model is compact and fast. It follows any smooth response of one axis, but not coupling
    between axes.

    Parameters
    ----------
    degree : int, optional
        Degree n, 1 to 15; the study takes the sixth. None: chosen from the calibration samples
        by cross-validation.

    Attributes
    ----------
    coefficients_ : ndarray, shape (2, n + 1)
        Chebyshev coefficients in the scaled feature, rows ``alpha`` (on y) and ``beta`` (on x).
    powers_ : ndarray, shape (2, n + 1)
        The same as coefficients of powers, which are what is summed.
    whitening_ : ndarray, shape (2, n + 1, n + 1)
        Inverse of each design's triangular factor: rows of terms times it have the squared length
        that their value's variance is, for errors of size one.

    Notes
    -----
    Implements: model:poly (You2011), described in words: ``alpha = sum_k a_k y^k``, ``beta = sum_k
    b_k x^k``, k = 0..n. The study sweeps one axis while the other is held; here each axis is
    fitted to all samples given. Fitted in Chebyshev polynomials, which span the same functions
    without their loss of digits.

    Failure: a NaN row for a NaN feature row, outside the hull, or where an angle reaches 90
    degrees. fit raises UnusableDataError below n + 1 different features an axis, or where they lie
    on one line.

    Cost: 6 (n + 1) operations and 2 tangents per sample.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-30, 31, 5))
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

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit one polynomial an axis to samples (n, 2) of Suns (n, 3)."""
        del context
        by = self.about.name
        if self.degree is None:
            most = min(MAX_DEGREE, min(len(np.unique(column)) for column in features.T) - 1)
            require_samples(most, 1, by, "different features on each axis")
            sizes = list(range(2, most + 2))
        else:
            needed = self.degree + 1
            require_samples(len(features), needed, by, f"degree {self.degree} on each axis")
            sizes = [needed]
        fit = fit_axes(_axis_terms, sizes, features, sun, target=self.target, by=by)
        self.middle_, self.half_range_ = fit.middle, fit.half_range
        self.coefficients_, self.whitening_ = fit.coefficients, fit.whitening
        self.powers_ = np.stack([chebyshev.cheb2poly(row) for row in fit.coefficients])
        self.validated_deg_ = fit.validated_deg

    def settings(self) -> Mapping[str, Setting]:
        """Give the degree, chosen or given."""
        return {"degree": self.coefficients_.shape[1] - 1}

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, 2)."""
        from algorithms.models.non_physical.regression_kernel import axis_values  # noqa: PLC0415 - Numba

        del context
        values = np.empty((len(features), 2), order="F")
        for axis, column in AXES:
            scaled = (features[:, column] - self.middle_[column]) / self.half_range_[column]
            axis_values(scaled, self.powers_[axis], values[:, axis])
        return sun_from_target(values, self.target)

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance that the coefficients' errors make, rad^2."""
        del context
        scaled = (features - self.middle_) / self.half_range_
        degree = self.coefficients_.shape[1] - 1
        share = np.zeros(len(features))
        for axis, column in AXES:
            terms = _axis_terms(scaled[:, column], degree + 1)
            share += ((terms @ self.whitening_[axis]) ** 2).sum(axis=1)
        return np.asarray(share * np.radians(self.quality_.residual_rms_deg) ** 2 / 4.0)


@documented
@dataclass
class SurfacePolynomial(_Polynomial):
    """Each Sun angle as a polynomial surface over both features.

    The cross terms model coupling between axes: in-plane rotation, tilt and distortion away from
    the axes.

    Parameters
    ----------
    degree : int, optional
        Total degree n, 1 to 15. None: chosen from the calibration samples by cross-validation.

    Attributes
    ----------
    coefficients_ : ndarray, shape (2, (n + 1)(n + 2) / 2)
        Coefficients of ``T_i(u_x) T_j(u_y)``, i + j <= n, by total degree and then by j, rows
        ``alpha`` and ``beta``.
    powers_ : ndarray, shape (2, n + 1, n + 1)
        The same as coefficients of ``u_y^j u_x^k``, which are what is summed.
    whitening_ : ndarray, shape (terms, terms)
        Inverse of the design's triangular factor: rows of terms times it have the squared length
        that their value's variance is, for errors of size one.

    Notes
    -----
    Implements: model:poly (Chang2006), described in words: ``alpha = sum a_ij x^i y^j``, ``beta =
    sum b_ij x^i y^j``, i + j <= n. Fitted in products of Chebyshev polynomials, which span the
    same functions without their loss of digits.

    Failure: a NaN row for a NaN feature row, outside the hull, or where an angle reaches 90
    degrees. fit raises UnusableDataError below (n + 1)(n + 2) / 2 samples or where they lie so
    that they do not determine every term.

    Cost: 2.5 (n + 1)(n + 2) operations and 2 tangents per sample.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-20, 21, 5))
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

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit both surfaces to samples (n, 2) of Suns (n, 3)."""
        del context
        by = self.about.name
        middle, half = feature_scaling(features, by)
        scaled = (features - middle) / half
        wanted = target_from_sun(sun, self.target)
        degree, validated = self.degree, None
        if degree is None:
            require_samples(len(features), 4, by, "three terms and one sample left out")
            design = _surface_terms(scaled, MAX_DEGREE)
            sizes = [_terms(n) for n in range(1, MAX_DEGREE + 1) if _terms(n) < len(features)]
            between = _surface_terms((between_poses(sun, features) - middle) / half, MAX_DEGREE)
            errors = errors_of_orders(design, sizes, wanted, folds(sun), between)
            choice = choose_order(errors, by)
            degree, validated = choice.order + 1, in_degrees(choice.rms, self.target)
        require_samples(len(features), _terms(degree), by, f"total degree {degree}")
        design = _surface_terms(scaled, degree)
        self.coefficients_ = solve_regression(design, wanted, by).T.copy()
        self.powers_ = _as_powers(self.coefficients_, degree)
        self.whitening_ = np.asarray(np.linalg.inv(np.linalg.qr(design, mode="r")))
        self.middle_, self.half_range_, self.validated_deg_ = middle, half, validated

    def settings(self) -> Mapping[str, Setting]:
        """Give the total degree, chosen or given."""
        return {"degree": _degree(self.coefficients_.shape[1])}

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, 2)."""
        from algorithms.models.non_physical.regression_kernel import surface_values  # noqa: PLC0415 - Numba

        del context
        x, y = (
            (features[:, column] - self.middle_[column]) / self.half_range_[column]
            for column in (0, 1)
        )
        # Row by row: a matrix product rounds a sample differently in batches of another size.
        values = np.empty((2, len(features)))
        surface_values(x, y, self.powers_, values)
        return sun_from_target(values.T, self.target)

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance that the coefficients' errors make, rad^2."""
        del context
        scaled = (features - self.middle_) / self.half_range_
        terms = _surface_terms(scaled, _degree(self.coefficients_.shape[1]))
        share = ((terms @ self.whitening_) ** 2).sum(axis=1)
        return np.asarray(share * np.radians(self.quality_.residual_rms_deg) ** 2 / 2.0)


def _axis_terms(scaled: Floats, size: int) -> Floats:
    """``T_k(u)`` for k = 0..size - 1, (N, size)."""
    return np.asarray(chebyshev.chebvander(scaled, size - 1), dtype=np.float64)


def _axis_columns(scaled: Floats, degree: int) -> list[Floats]:
    """``T_k(u)`` for k = 0..degree, each (N,)."""
    columns = [np.ones_like(scaled), scaled]
    for _ in range(degree - 1):
        columns.append(2.0 * scaled * columns[-1] - columns[-2])
    return columns


def _powers(degree: int) -> list[tuple[int, int]]:
    """Degrees (i, j) of the terms ``T_i(u_x) T_j(u_y)``: every order's come before the next's."""
    return [(total - j, j) for total in range(degree + 1) for j in range(total + 1)]


def _terms(degree: int) -> int:
    return (degree + 1) * (degree + 2) // 2


def _degree(terms: int) -> int:
    return int(np.sqrt(2 * terms)) - 1


def _as_powers(coefficients: Floats, degree: int) -> Floats:
    """Coefficients (2, n + 1, n + 1) of ``u_y^j u_x^k`` from those (2, terms) of `_powers`."""
    monomials = _monomials(degree)
    products = np.zeros((2, degree + 1, degree + 1))
    for term, (i, j) in enumerate(_powers(degree)):
        products[:, j, i] = coefficients[:, term]
    return np.asarray(monomials @ products @ monomials.T)


@lru_cache(maxsize=16)
def _monomials(degree: int) -> Floats:
    """Coefficients (n + 1, n + 1) of powers, by rows, in each of Chebyshev's polynomials."""
    found = np.zeros((degree + 1, degree + 1))
    for k in range(degree + 1):
        powers = chebyshev.cheb2poly(np.eye(degree + 1)[k])
        found[: len(powers), k] = powers
    return found


def _surface_terms(scaled: Floats, degree: int) -> Floats:
    """``T_i(u_x) T_j(u_y)`` for i + j <= degree, (N, terms)."""
    x, y = (_axis_columns(column, degree) for column in scaled.T)
    return np.stack([x[i] * y[j] for i, j in _powers(degree)], axis=1)

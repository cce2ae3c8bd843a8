"""Sun angles as a line and a Fourier series of voltage balances (Fourier)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.calibration.quality import Setting
from algorithms.contract import AboutModel, FeatureKind, Floats
from algorithms.documented import documented
from algorithms.inputs import require_samples
from algorithms.models.non_physical.axis_regression import AXES, fit_axes
from algorithms.models.non_physical.regression_axes import (
    Target,
    sun_from_target,
)
from algorithms.parameters import require_choice, require_order

MAX_HARMONICS = 8
"""Past it, waves of twice the range's period are hardly distinguished from sums of each other."""

_FUNDAMENTAL = np.pi / 2.0
"""Of a feature scaled to [-1, 1]: half a wave over the calibrated range."""


@documented
@dataclass
class FourierBalance(CalibratedModel):
    """Each Sun angle as a linear function of its balance plus a Fourier series.

    The balance of a quadrant photodiode departs smoothly from a line, and periodically if the light
    is periodic (interference, gaps of a mask); sines and cosines describe both.

    Parameters
    ----------
    harmonics : int, optional
        Order N of the series, 1 to 8. None: chosen from the calibration samples by
        cross-validation.
    target : {"angle", "tangent"}
        Output of the series: the angle in degrees, as published, or its tangent.

    Attributes
    ----------
    middle_, half_range_ : ndarray, shape (2,)
        The balances' scaling ``u = (balance - middle) / half_range`` onto [-1, 1].
    coefficients_ : ndarray, shape (2, 2 + 2 N)
        Of 1, u, and then ``cos(n pi u / 2), sin(n pi u / 2)`` for n = 1..N, rows ``alpha`` (on
        s_b) and ``beta`` (on s_a).
    whitening_ : ndarray, shape (2, 2 + 2 N, 2 + 2 N)
        Inverse of each design's triangular factor: rows of terms times it have the squared length
        that their value's variance is, for errors of size one.

    Notes
    -----
    Implements: model:fourier (Pentke2022), described in words: ``alpha = a_0 + a_1 u + sum_n A_n
    cos(n w u) + B_n sin(n w u)``, ``beta`` alike. The line is ours, and so is the period of twice
    the calibrated range: a series of the range's own period must come back at one end to where it
    began at the other, which an angle does not, nor its error.

    Shapes: balances ``(s_a, s_b)`` (N, 2) to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, outside the hull, or where an angle reaches 90
    degrees. fit raises UnusableDataError below 2 + 2 N different balances an axis, or where the
    samples do not determine every term.

    Cost: 4 tangents, 4 divisions and 14 N operations per sample.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-30, 31, 3))
    >>> tangents = sun[:, :2] / sun[:, 2:]
    >>> balances = tangents + 0.01 * np.sin(12 * tangents)
    >>> model = FourierBalance(harmonics=6).fit(balances, sun)
    >>> angles_from_sun(model.predict([balances[0], [0.9, 0.0]])).round(1)
    array([[-30., -30.],
           [ nan,  nan]])
    """

    about: ClassVar = AboutModel(
        name="fourier-balance",
        taxonomy="Fourier",
        studies=("Pentke2022",),
        labels=("model:fourier",),
        origin="survey",
        accepts=frozenset({FeatureKind.BALANCE}),
    )

    harmonics: int | None = None
    target: Target = "angle"

    middle_: Floats = field(init=False, repr=False, compare=False)
    half_range_: Floats = field(init=False, repr=False, compare=False)
    coefficients_: Floats = field(init=False, repr=False, compare=False)
    whitening_: Floats = field(init=False, repr=False, compare=False)
    validated_deg_: float | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_order(self.about.name, MAX_HARMONICS, harmonics=self.harmonics)
        require_choice(self.about.name, Target, target=self.target)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit one series an axis to samples (n, 2) of Suns (n, 3)."""
        del context
        by = self.about.name
        different = min(len(np.unique(column)) for column in features.T)
        fewest = self.harmonics or 1
        require_samples(different, 2 + 2 * fewest, by, f"a line and {fewest} harmonics an axis")
        most = self.harmonics or min(MAX_HARMONICS, (different - 2) // 2)
        sizes = [2 + 2 * n for n in range(fewest, most + 1)]
        fit = fit_axes(_terms, sizes, features, sun, target=self.target, by=by)
        self.middle_, self.half_range_ = fit.middle, fit.half_range
        self.coefficients_, self.whitening_ = fit.coefficients, fit.whitening
        self.validated_deg_ = fit.validated_deg

    def settings(self) -> Mapping[str, Setting]:
        """Give the order, chosen or given."""
        return {"harmonics": self.coefficients_.shape[1] // 2 - 1}

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of balances (N, 2)."""
        from algorithms.models.non_physical.regression_kernel import series_values  # noqa: PLC0415 - Numba

        del context
        values = np.empty((len(features), 2), order="F")
        for axis, column in AXES:
            scaled = (features[:, column] - self.middle_[column]) / self.half_range_[column]
            half = np.tan(scaled * (_FUNDAMENTAL / 2.0))  # NumPy's tangents are its fastest
            series_values(scaled, half, self.coefficients_[axis], values[:, axis])
        return sun_from_target(values, self.target)

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance that the coefficients' errors make, rad^2."""
        del context
        share = np.zeros(len(features))
        for axis, column in AXES:
            scaled = (features[:, column] - self.middle_[column]) / self.half_range_[column]
            terms = _terms(scaled, self.coefficients_.shape[1])
            share += ((terms @ self.whitening_[axis]) ** 2).sum(axis=1)
        return np.asarray(share * np.radians(self.quality_.residual_rms_deg) ** 2 / 4.0)


def _terms(scaled: Floats, size: int) -> Floats:
    """``1, u, cos(w u), sin(w u), cos(2 w u), ...`` (n, size) of a scaled balance u (n,)."""
    columns = [np.ones_like(scaled), scaled]
    for n in range(1, size // 2):
        turn = n * _FUNDAMENTAL * scaled
        columns += [np.cos(turn), np.sin(turn)]
    return np.stack(columns, axis=1)

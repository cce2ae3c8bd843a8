"""Look-up table of row polynomials of the error of the nominal projection (LUT)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import chebyshev

from algorithms.angles import angles_from_sun
from algorithms.calibration.blocks import best_candidate, folds, splits
from algorithms.calibration.calibrated import Columns
from algorithms.calibration.conditioning import WORST_CONDITION
from algorithms.calibration.hull import median_spacing
from algorithms.calibration.projection import ProjectionModel
from algorithms.calibration.quality import Setting
from algorithms.contract import (
    AboutModel,
    Floats,
    UnusableDataError,
)
from algorithms.documented import documented
from algorithms.inputs import require_samples
from algorithms.models.lut.error_tables import (
    MAX_NODES,
    SMOOTHINGS,
    GridAxis,
    errors_left_out,
    interpolation_matrix,
    require_size,
    row_products,
    row_roughness,
    solve_table,
)
from algorithms.models.nominal_projection import (
    POSITIONS,
)
from algorithms.models.non_physical.regression_axes import sun_from_target
from algorithms.parameters import require_order, require_positive

MAX_DEGREE = 15

DEGREES = (2, 4, 6, 8, 12)
"""Of each row, tried where none is given; the study's is the last."""


@documented
@dataclass
class BlendedPolynomials(ProjectionModel):
    """Nominal angles corrected by polynomials of one angle, interpolated along the other angle.

    A table of polynomial coefficients is much smaller than one of nodes; interpolation between
    neighbouring polynomials keeps the correction smooth.

    Parameters
    ----------
    interval_deg : float
        Distance in alpha between rows, positive; the study's is 1.
    degree : int, optional
        Degree n of each row's polynomial in beta, 1 to 15; the study's is 8. None: chosen from the
        calibration samples by cross-validation, with the smoothing.
    smoothing : float, optional
        Weight of the squared second differences of coefficients from row to row against one
        sample's squared error, positive; 1e-3 only fills rows no sample determines. None: chosen.

    Attributes
    ----------
    alpha_axis_ : GridAxis
        The rows' nominal alpha in degrees.
    beta_middle_deg_, beta_half_range_deg_ : float
        Scaling of the nominal beta onto [-1, 1].
    coefficients_deg_ : ndarray, shape (A, n + 1, 2)
        Chebyshev coefficients of the errors of alpha and beta, row by row.
    smoothing_ : float
        Given or chosen.

    Notes
    -----
    Implements: model:lut (He2013), described in words: for nominal angles (eq:stdproj) between
    rows k and k + 1, ``e = (1 - w) P_k(beta) + w P_{k+1}(beta)`` with w the fraction of the
    interval. All rows are fitted at once to samples anywhere, in Chebyshev polynomials, which span
    the same functions without the loss of digits.

    Failure: a NaN row for a NaN feature row, outside the hull, or where an angle reaches 90
    degrees. fit raises UnusableDataError below 2 (n + 1) samples, where they do not determine a
    polynomial on two rows, where they settle the rows so badly that rounding would show, or past
    250,000 coefficients.

    Cost: 12 (n + 1) operations per sample, and 2 per facet of the hull; the fit solves one sparse
    system in A (n + 1) unknowns.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-10, 11, 2))
    >>> bent = 200.0 * (sun[:, :2] / sun[:, 2:]) ** 3  # what the drawing does not know
    >>> spots = 200.0 * sun[:, :2] / sun[:, 2:] + bent
    >>> model = BlendedPolynomials(focal_length_mm=2.0, unit_mm=0.01, interval_deg=5.0, degree=4)
    >>> angles_from_sun(model.fit(spots, sun).predict([spots[0], [900.0, 0.0]])).round(2)
    array([[-10., -10.],
           [ nan,  nan]])
    """

    about: ClassVar = AboutModel(
        name="lut-polynomial",
        taxonomy="LUT",
        studies=("He2013",),
        labels=("model:lut", "eq:stdproj"),
        origin="survey",
        needs=("focal_length_mm",),
        accepts=POSITIONS,
    )

    interval_deg: float = 1.0
    degree: int | None = None
    smoothing: float | None = None

    fewest: ClassVar[int] = 4

    alpha_axis_: GridAxis = field(init=False, repr=False, compare=False)
    beta_middle_deg_: float = field(init=False, repr=False, compare=False)
    beta_half_range_deg_: float = field(init=False, repr=False, compare=False)
    coefficients_deg_: Floats = field(init=False, repr=False, compare=False)
    smoothing_: float = field(init=False, repr=False, compare=False)
    validated_deg_: float | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        smoothing = 1.0 if self.smoothing is None else self.smoothing
        require_positive(self.about.name, interval_deg=self.interval_deg, smoothing=smoothing)
        require_order(self.about.name, MAX_DEGREE, degree=self.degree)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Solve for all rows' coefficients."""
        del context
        nominal = self.nominal_deg(features)
        errors = angles_from_sun(sun) - nominal
        degree, smoothing, self.validated_deg_ = self.degree, self.smoothing, None
        if degree is None or smoothing is None:
            (degree, smoothing), self.validated_deg_ = self._chosen(nominal, errors, sun)
        self.smoothing_ = smoothing
        self.solve(nominal, errors, degree, smoothing)

    def settings(self) -> Mapping[str, Setting]:
        """Give degree and smoothing, chosen or given."""
        return {"degree": self.coefficients_deg_.shape[1] - 1, "smoothing": self.smoothing_}

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, 2)."""
        from algorithms.models.lut.table_kernel import corrected_along_rows  # noqa: PLC0415 - Numba

        del context
        angles = np.empty((len(features), 2), order="F")
        first = (float(self.alpha_axis_.start), float(self.alpha_axis_.interval))
        scaling = (float(self.beta_middle_deg_), float(self.beta_half_range_deg_))
        nominal = self.nominal_deg(features)
        corrected_along_rows(nominal, self.coefficients_deg_, first, scaling, angles)
        return sun_from_target(angles, "angle")

    def _chosen(
        self, nominal: Floats, errors: Floats, sun: Floats
    ) -> tuple[tuple[int, float], float]:
        """Degree and smoothing with the smallest error on samples left out, and that error.

        Tried on rows as coarse as the poses, where it takes tenths of the time: second differences
        grow with the interval squared, and rows become fewer.
        """
        degrees = DEGREES if self.degree is None else (self.degree,)
        smoothings = SMOOTHINGS if self.smoothing is None else (self.smoothing,)
        step = median_spacing(np.unique(np.round(nominal, 9), axis=0))
        coarse = max(self.interval_deg, step)
        while (nodes := _rows(nominal, coarse).nodes * (max(degrees) + 1)) > MAX_NODES:
            coarse *= 2.0
        alpha, basis, design = _equations(nominal, coarse, max(degrees))
        weights = [weight * (self.interval_deg / coarse) ** 3 for weight in smoothings]
        parts = splits(folds(sun))
        found: dict[tuple[int, float], float] = {}
        for degree in degrees:
            terms = degree + 1
            if _rank(nominal, basis[:, :terms]) < 2 * terms:
                continue
            # of every row the terms up to this degree
            part = design[:, np.arange(nodes) % (max(degrees) + 1) < terms]
            errors_of = errors_left_out(
                part, row_roughness(alpha.nodes, terms), weights, errors, parts
            )
            found |= {(degree, s): e for s, e in zip(smoothings, errors_of.tolist(), strict=True)}
        tried = [(n, weight) for n in degrees for weight in smoothings]
        return best_candidate(tried, lambda settings: found.get(settings, np.inf), self.about.name)

    def solve(self, nominal: Floats, errors: Floats, degree: int, smoothing: float) -> None:
        """Solve for the rows that fit errors (n, 2) at nominal angles (n, 2), degrees."""
        terms, by = degree + 1, self.about.name
        require_samples(len(nominal), 2 * terms, by, f"degree {degree} on at least two rows")
        require_size(_rows(nominal, self.interval_deg).nodes * terms, by, self.interval_deg)
        alpha, basis, design = _equations(nominal, self.interval_deg, degree)
        rank = _rank(nominal, basis)
        if rank < 2 * terms:
            raise UnusableDataError(
                f"{by} needs samples that settle {2 * terms} terms (degree {degree} on two rows); "
                f"the {len(nominal)} given settle only {rank}"
            )
        roughness = row_roughness(alpha.nodes, terms)
        solution = solve_table(design, roughness, smoothing, errors, by)
        self.alpha_axis_ = alpha
        self.beta_middle_deg_, self.beta_half_range_deg_ = _scale(nominal)
        self.coefficients_deg_ = solution.reshape(alpha.nodes, terms, 2)


def _rows(nominal: Floats, interval: float) -> GridAxis:
    return GridAxis.over(nominal[:, 0], interval)


def _scale(nominal: Floats) -> tuple[float, float]:
    """Middle and half range of beta."""
    low, high = float(nominal[:, 1].min()), float(nominal[:, 1].max())
    return (low + high) / 2, (high - low) / 2


def _equations(nominal: Floats, interval: float, degree: int) -> tuple[GridAxis, Floats, Any]:
    """Rows, their terms (n, degree + 1) at each sample, and both rows' around it (n, unknowns)."""
    from scipy.sparse import csr_array  # noqa: PLC0415 - SciPy, at the first fit only

    alpha = _rows(nominal, interval)
    middle, half = _scale(nominal)
    scaled = (nominal[:, 1] - middle) / half
    basis = np.asarray(chebyshev.chebvander(scaled, degree), dtype=np.float64)
    across = interpolation_matrix(alpha, nominal[:, 0])
    return alpha, basis, row_products(across, csr_array(basis))


def _rank(nominal: Floats, basis: Floats) -> int:
    """How many terms of polynomials that change linearly from row to row the samples settle.

    Such coefficients are free of roughness: the samples themselves must settle those.
    """
    trend = np.hstack([basis, basis * nominal[:, :1] / np.abs(nominal[:, 0]).max()])
    return int(np.linalg.matrix_rank(trend, rtol=1.0 / WORST_CONDITION))

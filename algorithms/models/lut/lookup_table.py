"""Look-up tables of the error of the nominal projection: node by node, or row polynomials (LUT)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from algorithms.angles import angles_from_sun, sun_from_angles
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    Model,
    SensorGeometry,
    UnusableDataError,
)
from algorithms.inputs import (
    as_features,
    as_frontal_calibration,
    require_fitted,
    require_positive,
    require_samples,
)
from algorithms.models.conditioning import WORST_CONDITION
from algorithms.models.lut.error_tables import (
    GridAxis,
    convex_hull,
    distance_outside,
    interpolation_matrix,
    require_size,
    row_products,
    row_roughness,
    solve_table,
    surface_roughness,
)
from algorithms.models.nominal_projection import (
    POSITIONS,
    nominal_projection,
    nominal_tangents,
    require_projection,
)

MAX_DEGREE = 15


@dataclass
class ErrorTable(Model):
    """Nominal angles corrected by a table of their errors, interpolated between its nodes.

    Whatever the error comes from, the table holds it as measured over the field of view; its
    accuracy is that of the calibration samples and of the interval between nodes.

    Parameters
    ----------
    focal_length_mm : float
        Nominal distance from aperture to detector, positive.
    unit_mm : float
        Displacement of the spot for one unit of feature, positive: the pixel pitch for spots,
        half the aperture's width for balances.
    centre : tuple of two float
        Nominal feature (x, y) of the spot when the Sun is on the boresight.
    interval_deg : float
        Distance between nodes, positive; the study's is 1.
    smoothing : float
        Weight of the table's squared second differences against one sample's squared error,
        positive: small enough only to fill nodes that no sample settles.

    Attributes
    ----------
    alpha_axis_, beta_axis_ : GridAxis
        The nodes' nominal angles in degrees.
    table_deg_ : ndarray, shape (A, B, 2)
        Errors of alpha and beta at the nodes.
    hull_ : ndarray, shape (m, 3)
        Facets of the calibrated region in (alpha, beta).

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: model:lut (He2013), in words there: ``angle = nominal + e(nominal)``, nominal by
    eq:stdproj, e bilinear between the nodes of a two-dimensional table of 1 degree interval. The
    nodes are the least-squares ones for samples anywhere, so repeats are averaged.

    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, for a nominal direction more than half an interval
    outside the convex hull of the calibration, or where an angle reaches 90 degrees. fit raises
    UnusableDataError below 3 samples, for samples on one line, or for a table past 250,000 nodes.

    Cost: 40 operations a sample, and 2 a facet of the hull; the fit solves one sparse system in
    A B unknowns.

    References
    ----------
    He2013; survey model:lut, eq:stdproj.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> steps = np.arange(-10, 11, 2)
    >>> sun = sun_from_angles(np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2))
    >>> bent = 200.0 * (sun[:, :2] / sun[:, 2:]) ** 3  # what the drawing does not know
    >>> spots = 200.0 * sun[:, :2] / sun[:, 2:] + bent
    >>> model = ErrorTable(focal_length_mm=2.0, unit_mm=0.01, interval_deg=2.0).fit(spots, sun)
    >>> angles_from_sun(model.predict([spots[0], [900.0, 0.0]])).round(2)
    array([[-10., -10.],
           [ nan,  nan]])
    """

    about: ClassVar = AboutModel(
        name="lut",
        taxonomy="LUT",
        studies=("He2013",),
        labels=("model:lut", "eq:stdproj"),
        origin="survey",
        needs=("focal_length_mm",),
        accepts=POSITIONS,
    )

    focal_length_mm: float
    unit_mm: float
    centre: tuple[float, float] = (0.0, 0.0)
    interval_deg: float = 1.0
    smoothing: float = 1e-3

    alpha_axis_: GridAxis = field(init=False, repr=False, compare=False)
    beta_axis_: GridAxis = field(init=False, repr=False, compare=False)
    table_deg_: Floats = field(init=False, repr=False, compare=False)
    hull_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_projection(self.about.name, self.focal_length_mm, self.unit_mm, self.centre)
        require_positive(self.about.name, interval_deg=self.interval_deg, smoothing=self.smoothing)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the table over the sensor's nominal angles, at the published interval."""
        return cls(**nominal_projection(geometry, kind, cls.about))

    def fit(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """Solve for the table's nodes."""
        found, vectors = as_frontal_calibration(features, sun, self.about.name)
        require_samples(len(found), 3, self.about.name, "a region to interpolate in")
        nominal = self._nominal_deg(found)
        hull = convex_hull(nominal, self.about.name)
        alpha = GridAxis.covering(nominal[:, 0], self.interval_deg)
        beta = GridAxis.covering(nominal[:, 1], self.interval_deg)
        require_size(alpha.nodes * beta.nodes, self.about.name, self.interval_deg)

        # Row-wise product of the two axes' weights: four nodes a sample.
        across = interpolation_matrix(alpha, nominal[:, 0])
        along = interpolation_matrix(beta, nominal[:, 1])
        design = row_products(across, along)
        roughness = surface_roughness(alpha.nodes, beta.nodes)
        errors = angles_from_sun(vectors) - nominal
        nodes = solve_table(design, roughness, self.smoothing, errors, self.about.name)

        self.alpha_axis_, self.beta_axis_, self.hull_ = alpha, beta, hull
        self.table_deg_ = nodes.reshape(alpha.nodes, beta.nodes, 2)
        return self

    def predict(self, features: ArrayLike) -> Floats:
        """Sun unit vectors (N, 3) of features (N, 2)."""
        require_fitted(self, "table_deg_")
        nominal = self._nominal_deg(as_features(features, 2, self.about.name))
        i, u = self.alpha_axis_.cells(nominal[:, 0])
        j, v = self.beta_axis_.cells(nominal[:, 1])
        u, v = u[:, None], v[:, None]
        table = self.table_deg_
        lower = (1 - v) * table[i, j] + v * table[i, j + 1]
        upper = (1 - v) * table[i + 1, j] + v * table[i + 1, j + 1]
        corrected = nominal + (1 - u) * lower + u * upper
        corrected[distance_outside(nominal, self.hull_) > self.interval_deg / 2] = np.nan
        return sun_from_angles(corrected)

    def _nominal_deg(self, found: Floats) -> Floats:
        tangents = nominal_tangents(found, self.focal_length_mm, self.unit_mm, self.centre)
        return np.degrees(np.arctan(tangents))


@dataclass
class BlendedPolynomials(Model):
    """Nominal angles corrected by polynomials of one angle, blended between rows of the other.

    A table of polynomial coefficients takes far less room than one of nodes; weighting the two
    neighbouring polynomials keeps the correction smooth from row to row.

    Parameters
    ----------
    focal_length_mm : float
        Nominal distance from aperture to detector, positive.
    unit_mm : float
        Displacement of the spot for one unit of feature, positive: the pixel pitch for spots,
        half the aperture's width for balances.
    centre : tuple of two float
        Nominal feature (x, y) of the spot when the Sun is on the boresight.
    interval_deg : float
        Distance in alpha between rows, positive; the study's is 1.
    degree : int
        Degree n of each row's polynomial in beta, 1 to 15; the study's is 8.
    smoothing : float
        Weight of the squared second differences of coefficients from row to row against one
        sample's squared error, positive: small enough only to fill rows no sample settles.

    Attributes
    ----------
    alpha_axis_ : GridAxis
        The rows' nominal alpha in degrees.
    beta_middle_deg_, beta_half_range_deg_ : float
        Scaling of the nominal beta onto [-1, 1].
    coefficients_deg_ : ndarray, shape (A, n + 1, 2)
        Chebyshev coefficients of the errors of alpha and beta, row by row.
    hull_ : ndarray, shape (m, 3)
        Facets of the calibrated region in (alpha, beta).

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: model:lut (He2013), in words there: for nominal angles (eq:stdproj) between rows k
    and k + 1, ``e = (1 - w) P_k(beta) + w P_{k+1}(beta)`` with w the fraction of the interval. All
    rows are fitted at once to samples anywhere, in Chebyshev polynomials, which span the same
    functions without the loss of digits.

    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, for a nominal direction more than half an interval
    outside the convex hull of the calibration, or where an angle reaches 90 degrees. fit raises
    UnusableDataError below 2 (n + 1) samples, where they do not settle a polynomial on two rows,
    where they settle the rows so badly that rounding would show, or past 250,000 coefficients.

    Cost: 12 (n + 1) operations a sample, and 2 a facet of the hull; the fit solves one sparse
    system in A (n + 1) unknowns.

    References
    ----------
    He2013; survey model:lut, eq:stdproj.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> steps = np.arange(-10, 11, 2)
    >>> sun = sun_from_angles(np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2))
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

    focal_length_mm: float
    unit_mm: float
    centre: tuple[float, float] = (0.0, 0.0)
    interval_deg: float = 1.0
    degree: int = 8
    smoothing: float = 1e-3

    alpha_axis_: GridAxis = field(init=False, repr=False, compare=False)
    beta_middle_deg_: float = field(init=False, repr=False, compare=False)
    beta_half_range_deg_: float = field(init=False, repr=False, compare=False)
    coefficients_deg_: Floats = field(init=False, repr=False, compare=False)
    hull_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_projection(self.about.name, self.focal_length_mm, self.unit_mm, self.centre)
        require_positive(self.about.name, interval_deg=self.interval_deg, smoothing=self.smoothing)
        if not 1 <= self.degree <= MAX_DEGREE:
            raise ValueError(
                f"{self.about.name}: degree must be from 1 to {MAX_DEGREE}; got {self.degree!r}"
            )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the rows over the sensor's nominal angles, at the published interval."""
        return cls(**nominal_projection(geometry, kind, cls.about))

    def fit(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """Solve for all rows' coefficients."""
        from scipy.sparse import csr_array  # noqa: PLC0415 - SciPy, at the first fit only

        found, vectors = as_frontal_calibration(features, sun, self.about.name)
        terms = self.degree + 1
        require_samples(
            len(found), 2 * terms, self.about.name, f"degree {self.degree} on at least two rows"
        )
        nominal = self._nominal_deg(found)
        hull = convex_hull(nominal, self.about.name)
        alpha = GridAxis.covering(nominal[:, 0], self.interval_deg)
        require_size(alpha.nodes * terms, self.about.name, self.interval_deg)
        low, high = float(nominal[:, 1].min()), float(nominal[:, 1].max())
        middle, half = (low + high) / 2, (high - low) / 2
        basis = np.asarray(chebyshev.chebvander((nominal[:, 1] - middle) / half, self.degree))
        # Coefficients that change linearly from row to row are free of roughness: the samples
        # themselves must settle those.
        trend = np.hstack([basis, basis * nominal[:, :1] / np.abs(nominal[:, 0]).max()])
        rank = int(np.linalg.matrix_rank(trend, rtol=1.0 / WORST_CONDITION))
        if rank < 2 * terms:
            raise UnusableDataError(
                f"{self.about.name} needs samples that settle {2 * terms} terms (degree "
                f"{self.degree} on two rows); the {len(found)} given settle only {rank}"
            )

        across = interpolation_matrix(alpha, nominal[:, 0])
        design = row_products(across, csr_array(basis))
        roughness = row_roughness(alpha.nodes, terms)
        errors = angles_from_sun(vectors) - nominal
        solution = solve_table(design, roughness, self.smoothing, errors, self.about.name)

        self.alpha_axis_, self.hull_ = alpha, hull
        self.beta_middle_deg_, self.beta_half_range_deg_ = middle, half
        self.coefficients_deg_ = solution.reshape(alpha.nodes, terms, 2)
        return self

    def predict(self, features: ArrayLike) -> Floats:
        """Sun unit vectors (N, 3) of features (N, 2)."""
        require_fitted(self, "coefficients_deg_")
        nominal = self._nominal_deg(as_features(features, 2, self.about.name))
        row, weight = self.alpha_axis_.cells(nominal[:, 0])
        scaled = (nominal[:, 1] - self.beta_middle_deg_) / self.beta_half_range_deg_
        blend = weight[:, None, None]
        rows = self.coefficients_deg_
        coefficients = (1 - blend) * rows[row] + blend * rows[row + 1]
        errors = chebyshev.chebval(scaled[:, None], np.moveaxis(coefficients, 1, 0), tensor=False)
        corrected = nominal + errors
        corrected[distance_outside(nominal, self.hull_) > self.interval_deg / 2] = np.nan
        return sun_from_angles(corrected)

    def _nominal_deg(self, found: Floats) -> Floats:
        tangents = nominal_tangents(found, self.focal_length_mm, self.unit_mm, self.centre)
        return np.degrees(np.arctan(tangents))

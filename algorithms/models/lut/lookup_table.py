"""Look-up table of the error of the nominal projection, node by node (LUT)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from algorithms.angles import angles_from_sun
from algorithms.calibration.blocks import best_candidate, folds, splits
from algorithms.calibration.calibrated import Columns
from algorithms.calibration.hull import median_spacing
from algorithms.calibration.projection import ProjectionModel
from algorithms.calibration.quality import Setting
from algorithms.contract import AboutModel, Floats
from algorithms.documented import documented
from algorithms.models.lut.error_tables import (
    MAX_BAND,
    SMOOTHINGS,
    GridAxis,
    errors_left_out,
    interpolation_matrix,
    require_size,
    row_products,
    solve_table,
    surface_roughness,
)
from algorithms.models.nominal_projection import (
    POSITIONS,
)
from algorithms.models.non_physical.regression_axes import sun_from_target
from algorithms.parameters import require_positive


@documented
@dataclass
class ErrorTable(ProjectionModel):
    """Nominal angles corrected by an interpolated table of their errors.

    The table stores the measured error over the field of view, whatever its cause; accuracy
    depends on the calibration samples and the interval between nodes.

    Parameters
    ----------
    interval_deg : float
        Distance between nodes, positive; the study's is 1.
    smoothing : float, optional
        Weight of the table's squared second differences against one sample's squared error,
        positive; 1e-3 only fills nodes that no sample determines. None: chosen from the
        calibration samples by cross-validation, on a table as coarse as their poses.

    Attributes
    ----------
    alpha_axis_, beta_axis_ : GridAxis
        The nodes' nominal angles in degrees.
    table_deg_ : ndarray, shape (A, B, 2)
        Errors of alpha and beta at the nodes.
    smoothing_ : float
        Given or chosen.

    Notes
    -----
    Implements: model:lut (He2013), described in words: ``angle = nominal + e(nominal)``, nominal
    by eq:stdproj, e bilinear between the nodes of a two-dimensional table of 1 degree interval.
    The nodes are the least-squares ones for samples anywhere, so repeats are averaged.

    Failure: a NaN row for a NaN feature row, outside the hull, or where an angle reaches 90
    degrees. fit raises UnusableDataError below 3 samples, for samples on one line, or for a table
    past 250,000 nodes.

    Cost: 40 operations per sample, and 2 per facet of the hull; the fit solves one sparse system in
    A B unknowns.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-10, 11, 2))
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

    interval_deg: float = 1.0
    smoothing: float | None = None

    fewest: ClassVar[int] = 3

    alpha_axis_: GridAxis = field(init=False, repr=False, compare=False)
    beta_axis_: GridAxis = field(init=False, repr=False, compare=False)
    table_deg_: Floats = field(init=False, repr=False, compare=False)
    smoothing_: float = field(init=False, repr=False, compare=False)
    validated_deg_: float | None = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        smoothing = 1.0 if self.smoothing is None else self.smoothing
        require_positive(self.about.name, interval_deg=self.interval_deg, smoothing=smoothing)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Solve for the table's nodes."""
        del context
        nominal = self.nominal_deg(features)
        errors = angles_from_sun(sun) - nominal
        chosen, self.validated_deg_ = self.smoothing, None
        if chosen is None:
            chosen, self.validated_deg_ = self._chosen(nominal, errors, sun)
        self.smoothing_ = chosen
        self.solve(nominal, errors, chosen)

    def settings(self) -> Mapping[str, Setting]:
        """Give the smoothing, chosen or given."""
        return {"smoothing": self.smoothing_}

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, 2)."""
        from algorithms.models.lut.table_kernel import correct  # noqa: PLC0415 - Numba

        del context
        angles = np.empty((len(features), 2), order="F")
        alpha, beta = self.alpha_axis_, self.beta_axis_
        starts = (float(alpha.start), float(beta.start))
        nominal = self.nominal_deg(features)
        correct(nominal, self.table_deg_, starts, float(alpha.interval), angles)
        return sun_from_target(angles, "angle")

    def _chosen(self, nominal: Floats, errors: Floats, sun: Floats) -> tuple[float, float]:
        """Smoothing that leaves the smallest error on samples left out, and that error.

        Tried on a coarser table, where it takes hundredths of the time: second differences grow
        with the interval squared, and their squares' sum with the interval squared.
        """
        step = median_spacing(np.unique(np.round(nominal, 9), axis=0))
        coarse = max(self.interval_deg, step)
        while (nodes := _nodes(nominal, coarse)) * np.sqrt(nodes) > MAX_BAND:
            coarse *= 2.0
        alpha, beta, design = _equations(nominal, coarse)
        weights = [weight * (self.interval_deg / coarse) ** 2 for weight in SMOOTHINGS]
        found = errors_left_out(
            design, surface_roughness(alpha.nodes, beta.nodes), weights, errors, splits(folds(sun))
        )
        errors_of = dict(zip(SMOOTHINGS, found.tolist(), strict=True))
        return best_candidate(SMOOTHINGS, errors_of.__getitem__, self.about.name)

    def solve(self, nominal: Floats, errors: Floats, smoothing: float) -> None:
        """Solve for the nodes that fit errors (n, 2) at nominal angles (n, 2), degrees."""
        require_size(_nodes(nominal, self.interval_deg), self.about.name, self.interval_deg)
        alpha, beta, design = _equations(nominal, self.interval_deg)
        roughness = surface_roughness(alpha.nodes, beta.nodes)
        nodes = solve_table(design, roughness, smoothing, errors, self.about.name)
        self.alpha_axis_, self.beta_axis_ = alpha, beta
        self.table_deg_ = nodes.reshape(alpha.nodes, beta.nodes, 2)


def _axes(nominal: Floats, interval: float) -> tuple[GridAxis, GridAxis]:
    return GridAxis.over(nominal[:, 0], interval), GridAxis.over(nominal[:, 1], interval)


def _nodes(nominal: Floats, interval: float) -> int:
    alpha, beta = _axes(nominal, interval)
    return alpha.nodes * beta.nodes


def _equations(nominal: Floats, interval: float) -> tuple[GridAxis, GridAxis, Any]:
    """Both axes of a table, and the weights (n, nodes) of the four nodes around each sample."""
    alpha, beta = _axes(nominal, interval)
    across = interpolation_matrix(alpha, nominal[:, 0])
    along = interpolation_matrix(beta, nominal[:, 1])
    return alpha, beta, row_products(across, along)

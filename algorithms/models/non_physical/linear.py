"""Straight line of each Sun angle on its feature (Linear)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.calibration.quality import Parameter
from algorithms.contract import AboutModel, Floats
from algorithms.documented import documented
from algorithms.models.nominal_projection import POSITIONS
from algorithms.models.non_physical.regression_axes import (
    Target,
    feature_scaling,
    solve_regression,
    sun_from_target,
    target_from_sun,
)
from algorithms.parameters import require_choice


@documented
@dataclass
class LinearFit(CalibratedModel):
    """Each Sun angle as a linear function of the feature of its axis.

    With two parameters per axis it is the smallest and fastest calibration. It is valid over a
    narrow field of view, where the response is linear.

    Parameters
    ----------
    target : {"angle", "tangent"}
        Output of the line: the angle in degrees, as published, or its tangent, in which the
        response of a pinhole is linear.

    Attributes
    ----------
    coefficients_ : ndarray, shape (2, 2)
        Intercept and slope on the feature, rows ``alpha`` (on y) and ``beta`` (on x); in degrees
        (or tangents) and per unit of feature.
    deviations_ : ndarray, shape (2, 2)
        Their standard errors.

    Notes
    -----
    Implements: model:linear (Faizullin2017), described in words: ``alpha = c_0 + c_1 y``, ``beta =
    d_0 + d_1 x`` by ordinary least squares.

    Failure: a NaN row for a NaN feature row, outside the hull or where an angle reaches 90 degrees.
    fit raises UnusableDataError below 3 samples, where they lie on one line, or where a line
    explains nothing of them, as with swapped axes.

    Cost: 4 operations and 2 tangents per sample.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-5, 6, 5))
    >>> balances = 4.0 * sun[:, :2] / sun[:, 2:] + 0.01
    >>> model = LinearFit().fit(balances, sun)
    >>> model.coefficients_.round(2)
    array([[-0.14, 14.29],
           [-0.14, 14.29]])
    >>> angles_from_sun(model.predict([[0.36, 0.08]])).round(2)
    array([[1., 5.]])
    """

    about: ClassVar = AboutModel(
        name="linear",
        taxonomy="Linear",
        studies=("Faizullin2017",),
        labels=("model:linear",),
        origin="survey",
        accepts=POSITIONS,
    )

    target: Target = "angle"

    fewest: ClassVar[int] = 3

    coefficients_: Floats = field(init=False, repr=False, compare=False)
    deviations_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_choice(self.about.name, Target, target=self.target)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit one line an axis to samples (n, 2) of Suns (n, 3)."""
        del context
        wanted = target_from_sun(sun, self.target)
        middle, half = feature_scaling(features, self.about.name)
        coefficients, deviations = np.empty((2, 2)), np.empty((2, 2))
        for axis, column in ((0, 1), (1, 0)):
            scaled = (features[:, column] - middle[column]) / half[column]
            design = np.column_stack([np.ones(len(scaled)), scaled])
            level, slope = solve_regression(design, wanted[:, axis], self.about.name)
            residual = wanted[:, axis] - level - slope * scaled
            variance = residual @ residual / max(len(scaled) - 2, 1)
            errors = variance * np.linalg.inv(design.T @ design)
            shift = np.array([[1.0, -middle[column] / half[column]], [0.0, 1.0 / half[column]]])
            coefficients[axis] = shift @ (level, slope)
            deviations[axis] = np.sqrt(np.diag(shift @ errors @ shift.T))
        self.coefficients_, self.deviations_ = coefficients, deviations

    def fitted_parameters(self) -> tuple[Parameter, ...]:
        """Give intercepts and slopes, in degrees (or tangents) and per unit of feature."""
        unit = "deg" if self.target == "angle" else ""
        return tuple(
            Parameter(f"{what}_{axis}", float(value), float(deviation), unit)
            for axis, values, deviations in zip(
                ("alpha", "beta"), self.coefficients_, self.deviations_, strict=True
            )
            for what, value, deviation in zip(
                ("intercept", "slope"), values, deviations, strict=True
            )
        )

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, 2)."""
        del context
        values = np.empty((len(features), 2), order="F")
        for axis, column in ((0, 1), (1, 0)):
            level, slope = self.coefficients_[axis]
            np.multiply(features[:, column], slope, out=values[:, axis])
            values[:, axis] += level
        return sun_from_target(values, self.target)

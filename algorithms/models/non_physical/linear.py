"""Straight line of each Sun angle on its feature (Linear)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
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


@dataclass
class LinearFit(Model):
    """Each Sun angle as a straight line on the feature of its axis.

    Two numbers an axis make the smallest and fastest calibration there is; it holds over a
    narrow field of view, where the sensor's response is straight.

    Parameters
    ----------
    target : {"angle", "tangent"}
        What the line gives: the angle in degrees, as published, or its tangent, which is what a
        pinhole's response is straight in.

    Attributes
    ----------
    coefficients_ : ndarray, shape (2, 2)
        Intercept and slope on the feature, rows ``alpha`` (on y) and ``beta`` (on x); in degrees
        (or tangents) and per unit of feature.

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: model:linear (Faizullin2017), in words there: ``alpha = c_0 + c_1 y``,
    ``beta = d_0 + d_1 x`` by ordinary least squares.

    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row or where an angle reaches 90 degrees. fit raises
    UnusableDataError below 2 samples or where all have the same feature.

    Cost: 4 operations and 2 tangents a sample.

    References
    ----------
    Faizullin2017; survey model:linear.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> steps = [-5, 0, 5]
    >>> sun = sun_from_angles(np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2))
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

    coefficients_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_target(self.target, self.about.name)

    def fit(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """Fit one line an axis."""
        found, vectors = as_frontal_calibration(features, sun, self.about.name)
        require_samples(len(found), 2, self.about.name, "two coefficients an axis")
        wanted = target_from_sun(vectors, self.target)
        middle, half = feature_scaling(found, self.about.name)
        coefficients = np.empty((2, 2))
        for axis, column in ((0, 1), (1, 0)):
            scaled = (found[:, column] - middle[column]) / half[column]
            design = np.column_stack([np.ones(len(scaled)), scaled])
            level, slope = solve_regression(design, wanted[:, axis], self.about.name)
            slope = slope / half[column]
            coefficients[axis] = level - slope * middle[column], slope
        self.coefficients_ = coefficients
        return self

    def predict(self, features: ArrayLike) -> Floats:
        """Sun unit vectors (N, 3) of features (N, 2)."""
        require_fitted(self, "coefficients_")
        found = as_features(features, 2, self.about.name)
        level, slope = self.coefficients_.T
        return sun_from_target(level + slope * found[:, ::-1], self.target)

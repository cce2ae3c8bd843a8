"""A deep network that corrects a cubic surface of one spot's place (DNN)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.contract import AboutModel, Floats
from algorithms.documented import documented
from algorithms.models.neural_network.direction_errors import (
    Corrected,
    Correction,
    combine,
    least_squares,
)
from algorithms.models.neural_network.training import on_grid, require_training
from algorithms.models.nominal_projection import POSITIONS
from algorithms.models.non_physical.regression_axes import feature_scaling
from algorithms.row_arithmetic import normalise

#: Powers of the features in each term, by degree.
_CUBIC = tuple((total - j, j) for total in range(4) for j in range(total + 1))


@documented
@dataclass
class DeepSurface(Corrected, CalibratedModel):
    """Cubic surfaces of both features, with a deep network for the residuals.

    The surfaces fit the smooth part, and the network fits the rest, such as a spot cut off at the
    edge of the field.

    Attributes
    ----------
    coefficients_ : ndarray, shape (10, 2)
        Of ``u_x^i u_y^j``, i + j <= 3, by total degree and then by j, in ``tan(beta)`` and
        ``tan(alpha)``.

    Notes
    -----
    Implements: model:dnn (model:nn, Sun2023, Soken2023): after a cubic surface a network of the
    same inputs gives the errors that are left along two axes (Sun2023, on a quadrant photodiode).
    Layers are Soken2023's: units as many as inputs with a log-sigmoid, two layers of hyperbolic
    tangents, two linear outputs; eight units a hidden layer are ours. Surfaces are of the angles'
    tangents, errors tangents along two axes across the direction: ours. Trained by Levenberg and
    Marquardt's method on four fifths of the poses until the error on the other fifth, in blocks, no
    longer falls.

    Failure: a NaN row for a NaN feature row, or outside the hull. fit raises UnusableDataError for
    fewer poses than the network has weights an output, 60 for eight units, or where they lie on one
    line.

    Cost: 1000 operations per sample. A fit takes some 5 ms a pose and start.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-30, 31, 5))
    >>> balances = np.tanh(sun[:, :2] / sun[:, 2:])
    >>> model = DeepSurface().fit(balances, sun)
    >>> angles_from_sun(model.predict([balances[0], [9.0, 0.0]])).round(1)
    array([[-30., -30.],
           [ nan,  nan]])
    """

    about: ClassVar = AboutModel(
        name="dnn-surface",
        taxonomy="DNN",
        studies=("Sun2023", "Soken2023"),
        labels=("model:nn", "model:dnn"),
        origin="survey",
        accepts=POSITIONS,
    )

    hidden: int = 8
    restarts: int = 3
    seed: int = 0

    middle_: Floats = field(init=False, repr=False, compare=False)
    half_range_: Floats = field(init=False, repr=False, compare=False)
    coefficients_: Floats = field(init=False, repr=False, compare=False)
    correction_: Correction = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_training(self.about.name, self.hidden, self.restarts, self.seed)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit the surfaces, then train on what they leave, samples (n, 2) of Suns (n, 3)."""
        del context
        by = self.about.name
        features, sun = on_grid(features, sun)
        self.middle_, self.half_range_ = feature_scaling(features, by)
        inputs = self._scaled(features)
        tangents = sun[:, :2] / sun[:, 2:]
        self.coefficients_ = least_squares(np.column_stack(_terms(inputs)), tangents, by)
        self._train(by, inputs, sun)

    def _base(self, inputs: Floats) -> Floats:
        """Directions (N, 3) of the surfaces."""
        tangents = combine(_terms(inputs), self.coefficients_)
        return normalise(np.column_stack([tangents, np.ones(len(inputs))]))


def _terms(inputs: Floats) -> list[Floats]:
    """Products (10 of (N,)) of both features' powers; no powers but by products."""
    powers = []
    for column in inputs.T:
        square = column * column
        powers.append((np.ones_like(column), column, square, square * column))
    return [powers[0][i] * powers[1][j] for i, j in _CUBIC]

"""The standard projection model (SPM): the drawing's geometry, nothing calibrated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.drawn import DrawnModel
from algorithms.calibration.projection import ProjectionModel
from algorithms.contract import AboutModel, Floats
from algorithms.documented import documented
from algorithms.models.nominal_projection import (
    POSITIONS,
)


@documented
@dataclass
class StandardProjection(ProjectionModel, DrawnModel):
    """Direction from the spot through the centre of the aperture, with the nominal geometry.

    One multiplication per axis converts the spot's position to tangents of the Sun angles; errors
    of focal length, centre and alignment are not corrected.

    Parameters
    ----------
    focal_length_mm : float
        Distance h from aperture to detector, positive.

    Notes
    -----
    Implements: eq:stdproj (model:spm, deBoer2013): ``alpha = arctan(Y s / h)``,
    ``beta = arctan(X s / h)`` with X, Y counted from the centre; for balances (alg:VB)
    ``tan(beta) = S_A d / (2 h)``, ``tan(alpha) = S_B d / (2 h)``.

    Failure: a NaN row for a NaN feature row.

    Cost: 11 operations per sample.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun
    >>> model = StandardProjection(focal_length_mm=2.0, unit_mm=0.01, centre=(100.0, 80.0))
    >>> model = model.fit([[100.0, 80.0]], [[0.0, 0.0, 1.0]])
    >>> angles_from_sun(model.predict([[100.0, 80.0], [300.0, 80.0], [100.0, 180.0]])).round(2)
    array([[ 0.  ,  0.  ],
           [ 0.  , 45.  ],
           [26.57,  0.  ]])
    """

    about: ClassVar = AboutModel(
        name="spm",
        taxonomy="SPM",
        studies=("deBoer2013",),
        labels=("model:spm", "eq:stdproj", "alg:VB"),
        origin="survey",
        needs=("focal_length_mm",),
        accepts=POSITIONS,
    )

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of features (N, 2)."""
        from algorithms.models.geometric.projection_kernel import project  # noqa: PLC0415 - Numba

        del context
        sun = np.empty((len(features), 3))
        centre = (float(self.centre[0]), float(self.centre[1]))
        scale = float(self.unit_mm) / float(self.focal_length_mm)
        project(features[:, 0], features[:, 1], centre, scale, sun)
        return sun

"""The brighter face of each opposite pair alone (ICM/Albedo, maximum currents)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.cube_currents import CubeCurrents
from algorithms.contract import AboutCompensation, FeatureKind, Floats
from algorithms.documented import documented


@documented
@dataclass
class MaximumCurrents(CubeCurrents):
    """Brighter face of each opposite pair; light on the darker face is attributed to the Earth.

    Sunlight is stronger than albedo and never reaches both faces of a pair. Earthlight on a sunlit
    face remains.

    Notes
    -----
    Implements: eq:albedo1 (model:albedo, Frezza2022): ``max(I_+, I_-)`` of every pair; the side is
    that of the brighter face. Faces are compared in units of their own full sunlight.

    Shapes: signals (N, 6), in any common unit, to the same; the darker of each pair is 0.

    Failure: a NaN row for a NaN feature row. fit raises UnusableDataError where no sample lights a
    face.

    Cost: 5 operations per face.

    Examples
    --------
    >>> faces = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> clean = MaximumCurrents(faces).fit([[1, 0, 0, 0, 0, 0]], [[1.0, 0.0, 0.0]])
    >>> clean.transform([[0.6, 0.1, 0.0, 0.2, 0.8, 0.0]])
    array([[0.6, 0. , 0. , 0.2, 0.8, 0. ]])
    """

    about: ClassVar = AboutCompensation(
        name="maximum-currents",
        taxonomy="ICM/Albedo",
        studies=("Frezza2022",),
        labels=("model:albedo", "eq:albedo1"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
        ahead_of=("solar-panel",),
    )

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Signals (N, 6) of the brighter faces."""
        del context
        plus, minus = self.pairs(features)
        return self.lit_by(np.where(plus >= minus, plus, -minus))

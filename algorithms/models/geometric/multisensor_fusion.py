"""Sun vectors from many detectors that look different ways: the basic six-face model (Basic)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.drawn import DrawnModel
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
)
from algorithms.documented import documented
from algorithms.models.geometric.detector_faces import axis_faces
from algorithms.row_arithmetic import normalise


@documented
@dataclass
class SixFaces(DrawnModel):
    """Sun vector from the brighter face of each opposite pair of a cube.

    The signal of a face is the cosine of its angle to the Sun. The lit face of a pair gives the
    component along their axis, its side the sign; the vector is scaled to unit length.

    Parameters
    ----------
    face_normals : tuple of six vectors
        Unit normals of the detectors in the order of the features; the six directions +x, -x,
        +y, -y, +z, -z, each once, in any order.

    Notes
    -----
    Implements: eq:msfstd (model:base, Allgeier2009): ``I_a = max(I_x-, I_x+)``, ``I_b =
    max(I_y-, I_y+)``, ``I_c = max(I_z-, I_z+)``, ``s = (+-I_a, +-I_b, +-I_c) / sqrt(I_a^2 +
    I_b^2 + I_c^2)``. The survey leaves the sign open: it is the side of the brighter face, plus
    when both are equal. A pair whose two signals are negative (noise in the dark) gives 0.

    Shapes: signals (N, 6), in any common unit, to unit vectors (N, 3), all directions.

    Failure: a NaN row for a NaN feature row, or where no signal is positive. Albedo on an unlit
    face is mistaken for sunlight if this face is the brighter of its pair.

    Cost: 14 operations and one root per sample.

    Examples
    --------
    >>> faces = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> signals = [[0.6, 0.0, 0.0, 0.0, 0.8, 0.0], [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]]
    >>> SixFaces(faces).fit(signals, [[0.6, 0.0, 0.8], [0.0, -1.0, 0.0]]).predict(signals)
    array([[ 0.6,  0. ,  0.8],
           [ 0. , -1. ,  0. ]])
    """

    about: ClassVar = AboutModel(
        name="basic",
        taxonomy="Basic",
        studies=("Allgeier2009",),
        labels=("model:base", "eq:msfstd"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    face_normals: tuple[tuple[float, float, float], ...]

    frontal: ClassVar[bool] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        axis_faces(self.face_normals, self.about.name)

    def columns(self) -> int:
        """Six faces."""
        return 6

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, 6)."""
        del context
        plus, minus = axis_faces(self.face_normals, self.about.name)
        positive, negative = features[:, plus], features[:, minus]
        brighter = np.maximum(np.maximum(positive, negative), 0.0)
        return normalise(np.where(positive >= negative, brighter, -brighter))

"""Sun vectors from many detectors that look different ways: the basic six-face model (Basic)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    Model,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.inputs import as_calibration, as_features, require_fitted
from algorithms.row_arithmetic import normalised

AXIS_TOLERANCE = 1e-6
"""Largest departure of a face normal's components from 0 and 1."""


@dataclass
class SixFaces(Model):
    """Sun vector whose components are the brighter face of each opposite pair of a cube.

    Each face's signal is the cosine of its angle to the Sun, so the lit one of a pair is that
    axis's component and its side the sign; the length is then scaled to one.

    Parameters
    ----------
    face_normals : tuple of six vectors
        Unit normals of the detectors in the order of the features; the six directions +x, -x,
        +y, -y, +z, -z, each once, in any order.

    Attributes
    ----------
    n_samples_ : int
        Samples with features that `fit` was given.

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: eq:msfstd (model:base, Allgeier2009): ``I_a = max(I_x-, I_x+)``, ``I_b =
    max(I_y-, I_y+)``, ``I_c = max(I_z-, I_z+)``, ``s = (+-I_a, +-I_b, +-I_c) / sqrt(I_a^2 +
    I_b^2 + I_c^2)``. The survey leaves the sign open: it is the side of the brighter face, plus
    when both are equal. A pair whose two signals are negative (noise in the dark) gives 0.

    Shapes: signals (N, 6), in any common unit, to unit vectors (N, 3), all directions. Nothing is
    learnt; fit checks its input and counts it.

    Failure: a NaN row for a NaN feature row, or where no signal is positive. Albedo on an unlit
    face is taken for Sun where it is the brighter of its pair.

    Cost: 14 operations and one root a sample.

    References
    ----------
    Allgeier2009; survey model:base, eq:msfstd.

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

    n_samples_: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        self._columns()

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model of the sensor's six faces."""
        cls.about.require_kind(kind)
        geometry.require("face_normals", by=cls.about.name)
        return cls(geometry.face_normals or ())

    def fit(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """Check the calibration data; nothing is learnt from them."""
        found, _ = as_calibration(features, sun, 6, self.about.name)
        self.n_samples_ = len(found)
        return self

    def predict(self, features: ArrayLike) -> Floats:
        """Sun unit vectors (N, 3) of signals (N, 6)."""
        require_fitted(self, "n_samples_")
        signals = as_features(features, 6, self.about.name)
        plus, minus = self._columns()
        positive, negative = signals[:, plus], signals[:, minus]
        brighter = np.maximum(np.maximum(positive, negative), 0.0)
        return normalised(np.where(positive >= negative, brighter, -brighter))

    def _columns(self) -> tuple[list[int], list[int]]:
        """Columns of the +x, +y, +z faces and of the -x, -y, -z faces."""
        normals = np.asarray(self.face_normals, dtype=np.float64)
        axes = np.vstack([np.eye(3), -np.eye(3)])
        if normals.shape == (6, 3):
            match = (np.abs(normals - axes[:, None]) <= AXIS_TOLERANCE).all(axis=2)
            if (match.sum(axis=0) == 1).all() and (match.sum(axis=1) == 1).all():
                columns = [int(column) for column in match.argmax(axis=1)]
                return columns[:3], columns[3:]
        raise UnsuitableDesignError(
            f"{self.about.name} needs six face normals, +-x, +-y and +-z each once; "
            f"got {self.face_normals!r}"
        )

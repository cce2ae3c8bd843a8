"""Sun vectors from a satellite's own solar panels: normals weighted by currents (Solar panel)."""

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
from algorithms.models.geometric.detector_faces import UNIT_TOLERANCE, Normals, row_sums
from algorithms.row_arithmetic import normalised


@dataclass
class SolarPanels(Model):
    """Sum of the lit panels' normals, each weighted by its current, scaled to length one.

    On a body with panels square to each other every current is a component of the Sun vector, so
    the satellite's power supply doubles as its coarse Sun sensor. Light that reaches both panels
    of a pair alike cancels.

    Parameters
    ----------
    face_normals : tuple of six vectors
        Unit normals of the panels in the order of the features: three pairs of opposite ones,
        the pairs square to each other, in any order and turned any way.

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
    Implements: eq:msfsc (model:solarpanel, Nurgizat2021): ``n = sum_i n_i I_i / sqrt(sum_i
    I_i^2)`` over lit panels. Survey prints ``sum_i n_i I_0 / sum_i I_i^2``; corrected because
    that ratio has a unit and no panel's direction weighs more than another's. The corrected one
    is a unit vector where one panel of each pair is lit; the length is scaled to one where stray
    light or albedo lights both. A panel is lit whose signal is positive.

    Shapes: signals (N, 6), in any common unit, to unit vectors (N, 3), all directions. Nothing is
    learnt; fit checks its input and counts it.

    Failure: a NaN row for a NaN feature row, or where no signal is positive, or opposite ones
    cancel. Albedo is taken for Sun, and differences between the panels go straight into the
    result.

    Cost: 40 operations and one root a sample.

    References
    ----------
    Nurgizat2021; survey model:solarpanel, eq:msfsc.

    Examples
    --------
    >>> panels = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> currents = [[0.3, 0.0, 0.0, 0.0, 0.4, 0.0]]
    >>> SolarPanels(panels).fit(currents, [[0.6, 0.0, 0.8]]).predict(currents).round(3)
    array([[0.6, 0. , 0.8]])
    """

    about: ClassVar = AboutModel(
        name="solar-panel",
        taxonomy="Solar panel",
        studies=("Nurgizat2021",),
        labels=("model:solarpanel", "eq:msfsc"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    face_normals: Normals

    n_samples_: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        self._normals()

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model of the sensor's six panels."""
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
        lit = np.maximum(as_features(features, 6, self.about.name), 0.0)
        return normalised(np.column_stack([row_sums(lit, n) for n in self._normals().T]))

    def _normals(self) -> Floats:
        """(6, 3) normals, or UnsuitableDesignError unless they are three square pairs."""
        normals = np.asarray(self.face_normals, dtype=np.float64)
        if normals.shape == (6, 3):
            # row by row one opposite (-1), itself (1) and four at right angles (0)
            cosines = np.sort(normals @ normals.T, axis=1)
            if np.allclose(cosines, [-1.0, 0.0, 0.0, 0.0, 0.0, 1.0], rtol=0, atol=UNIT_TOLERANCE):
                return normals
        raise UnsuitableDesignError(
            f"{self.about.name} needs six panel normals, three opposite pairs square to each "
            f"other; got {self.face_normals!r}"
        )

"""Sun vectors from the lateral faces of a regular pyramid (Pyramidal)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.faces_model import FacesModel
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    UnsuitableDesignError,
    UnusableDataError,
)
from algorithms.documented import documented
from algorithms.inputs import require_samples
from algorithms.models.geometric.detector_faces import (
    UNIT_TOLERANCE,
    Normals,
    require_normals,
    row_sums,
)
from algorithms.parameters import require_choice, require_within
from algorithms.row_arithmetic import normalise

Coefficient = Literal["common", "each"]


@documented
@dataclass
class RegularPyramid(FacesModel):
    """Sun vector from signals weighted by the normals of a pyramid's faces.

    The columns of a regular pyramid's normals are orthogonal, so least squares over all faces
    separates into three weighted sums. A constant added to all faces cancels in the two horizontal
    ones, and noise averages out over the faces.

    Parameters
    ----------
    face_normals : tuple of M vectors
        Unit normals in the order of the features, M at least 3: all equally far from +z, by less
        than 90 degrees, and evenly spaced around it, in any order.
    coefficient : {"common", "each"}
        Whether one measurement coefficient serves all faces, as published, or the calibration
        gives each its own, which makes up for gains that differ.
    dark_fraction : float
        Share of the row's largest signal, in [0, 1), up to which a face counts as dark: what dark
        current and stray light may look like.

    Attributes
    ----------
    coefficients_ : ndarray, shape (M,)
        xi of every face: cosine of incidence per unit of signal.

    Notes
    -----
    Implements: eq:msfpyra1, eq:msfpyra2 (model:pyra, Wang2019): ``s = xi (b_x^T / b_x^T b_x, b_y^T
    / b_y^T b_y, b_z^T / b_z^T b_z) e``, e the signals of the M illuminated faces, b_x, b_y and b_z
    the components of their normals. The survey prints b_x in all three rows; corrected because
    each row gives its own component. Azimuths are counted there from +y towards +x; the normals
    here hold them. The length is scaled to one, so a common xi drops out of the direction.

    Shapes: signals (N, M), in any common unit, to unit vectors (N, 3). xi is learnt by least
    squares of the cosines of incidence on the signals of samples with all faces lit.

    Failure: a NaN row for a NaN feature row, and where a face is dark: over some of the faces the
    three sums do not separate. A constant added to all faces pulls the vector towards +z. fit
    raises UnusableDataError where no sample lights all faces.

    Cost: 6 operations per face and one root per sample.

    Examples
    --------
    >>> import numpy as np
    >>> normals = ((0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (-0.6, 0.0, 0.8), (0.0, -0.6, 0.8))
    >>> sun = np.array([[0.0, 0.0, 1.0], [0.28, 0.0, 0.96], [0.0, -0.28, 0.96]])
    >>> signals = 2.5 * sun @ np.array(normals).T
    >>> model = RegularPyramid(normals).fit(signals, sun)
    >>> model.coefficients_.round(3)
    array([0.4, 0.4, 0.4, 0.4])
    >>> model.predict(signals[1:2]).round(3)
    array([[0.28, 0.  , 0.96]])
    """

    about: ClassVar = AboutModel(
        name="pyramidal",
        taxonomy="Pyramidal",
        studies=("Wang2019",),
        labels=("model:pyra", "eq:msfpyra1", "eq:msfpyra2"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    face_normals: Normals
    coefficient: Coefficient = "common"
    dark_fraction: float = 0.01

    coefficients_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        self._normals()
        require_choice(self.about.name, Coefficient, coefficient=self.coefficient)
        require_within(self.about.name, "[0, 1)", dark_fraction=self.dark_fraction)

    def columns(self) -> int:
        """One a face."""
        return len(self.face_normals)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn the measurement coefficients."""
        del context
        normals = self._normals()
        lit = self._all_lit(features)
        require_samples(int(lit.sum()), 1, self.about.name, "with every face lit")
        signals, cosines = features[lit], sun[lit] @ normals.T
        products, squares = (signals * cosines).sum(axis=0), (signals**2).sum(axis=0)
        if self.coefficient == "common":
            coefficients = np.full(len(normals), products.sum() / squares.sum())
        else:
            coefficients = products / squares
        if not (coefficients > 0).all():
            raise UnusableDataError(
                f"{self.about.name}: the lit faces must look towards the Sun; the calibration "
                f"gives coefficients of {coefficients.min():.6g} and more"
            )
        self.coefficients_ = coefficients

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, M)."""
        del context
        signals = np.where(self._all_lit(features)[:, None], features, np.nan)
        rows = [b / (b @ b) * self.coefficients_ for b in self._normals().T]
        return normalise(np.column_stack([row_sums(signals, row) for row in rows]))

    def _all_lit(self, signals: Floats) -> NDArray[np.bool_]:
        least = np.maximum(self.dark_fraction * signals.max(axis=1), 0.0)
        return np.asarray((signals > least[:, None]).all(axis=1))

    def _normals(self) -> Floats:
        """(M, 3) normals, or UnsuitableDesignError unless they are a regular pyramid's."""
        normals = require_normals(self.face_normals, self.about.name)
        up = normals[:, 2]
        turns = np.sort(np.arctan2(normals[:, 1], normals[:, 0]))
        steps = np.diff(turns, append=turns[0] + 2.0 * np.pi)
        level = np.ptp(up) <= UNIT_TOLERANCE < up.min()
        even = np.allclose(steps, 2.0 * np.pi / len(normals), rtol=0, atol=10 * UNIT_TOLERANCE)
        if not (level and even):
            raise UnsuitableDesignError(
                f"{self.about.name} needs the faces of a regular pyramid around +z, equally "
                f"tilted and evenly spaced; got {self.face_normals!r}"
            )
        return normals

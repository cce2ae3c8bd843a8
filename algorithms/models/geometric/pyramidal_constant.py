"""A pyramid of cells free of light that all see alike: two rows and a length of one (Pyramidal)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

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
from algorithms.models.geometric.detector_faces import Normals, row_sums
from algorithms.models.geometric.pyramidal import RegularPyramid


@documented
@dataclass
class SteadyPyramid(FacesModel):
    """Sun vector of a pyramid from two horizontal sums in which constant light cancels.

    The horizontal components of a regular pyramid's normals sum to zero, so light common to all
    faces cancels in x and y. The third component follows from unit length.

    Parameters
    ----------
    face_normals : tuple of M vectors
        Unit normals of the pyramid's faces in the order of the features, M at least 3: tilted from
        +z alike, by less than 90 degrees, and evenly spaced around it, in any order.
    largest_misfit : float
        Positive; how far, in cosines of incidence, a face may be off what the direction and one
        constant explain, and how far the constant below none. Beyond it a face is dark, or the
        interference not constant. The default, ours, is three times what gains leave that differ
        by a few percent.

    Attributes
    ----------
    coefficient_ : float
        xi: cosine of incidence per unit of signal.

    Notes
    -----
    Implements: eq:msfpyra1, eq:msfpyra2 (model:pyra, Wang2019) with their first two rows, ``x = xi
    b_x^T e / b_x^T b_x`` and ``y = xi b_y^T e / b_y^T b_y``, and ``z = sqrt(1 - x^2 - y^2)``: the
    survey says that the model makes up for constant interference, which the printed third row
    carries into z whole (`pyramidal`). The survey prints b_x in all three rows; corrected because
    each row gives its own component. xi counts here, where a common scale drops out of three rows,
    and is learnt from the two rows alone by least squares. So the Sun must be as bright as it was
    then. Equations and failures differ, hence a class of its own beside `pyramidal`.

    Shapes: signals (N, M), in any common unit, to unit vectors (N, 3), those with ``z > 0``.

    Failure: a NaN row for a NaN feature row, outside the hull, where x and y are longer than one,
    and where a face or the constant misfits: where a face is dark, or interference differs from
    face to face. Two dark faces side by side pull the vector towards +z and the constant down with
    hardly a misfit; in strong interference they pass for lit ones. Errors of x and y show in z with
    the tangent of the angle off the boresight. fit raises UnusableDataError where no sample off the
    boresight lights all faces, by the drawing.

    Cost: 8 operations per face and one root per sample.

    Examples
    --------
    >>> import numpy as np
    >>> normals = ((0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (-0.6, 0.0, 0.8), (0.0, -0.6, 0.8))
    >>> sun = np.array([[0.0, 0.0, 1.0], [0.28, 0.0, 0.96], [0.0, -0.28, 0.96]])
    >>> signals = 2.5 * sun @ np.array(normals).T + 0.3
    >>> SteadyPyramid(normals).fit(signals, sun).predict(signals[1:2] + 0.2).round(3)
    array([[0.28, 0.  , 0.96]])
    """

    about: ClassVar = AboutModel(
        name="pyramidal-constant",
        taxonomy="Pyramidal",
        studies=("Wang2019",),
        labels=("model:pyra", "eq:msfpyra1", "eq:msfpyra2"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    face_normals: Normals
    largest_misfit: float = 0.1

    coefficient_: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        try:
            RegularPyramid(self.face_normals)
        except UnsuitableDesignError as refusal:
            raise UnsuitableDesignError(f"{self.about.name}, as {refusal}") from refusal
        if not self.largest_misfit > 0:
            raise ValueError(
                f"{self.about.name}: largest_misfit must be positive; got {self.largest_misfit!r}"
            )

    def columns(self) -> int:
        """One a face."""
        return len(self.face_normals)

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn the measurement coefficient."""
        del context
        lit = (sun @ np.asarray(self.face_normals, dtype=np.float64).T > 0).all(axis=1)
        require_samples(int(lit.sum()), 1, self.about.name, "whose Sun lights every face")
        sums = self._horizontal(features[lit])
        squares = float((sums**2).sum())
        product = float((sums * sun[lit, :2]).sum())
        if not product > 0:
            raise UnusableDataError(
                f"{self.about.name} needs samples off the boresight whose signals lean towards "
                f"the Sun; their product with it is {product:.6g}"
            )
        self.coefficient_ = product / squares

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, M)."""
        del context
        x, y = (self._horizontal(features) * self.coefficient_).T
        with np.errstate(invalid="ignore"):
            z = np.sqrt(1.0 - x * x - y * y)
        mean = row_sums(features, np.ones(self.columns())) / self.columns()
        constant = mean * self.coefficient_ - self.face_normals[0][2] * z
        z[~(constant >= -self.largest_misfit)] = np.nan
        for column, (b_x, b_y, _) in zip(features.T, self.face_normals, strict=True):
            misfit = (column - mean) * self.coefficient_ - (b_x * x + b_y * y)
            z[~(np.abs(misfit) <= self.largest_misfit)] = np.nan
        found = np.stack([x, y, z], axis=1)
        found[~(z > 0)] = np.nan
        return found

    def _horizontal(self, signals: Floats) -> Floats:
        """``b^T e / b^T b`` (N, 2) of the first two components."""
        rows = np.asarray(self.face_normals, dtype=np.float64).T[:2]
        return np.stack([row_sums(signals, b / (b @ b)) for b in rows], axis=1)

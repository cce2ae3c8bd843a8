"""`CalibratedModel`: what every model that learns does alike, around what it learns."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.angles import separation_deg
from algorithms.calibration.hull import Hull
from algorithms.calibration.quality import FitQuality, Parameter, Setting, data_digest
from algorithms.context import Context, as_context, complete
from algorithms.contract import Floats, Model, UnusableDataError
from algorithms.inputs import (
    as_calibration_rows,
    as_feature_rows,
    as_features,
    require_fitted,
    require_samples,
)
from algorithms.row_arithmetic import finite_rows

Columns = Mapping[str, Floats]

#: Rows answered at a time: what they need stays in a core's cache.
_ROWS = 8192
#: Features of a place on a plane.
PLANAR = 2
#: Share of the directions' own spread that residuals may have: a model that leaves more has not
#: found how its features go with the Sun, as with swapped or mirrored axes.
WORST_RESIDUAL = 0.5
#: Residual up to which a drawing, which needs no spread of directions, is not refused (with more it
#: points into another octant), and samples from which it may be.
_LOST_DEG, _FEWEST_LOST = 45.0, 10


@dataclass
class CalibratedModel(Model):
    """A model that learns from calibration samples, refuses too few, and flags answers.

    A subclass is a dataclass that writes `about`, `learn` and `answer`. It gets only rows with
    features; a refused fit leaves the model as it was. Outside the convex hull of what it was
    calibrated on it answers NaN: of the features where there are two, else of the directions.

    Parameters
    ----------
    extrapolation : float
        Allowed extrapolation beyond the calibrated region, as a share of its half width (for
        signals: in radians), at least 0; infinity: unlimited. Half the distance between
        neighbouring poses is always allowed.

    Attributes
    ----------
    quality_ : FitQuality
        Residuals, those of samples held out too, parameters with standard errors, settings chosen.
    hull_ : Hull
        Where answers are given: of the calibrated features where there are two, else the cone of
        the calibrated directions.

    Notes
    -----
    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to unit vectors (N, 3).
    """

    #: Whether the Sun must be in front of the detector (``s_z > 0``).
    frontal: ClassVar[bool] = True
    #: Samples with features below which there is nothing to fit.
    fewest: ClassVar[int] = 1
    #: Whether answers end with the hull; a drawing that learns nothing holds everywhere.
    bounded: ClassVar[bool] = True

    extrapolation: float = field(default=0.0, kw_only=True)

    quality_: FitQuality = field(init=False, repr=False, compare=False)
    hull_: Hull = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if not self.extrapolation >= 0:
            raise ValueError(
                f"{self.about.name}: extrapolation must be 0 or more; got {self.extrapolation!r}"
            )

    def columns(self) -> int:
        """Features of a sample; two unless the subclass says otherwise."""
        return 2

    @abstractmethod
    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Set the fitted attributes; UnusableDataError where the samples do not determine them.

        Parameters
        ----------
        features : ndarray, shape (n, F)
            Finite.
        sun : ndarray, shape (n, 3)
            Unit vectors.
        context : mapping of str to ndarray
            Columns that ``about.context`` names.
        """
        ...

    @abstractmethod
    def answer(self, features: Floats, context: Columns) -> Floats:
        """(N, 3) unit vectors of features (N, F), row by row; NaN rows stay NaN."""
        ...

    def fitted_parameters(self) -> tuple[Parameter, ...]:
        """Parameters with standard errors, once learnt; none by default."""
        return ()

    def condition(self) -> float | None:
        """Condition of the equations solved, once learnt; None by default."""
        return None

    def settings(self) -> Mapping[str, Setting]:
        """Orders and smoothing that the samples chose, once learnt; none by default."""
        return {}

    def validation_rms_deg(self) -> float | None:
        """Error on samples left out, where they chose a setting: `validated_deg_`, or None."""
        found: float | None = getattr(self, "validated_deg_", None)
        return found

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance of a tangent axis that the parameters' errors make, rad^2; 0 by default."""
        del context
        return np.zeros(len(features))

    def fit(self, features: ArrayLike, sun: ArrayLike, context: Context | None = None) -> Self:
        """Learn from features (N, F) of known Suns (N, 3), unit vectors; returns self."""
        found, vectors, usable = as_calibration_rows(
            features, sun, self.columns(), self.about.name, frontal=self.frontal
        )
        require_samples(len(found), self.fewest, self.about.name, "to be calibrated at all")
        columns = as_context(context, self.about.context, len(usable), self.about.name)
        known = complete(columns, len(usable))[usable]
        found, vectors = found[known], vectors[known]
        columns = {name: column[usable][known] for name, column in columns.items()}
        learnt = replace(self)  # a refusal leaves no trace
        learnt.hull_ = self._region(found, vectors)
        learnt.learn(found, vectors, columns)
        learnt.assess(found, vectors, columns)
        vars(self).update(vars(learnt))
        return self

    def assess(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Set `quality_` of what was learnt from these samples.

        Raises
        ------
        UnusableDataError
            If the fitted model explains next to nothing of where the Sun was.
        """
        error = separation_deg(self.answer(features, context), sun)
        answered = error[np.isfinite(error)]
        residual = float(np.sqrt(np.mean(answered**2))) if len(answered) else np.inf
        left_out = self.validation_rms_deg()
        # a drawing needs no samples, so that only many say that it has nothing to do with them
        if np.isfinite(self.extrapolation) and (self.bounded or len(sun) >= _FEWEST_LOST):
            least = 0.0 if self.bounded else _LOST_DEG
            size = residual if left_out is None else left_out
            _require_explained(size, sun, self.about.name, least)
        self.quality_ = FitQuality(
            samples=len(features),
            residual_rms_deg=residual,
            data_digest=data_digest(features, sun, context),
            condition=self.condition(),
            parameters=self.fitted_parameters(),
            settings=dict(self.settings()),
            validation_rms_deg=left_out,
        )

    def _region(self, features: Floats, sun: Floats) -> Hull:
        """Return where answers are given; UnusableDataError where samples span no region."""
        if not self.bounded or np.isinf(self.extrapolation):
            return Hull(np.empty((0, 3)))
        if features.shape[1] == PLANAR:
            return Hull.around(features, self.about.name, self.extrapolation)
        return Hull.of_directions(sun, self.about.name, self.extrapolation)

    def predict(self, features: ArrayLike, context: Context | None = None) -> Floats:
        """Sun unit vectors (N, 3) of features (N, F); NaN rows where undefined."""
        require_fitted(self, "quality_")
        found = as_feature_rows(features, self.columns(), self.about.name)
        columns = as_context(context, self.about.context, len(found), self.about.name)
        untold = ~complete(columns, len(found))
        answers = np.empty((len(found), 3))
        for start in range(0, len(found), _ROWS):
            rows = slice(start, start + _ROWS)
            chunk = finite_rows(found[rows])
            part = self.answer(chunk, {name: columns[name][rows] for name in columns})
            if self.bounded:
                held = self.hull_.holds(chunk if chunk.shape[1] == PLANAR else part)
                if not held.all():
                    part[~held] = np.nan
            answers[rows] = part
        if columns:
            answers[untold] = np.nan
        return answers

    def deviation_deg(self, features: ArrayLike, context: Context | None = None) -> Floats:
        """1-sigma (N,) of each direction's errors along a tangent axis, degrees.

        Of what the calibration leaves: the size of its residuals (of samples left out, where
        there are such) and the standard errors of the parameters.
        """
        directions = self.predict(features, context)
        found = as_features(features, self.columns(), self.about.name)
        columns = as_context(context, self.about.context, len(found), self.about.name)
        size = self.quality_.validation_rms_deg or self.quality_.residual_rms_deg
        variance = self.variance(found, columns) + np.radians(size) ** 2 / 2.0
        variance[~np.isfinite(directions[:, 0])] = np.nan
        return np.asarray(np.degrees(np.sqrt(variance)))


def _require_explained(residual_deg: float, sun: Floats, by: str, least_deg: float) -> None:
    """Raise UnusableDataError where residuals are as large as the directions' own spread.

    Residuals up to `least_deg` are never too large.
    """
    middle = sun.mean(axis=0)
    spread = float(np.degrees(np.sqrt(np.mean(((sun - middle) ** 2).sum(axis=1)))))
    if not residual_deg <= max(WORST_RESIDUAL * spread, least_deg):
        raise UnusableDataError(
            f"{by}: the fit leaves residuals of {residual_deg:.3g} deg where the Sun spread over "
            f"{spread:.3g} deg: features and Suns do not belong together as the model has it; are "
            "the axes swapped or mirrored, or samples out of order?"
        )

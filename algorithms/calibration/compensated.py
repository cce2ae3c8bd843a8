"""`CalibratedCompensation`: what every compensation does alike, around what it takes out."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field, replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.quality import data_digest
from algorithms.context import Context, as_context, complete
from algorithms.contract import Compensation, Floats
from algorithms.inputs import as_calibration_rows, as_features, require_fitted, require_samples


@dataclass
class CalibratedCompensation(Compensation):
    """A compensation that checks what it is given and refuses what does not determine it.

    A subclass is a dataclass that writes `about`, `apply` and, unless its drawing says all,
    `learn`. It gets only rows with features; a refused fit leaves it as it was.

    Attributes
    ----------
    samples_ : int
        Calibration samples with features.
    data_digest_ : str
        Of these samples.
    """

    #: Whether the Sun must be in front of the detector (``s_z > 0``).
    frontal: ClassVar[bool] = True

    samples_: int = field(init=False, repr=False, compare=False)
    data_digest_: str = field(init=False, repr=False, compare=False)

    def columns(self) -> int:
        """Features of a sample; two unless the subclass says otherwise."""
        return 2

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Set the fitted attributes; UnusableDataError where the samples do not determine them.

        By default nothing is learnt: the drawing says all.
        """

    @abstractmethod
    def apply(self, features: Floats, context: Columns) -> Floats:
        """(N, F) features without the effect, row by row; NaN rows stay NaN."""
        ...

    def fit(self, features: ArrayLike, sun: ArrayLike, context: Context | None = None) -> Self:
        """Learn from features (N, F) of known Suns (N, 3), unit vectors; returns self."""
        by = self.about.name
        found, vectors, usable = as_calibration_rows(
            features, sun, self.columns(), by, frontal=self.frontal
        )
        require_samples(len(found), 1, by, "to be calibrated at all")
        columns = as_context(context, self.about.context, len(usable), by)
        known = complete(columns, len(usable))[usable]
        found, vectors = found[known], vectors[known]
        columns = {name: column[usable][known] for name, column in columns.items()}
        learnt = replace(self)  # a refusal leaves no trace
        learnt.learn(found, vectors, columns)
        learnt.samples_ = len(found)
        learnt.data_digest_ = data_digest(found, vectors, columns)
        vars(self).update(vars(learnt))
        return self

    def transform(self, features: ArrayLike, context: Context | None = None) -> Floats:
        """(N, F) features of features (N, F), of the same kind; NaN rows where undefined."""
        require_fitted(self, "data_digest_")
        found = as_features(features, self.columns(), self.about.name)
        columns = as_context(context, self.about.context, len(found), self.about.name)
        found[~complete(columns, len(found))] = np.nan
        given = self.apply(found, columns)
        given[~np.isfinite(given).all(axis=1)] = np.nan
        return given

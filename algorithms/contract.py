"""The contract of extractors, compensations and models; `algorithms.pipeline` puts them together.

Conventions: the Sun is a unit vector ``s`` from the sensor to the Sun, shape (N, 3), +z the
boresight. ``tan(alpha) = s_y/s_z``, ``tan(beta) = s_x/s_z``; a pinhole spot falls at
``X = h tan(beta)``, ``Y = h tan(alpha)``. Pixel centres are integers, order (x, y), x along
columns. Public angles are degrees. A row where nothing is found is NaN.
"""

from __future__ import annotations

import dataclasses
from abc import abstractmethod
from typing import TYPE_CHECKING, Any, ClassVar, Protocol, Self, cast, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.about import (
    About,
    AboutCompensation,
    AboutExtractor,
    AboutModel,
    FeatureKind,
    Observation,
    Origin,
)
from algorithms.context import Context
from algorithms.design import SensorGeometry, UnsuitableDesignError
from algorithms.measurement import Measurement, measurement_of

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

__all__ = [
    "About",
    "AboutCompensation",
    "AboutExtractor",
    "AboutModel",
    "Compensation",
    "Context",
    "Extractor",
    "FeatureKind",
    "Floats",
    "Model",
    "NotFittedError",
    "Observation",
    "Origin",
    "SensorGeometry",
    "UnsuitableDesignError",
    "UnusableDataError",
    "parameters",
]

Floats = NDArray[np.float64]

#: Names of a kind's columns, where they are the same for every sensor.
_COLUMNS = {FeatureKind.SPOT: ("x_px", "y_px"), FeatureKind.BALANCE: ("s_a", "s_b")}


class NotFittedError(ValueError, AttributeError):
    """A model was asked to predict before it was fitted."""


class UnusableDataError(ValueError):
    """Well-formed data that a method cannot work on: too few samples, or on one line.

    What a model's ``fit`` raises for a calibration that does not determine it: a result of method
    and data, as repeatable as a score. Any other error, a ValueError too, is a mistake: of the
    caller (a wrong shape) or of the implementation.
    """


@runtime_checkable
class Extractor(Protocol):
    """Observations in, features out; a frozen dataclass whose fields are its parameters.

    An implementation names this class as its base and writes `about` and `extract`; the other
    members serve it as they stand unless its parameters, columns or covariance are its own.
    """

    about: ClassVar[AboutExtractor]

    @property
    def features(self) -> tuple[str, ...]:
        """Names of the F output columns; by default those of the kind."""
        columns = _COLUMNS.get(self.about.kind)
        if columns is None:
            raise NotImplementedError(
                f"{self.about.name} must name its own columns: {self.about.kind} have no fixed ones"
            )
        return columns

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the extractor with the parameters this sensor's design asks for.

        By default those that the design has under the same names, of what ``about.needs`` names;
        all others are the published method's. UnsuitableDesignError where it does not read sensors
        of this design, or where a field it needs is None.
        """
        return cls(**_drawn(cls, geometry))

    @abstractmethod
    def extract(self, observations: ArrayLike) -> Floats:
        """(N, F) float64; a NaN row where nothing was found. ValueError on wrong input."""
        ...

    def measure(self, observations: ArrayLike, bad: ArrayLike | None = None) -> Measurement:
        """Features as `extract`, their covariance and flags; see `algorithms.measurement`.

        A single sample is a batch of one; `bad`, True for a bad pixel, has one sample's shape.
        """
        return measurement_of(
            self.extract, self.about.observation, self.about.name, observations, bad
        )


@runtime_checkable
class Compensation(Protocol):
    """Features in, features out, freed of an effect that the model behind does not know.

    A stage between extractor and model, calibrated before it. Dataclasses, as models are.
    """

    about: ClassVar[AboutCompensation]

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the unfitted stage for this sensor's design and this kind of features.

        Parameters as `Extractor.for_sensor` has them. UnsuitableDesignError where `kind` is not
        accepted or a field it takes is None.
        """
        cls.about.require_kind(kind)
        return cls(**_drawn(cls, geometry))

    @classmethod
    def design_behind(cls, geometry: SensorGeometry) -> SensorGeometry:
        """Return the design that the stages behind this one are made for: without its effect."""
        return geometry

    @abstractmethod
    def fit(self, features: ArrayLike, sun: ArrayLike, context: Context | None = None) -> Self:
        """Learn from features (N, F) and unit vectors (N, 3); NaN feature rows are left out.

        UnusableDataError where they do not determine it; ValueError on wrong input.
        """
        ...

    @abstractmethod
    def transform(self, features: ArrayLike, context: Context | None = None) -> Floats:
        """(N, F) features of the same kind; NaN rows where undefined. NotFittedError before fit."""
        ...


@runtime_checkable
class Model(Protocol):
    """Features in, Sun unit vectors out. Dataclasses: init fields = parameters, fitted end in _.

    An implementation names this class as its base and writes `about`, `fit` and `predict`;
    `for_sensor` serves as it stands a model that learns all it knows from its calibration. What
    all calibrated models do alike, `algorithms.calibration.CalibratedModel` does for them.
    """

    about: ClassVar[AboutModel]

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the unfitted model for this sensor's design and this kind of features.

        Parameters as `Extractor.for_sensor` has them. UnsuitableDesignError where `kind` is not
        accepted or a field it takes is None.
        """
        cls.about.require_kind(kind)
        return cls(**_drawn(cls, geometry))

    @abstractmethod
    def fit(self, features: ArrayLike, sun: ArrayLike, context: Context | None = None) -> Self:
        """Learn from features (N, F) and unit vectors (N, 3); NaN feature rows are left out.

        `context` holds the columns that ``about.context`` names. UnusableDataError where the
        samples do not determine the model; ValueError on wrong input.
        """
        ...

    @abstractmethod
    def predict(self, features: ArrayLike, context: Context | None = None) -> Floats:
        """(N, 3) unit vectors; NaN rows where undefined. NotFittedError before fit."""
        ...


def _drawn(implementation: Any, geometry: SensorGeometry) -> dict[str, Any]:
    """Return the parameters that the design has under the same names, of those needed."""
    about = implementation.about
    geometry.require(*about.needs, by=about.name)
    given = {field.name for field in dataclasses.fields(implementation) if field.init}
    return {name: getattr(geometry, name) for name in about.needs if name in given}


def parameters(implementation: Extractor | Compensation | Model) -> dict[str, Any]:
    """Return the constructor parameters of an implementation, by name.

    Parameters
    ----------
    implementation : Extractor, Compensation or Model
        Fitted or not.

    Returns
    -------
    dict
        Values by name, in the constructor's order.

    Raises
    ------
    TypeError
        If it is not a dataclass.

    Examples
    --------
    >>> from algorithms.models.geometric.standard_projection import StandardProjection
    >>> parameters(StandardProjection(focal_length_mm=2.0, unit_mm=0.01))
    {'extrapolation': 0.0, 'focal_length_mm': 2.0, 'unit_mm': 0.01, 'centre': (0.0, 0.0)}
    """
    # The protocols are structural: that an implementation is a dataclass, only running it shows.
    fields = dataclasses.fields(cast("DataclassInstance", implementation))
    return {field.name: getattr(implementation, field.name) for field in fields if field.init}

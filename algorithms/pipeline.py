"""Extractor, compensations and model put together: what is scored, and what a user calls.

The stages meet in features (N, F), float64. To calibrate several models on what one extractor
found, extract once with `extract_features` and hand the features to each pipeline's `fit_features`
and `predict_features`.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Self, cast

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import (
    Compensation,
    Context,
    Extractor,
    FeatureKind,
    Floats,
    Model,
    NotFittedError,
    SensorGeometry,
)


@dataclass
class Pipeline:
    """An extractor, compensations and a model: what a study resolves to, and what is scored.

    Calibrated once on observations of known Suns, it turns others into directions. Each stage is
    fitted to what the stages before it leave.

    Parameters
    ----------
    extractor : Extractor
        Made for the sensor (`for_sensor`).
    model : Model
        Fitted or not; it must accept the extractor's kind of features.
    compensations : tuple of Compensation
        In the order they are applied, each of the extractor's kind of features.

    Raises
    ------
    ValueError
        If a stage does not accept the extractor's kind of features.

    Examples
    --------
    >>> from algorithms.extractors.frames.centroid import BasicCentroid
    >>> from algorithms.models.geometric.standard_projection import StandardProjection
    >>> design = SensorGeometry(focal_length_mm=2.0, pixel_pitch_mm=1.0, centre_px=(2.0, 2.0))
    >>> pipeline = Pipeline.for_sensor(BasicCentroid, StandardProjection, design)
    >>> frame = np.zeros((1, 5, 5))
    >>> frame[0, 2, 2] = 1.0
    >>> pipeline = pipeline.fit(frame, [[0.0, 0.0, 1.0]])
    >>> pipeline.predict(np.roll(frame, 2, axis=2)).round(3)  # 2 px of 1 mm, 2 mm from the hole
    array([[0.707, 0.   , 0.707]])
    """

    extractor: Extractor
    model: Model
    compensations: tuple[Compensation, ...] = ()

    def __post_init__(self) -> None:
        extractor = self.extractor.about
        for stage in self.stages:
            if extractor.kind not in stage.about.accepts:
                what = "model" if stage is self.model else "compensation"
                raise ValueError(
                    f"{what} {stage.about.name} accepts {sorted(stage.about.accepts)} features; "
                    f"extractor {extractor.name} gives {extractor.kind}"
                )

    @classmethod
    def for_sensor(
        cls,
        extractor: type[Extractor],
        model: type[Model],
        geometry: SensorGeometry,
        compensations: Sequence[type[Compensation]] = (),
    ) -> Self:
        """All parts with the parameters this sensor's design asks for."""
        kind = extractor.about.kind
        stages, behind = make_stages(compensations, geometry, kind)
        return cls(extractor.for_sensor(geometry), model.for_sensor(behind, kind), stages)

    @property
    def stages(self) -> tuple[Compensation | Model, ...]:
        """Compensations and model, in the order they are applied."""
        return (*self.compensations, self.model)

    @property
    def name(self) -> str:
        """Names of compensations and model, such as ``"optical + polynomial-2d"``."""
        return " + ".join(stage.about.name for stage in self.stages)

    @property
    def context(self) -> tuple[str, ...]:
        """Columns that its stages read beside the features, sorted."""
        return tuple(sorted({name for stage in self.stages for name in stage.about.context}))

    def with_model(self, model: Model) -> Self:
        """Return the pipeline with another model behind the same extractor."""
        return replace(self, model=model)

    def features(self, observations: ArrayLike, origin_px: ArrayLike | None = None) -> Floats:
        """Features (N, F) as `extract_features` gives them."""
        return extract_features(self.extractor, observations, origin_px)

    def fit(
        self,
        observations: ArrayLike,
        sun: ArrayLike,
        origin_px: ArrayLike | None = None,
        context: Context | None = None,
    ) -> Self:
        """Fit all stages to observations of known Suns (N, 3), unit vectors; returns self."""
        return self.fit_features(self.features(observations, origin_px), sun, context)

    def predict(
        self,
        observations: ArrayLike,
        origin_px: ArrayLike | None = None,
        context: Context | None = None,
    ) -> Floats:
        """Sun unit vectors (N, 3); NaN rows where undefined."""
        return self.predict_features(self.features(observations, origin_px), context)

    def fit_features(
        self, features: ArrayLike, sun: ArrayLike, context: Context | None = None
    ) -> Self:
        """`fit` from where features (N, F) are known."""
        for stage in self.compensations:
            features = stage.fit(features, sun, context).transform(features, context)
        self.model.fit(features, sun, context)
        return self

    def predict_features(self, features: ArrayLike, context: Context | None = None) -> Floats:
        """`predict` from where features (N, F) are known."""
        for stage in self.compensations:
            features = stage.transform(features, context)
        return self.model.predict(features, context)

    def require_fitted(self) -> None:
        """Raise NotFittedError unless every stage has been fitted."""
        for stage in self.stages:
            fitted = [f.name for f in dataclasses.fields(cast("Any", stage)) if not f.init]
            if not all(hasattr(stage, name) for name in fitted):
                raise NotFittedError(f"{stage.about.name} is not fitted yet; call fit first")


def make_stages(
    compensations: Sequence[type[Compensation]], geometry: SensorGeometry, kind: FeatureKind
) -> tuple[tuple[Compensation, ...], SensorGeometry]:
    """Make compensations for a sensor, each for the design that those before it leave.

    Parameters
    ----------
    compensations : sequence of class
        In the order they are applied.
    geometry : SensorGeometry
        Of the sensor.
    kind : FeatureKind
        What the extractor gives.

    Returns
    -------
    tuple
        The stages unfitted, and the design that the model behind them is made for.

    Raises
    ------
    UnsuitableDesignError
        Where one does not suit the sensor.

    Examples
    --------
    >>> from algorithms.compensations.optics.refraction import Refraction
    >>> design = SensorGeometry(
    ...     focal_length_mm=2.0, aperture_width_mm=1.0, cover_glass=((0.5, 1.5),)
    ... )
    >>> (glass,), behind = make_stages((Refraction,), design, FeatureKind.BALANCE)
    >>> glass.layers, behind.cover_glass
    (((0.5, 1.5),), None)
    """
    stages: list[Compensation] = []
    for compensation in compensations:
        stages.append(compensation.for_sensor(geometry, kind))
        geometry = compensation.design_behind(geometry)
    return tuple(stages), geometry


def extract_features(
    extractor: Extractor, observations: ArrayLike, origin_px: ArrayLike | None = None
) -> Floats:
    """Features of observations, checked, in detector coordinates.

    Parameters
    ----------
    extractor : Extractor
        Made for the sensor.
    observations : array_like
        Batch of N in the shape of the extractor's kind of observation.
    origin_px : array_like, shape (N, 2), optional
        Detector coordinates of the first pixel of each window, px; spots are moved by them, so
        that windows of a large detector are read in detector coordinates.

    Returns
    -------
    ndarray, shape (N, F)
        Every row is finite, or NaN throughout where nothing was found.

    Raises
    ------
    ValueError
        If the observations are not what the extractor reads, if `origin_px` has another shape
        than spots need, or if the extractor breaks its contract (`check_features`).

    Examples
    --------
    >>> from algorithms.extractors.frames.centroid import BasicCentroid
    >>> frames = [[[0, 0], [0, 7]], [[0, 0], [0, 0]]]
    >>> extract_features(BasicCentroid(), frames, [[10, 20], [10, 20]])
    array([[11., 21.],
           [nan, nan]])
    """
    features = check_features(
        extractor, extractor.extract(observations), len(np.asarray(observations))
    )
    return in_detector_coordinates(features, extractor.about.kind, origin_px)


def check_features(extractor: Extractor, features: Floats, count: int) -> Floats:
    """Hold what an extractor gave for `count` observations to its contract.

    Parameters
    ----------
    extractor : Extractor
        Whose features they are.
    features : ndarray, shape (count, F)
        What it gave.
    count : int
        Observations it was given.

    Returns
    -------
    ndarray, shape (count, F)
        Rows that are not finite throughout are NaN throughout.

    Raises
    ------
    ValueError
        If they are not float64 of this shape.

    Examples
    --------
    >>> from algorithms.extractors.frames.centroid import BasicCentroid
    >>> check_features(BasicCentroid(), np.zeros((3, 4)), 3)
    Traceback (most recent call last):
    ValueError: bcm must give float64 features of shape (3, 2); got float64 (3, 4)
    """
    expected = (count, len(extractor.features))
    if features.shape != expected or features.dtype != np.float64:
        raise ValueError(
            f"{extractor.about.name} must give float64 features of shape {expected}; "
            f"got {features.dtype} {features.shape}"
        )
    finite = np.isfinite(features).all(axis=1, keepdims=True)
    return features if finite.all() else np.where(finite, features, np.nan)


def in_detector_coordinates(
    features: Floats, kind: FeatureKind, origin_px: ArrayLike | None
) -> Floats:
    """Spots, one or many, moved by their windows' origins; other kinds of features unchanged.

    Parameters
    ----------
    features : ndarray, shape (N, F)
        Of one window each.
    kind : FeatureKind
        What they are.
    origin_px : array_like, shape (N, 2), optional
        Detector coordinates of each window's first pixel, px.

    Returns
    -------
    ndarray, shape (N, F)
        In detector coordinates.

    Raises
    ------
    ValueError
        If there are not as many origins as spots.

    Examples
    --------
    >>> in_detector_coordinates(np.array([[1.5, 2.0]]), FeatureKind.SPOT, [[100, 200]])
    array([[101.5, 202. ]])
    """
    if origin_px is None or kind not in {FeatureKind.SPOT, FeatureKind.SPOTS}:
        return features
    origin = np.asarray(origin_px, dtype=np.float64)
    if origin.shape != (len(features), 2):
        raise ValueError(f"origin_px must have shape {(len(features), 2)}; got {origin.shape}")
    if kind is FeatureKind.SPOT:
        return features + origin
    moved = features.reshape(len(features), -1, 3).copy()
    moved[:, :, :2] += np.where(moved[:, :, 2:] > 0, origin[:, None], 0.0)
    return moved.reshape(features.shape)

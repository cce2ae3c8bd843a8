"""An extractor and a model put together: what is scored, and what a user calls.

The stages meet in features (N, F), float64. To calibrate several models on what one extractor
found, extract once with `extracted` and hand the features to each pipeline's `fit_features` and
`predict_features`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import Extractor, FeatureKind, Floats, Model, SensorGeometry


@dataclass
class Pipeline:
    """An extractor and a model: what a study resolves to, and what is scored.

    Parameters
    ----------
    extractor : Extractor
    model : Model
        Fitted or not; it must accept the extractor's kind of features.

    Raises
    ------
    ValueError
        If the model does not accept the extractor's kind of features.
    """

    extractor: Extractor
    model: Model

    def __post_init__(self) -> None:
        extractor, model = self.extractor.about, self.model.about
        if extractor.kind not in model.accepts:
            raise ValueError(
                f"model {model.name} accepts {sorted(model.accepts)} features; "
                f"extractor {extractor.name} gives {extractor.kind}"
            )

    @classmethod
    def for_sensor(
        cls, extractor: type[Extractor], model: type[Model], geometry: SensorGeometry
    ) -> Self:
        """Both parts with the parameters this sensor's design asks for."""
        return cls(extractor.for_sensor(geometry), model.for_sensor(geometry, extractor.about.kind))

    def with_model(self, model: Model) -> Self:
        """Return the pipeline with another model behind the same extractor."""
        return replace(self, model=model)

    def features(self, observations: ArrayLike, origin_px: ArrayLike | None = None) -> Floats:
        """Features (N, F) as `extracted` gives them."""
        return extracted(self.extractor, observations, origin_px)

    def fit(
        self, observations: ArrayLike, sun: ArrayLike, origin_px: ArrayLike | None = None
    ) -> Self:
        """Fit the model to observations of known Suns (N, 3), unit vectors; returns self."""
        return self.fit_features(self.features(observations, origin_px), sun)

    def predict(self, observations: ArrayLike, origin_px: ArrayLike | None = None) -> Floats:
        """Sun unit vectors (N, 3); NaN rows where undefined."""
        return self.predict_features(self.features(observations, origin_px))

    def fit_features(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """`fit` from where features (N, F) are known."""
        self.model.fit(features, sun)
        return self

    def predict_features(self, features: ArrayLike) -> Floats:
        """`predict` from where features (N, F) are known."""
        return self.model.predict(features)


def extracted(
    extractor: Extractor, observations: ArrayLike, origin_px: ArrayLike | None = None
) -> Floats:
    """Features of observations, checked, in detector coordinates.

    Parameters
    ----------
    extractor : Extractor
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
        than spots need, or if the extractor breaks its contract (`checked`).
    """
    features = checked(extractor, extractor.extract(observations), len(np.asarray(observations)))
    return in_detector_coordinates(features, extractor.about.kind, origin_px)


def checked(extractor: Extractor, features: Floats, count: int) -> Floats:
    """Hold what an extractor gave for `count` observations to its contract.

    Returns
    -------
    ndarray, shape (count, F)
        Rows that are not finite throughout are NaN throughout.

    Raises
    ------
    ValueError
        If they are not float64 of this shape.
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
    """Spot features (N, 2) moved by their windows' origins (N, 2); other kinds unchanged."""
    if origin_px is None or kind is not FeatureKind.SPOT:
        return features
    origin = np.asarray(origin_px, dtype=np.float64)
    if origin.shape != features.shape:
        raise ValueError(f"origin_px must have shape {features.shape}; got {origin.shape}")
    return features + origin

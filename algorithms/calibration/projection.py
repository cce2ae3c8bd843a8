"""`ProjectionModel`: a model of one spot's place that starts from the drawing's projection."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from algorithms.calibration.calibrated import CalibratedModel
from algorithms.contract import FeatureKind, Floats, SensorGeometry
from algorithms.models.nominal_projection import (
    nominal_projection,
    nominal_tangents,
    require_projection,
)


@dataclass
class ProjectionModel(CalibratedModel):
    """A model of spots or balances with the drawing's focal length, unit and centre."""

    focal_length_mm: float
    unit_mm: float
    centre: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_projection(self.about.name, self.focal_length_mm, self.unit_mm, self.centre)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model that starts from the sensor's drawing."""
        return cls(**nominal_projection(geometry, kind, cls.about))

    def nominal_deg(self, features: Floats) -> Floats:
        """Angles (N, 2), alpha and beta in degrees, of features (N, 2) by the drawing."""
        tangents = nominal_tangents(features, self.focal_length_mm, self.unit_mm, self.centre)
        return np.degrees(np.arctan(tangents))

"""Calibrated models of faces, which answer where their calibration's answers lie."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.calibration.hull import Hull
from algorithms.contract import FeatureKind, Floats, SensorGeometry, UnsuitableDesignError
from algorithms.models.geometric.detector_faces import Normals, require_square_pairs

MAX_SIGNALS = 8
"""More have too many products (165 of ten signals are of the third degree) and weights."""

FEWEST_LIT = 8
"""Samples that light a panel below which its opposite speaks for it."""


@dataclass
class FacesModel(CalibratedModel):
    """A model that reads one signal a face, whatever the Sun's side.

    Its region is the cone of the directions that it gives for the calibration samples, not of
    those that are true: a model whose response is not quite the sensor's would else leave the
    rim of its own calibration unanswered.

    Attributes
    ----------
    hull_ : Hull
        Cone of the directions it gives for the calibration.

    Notes
    -----
    Shapes: signals (N, K), in any common unit, to unit vectors (N, 3), all directions.
    """

    frontal: ClassVar[bool] = False

    def assess(self, features: Floats, sun: Floats, context: Columns) -> None:
        """As `CalibratedModel`, then set `hull_` around the answers to these samples."""
        super().assess(features, sun, context)
        if self.bounded and np.isfinite(self.extrapolation):
            found = self.answer(features, context)
            found = found[np.isfinite(found).all(axis=1)]
            self.hull_ = Hull.of_directions(found, self.about.name, self.extrapolation)


@dataclass
class SignalsModel(FacesModel):
    """A model of faces that reads all signals together and need not know where faces look.

    Parameters
    ----------
    signals : int
        Detectors K, 2 to 8.
    """

    signals: int

    fewest: ClassVar[int] = 4

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 2 <= self.signals <= MAX_SIGNALS:
            raise UnsuitableDesignError(
                f"{self.about.name} reads 2 to {MAX_SIGNALS} signals; got {self.signals!r}"
            )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model of the sensor's detectors; UnsuitableDesignError past eight."""
        cls.about.require_kind(kind)
        geometry.require("face_normals", by=cls.about.name)
        return cls(signals=len(geometry.face_normals or ()))

    def columns(self) -> int:
        """One a detector."""
        return self.signals


@dataclass
class SquarePanelsModel(FacesModel):
    """A model of three pairs of opposite panels, square to each other.

    Parameters
    ----------
    face_normals : tuple of six vectors
        Unit normals of the panels in the order of the features: three pairs of opposite ones,
        the pairs square to each other, in any order and turned any way.
    """

    face_normals: Normals

    fewest: ClassVar[int] = FEWEST_LIT

    def __post_init__(self) -> None:
        super().__post_init__()
        require_square_pairs(self.face_normals, self.about.name)

    def columns(self) -> int:
        """Six panels."""
        return 6

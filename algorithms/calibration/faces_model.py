"""`FacesModel`: a calibrated model of faces, which answers where its calibration's answers lie."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.calibration.hull import Hull
from algorithms.contract import Floats


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

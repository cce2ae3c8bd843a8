"""`DrawnModel`: a model that is its drawing, and learns nothing from calibration samples."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from algorithms.calibration.calibrated import CalibratedModel, Columns
from algorithms.contract import Floats


@dataclass
class DrawnModel(CalibratedModel):
    """A model of the drawing alone: ``fit`` checks its input and finds how far off it is.

    Parameters
    ----------
    extrapolation : float
        As `CalibratedModel` has it; a drawing holds everywhere, whatever was calibrated.

    Attributes
    ----------
    quality_ : FitQuality
        How many calibration samples there were, and how far off the drawing is.
    hull_ : Hull
        Without sides.
    """

    bounded: ClassVar[bool] = False

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn nothing: the drawing is all there is."""

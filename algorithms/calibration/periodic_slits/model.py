"""`PeriodicSlitModel`: slits on a raster over two lines of pixels, read together."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.periodic_slits.pattern_fit import Raster, raster, spots_of
from algorithms.contract import Floats
from algorithms.models.geometric.single_slit import DeflectedSlits
from algorithms.parameters import require_positive, require_within


@dataclass
class PeriodicSlitModel(DeflectedSlits):
    """A model of the assembly of equal slits that are read together.

    Parameters
    ----------
    smallest_contrast : float
        Smallest contrast of the pattern that is accepted, in [0, 1); light without a pattern has a
        contrast of 0.

    Attributes
    ----------
    vector_ : ndarray, shape (10,)
        Of the assembly, as of the slit model: focal length, deflection and inclination of each
        line, mm and degrees; centre (x, y) in px; tilts about x and y in degrees.

    Notes
    -----
    Shapes: signals (N, 2 L), the light of L pixels of one line and then the other, in any unit,
    to unit vectors (N, 3).
    """

    line_pixels: int = field(kw_only=True)
    smallest_contrast: float = field(default=0.05, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self.about.name, line_pixels=self.line_pixels)
        require_within(self.about.name, "[0, 1)", smallest_contrast=self.smallest_contrast)

    @abstractmethod
    def read(self, lines: Floats, found: Raster, middle: float, shifts: Floats) -> None:
        """Write into `shifts` (M,) the pattern's, px, on lines (M, L) whose middle is given."""
        ...

    def raster(self) -> Raster:
        """Return the slits' raster; UnsuitableDesignError where they have none."""
        return raster(self.slits, self.pixel_pitch_mm, self.about.name)

    def columns(self) -> int:
        """Pixels of both lines."""
        return 2 * self.line_pixels

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit the assembly to the shifts of the pattern."""
        spots = self.spots(features)
        seen = np.isfinite(spots[:, 0])
        super().learn(spots[seen], sun[seen], context)

    def answer(self, features: Floats, context: Columns) -> Floats:
        """(N, 3) unit vectors of signals (N, 2 L)."""
        return super().answer(self.spots(features), context)

    def variance(self, features: Floats, context: Columns) -> Floats:
        """(N,) variance of a tangent axis that the assembly's errors make, rad^2."""
        return super().variance(self.spots(features), context)

    def spots(self, features: Floats) -> Floats:
        """(N, 2) px of the pattern's middle in signals (N, 2 L); NaN where it is not seen."""
        lines = np.ascontiguousarray(features).reshape(-1, self.line_pixels)
        middle = (self.line_pixels - 1) / 2.0
        shifts = np.empty(len(lines))
        self.read(lines, self.raster(), middle, shifts)
        return spots_of(shifts.reshape(-1, 2), self.line_axes, middle)

"""`DialModel`: a calibrated model of two code dials."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from algorithms.calibration.calibrated import CalibratedModel
from algorithms.contract import FeatureKind, SensorGeometry
from algorithms.models.multiplex.dial_code import Axes, DialCode, dial_code


@dataclass
class DialModel(CalibratedModel):
    """A model of two equal code dials, one along each axis.

    Parameters
    ----------
    bits : int
        Coarse tracks of each dial, in [1, 16].
    cell_mm : float
        Length of a Gray cell, positive, below `period_mm`.
    period_mm : float
        Period of the fine rows.
    focal_length_mm : float
        Nominal distance from the slit to the dials, positive.
    axes : tuple of {"x", "y"}
        Detector axis along which each dial lies, in the order of the features.
    smallest_contrast : float
        Smallest contrast (amplitude over mean) of the fine rows that is accepted, in [0, 1). A slit
        of half a period has a contrast of 2/pi, light without a pattern 0.

    Notes
    -----
    Shapes: signals (N, 2 (bits + 4)), a dial's coarse tracks and then F1 to F4, in any common
    unit, to unit vectors (N, 3).
    """

    bits: int
    cell_mm: float
    period_mm: float
    focal_length_mm: float
    axes: Axes = ("x", "y")
    smallest_contrast: float = 0.2

    def __post_init__(self) -> None:
        super().__post_init__()
        self.code.require(self.about.name)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model of the sensor's dials; UnsuitableDesignError where it has none."""
        return cls(**dial_code(geometry, kind, cls.about))

    @property
    def code(self) -> DialCode:
        """How the dials are read."""
        return DialCode(
            self.bits,
            self.cell_mm,
            self.period_mm,
            self.focal_length_mm,
            self.axes,
            self.smallest_contrast,
        )

    def columns(self) -> int:
        """Coarse and fine tracks of both dials."""
        return self.code.columns

"""The shadow that a thick mask throws into its own aperture (ICM/Shadow)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.contract import (
    AboutCompensation,
    FeatureKind,
    Floats,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.documented import documented
from algorithms.models.nominal_projection import (
    POSITIONS,
    nominal_projection,
    require_projection,
)
from algorithms.parameters import require_positive


@documented
@dataclass
class MaskShadow(CalibratedCompensation):
    """Spots of a thick mask converted to those of a thin mask.

    Light passes where the projections of the two faces of the mask overlap. The middle of the
    overlap is the mean of both, so the spot moves as if a thin aperture were in the middle of the
    mask. Beyond the angle at which they part, nothing passes.

    Parameters
    ----------
    focal_length_mm : float
        Distance h from the mask's lower face to the detector, positive.
    thickness_mm : float
        Of the mask, positive.
    aperture_mm : float
        Its aperture's diameter d, positive.
    drawn_mm : float, optional
        Focal length of the next model, positive: that of the thin mask to which the spots are
        converted. The lower face's where None.

    Notes
    -----
    Implements: eq:shadcomp (model:shad, Antonello2018) with the elevation e: ``R_C0 = (t + h)
    tan(pi/2 - e)``, ``R_C1 = h tan(pi/2 - e)``, the spot's centre their mean. The survey prints
    the distance of the arcs' centres as ``h tan(pi/2 - alpha)``; corrected because it is ``R_C0 -
    R_C1 = t tan(pi/2 - e)``. Features come out as of a mask without thickness at ``drawn_mm``:
    multiplied by ``drawn_mm / (h + t / 2)``. For a centroid that weighs parallel light evenly this
    is exact. Drawn from the mask's middle, as `SensorGeometry` is, the factor is one, and all that
    remains is a NaN row where no light passes. `pinhole-shadow` corrects what spot finders other
    than a centroid leave, `slit-shadow` the light that balances lose.

    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to the same.

    Failure: a NaN row for a NaN feature row, and where ``t tan(theta)`` reaches d.

    Cost: 10 operations per sample.

    Examples
    --------
    >>> mask = MaskShadow(focal_length_mm=2.0, unit_mm=1.0, thickness_mm=0.2, aperture_mm=0.4)
    >>> mask.fit([[1.05, 0.0]], [[0.0, 0.0, 1.0]]).transform([[1.05, 0.0], [4.5, 0.0]]).round(6)
    array([[ 1.,  0.],
           [nan, nan]])
    """

    about: ClassVar = AboutCompensation(
        name="shadow",
        taxonomy="ICM/Shadow",
        studies=("Antonello2018",),
        labels=("model:shad", "eq:shadcomp"),
        origin="survey",
        version=2,
        needs=("focal_length_mm", "mask_thickness_mm", "aperture_width_mm"),
        accepts=POSITIONS,
        ahead_of=("spm",),
    )

    focal_length_mm: float
    unit_mm: float
    thickness_mm: float
    aperture_mm: float
    centre: tuple[float, float] = (0.0, 0.0)
    drawn_mm: float | None = None

    def __post_init__(self) -> None:
        by = self.about.name
        require_projection(by, self.focal_length_mm, self.unit_mm, self.centre)
        require_positive(by, thickness_mm=self.thickness_mm, aperture_mm=self.aperture_mm)
        if self.drawn_mm is not None:
            require_positive(by, drawn_mm=self.drawn_mm)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the compensation of the sensor's mask, whose middle the drawing counts from.

        Spots come out for the drawing's own distance, which models behind divide by.
        UnsuitableDesignError where the mask has no thickness.
        """
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        drawn = nominal_projection(geometry, kind, cls.about)
        thickness = geometry.mask_thickness_mm or 0.0
        if thickness == 0.0:
            raise UnsuitableDesignError(
                f"{cls.about.name} needs a mask that has a thickness; got 0"
            )
        return cls(
            focal_length_mm=drawn["focal_length_mm"] - thickness / 2.0,
            unit_mm=drawn["unit_mm"],
            thickness_mm=thickness,
            aperture_mm=geometry.aperture_width_mm or 0.0,
            centre=drawn["centre"],
            drawn_mm=drawn["focal_length_mm"],
        )

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Spots (N, 2) as of a mask without thickness at the drawn distance."""
        del context
        moved = (features - np.asarray(self.centre)) * self.unit_mm
        middle = self.focal_length_mm + self.thickness_mm / 2.0
        tangent = np.sqrt(moved[:, 0] ** 2 + moved[:, 1] ** 2) / middle
        dark = ~(self.thickness_mm * tangent < self.aperture_mm)
        drawn = self.focal_length_mm if self.drawn_mm is None else self.drawn_mm
        found = moved * (drawn / middle) / self.unit_mm + np.asarray(self.centre)
        found[dark] = np.nan
        return np.asarray(found)

"""The Sun is a disc: where the middle of its spot's outline falls (SECM/Solar)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.contract import AboutCompensation, FeatureKind, Floats, SensorGeometry
from algorithms.documented import documented
from algorithms.models.nominal_projection import (
    nominal_projection,
    require_projection,
)
from algorithms.parameters import require_within

ITERATIONS = 4
"""Fixed-point steps; each leaves the square of the disc's radius of what was left."""


@documented
@dataclass
class SolarDiscBias(CalibratedCompensation):
    """Centres of spot outlines corrected for the size of the solar disc.

    Rays from the two limbs of the Sun are not parallel, so away from the boresight the middle of a
    spot's outline is not at the ray of the Sun's centre; the difference is 0.002 degrees at 60
    degrees.

    Parameters
    ----------
    focal_length_mm : float
        Distance h from mask to detector, positive.

    Notes
    -----
    Implements: model:solar (Antonello2018), described in words: light that is not parallel alters
    the spot's shape and moves its centre. With the limbs at ``theta +- rho`` the outline's middle
    is ``h (tan(theta + rho) + tan(theta - rho)) / 2 = h t (1 + r^2) / (1 - r^2 t^2)``, t =
    tan(theta), r = tan(rho), solved for t. It holds for methods that find outlines (circles,
    thresholds). A centroid weighted by light is not moved at all: the disc's rays pass the
    aperture in proportion to their cosines, and the mean of their tangents with that weight is the
    centre's own.

    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to the same.

    Failure: a NaN row for a NaN feature row.

    Cost: 30 operations per sample.

    Examples
    --------
    >>> import numpy as np
    >>> disc = SolarDiscBias(focal_length_mm=1.0, unit_mm=1.0, disc_deg=2.0)
    >>> middle = (np.tan(np.radians(61.0)) + np.tan(np.radians(59.0))) / 2
    >>> found = disc.fit([[middle, 0.0]], [[0.0, 0.0, 1.0]]).transform([[middle, 0.0]])
    >>> np.degrees(np.arctan(found[0])).round(6)
    array([60.,  0.])
    """

    about: ClassVar = AboutCompensation(
        name="solar-disc",
        taxonomy="SECM/Solar",
        studies=("Antonello2018",),
        labels=("model:solar",),
        origin="survey",
        needs=("focal_length_mm",),
        accepts=frozenset({FeatureKind.SPOT}),
        ahead_of=("spm",),
    )

    focal_length_mm: float
    unit_mm: float
    centre: tuple[float, float] = (0.0, 0.0)
    disc_deg: float = 0.533

    def __post_init__(self) -> None:
        require_projection(self.about.name, self.focal_length_mm, self.unit_mm, self.centre)
        require_within(self.about.name, "(0, 10)", disc_deg=self.disc_deg)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the compensation for the sensor's drawing and the Sun seen from the Earth."""
        return cls(**nominal_projection(geometry, kind, cls.about))

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Spots (N, 2) of the Sun's centre."""
        del context
        square = float(np.tan(np.radians(self.disc_deg / 2.0))) ** 2
        moved = (features - np.asarray(self.centre)) * (self.unit_mm / self.focal_length_mm)
        middle = moved[:, 0] ** 2 + moved[:, 1] ** 2
        share = np.full_like(middle, 1.0)
        for _ in range(ITERATIONS):
            share = (1.0 - square * middle * share**2) / (1.0 + square)
        scale = self.focal_length_mm / self.unit_mm
        return np.asarray(moved * share[:, None] * scale + np.asarray(self.centre))

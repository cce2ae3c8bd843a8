"""Refraction in the plates between mask and detector, undone ray by ray (OCM)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.contract import (
    AboutCompensation,
    FeatureKind,
    Floats,
    SensorGeometry,
)
from algorithms.documented import documented
from algorithms.models.nominal_projection import (
    POSITIONS,
    nominal_projection,
    require_projection,
)

ITERATIONS = 30
"""Newton's steps towards a ray; they rise to it, and five are usual."""

#: Largest tangent of a ray looked for; beyond, there is none.
_FLATTEST = 1e9
#: Distance to the spot, over the spot's own, from which on a ray is found.
_FOUND = 1e-12


@documented
@dataclass
class Refraction(CalibratedCompensation):
    """Spots corrected for refraction in glass between mask and detector.

    A plate refracts light towards its normal, so that spots fall short of ``h tan(theta)``, the
    more so the larger the angle: at 60 degrees by a quarter of the plate's thickness. The angle is
    found from the spot by iteration, for any number of layers.

    Parameters
    ----------
    focal_length_mm : float
        Distance h from mask to detector, glass included, positive.
    layers : tuple of (float, float)
        Thickness mm, positive, and refractive index, at least 1, of each plate.

    Notes
    -----
    Implements: eq:refcomp1, eq:refcomp3 (model:optic, Wei2011): with t = tan(theta), the spot
    falls at ``l = (h - sum d_i) t + sum d_i tan(arcsin(sin(theta) / n_i))``, solved for theta by
    iteration; ``k = h t / l`` brings it to where it would be without glass. In the survey n_1 is
    vacuum, n_2 and n_3 the layers. Newton's steps take the place of the study's own iteration.

    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to the same.

    Failure: a NaN row for a NaN feature row, and for a spot farther out than any ray falls through
    plates that fill the whole distance.

    Cost: five steps of 15 operations per layer and a sample.

    Examples
    --------
    >>> import numpy as np
    >>> glass = Refraction(focal_length_mm=2.0, unit_mm=1.0, layers=((1.0, 1.5),))
    >>> spot = 1.0 * np.tan(np.radians(60)) + 1.0 * np.tan(np.arcsin(np.sin(np.radians(60)) / 1.5))
    >>> found = glass.fit([[spot, 0.0]], [[0.0, 0.0, 1.0]]).transform([[spot, 0.0]])
    >>> np.degrees(np.arctan(found / 2.0)).round(6)
    array([[60.,  0.]])
    """

    about: ClassVar = AboutCompensation(
        name="optical",
        taxonomy="OCM",
        studies=("Wei2011",),
        labels=("model:optic", "eq:refcomp1", "eq:refcomp3"),
        origin="survey",
        needs=("focal_length_mm", "cover_glass"),
        accepts=POSITIONS,
        ahead_of=(
            "spm",
            "lsq",
            "polynomial-2d",
        ),
    )

    focal_length_mm: float
    unit_mm: float
    centre: tuple[float, float] = (0.0, 0.0)
    layers: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        by = self.about.name
        require_projection(by, self.focal_length_mm, self.unit_mm, self.centre)
        for layer in self.layers:
            if not (np.shape(layer) == (2,) and layer[0] > 0 and layer[1] >= 1):
                raise ValueError(
                    f"{by}: layers must be positive thicknesses with indices of at least 1; "
                    f"got {layer!r}"
                )
        if not sum(thickness for thickness, _ in self.layers) <= self.focal_length_mm:
            raise ValueError(
                f"{by}: layers must fit into focal_length_mm {self.focal_length_mm!r}; "
                f"got {self.layers!r}"
            )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the compensation of the sensor's cover glass."""
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        return cls(
            **nominal_projection(geometry, kind, cls.about), layers=geometry.cover_glass or ()
        )

    @classmethod
    def design_behind(cls, geometry: SensorGeometry) -> SensorGeometry:
        """Return the design without glass, so that no model behind refracts once more."""
        return replace(geometry, cover_glass=None)

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Spots (N, 2) where they would be without glass."""
        del context
        moved = (features - np.asarray(self.centre)) * self.unit_mm
        fallen = np.sqrt(moved[:, 0] ** 2 + moved[:, 1] ** 2)
        gap = self.focal_length_mm - sum(thickness for thickness, _ in self.layers)
        paraxial = gap + sum(thickness / index for thickness, index in self.layers)
        # the curve of places is concave: from the paraxial ray, Newton's steps only rise
        tangent, off = fallen / paraxial, fallen
        for _ in range(ITERATIONS):
            place, slope = gap * tangent, np.full_like(tangent, gap)
            for thickness, index in self.layers:
                # tan of the angle within, of its sine over the index
                root = np.sqrt(index**2 + (index**2 - 1.0) * tangent**2)
                place = place + thickness * tangent / root
                slope = slope + thickness * index**2 / root**3
            off = fallen - place
            if not (np.abs(off) > _FOUND * fallen).any():
                break
            tangent = np.minimum(tangent + off / slope, _FLATTEST)
        stretch = np.full_like(fallen, self.focal_length_mm / paraxial)
        np.divide(self.focal_length_mm * tangent, fallen, out=stretch, where=fallen > 0)
        stretch[~(np.abs(off) <= 1e3 * _FOUND * fallen)] = np.nan  # farther than any ray falls
        return np.asarray(moved * stretch[:, None] / self.unit_mm + np.asarray(self.centre))

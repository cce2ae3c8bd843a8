"""The shade that the walls of two crossed slits throw on balances of light (ICM/Shadow)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.calibration.slit_sensor import require_crossed_slits
from algorithms.contract import (
    AboutCompensation,
    FeatureKind,
    Floats,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.documented import documented
from algorithms.parameters import require_positive


@documented
@dataclass
class SlitShadow(CalibratedCompensation):
    """Balances of photodiode pairs behind thick slits, converted to those behind thin slits.

    The walls of a thick slit narrow the strip of light without moving its middle. A balance is the
    displacement divided by the total light, so less light makes it larger.

    Parameters
    ----------
    focal_length_mm : float
        Distance H from the mask's middle to the photodiodes, positive.
    thickness_mm : float
        Thickness t of the mask, positive.

    Notes
    -----
    Implements: model:shad (Chang2006), described in words and in the study's abstract; the
    equation is ours. Behind a slit of width w the strip is ``w - t abs(T_u)`` wide, ``T_u`` the
    tangent across the slit; of two slits at 45 deg to the axes the sum of both is ``2 w - sqrt(2)
    t max(abs(T_x), abs(T_y))``. With ``s = sqrt(2) H T / w`` behind thin walls (alg:VB of a square
    aperture of width ``sqrt(2) w``), thick ones give ``S = s / (1 - t max(abs(s_a), abs(s_b)) / (2
    H))``, inverted by ``s = S / (1 + t max(abs(S_a), abs(S_b)) / (2 H))``. Light lost in the gap
    between the photodiodes is not in it, as it is not in alg:VB.

    Shapes: balances ``(s_a, s_b)`` (N, 2), dimensionless, to the same.

    Failure: a NaN row for a NaN feature row.

    Cost: 6 operations per sample.

    Examples
    --------
    >>> walls = SlitShadow(focal_length_mm=0.5, thickness_mm=0.1)
    >>> walls.fit([[0.5, 0.2]], [[0.0, 0.0, 1.0]]).transform([[0.5, 0.2]]).round(6)
    array([[0.47619 , 0.190476]])
    """

    about: ClassVar = AboutCompensation(
        name="slit-shadow",
        taxonomy="ICM/Shadow",
        studies=("Chang2006",),
        labels=("model:shad", "alg:VB"),
        needs=("focal_length_mm", "mask_thickness_mm", "slits"),
        accepts=frozenset({FeatureKind.BALANCE}),
        ahead_of=("spm", "slit-pairs", "polynomial-1d", "polynomial-2d"),
    )

    focal_length_mm: float
    thickness_mm: float

    def __post_init__(self) -> None:
        require_positive(
            self.about.name, focal_length_mm=self.focal_length_mm, thickness_mm=self.thickness_mm
        )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the compensation of the sensor's slits.

        UnsuitableDesignError unless they are two of one width, 45 deg to either side of the axes,
        in a mask that has a thickness.
        """
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        require_crossed_slits(geometry, by=cls.about.name)
        thickness = geometry.mask_thickness_mm or 0.0
        if thickness <= 0:
            raise UnsuitableDesignError(
                f"{cls.about.name} needs slits in a mask that has a thickness; got {thickness:g} mm"
            )
        return cls(focal_length_mm=geometry.focal_length_mm or 0.0, thickness_mm=thickness)

    def apply(self, features: Floats, context: Columns) -> Floats:
        """Balances (N, 2) as behind thin walls."""
        del context
        larger = np.maximum(np.abs(features[:, 0]), np.abs(features[:, 1]))
        lost = self.thickness_mm / (2.0 * self.focal_length_mm) * larger
        return np.asarray(features / (1.0 + lost)[:, None])

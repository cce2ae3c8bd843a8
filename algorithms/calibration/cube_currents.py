"""`CubeCurrents`: what methods against albedo share, a cube's currents in units of one Sun."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.compensated import CalibratedCompensation
from algorithms.contract import Floats, UnusableDataError
from algorithms.models.geometric.detector_faces import Normals, axis_faces

SURELY_LIT = 0.3
"""Cosine by the drawing from which on a face's sample tells of its current in full sunlight."""


@dataclass
class CubeCurrents(CalibratedCompensation):
    """Base of the methods: learns every face's current in full sunlight.

    Parameters
    ----------
    face_normals : tuple of six vectors
        The six directions +x, -x, +y, -y, +z, -z, each once, in the order of the features.

    Attributes
    ----------
    one_sun_ : ndarray, shape (6,)
        Current of each face under perpendicular sunlight, in units of the features.
    """

    frontal: ClassVar[bool] = False

    face_normals: Normals

    one_sun_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        axis_faces(self.face_normals, self.about.name)

    def columns(self) -> int:
        """Six faces."""
        return 6

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Learn every face's current in full sunlight; one never lit takes the others' mean."""
        del context
        self.one_sun_ = self.full_sunlight(features, sun, np.ones(features.shape, dtype=np.bool_))

    def full_sunlight(self, features: Floats, sun: Floats, usable: NDArray[np.bool_]) -> Floats:
        """Give each face's current (6,) under perpendicular sunlight, of usable samples (n, 6)."""
        cosines = sun @ np.asarray(self.face_normals, dtype=np.float64).T
        cosines[(cosines < SURELY_LIT) | ~usable] = 0.0
        squares = (cosines**2).sum(axis=0)
        lit = squares > 0
        found = (features * cosines).sum(axis=0)[lit] / squares[lit]
        if not (lit.any() and (found > 0).all()):
            raise UnusableDataError(
                f"{self.about.name} needs samples that light its faces with positive signals"
            )
        one_sun = np.full(6, found.mean())
        one_sun[lit] = found
        return one_sun

    def pairs(self, features: Floats) -> tuple[Floats, Floats]:
        """Currents (N, 3) of the plus and of the minus faces in units of one Sun, not negative."""
        plus, minus = axis_faces(self.face_normals, self.about.name)
        relative = np.maximum(features / self.one_sun_, 0.0)
        return relative[:, plus], relative[:, minus]

    def lit_by(self, sun: Floats) -> Floats:
        """Currents (N, 6) of a Sun vector (N, 3) alone, in the features' unit; NaN rows stay."""
        plus, minus = axis_faces(self.face_normals, self.about.name)
        found = np.empty((len(sun), 6))
        found[:, plus], found[:, minus] = np.maximum(sun, 0.0), np.maximum(-sun, 0.0)
        return np.asarray(found * self.one_sun_)

"""How the built sensor differs from the drawing."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats


@dataclass(frozen=True)
class Assembly:
    """Errors of assembly, the same for every sample of a sensor.

    Attributes
    ----------
    tilt_x_deg, tilt_y_deg
        Rotation of the sensor's head about the reference x, then the y axis.
    rotation_deg
        In-plane rotation about the head's boresight.
    focal_length_error_mm
        Built minus nominal distance from mask to detector.
    offset_x_mm, offset_y_mm
        Shift of the mask against the detector.
    """

    tilt_x_deg: float = 0.0
    tilt_y_deg: float = 0.0
    rotation_deg: float = 0.0
    focal_length_error_mm: float = 0.0
    offset_x_mm: float = 0.0
    offset_y_mm: float = 0.0

    def matrix(self) -> Floats:
        """(3, 3) rotation from the reference frame to the head: ``R_z R_y R_x``."""
        return (
            _about(2, self.rotation_deg) @ _about(1, self.tilt_y_deg) @ _about(0, self.tilt_x_deg)
        )

    def to_head(self, sun: Floats) -> Floats:
        """Sun vectors (N, 3) as the head sees them; exactly the input when nothing is turned."""
        if self.tilt_x_deg == self.tilt_y_deg == self.rotation_deg == 0:
            return sun
        turn = self.matrix()
        # written out: the order of additions must not depend on the linear algebra library
        return np.asarray(
            sun[:, :1] * turn[:, 0] + sun[:, 1:2] * turn[:, 1] + sun[:, 2:] * turn[:, 2]
        )


def _about(axis: int, angle_deg: float) -> Floats:
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    turn = np.eye(3)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn[i, i] = turn[j, j] = c
    turn[i, j], turn[j, i] = -s, s
    return turn

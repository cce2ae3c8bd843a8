"""`ForwardModel`: a sensor model that gives the features of each direction, inverted row by row."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.parametric import RADIAN_DEG, FreeParameter, ParametricModel
from algorithms.contract import Floats

SETTLED = 1e-9
"""Last step of an inversion, in tangents of the angles, at which a direction is found: 6e-8 deg."""

#: Newton's method doubles the digits a step; a start by the drawing has one at least.
_STEPS = 12
#: Step of the derivatives, in tangents.
_DIFFERENCE = 1e-7
#: A direction that a trial's numbers leave undefined: farther off than any defined one.
_UNDEFINED_RAD = 4.0


#: Free parameters of a head that is turned against the outer frame.
TILTS = FreeParameter("tilt_x", "deg", RADIAN_DEG), FreeParameter("tilt_y", "deg", RADIAN_DEG)
TURNS = (FreeParameter("rotation", "deg", RADIAN_DEG), *TILTS)


@dataclass
class ForwardModel(ParametricModel):
    """Features as a function of the Sun in the head's frame, which is turned against the outer one.

    A subclass writes `free_parameters`, `cast` and `drawing`. Directions are found by Newton's
    method on `cast`, which starts from the drawing; a fit needs no inversion, as the Suns are known
    there. Its residuals are the features' errors, brought to angles across the true direction by
    the drawing.
    """

    @abstractmethod
    def cast(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) features of ``(s_x, s_y) / s_z`` (N, 2) in the head's frame; NaN where none."""
        ...

    @abstractmethod
    def drawing(self) -> tuple[float, tuple[float, float]]:
        """Tangent for one unit of feature, and the feature (x, y) on the boresight."""
        ...

    def turns(self, vector: Floats) -> tuple[float, float, float]:
        """Rotation about the boresight and tilts about x and y of the head, deg; 0 if not free."""
        names = [one.name for one in self.free_parameters()]
        rotation, tilt_x, tilt_y = (
            float(vector[names.index(turn.name)]) if turn.name in names else 0.0 for turn in TURNS
        )
        return rotation, tilt_x, tilt_y

    def slopes(self, sun: Floats) -> Floats | float:
        """Tangents for a unit of each feature at directions (N, 3); the drawing's by default."""
        del sun
        return self.drawing()[0]

    def directions(self, vector: Floats, features: Floats, context: Columns) -> Floats:
        """(N, 3) directions of features (N, 2), by `tangents_cast`."""
        del context
        slope, centre = self.drawing()
        start = (features - np.asarray(centre)) * slope
        tangents = tangents_cast(lambda trial: self.cast(vector, trial), features, start)
        return outward(tangents, self.turns(vector))

    def residuals(
        self,
        vector: Floats,
        features: Floats,
        sun: Floats,
        axes: tuple[Floats, Floats],
        context: Columns,
    ) -> Floats:
        """(n, 2) features' errors, as the drawing turns them into angles, radians."""
        from algorithms.calibration.parametric_kernel import across_axes  # noqa: PLC0415 - Numba

        del context
        off = features - self.cast(vector, inward(sun, self.turns(vector)))
        steps = off * self.slopes(sun) * sun[:, 2:]  # ds = s_z dt, less what runs along s
        across_axes(steps, *axes, _UNDEFINED_RAD)
        return np.asarray(steps)


def tangents_cast(forward: Callable[[Floats], Floats], wanted: Floats, start: Floats) -> Floats:
    """Tangents (N, 2) at which `forward` gives what is wanted (N, 2), by Newton's method.

    Parameters
    ----------
    forward : callable
        (N, 2) features of tangents (N, 2), row by row.
    wanted : ndarray, shape (N, 2)
        Features.
    start : ndarray, shape (N, 2)
        Tangents to start from.

    Returns
    -------
    ndarray, shape (N, 2)
        NaN where the steps have not converged within `SETTLED`, or where `forward` has folded
        back: its derivatives' determinant has not the sign it has on the boresight.

    Examples
    --------
    >>> twice = lambda tangents: 2.0 * tangents + tangents**3
    >>> tangents_cast(twice, np.array([[3.0, 0.0]]), np.array([[1.5, 0.0]])).round(9)
    array([[1., 0.]])
    """
    tangents, before = np.array(start, order="F"), np.zeros_like(start, order="F")
    way = np.sign(_derivatives(forward, np.zeros((1, 2)))[2])
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        for _ in range(_STEPS):
            here, ((a, b), (c, d)), determinant = _derivatives(forward, tangents)
            off = wanted - here
            steps = np.empty_like(tangents)
            steps[:, 0] = (off[:, 0] * d - c * off[:, 1]) / determinant
            steps[:, 1] = (a * off[:, 1] - off[:, 0] * b) / determinant
            length = np.sqrt(steps[:, 0] ** 2 + steps[:, 1] ** 2)
            reach = 0.5 * (1.0 + np.sqrt(tangents[:, 0] ** 2 + tangents[:, 1] ** 2))
            steps *= np.where(length > reach, reach / length, 1.0)[:, None]
            astray = ~np.isfinite(length)  # no features there: half the way back
            steps[astray] = 0.5 * (before - tangents)[astray]
            before[~astray] = tangents[~astray]
            tangents += steps
        tangents[~((length <= SETTLED) & (determinant * way > 0))] = np.nan
    return tangents


def outward(tangents: Floats, turns: tuple[float, float, float]) -> Floats:
    """Turn tangents (N, 2) in the head's frame into unit vectors (N, 3) in the outer one.

    ``R_x(tilt_x) R_y(tilt_y) R_z(rotation)``; a NaN row where the Sun is behind.
    """
    from algorithms.calibration.parametric_kernel import directions_outside  # noqa: PLC0415 - Numba

    rotation, tilt_x, tilt_y = (circle(turn) for turn in turns)
    found = np.empty((len(tangents), 3))
    directions_outside(tangents[:, 0], tangents[:, 1], rotation, tilt_x, tilt_y, found)
    return found


def inward(sun: Floats, turns: tuple[float, float, float]) -> Floats:
    """Turn directions (N, 3) in the outer frame into tangents (N, 2) in the head's.

    The inverse of `outward`; NaN where the Sun is behind the head.
    """
    from algorithms.calibration.parametric_kernel import tangents_in_head  # noqa: PLC0415 - Numba

    rotation, tilt_x, tilt_y = (circle(turn) for turn in turns)
    tangents = np.empty((len(sun), 2))
    tangents_in_head(sun, rotation, tilt_x, tilt_y, tangents)
    return tangents


def circle(angle_deg: float) -> tuple[float, float]:
    """Cosine and sine of an angle in degrees."""
    return math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))


def _derivatives(
    forward: Callable[[Floats], Floats], tangents: Floats
) -> tuple[Floats, tuple[tuple[Floats, Floats], tuple[Floats, Floats]], Floats]:
    """Features (N, 2), their derivatives by each tangent, and the determinant (N,)."""
    here = forward(tangents)
    columns = []
    for axis in range(2):
        beside = tangents.copy()
        beside[:, axis] += _DIFFERENCE
        change = (forward(beside) - here) / _DIFFERENCE
        columns.append((change[:, 0], change[:, 1]))
    (a, b), (c, d) = columns
    return here, (columns[0], columns[1]), a * d - c * b

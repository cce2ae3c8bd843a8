"""Rate-integrating gyroscope: how far the body turned between two samples, with its noise."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

import numpy as np

from algorithms.contract import Floats

_HOUR_S = 3600.0


@dataclass(frozen=True)
class Gyro:
    """Three axes along those of the body, each with white noise and a bias that wanders.

    Round numbers of a tactical micro-mechanical gyroscope as small satellites carry them.
    Misalignment and errors of scale are left out.

    Attributes
    ----------
    angle_random_walk_deg_sqrt_h
        White noise of the rate: the angle's standard deviation after an hour.
    bias_deg_h
        Standard deviation of the bias when it is switched on.
    bias_walk_deg_h_sqrt_h
        Standard deviation of what the bias has moved after an hour.
    """

    angle_random_walk_deg_sqrt_h: float = 0.15
    bias_deg_h: float = 10.0
    bias_walk_deg_h_sqrt_h: float = 0.5

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(f"{name} must be finite, not negative; got {value}")

    def read(
        self,
        turn: Floats,
        before: Floats,
        time_s: Floats,
        step_s: float,
        drawn: np.random.Generator,
    ) -> Floats:
        """Mean rates (N, 3) over the step before each sample, body frame, deg/s.

        Parameters
        ----------
        turn, before : ndarray, shape (N, 3, 3)
            From the inertial to the body frame, at each sample and `step_s` earlier.
        time_s : ndarray, shape (N,)
            Of the samples; the bias wanders on between them, however far apart they are.
        step_s : float
            Over which rates are integrated.
        drawn : numpy.random.Generator
            Of the noise.
        """
        walk = self.angle_random_walk_deg_sqrt_h / math.sqrt(_HOUR_S * step_s)
        white = walk * drawn.standard_normal((len(time_s), 3))
        first = self.bias_deg_h / _HOUR_S * drawn.standard_normal(3)
        apart = np.diff(time_s, prepend=time_s[:1])
        size = self.bias_walk_deg_h_sqrt_h / _HOUR_S**1.5 * np.sqrt(apart)
        moved = np.cumsum(size[:, None] * drawn.standard_normal((len(time_s), 3)), axis=0)
        return np.asarray(rotation_vectors_deg(turn, before) / step_s + first + moved + white)


def rotation_vectors_deg(turn: Floats, before: Floats) -> Floats:
    """(N, 3) axis times angle, deg, by which the body turned; less than half a turn.

    Of rotations (N, 3, 3) from the inertial to the body frame; vectors in the body frame. Written
    out, and angles through the C library: the same on every machine.
    """
    between = np.zeros_like(turn)
    for i in range(3):
        for j in range(3):
            for k in range(3):
                between[:, i, j] += turn[:, i, k] * before[:, j, k]
    # a body that turns by +a sees fixed vectors turn by -a
    axis = 0.5 * np.stack(
        [
            between[:, 1, 2] - between[:, 2, 1],
            between[:, 2, 0] - between[:, 0, 2],
            between[:, 0, 1] - between[:, 1, 0],
        ],
        axis=1,
    )
    cosine = 0.5 * (between[:, 0, 0] + between[:, 1, 1] + between[:, 2, 2] - 1.0)
    sine = np.sqrt(axis[:, 0] ** 2 + axis[:, 1] ** 2 + axis[:, 2] ** 2)
    angles = [math.atan2(s, c) for s, c in zip(sine.tolist(), cosine.tolist(), strict=True)]
    ratio = [angle / s if s > 0 else 1.0 for angle, s in zip(angles, sine.tolist(), strict=True)]
    return np.asarray(np.degrees(np.array(ratio))[:, None] * axis)

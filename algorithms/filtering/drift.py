"""What may be uncertain beside the Sun's direction: numbers of the sensor, and the gyroscope."""

from __future__ import annotations

import math
from dataclasses import dataclass

#: Errors ahead of the sensor's parameters: two of the direction, three of the bias.
MOTION = 5
LEVEL, EARTH, GAINS = 0, 1, 2
"""Places of faces' parameters: the light's strength, the Earth's, the first face's gain; behind
the gains two tilts a face."""
HEAD_TURNS, HEAD_SHIFTS = (0, 1), (2, 3, 4)
"""Places of a spot's parameters: turns of the head, focal length and offsets."""
_DAY_S = 86_400.0


@dataclass(frozen=True)
class Drift:
    """A number of the sensor that may differ from its calibration, and wander.

    Attributes
    ----------
    place : int
        Among the sensor's parameters (see `algorithms.filtering.readings_kernel`).
    deviation : float
        Standard deviation at the start.
    walk : float
        Of what it moves in a second.
    """

    place: int
    deviation: float
    walk: float


def random_walk(place: int, deviation: float) -> Drift:
    """Return a number that wanders by its deviation in a day."""
    return Drift(place, deviation, deviation / math.sqrt(_DAY_S))


@dataclass(frozen=True)
class Gyroscope:
    """What a gyroscope's data sheet says.

    Attributes
    ----------
    angle_walk : float
        White noise, rad/sqrt(s).
    bias : float
        Standard deviation when switched on, rad/s.
    bias_walk : float
        Of what the bias moves in a second, rad/s.
    """

    angle_walk: float
    bias: float
    bias_walk: float

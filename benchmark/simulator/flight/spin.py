"""Rates of a body that turns while a frame is exposed: `Spin`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.environment import uniform_direction


@dataclass(frozen=True)
class Spin:
    """One rate about an axis that is another one in every sample, uniform over the sphere.

    So a body that tumbles is met at random: where its axis points has nothing to do with where
    the Sun stands in the sensor.

    Attributes
    ----------
    rate_deg_s
        Size of the angular velocity.
    """

    rate_deg_s: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.rate_deg_s) and self.rate_deg_s > 0):
            raise ValueError(f"rate_deg_s must be finite and positive; got {self.rate_deg_s}")

    def draw(self, count: int, generator: np.random.Generator) -> Floats:
        """(N, 3) angular velocities about the sensor's own axes."""
        axes = np.empty((count, 3))
        for n in range(count):
            axes[n] = uniform_direction(generator)
        return self.rate_deg_s * axes

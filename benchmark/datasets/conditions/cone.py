"""Sun directions within a cone around the boresight."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from algorithms.contract import Floats
from benchmark.datasets.fields import Split
from benchmark.simulator.sensors.face_layouts import lattice


@dataclass(frozen=True)
class ConeField:
    """Directions up to `half_angle_deg` from +z; even in solid angle.

    Calibration: a Fibonacci lattice over the cap. Test: uniform in solid angle.
    """

    half_angle_deg: float
    calibration_samples: int = 500
    test_samples: int = 400

    @property
    def _lowest(self) -> float:
        return math.cos(math.radians(self.half_angle_deg))

    def sun(self, split: Split, generator: np.random.Generator) -> Floats:
        """(N, 3) unit vectors of a split."""
        if split == "calibration":
            return np.array(lattice(self.calibration_samples, self._lowest))
        points = []
        for _ in range(self.test_samples):
            z = 1.0 - (1.0 - self._lowest) * generator.random()
            turn = 2.0 * math.pi * generator.random()
            radius = math.sqrt(1.0 - z * z)
            points.append((radius * math.cos(turn), radius * math.sin(turn), z))
        return np.array(points)

    def card(self) -> dict[str, dict[str, Any]]:
        """By split: size and directions."""
        cone = f"up to {self.half_angle_deg:g} deg from the boresight"
        return {
            "calibration": {
                "samples": self.calibration_samples,
                "directions": f"Fibonacci lattice over the directions {cone}",
            },
            "test": {
                "samples": self.test_samples,
                "directions": f"uniform (solid angle) over the directions {cone}",
            },
        }

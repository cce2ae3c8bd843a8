"""Sun directions of the splits: turntable-like grids to calibrate on, random ones to test on."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, Protocol

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.environment import uniform_direction
from benchmark.simulator.light.sun_disc import from_angles

Split = Literal["calibration", "test"]


class Field(Protocol):
    """The directions a dataset covers."""

    def sun(self, split: Split, generator: np.random.Generator) -> Floats:
        """(N, 3) unit vectors of a split."""
        ...

    def card(self) -> dict[str, dict[str, Any]]:
        """By split: how many samples, and how their directions are chosen."""
        ...


@dataclass(frozen=True)
class AngleField:
    """A square field in the projection angles, |alpha| and |beta| up to `half_fov_deg`.

    Calibration: a regular grid, `steps` by `steps`, edges included, alpha the slow axis. Test:
    alpha and beta independent and uniform.
    """

    half_fov_deg: float
    steps: int = 21
    test_samples: int = 400

    def sun(self, split: Split, generator: np.random.Generator) -> Floats:
        """(N, 3) unit vectors of a split."""
        half = self.half_fov_deg
        if split == "calibration":
            axis = np.linspace(-half, half, self.steps)
            alpha, beta = np.repeat(axis, self.steps), np.tile(axis, self.steps)
        else:
            angles = half * (2.0 * generator.random((self.test_samples, 2)) - 1.0)
            alpha, beta = angles[:, 0], angles[:, 1]
        return from_angles(alpha, beta)

    def card(self) -> dict[str, dict[str, Any]]:
        """By split: size and directions."""
        half = self.half_fov_deg
        return {
            "calibration": {
                "samples": self.steps**2,
                "directions": f"grid of {self.steps} x {self.steps} over alpha, beta in "
                f"[-{half:g}, {half:g}] deg",
            },
            "test": {
                "samples": self.test_samples,
                "directions": f"alpha and beta independent, uniform in [-{half:g}, {half:g}] deg",
            },
        }


@dataclass(frozen=True)
class SphereField:
    """The whole sphere. Calibration: a Fibonacci lattice. Test: uniform in solid angle."""

    calibration_samples: int = 500
    test_samples: int = 2000

    def sun(self, split: Split, generator: np.random.Generator) -> Floats:
        """(N, 3) unit vectors of a split."""
        if split == "test":
            return np.array([uniform_direction(generator) for _ in range(self.test_samples)])
        turn = math.pi * (3.0 - math.sqrt(5.0))
        lattice = []
        for step in range(self.calibration_samples):
            z = 1.0 - (2.0 * step + 1.0) / self.calibration_samples
            radius = math.sqrt(1.0 - z * z)
            lattice.append((radius * math.cos(turn * step), radius * math.sin(turn * step), z))
        return np.array(lattice)

    def card(self) -> dict[str, dict[str, Any]]:
        """By split: size and directions."""
        return {
            "calibration": {
                "samples": self.calibration_samples,
                "directions": "Fibonacci lattice over the sphere",
            },
            "test": {
                "samples": self.test_samples,
                "directions": "uniform over the sphere (solid angle)",
            },
        }

"""What one batch of samples looks at: Sun directions and what varies from sample to sample."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats


@dataclass(frozen=True)
class Scene:
    """N samples before they reach the sensor.

    Attributes
    ----------
    sun
        (N, 3) unit vectors from the sensor to the Sun, sensor frame, +z the boresight.
    irradiance
        (N,) direct sunlight in units of the yearly mean.
    stray
        (N,) uniform stray light on every detector element, in units of the yearly mean
        sunlight at normal incidence.
    origin_px
        (N, 2) detector coordinate (x, y) of each window's first pixel, or None.
    albedo
        (N, K) extra response of each of K detector elements to light from the Earth, in units
        of the response to the yearly mean sunlight at normal incidence, or None. On pixels its
        irradiance at a few points of them, (N, R, C), as their sensor made it.
    rate_deg_s
        (N, 3) angular velocity of the sensor about its own x, y and z axes, or None at rest.
    """

    sun: Floats
    irradiance: Floats
    stray: Floats
    origin_px: NDArray[np.int64] | None = None
    albedo: Floats | None = None
    rate_deg_s: Floats | None = None

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.sun)

    def part(self, start: int, stop: int) -> Self:
        """Return samples `start` to `stop` (exclusive)."""
        return self.rows(slice(start, stop))

    def rows(self, which: slice | NDArray[np.int64]) -> Self:
        """Return these samples, in this order; of a kind of scene's own columns too."""
        columns = {field.name: getattr(self, field.name) for field in fields(self)}
        chosen = {name: column[which] for name, column in columns.items() if column is not None}
        return replace(self, **chosen)

    def seen_from(self, sun: Floats) -> Self:
        """Return the same scene with other Sun directions (N, 3)."""
        return replace(self, sun=sun)

    def alone(self) -> Scene:
        """Return the scene under mean sunlight and no other light, windows left out."""
        count = len(self)
        return Scene(self.sun, np.ones(count), np.zeros(count), rate_deg_s=self.rate_deg_s)

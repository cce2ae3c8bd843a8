"""Patches of clouds over the sunlit Earth: `Clouds`, and an Earth that has them, `CloudyEarth`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Earth, uniform_direction

#: Points over the sphere on which the mean cover is set.
_POINTS = 4000
_GOLDEN_TURN = math.pi * (3.0 - math.sqrt(5.0))


@dataclass(frozen=True)
class Clouds:
    """Where clouds are: a sum of plane waves over the ground, cut off at a threshold.

    The pattern is one for all, from a stream of its own, and stands still in the sensor's frame:
    nadir is random there, so that each sample flies over ground of its own.

    Attributes
    ----------
    cover
        Share of the whole sphere under clouds; 0.67 is the mean that MODIS saw (King et al. 2013,
        doi:10.1109/TGRS.2012.2227333).
    clear
        Reflectance between the clouds; 0.15 is about the mean of Earth without clouds as CERES
        sees it. That of the clouds follows from Earth's mean.
    waves
        How many.
    shortest_km, longest_km
        Wavelengths; weather systems are one to a few thousand kilometres wide.
    softness
        Width of the passage from clear to clouded in standard deviations of the field.
    """

    cover: float = 0.67
    clear: float = 0.15
    waves: int = 24
    shortest_km: float = 1500.0
    longest_km: float = 6000.0
    softness: float = 0.5

    def __post_init__(self) -> None:
        if not 0 < self.cover < 1:
            raise ValueError(f"cover must be in (0, 1); got {self.cover}")
        if not 0 <= self.clear <= 1:
            raise ValueError(f"clear must be in [0, 1]; got {self.clear}")
        if self.waves < 1:
            raise ValueError(f"waves must be at least 1; got {self.waves}")
        if not 0 < self.shortest_km <= self.longest_km:
            raise ValueError(
                "shortest_km must be above 0 and at most longest_km; got "
                f"{self.shortest_km} and {self.longest_km}"
            )
        if not self.softness > 0:
            raise ValueError(f"softness must be positive; got {self.softness}")

    def table(self, radius_km: float) -> Floats:
        """(M, 4) wave vectors over a unit sphere, and phases."""
        return _table(self, radius_km).copy()  # kernels are compiled for arrays of their own

    def threshold(self, radius_km: float) -> float:
        """Value of the field at which the mean cover is `cover`."""
        return _threshold(self, radius_km)

    def over(self, ground: Floats, radius_km: float) -> Floats:
        """(P,) share of clouds over ground (P, 3), unit vectors from Earth's centre."""
        from benchmark.simulator.kernels.earth import cover_of  # noqa: PLC0415 - Numba on demand

        out = np.empty(len(ground))
        numbers = np.array([1.0, 0.0, 0.0, self.threshold(radius_km), self.softness])
        cover_of(out, np.ascontiguousarray(ground), numbers, self.table(radius_km))
        return out


@dataclass(frozen=True)
class CloudyEarth(Earth):
    """An `Earth` under patches of clouds; its mean over the sphere is `reflectance` still."""

    clouds: Clouds = field(default_factory=Clouds)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.clouds.clear <= self.reflectance or not self.cloudy <= 1.0:
            raise ValueError(
                f"a mean of {self.reflectance} with {self.clouds.clear} between clouds needs "
                f"clouds that reflect {self.cloudy:.3g}; it must be in [clear, 1]"
            )

    @property
    def cloudy(self) -> float:
        """Reflectance of the clouds."""
        cover = self.clouds.cover
        return (self.reflectance - (1.0 - cover) * self.clouds.clear) / cover

    def sent_back(self, ground: Floats) -> Floats | float:
        """Reflectance (P,) of ground (P, 3)."""
        over = self.clouds.over(ground, self.radius_km)
        return self.clouds.clear + (self.cloudy - self.clouds.clear) * over

    def tables(self) -> tuple[Floats, Floats]:
        """Numbers (5,) and cloud waves (M, 4) for the kernels."""
        plain, _ = super().tables()
        threshold = self.clouds.threshold(self.radius_km)
        numbers = [plain[0], self.clouds.clear, self.cloudy, threshold, self.clouds.softness]
        return np.array(numbers), self.clouds.table(self.radius_km)


@lru_cache(maxsize=8)
def _table(clouds: Clouds, radius_km: float) -> Floats:
    stream = generator("earth", "clouds")
    low, high = 1.0 / clouds.longest_km, 1.0 / clouds.shortest_km
    rows = []
    for _ in range(clouds.waves):
        x, y, z = uniform_direction(stream)
        number = 2.0 * math.pi * radius_km * (low + (high - low) * stream.random())
        rows.append((number * x, number * y, number * z, 2.0 * math.pi * stream.random()))
    return np.array(rows)


@lru_cache(maxsize=8)
def _threshold(clouds: Clouds, radius_km: float) -> float:
    from benchmark.simulator.kernels.earth import field_of  # noqa: PLC0415 - Numba on demand

    z = [1.0 - 2.0 * (n + 0.5) / _POINTS for n in range(_POINTS)]
    ground = np.array(
        [
            (
                math.sqrt(1.0 - h * h) * math.cos(n * _GOLDEN_TURN),
                math.sqrt(1.0 - h * h) * math.sin(n * _GOLDEN_TURN),
                h,
            )
            for n, h in enumerate(z)
        ]
    )
    low, high, field = -5.0, 5.0, np.empty(_POINTS)
    field_of(field, ground, clouds.table(radius_km))
    for _ in range(40):
        middle = (low + high) / 2.0
        cover = np.clip((field - middle) / clouds.softness + 0.5, 0.0, 1.0)
        mean = math.fsum(cover.tolist()) / _POINTS
        if mean > clouds.cover:
            low = middle
        else:
            high = middle
    return (low + high) / 2.0

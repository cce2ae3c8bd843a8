"""Stray light that is brighter on one side of the detector than on the other.

Uniform stray light is `Irradiance`'s. Its slope belongs to scenes of its own, so that those without
one keep their numbers and their random streams.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.scene import Scene


@dataclass(frozen=True)
class UnevenIrradiance(Irradiance):
    """An `Irradiance` whose stray light also slopes across the detector, anew for every sample.

    Attributes
    ----------
    slope_spread
        Standard deviation, along x and y each, of how much more stray light the edge of the
        detector gets than its middle; in units of mean sunlight at normal incidence. At most a
        quarter of `stray`, so that stray light does not turn negative.
    """

    slope_spread: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.slope_spread <= self.stray / 4.0:
            raise ValueError(
                f"slope_spread must be in [0, stray / 4 = {self.stray / 4.0}]; got "
                f"{self.slope_spread}"
            )

    def draw_slopes(self, count: int, generator: np.random.Generator) -> Floats:
        """(N, 2) slopes along x and y."""
        return self.slope_spread * generator.standard_normal((count, 2))


@dataclass(frozen=True)
class UnevenScene(Scene):
    """A `Scene` under sloping stray light: `slope` (N, 2), as `UnevenIrradiance` draws it."""

    slope: Floats | None = None

    @classmethod
    def of(cls, scene: Scene, slope: Floats) -> UnevenScene:
        """Return `scene` with slopes (N, 2)."""
        if slope.shape != (len(scene), 2):
            raise ValueError(f"slopes must be ({len(scene)}, 2); got {slope.shape}")
        columns = {field.name: getattr(scene, field.name) for field in fields(Scene)}
        return cls(**columns, slope=slope)


def slope_nodes(scene: Scene, columns: int, rows: int) -> Floats | None:
    """(N, 2, 2) uneven part of stray light on the corner pixels of a detector read out whole.

    Between them it is bilinear (`add_between`). None for even scenes.
    """
    if not isinstance(scene, UnevenScene) or scene.slope is None:
        return None
    right, low = (columns - 1) / columns, (rows - 1) / rows
    x, y = scene.slope[:, :1, None], scene.slope[:, 1:, None]
    return np.asarray(x * np.array([[-right, right]]) + y * np.array([[-low], [low]]))


def slope(scene: Scene, places: Floats) -> Floats:
    """(N, K) stray light of a scene on elements at `places` (K, 2), uneven part included.

    Places are in units of half the detector's size, of its middle: an element gets the mean over
    its area, which of light that slopes evenly is that at the area's middle.
    """
    even = np.repeat(scene.stray[:, None], len(places), axis=1)
    if not isinstance(scene, UnevenScene) or scene.slope is None:
        return even
    slope = scene.slope
    return np.asarray(even + slope[:, :1] * places[:, 0] + slope[:, 1:] * places[:, 1])

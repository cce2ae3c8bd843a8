"""Stray light that is brighter on one side of the detector than on the other.

Uniform stray light is `Irradiance`'s. Its slope belongs to scenes and sensors of its own, so that
those without one keep their numbers and their random streams.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor


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
        return cls(
            scene.sun, scene.irradiance, scene.stray, scene.origin_px, scene.albedo, slope=slope
        )


def add_slope(flux: Floats, scene: Scene, detector: PixelArray) -> None:
    """Add the uneven part of stray light to frames (N, H, W) in place; nothing in even scenes.

    Each pixel gets ``slope . (position - middle) / half size`` of the detector, so nothing is
    added to the mean over the whole detector.
    """
    if not isinstance(scene, UnevenScene) or scene.slope is None or scene.origin_px is None:
        return
    _, rows, columns = flux.shape
    middle = detector.centre_px
    x = scene.origin_px[:, :1] + np.arange(columns) - middle[0]
    y = scene.origin_px[:, 1:] + np.arange(rows) - middle[1]
    flux += (scene.slope[:, :1] * x / (detector.columns / 2.0))[:, None, :]
    flux += (scene.slope[:, 1:] * y / (detector.rows / 2.0))[:, :, None]


@dataclass(frozen=True)
class UnevenFrameSensor(FrameSensor):
    """A `FrameSensor` that sees the slope of an `UnevenScene`'s stray light."""

    def lit(self, scene: Scene) -> Floats:
        """(N, H, W) as `FrameSensor.lit`, with the uneven part of stray light."""
        flux = super().lit(scene)
        add_slope(flux, scene, self.detector)
        return flux

"""Frames under stray light that is brighter on one side of the detector than on the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.stray_slope import UnevenIrradiance, UnevenScene
from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor

__all__ = ["UnevenFrameSensor", "UnevenIrradiance", "UnevenScene", "add_slope"]


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

    sees_slopes: ClassVar[bool] = True

    def lit(self, scene: Scene) -> Floats:
        """(N, H, W) as `FrameSensor.lit`, with the uneven part of stray light."""
        flux = super().lit(scene)
        add_slope(flux, scene, self.detector)
        return flux

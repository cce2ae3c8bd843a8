"""Frames of a CMOS array read out row by row while the sensor turns: `RollingFrameSensor`."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.frames import FrameSensor


@dataclass(frozen=True)
class RollingFrameSensor(FrameSensor):
    """A `FrameSensor` with an electronic rolling shutter on a body that turns.

    Row Y of the detector is exposed for `PixelArray.exposure_s`, centred at
    ``(Y - (rows - 1) / 2) row_time_s``; the scene's Sun directions are those of time 0. Each row
    sees the Sun where it stands during its own exposure. By default nothing rolls or turns, and
    frames are those of `FrameSensor` to the last bit.

    Attributes
    ----------
    row_time_s
        From one row's exposure to the next one's; negative where read-out runs to lower rows.
    rate_deg_s
        Angular velocity of the sensor about its own x, y and z axes, constant.
    instants
        Gauss nodes over the exposure; 1 leaves out the motion within it.
    """

    row_time_s: float = 0.0
    rate_deg_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
    instants: int = 1

    def __post_init__(self) -> None:
        if not (math.isfinite(self.row_time_s) and all(map(math.isfinite, self.rate_deg_s))):
            raise ValueError(
                f"row time and rates must be finite; got {self.row_time_s} s and {self.rate_deg_s}"
            )
        if self.instants < 1:
            raise ValueError(f"instants must be at least 1; got {self.instants}")

    def _optics(self) -> tuple[Hashable, ...]:
        rolling = self.row_time_s, self.rate_deg_s, self.instants, self.detector.exposure_s
        return (*super()._optics(), rolling)

    def seen_at(self, sun: Floats, time_s: Floats) -> Floats:
        """(N, T, 3) directions at times (N, T) to the Sun that is at `sun` (N, 3) at time 0.

        The Sun stands still, the sensor turns: ``s(t)`` is s turned by ``-|w| t`` about w.
        """
        rate = math.sqrt(math.fsum(w * w for w in self.rate_deg_s))
        if rate == 0.0:
            return np.repeat(sun[:, None, :], time_s.shape[1], axis=1)
        axis = np.array(self.rate_deg_s) / rate
        angles = [-math.radians(rate * t) for t in time_s.ravel()]
        c = np.array([math.cos(a) for a in angles]).reshape(*time_s.shape, 1)
        s = np.array([math.sin(a) for a in angles]).reshape(*time_s.shape, 1)
        along = (sun[:, 0] * axis[0] + sun[:, 1] * axis[1] + sun[:, 2] * axis[2])[:, None, None]
        square = np.cross(axis, sun)[:, None, :]
        return np.asarray(c * sun[:, None, :] + s * square + (1.0 - c) * along * axis)

    def _rendered(self, scene: Scene, origin_px: NDArray[np.int64]) -> Floats:
        """(N, H, W) as `FrameSensor._rendered`, every row at its own time."""
        if not any(self.rate_deg_s) or (self.row_time_s == 0.0 and self.instants == 1):
            return super()._rendered(scene, origin_px)
        from benchmark.simulator.kernels.rasteriser import render  # noqa: PLC0415 - Numba on demand

        detector, pitch = self.detector, self.detector.pitch_mm
        columns, rows = self.window_px
        row = origin_px[:, 1:] + np.arange(rows)
        middle = (row - detector.centre_px[1]) * self.row_time_s
        corner = np.stack([np.broadcast_to(origin_px[:, :1], row.shape), row], axis=2)
        corner = corner.reshape(-1, 2) - 0.5 - np.asarray(detector.centre_px)
        flux = np.zeros((len(scene), rows, columns))
        one = np.empty((len(scene) * rows, 1, columns))
        even = np.ones(len(one)), np.zeros(len(one))
        nodes, shares = np.polynomial.legendre.leggauss(self.instants)
        for node, share in zip(nodes, shares / 2.0, strict=True):
            seen = self.seen_at(scene.sun, middle + node * detector.exposure_s / 2.0)
            light = self.projected(Scene(seen.reshape(-1, 3), *even))
            render(one, self.camera.mask.table(pitch), light.rims_mm / pitch, light.light, corner)
            flux += share * one.reshape(flux.shape)
        return flux

"""Currents of two pairs of photodiodes, each pair under a slit: `SlitPairSensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.stray_slope import slope
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.projection import ProjectedLight
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.four_elements import QUADRANTS, LitAreas

_DIAGONAL = math.sqrt(0.5)  # sine and cosine of 45 deg


@dataclass(frozen=True)
class DiodePair:
    """Two photodiodes side by side, the gap between them under the middle of their slit.

    Attributes
    ----------
    reach_mm
        From the middle of the gap to either diode's far edge.
    breadth_mm
        Along the slit.
    gap_mm
        Between the two.
    """

    reach_mm: float
    breadth_mm: float
    gap_mm: float = 0.0

    def __post_init__(self) -> None:
        if not (self.breadth_mm > 0 and 0 <= self.gap_mm < 2 * self.reach_mm):
            raise ValueError(
                "breadth_mm must be positive and gap_mm in [0, 2 reach_mm); got "
                f"{self.breadth_mm}, {self.gap_mm}, {self.reach_mm}"
            )

    def boxes(self) -> Floats:
        """(2, 4): x_min, x_max, y_min, y_max of the diodes on the + and the - side, mm."""
        near, far, half = self.gap_mm / 2.0, self.reach_mm, self.breadth_mm / 2.0
        return np.array([(near, far, -half, half), (-far, -near, -half, half)])


@dataclass(frozen=True)
class SlitPairSensor(LitAreas):
    """Two equal slits at right angles, 45 deg to the sensor's axes, over a pair of diodes each.

    One pair measures along u = (x + y) / sqrt(2), the other along v = (y - x) / sqrt(2); a wall
    keeps the light of each slit to its pair. So turned, the diodes on the sides +v, +u, -v, -u
    lie in the quadrants Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), Q4 (-x, -y), and alg:VB, which is
    made for those, gives both balances: for slits of width w, thin and long enough,
    ``s_a = sqrt(2) h tan(beta) / w`` and ``s_b = sqrt(2) h tan(alpha) / w``, those of a quadrant
    photodiode behind a square aperture of width ``sqrt(2) w``.

    `camera.mask` is one slit, its width across and its height along the pair. Where there is a
    `ghost`, each pair has its own.
    """

    pair: DiodePair
    readout: CurrentReadout
    ghost: Ghost | None = None

    def __post_init__(self) -> None:
        apertures = self.camera.mask.apertures
        if len(apertures) != 1 or apertures[0].shape != "rectangle":
            raise ValueError(
                f"the mask must be the one slit that both pairs have; got {apertures!r}"
            )

    @property
    def open_mm2(self) -> float:
        """Area of both whole slits, mm^2."""
        return 2.0 * self.camera.mask.apertures[0].area_mm2

    def areas(self, projected: ProjectedLight, scene: Scene) -> Floats:
        """(N, 4) lit areas of the diodes, mm^2, times the light."""
        from benchmark.simulator.kernels.areas import lit_boxes  # noqa: PLC0415 - Numba on demand

        x, y = projected.rims_mm[..., 0], projected.rims_mm[..., 1]
        u, v = _DIAGONAL * (x + y), _DIAGONAL * (y - x)
        light = projected.light * scene.irradiance[:, None]
        table = self.camera.mask.table()
        out = np.empty((len(scene), 4))
        area = np.empty((len(scene), 2))
        for rims, columns in ((np.stack([u, v], -1), (1, 3)), (np.stack([v, -u], -1), (0, 2))):
            lit_boxes(area, self.pair.boxes(), table, np.ascontiguousarray(rims), light)
            out[:, columns] = area
        return out

    def stray(self, scene: Scene) -> Floats:
        """(N, 4) stray light at the middles of the diodes."""
        near, far = self.pair.gap_mm / 2.0, self.pair.reach_mm
        return slope(scene, _DIAGONAL * (near + far) / 2.0 / far * QUADRANTS)

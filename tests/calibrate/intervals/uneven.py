"""Sensors of five kinds that are worse in some places, and that no model follows wholly.

Noise grows with the angle off the boresight, or towards one face; of spots, cells and electrodes
a part of the response is none that the models know.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bench
import numpy as np
from samples import table

from calibrate.settings import Settings, parse_settings
from calibrate.table import Table

VECTOR = ("sun_x", "sun_y", "sun_z")
Drawn = np.random.Generator


@dataclass(frozen=True)
class Uneven:
    """A sensor: its columns, the light on it, what it reads, and models for it."""

    names: tuple[str, ...]
    poses: Callable[[int, Drawn], np.ndarray]
    read: Callable[[np.ndarray, Drawn], np.ndarray]
    models: tuple[str, ...]
    kind: str = ""

    def table(self, count: int, drawn: Drawn) -> Table:
        """A file of so many poses."""
        sun = self.poses(count, drawn)
        return table((*self.names, *VECTOR), self.read(sun, drawn), sun)

    @property
    def settings(self) -> Settings | None:
        """None where its columns' names say what they are."""
        if not self.kind:
            return None
        readings = {"kind": self.kind, "columns": list(self.names)}
        direction = {"form": "vector", "columns": list(VECTOR)}
        return parse_settings({"readings": readings, "direction": direction}, "uneven")


def square(half_deg: float) -> Callable[[int, Drawn], np.ndarray]:
    return lambda count, drawn: bench.sun_of(drawn.uniform(-half_deg, half_deg, (count, 2)))


def cone(half_deg: float) -> Callable[[int, Drawn], np.ndarray]:
    def poses(count: int, drawn: Drawn) -> np.ndarray:
        z = drawn.uniform(np.cos(np.radians(half_deg)), 1.0, count)
        turn, off = drawn.uniform(0.0, 2.0 * np.pi, count), np.sqrt(1.0 - z**2)
        return np.column_stack([off * np.cos(turn), off * np.sin(turn), z])

    return poses


def ball(count: int, drawn: Drawn) -> np.ndarray:
    return bench.sphere(count, int(drawn.integers(1 << 30)))


def outwards(sun: np.ndarray) -> np.ndarray:
    """0 at the boresight and 1 at 60 deg, (N, 1)."""
    return np.asarray((np.arccos(np.clip(sun[:, [2]], -1.0, 1.0)) / np.radians(60.0)) ** 2)


def spots(sun: np.ndarray, drawn: Drawn) -> np.ndarray:
    """Spots that wave by a part of a pixel, more so outwards, and with five times the noise."""
    tangents = sun[:, :2] / sun[:, 2:]
    found = bench.CENTRE + bench.FOCAL * tangents
    found = found + 0.6 * np.sin(found / 37.0) * (tangents**2).sum(axis=1)[:, None]
    return np.asarray(found + drawn.normal(0.0, 0.15, found.shape) * (1.0 + 4.0 * outwards(sun)))


def quadrants(sun: np.ndarray, drawn: Drawn) -> np.ndarray:
    light = bench.quadrants(sun, int(drawn.integers(1 << 30)))
    return light + drawn.normal(0.0, 0.032, light.shape) * outwards(sun)


def electrodes(sun: np.ndarray, drawn: Drawn) -> np.ndarray:
    currents = bench.electrodes(sun, int(drawn.integers(1 << 30)))
    return currents + drawn.normal(0.0, 0.012, currents.shape) * outwards(sun)


def faces(sun: np.ndarray, drawn: Drawn) -> np.ndarray:
    """Six cells that lose light at grazing angles, noisy towards +z."""
    light = bench.faces(sun, int(drawn.integers(1 << 30)))
    light = light * (1.0 - 0.05 * (1.0 - light.clip(0.0, 1.0)) ** 2)
    return np.asarray(light + drawn.normal(0.0, 0.006, light.shape) * (1.0 + sun[:, [2]]))


def tilted(sun: np.ndarray, drawn: Drawn) -> np.ndarray:
    """Four cells tilted by 35 deg that lose light at grazing angles."""
    turn, tilt = np.radians([45.0, 135.0, 225.0, 315.0]), np.radians(35.0)
    level = np.full(4, np.cos(tilt))
    normals = np.column_stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), level])
    light = np.maximum(sun @ normals.T, 0.0)
    light = light * (1.0 - 0.06 * (1.0 - light) ** 2) * [1.0, 0.97, 1.02, 0.99]
    return np.asarray(light + drawn.normal(0.0, 0.003, light.shape) * (1.0 + 4.0 * outwards(sun)))


SENSORS = {
    "spots": Uneven(("x_px", "y_px"), square(50.0), spots, ("homography",)),
    "quadrants": Uneven(("q1", "q2", "q3", "q4"), square(30.0), quadrants, ("qpd",)),
    "electrodes": Uneven(
        ("x_plus", "x_minus", "y_plus", "y_minus"), square(52.0), electrodes, ("polynomial-2d",)
    ),
    "faces": Uneven(("xp", "xm", "yp", "ym", "zp", "zm"), ball, faces, ("assembled-faces",)),
    "tilted": Uneven(
        ("p1", "p2", "p3", "p4"), cone(45.0), tilted, ("assembled-faces",), "channels"
    ),
}

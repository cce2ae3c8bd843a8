"""Files of one sensor as its bench would have written them with a mistake, each kind of sensor.

Nothing here comes from the project: axes, angles and order of rows are spelt out again.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import bench
import numpy as np

ANGLE_NAMES = ["theta_x_deg", "theta_y_deg"]
VECTOR_NAMES = ["sun_x", "sun_y", "sun_z"]


@dataclass(frozen=True)
class Sensor:
    """A sensor on a turntable: what it reads of directions, and over which square of poses."""

    names: tuple[str, ...]
    read: Callable[[np.ndarray, int], np.ndarray]
    half_deg: float
    count: int = 21

    def poses(self, seed: int) -> np.ndarray:
        """Angles (N, 2): a grid, or of odd seeds as many at random."""
        if seed % 2 == 0:
            return bench.grid(self.count, self.half_deg)
        drawn = np.random.default_rng(1000 + seed)
        return drawn.uniform(-self.half_deg, self.half_deg, (self.count**2, 2))


SENSORS = {
    "spots": Sensor(("x_px", "y_px"), bench.spots, 50.0),
    "balances": Sensor(("balance_x", "balance_y"), bench.balances, 55.0),
    "quadrants": Sensor(("q1", "q2", "q3", "q4"), bench.quadrants, 30.0),
    "electrodes": Sensor(("x_plus", "x_minus", "y_plus", "y_minus"), bench.electrodes, 55.0),
}
FACES = ("xp", "xm", "yp", "ym", "zp", "zm")
#: What each mistake does to the columns of readings, by kind of sensor.
SWAPPED = {
    "quadrants": [2, 1, 0, 3],
    "electrodes": [2, 3, 0, 1],
    "spots": [1, 0],
    "balances": [1, 0],
}
MIRRORED = {"quadrants": [1, 0, 3, 2], "electrodes": [1, 0, 2, 3]}
OPPOSITE = {"quadrants": [2, 3, 0, 1], "electrodes": [1, 0, 3, 2]}


def untouched(path: Path, kind: str, seed: int) -> Path:
    """A file without a mistake."""
    sensor = SENSORS[kind]
    angles = sensor.poses(seed)
    readings = sensor.read(bench.sun_of(angles), seed)
    return _made(path, sensor, readings, angles)


def mistaken(path: Path, kind: str, mistake: str, seed: int) -> Path:
    """The same file with one mistake."""
    sensor = SENSORS[kind]
    angles = sensor.poses(seed)
    sun = bench.sun_of(angles)
    readings = sensor.read(sun, seed)
    if mistake in OF_ANGLES:
        angles = OF_ANGLES[mistake](angles, sun)
    else:
        readings = OF_READINGS[mistake](readings, kind)
    return _made(path, sensor, readings, angles)


def on_sphere(path: Path, seed: int) -> Path:
    """Six cells of a box over the whole sphere."""
    sun = bench.sphere(600, 500 + seed)
    return bench.write(path, [*FACES, *VECTOR_NAMES], bench.faces(sun, seed), sun)


def _mirrored(readings: np.ndarray, kind: str) -> np.ndarray:
    if kind in MIRRORED:
        return readings[:, MIRRORED[kind]]
    centre = bench.CENTRE if kind == "spots" else 0.0
    return (readings - centre) * [-1, 1] + centre


def _opposite(readings: np.ndarray, kind: str) -> np.ndarray:
    if kind in OPPOSITE:
        return readings[:, OPPOSITE[kind]]
    return 2.0 * (bench.CENTRE if kind == "spots" else 0.0) - readings


def _radians(angles: np.ndarray, sun: np.ndarray) -> np.ndarray:
    return np.radians(angles)


def _other_gimbal(angles: np.ndarray, sun: np.ndarray) -> np.ndarray:
    x, y, z = sun.T
    return np.degrees(np.column_stack([np.arctan2(y, z), np.arcsin(x)]))


def _azimuth(angles: np.ndarray, sun: np.ndarray) -> np.ndarray:
    x, y, z = sun.T
    return np.degrees(np.column_stack([np.arctan2(y, x), np.arcsin(z)]))


OF_ANGLES = {
    "radians": _radians,
    "other gimbal": _other_gimbal,
    "azimuth and elevation": _azimuth,
}
OF_READINGS = {
    "swapped": lambda readings, kind: readings[:, SWAPPED[kind]],
    "mirrored": _mirrored,
    "inverted": _opposite,
    "quadrant order": lambda readings, kind: readings[:, [0, 2, 1, 3]],
    "a row late": lambda readings, kind: np.roll(readings, 1, axis=0),
}


def _made(path: Path, sensor: Sensor, readings: np.ndarray, angles: np.ndarray) -> Path:
    return bench.write(path, [*sensor.names, *ANGLE_NAMES], readings, angles)

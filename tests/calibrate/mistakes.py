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
#: What takes a dark offset of falling outputs back to light: their level without light.
LEVEL = 5.0


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


@dataclass(frozen=True)
class Made:
    """A file, and what is wrong with it.

    Attributes
    ----------
    paths : list of Path
        The runs.
    wrong : set of int
        Places of wrong poses.
    """

    paths: list[Path]
    wrong: frozenset[int] = frozenset()


def untouched(path: Path, kind: str, seed: int) -> Made:
    """A file without a mistake."""
    sensor = SENSORS[kind]
    angles = sensor.poses(seed)
    readings = sensor.read(bench.sun_of(angles), seed)
    return _made(path, sensor, readings, angles)


def mistaken(path: Path, kind: str, mistake: str, seed: int) -> Made:
    """The same file with one mistake."""
    sensor = SENSORS[kind]
    angles = sensor.poses(seed)
    sun = bench.sun_of(angles)
    readings = sensor.read(sun, seed)
    if mistake == "outliers":
        return _made(path, sensor, readings, *_outliers(angles, sun, seed))
    if mistake in OF_ANGLES:
        angles = OF_ANGLES[mistake](angles, sun)
    else:
        readings = OF_READINGS[mistake](readings, kind)
    return _made(path, sensor, readings, angles)


def run_off(path: Path, kind: str, seed: int, off_deg: float = 3.0, bad: int | None = 2) -> Made:
    """Four runs of the same field, one of them off by a constant; of None, none."""
    sensor = SENSORS[kind]
    paths = []
    for number in range(4):
        drawn = np.random.default_rng([seed, number])
        angles = drawn.uniform(-sensor.half_deg, sensor.half_deg, (150, 2))
        sun = bench.sun_of(angles)
        stated = bench.angles_of(sun @ bench.turn("x", off_deg).T) if number == bad else angles
        file = path.with_name(f"{path.stem}_run{number}.csv")
        header = [*sensor.names, *ANGLE_NAMES]
        paths.append(bench.write(file, header, sensor.read(sun, 100 * seed + number), stated))
    return Made(paths)


def beyond_fold(path: Path, seed: int) -> Made:
    """Quadrants measured past the edge of the patch of light."""
    angles = bench.grid(35, 60.0)
    readings = bench.quadrants(bench.sun_of(angles), seed)
    return _made(path, SENSORS["quadrants"], readings, angles)


def cross(path: Path, kind: str, seed: int) -> Made:
    """Two sweeps, one along each axis."""
    sensor = SENSORS[kind]
    line = np.linspace(-sensor.half_deg, sensor.half_deg, 80)
    angles = np.vstack([np.column_stack([line, 0 * line]), np.column_stack([0 * line, line])])
    return _made(path, sensor, sensor.read(bench.sun_of(angles), seed), angles)


def one_axis(path: Path, kind: str, seed: int) -> Made:
    """One sweep along one axis, turned about the boresight with the seed."""
    sensor = SENSORS[kind]
    line = np.linspace(-sensor.half_deg, sensor.half_deg, 80)
    sun = bench.sun_of(np.column_stack([line, 0 * line])) @ bench.turn("z", 17.0 * seed).T
    return _made(path, sensor, sensor.read(sun, seed), bench.angles_of(sun))


def on_sphere(path: Path, seed: int, level: float = 0.0, wrong: float = 0.0) -> Made:
    """Six cells of a box over the whole sphere, falling from a level or some poses wrong."""
    sun = bench.sphere(600, 500 + seed)
    readings = bench.faces(sun, seed)
    readings = level - readings if level else readings
    stated, bad = sun.copy(), frozenset[int]()
    if wrong:
        drawn = np.random.default_rng(seed)
        at = drawn.choice(len(sun), int(wrong * len(sun)), replace=False)
        stated[at], bad = _turned(sun[at], drawn, 10.0, 30.0), frozenset(int(n) for n in at)
    return Made([bench.write(path, [*FACES, *VECTOR_NAMES], readings, stated)], bad)


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
    "falling": lambda readings, kind: LEVEL - readings,
    "quadrant order": lambda readings, kind: readings[:, [0, 2, 1, 3]],
    "a row late": lambda readings, kind: np.roll(readings, 1, axis=0),
}


def _outliers(angles: np.ndarray, sun: np.ndarray, seed: int) -> tuple[np.ndarray, frozenset[int]]:
    drawn = np.random.default_rng(seed)
    at = drawn.choice(len(sun), len(sun) // 20, replace=False)
    changed = angles.copy()
    changed[at] = bench.angles_of(_turned(sun[at], drawn, 3.0, 30.0))
    return changed, frozenset(int(n) for n in at)


def _turned(sun: np.ndarray, drawn: np.random.Generator, low: float, high: float) -> np.ndarray:
    axes = np.cross(sun, drawn.normal(size=sun.shape))
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    off = np.radians(drawn.uniform(low, high, len(sun)))[:, None]
    return np.cos(off) * sun + np.sin(off) * axes


def _made(
    path: Path, sensor: Sensor, readings: np.ndarray, angles: np.ndarray,
    wrong: frozenset[int] = frozenset(),
) -> Made:  # fmt: skip
    return Made([bench.write(path, [*sensor.names, *ANGLE_NAMES], readings, angles)], wrong)

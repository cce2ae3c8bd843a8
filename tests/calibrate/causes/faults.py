"""Five sensors in closed form, faults of their files drawn by seed, and their errors in flight."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import bench
import numpy as np

from algorithms.angles import separation_deg
from calibrate.calibration import Calibration
from calibrate.readings import readings_of
from calibrate.table import Table

ANGLES = ["theta_x_deg", "theta_y_deg"]
CELLS = bench.sun_of(np.array([[24.0, 26.0], [24.0, -26.0], [-24.0, 26.0], [-24.0, -26.0]]))
CELL_NOISE = 0.002


def cells(sun: np.ndarray, seed: int) -> np.ndarray:
    """Four plain cells tilted by 35 deg."""
    light = np.maximum(sun @ CELLS.T, 0.0)
    return light + np.random.default_rng(seed).normal(0.0, CELL_NOISE, light.shape)


@dataclass(frozen=True)
class Sensor:
    """A sensor, its columns, half its field, models that read it, and light all columns see."""

    names: list[str]
    read: Callable[[np.ndarray, int], np.ndarray]
    half_deg: float
    models: tuple[str, ...]
    stray: float = 0.0


MAPS = ("homography", "lsq", "polynomial-2d", "lut-polynomial")
BALANCED = ("spm", "lsq", "polynomial-2d", "lut-polynomial")
SIGNALS = ("polynomial-signals", "assembled-faces")
SENSORS = {
    "spot": Sensor(["x_px", "y_px"], bench.spots, 50.0, MAPS),
    "quadrants": Sensor(["q1", "q2", "q3", "q4"], bench.quadrants, 30.0, BALANCED, bench.STRAY),
    "electrodes": Sensor(
        ["x_plus", "x_minus", "y_plus", "y_minus"], bench.electrodes, 50.0, BALANCED
    ),
    "faces": Sensor(["xp", "xm", "yp", "ym", "zp", "zm"], bench.faces, 180.0, SIGNALS),
    "cells": Sensor(["ch1", "ch2", "ch3", "ch4"], cells, 35.0, SIGNALS),
}
FAULTS = ("removed", "dark", "inverted", "scale", "sentinels", "clipped", "lag", "lamp")
#: Faults that a spot, which measures no light, has not.
OF_LIGHT = frozenset({"dark", "inverted", "lamp"})
LEVEL = 5.0
COUNT = 324


@dataclass
class Drawn:
    """A file with a fault, and what the sensor reads in flight.

    Attributes
    ----------
    path : Path
    said : str
        The fault and its amount.
    in_flight : callable
        Raw readings (N, K) of light (N, K).
    light : float
        Level of it in flight.
    unseen : bool
        Whether no file could show the fault: another sensor without it gives the same file.
    half : float
        Change of the scale of one half of an axis; zero where there is none.
    """

    path: Path
    said: str
    in_flight: Callable[[np.ndarray], np.ndarray]
    light: float = 1.0
    unseen: bool = False
    half: float = 0.0


def drawn(directory: Path, kind: str, fault: str, seed: int) -> Drawn:
    """Draw a file of a sensor with a fault; `fault` is empty for a clean one."""
    rng = np.random.default_rng([seed, FAULTS.index(fault) if fault else 99, len(kind)])
    sensor = SENSORS[kind]
    angles = poses(kind, rng)
    readings = sensor.read(sun_of(kind, angles), int(rng.integers(1 << 30)))
    path = directory / f"{kind}_{fault or 'clean'}_{seed}.csv"
    stated, said, made = angles, "clean", Drawn(path, "", lambda light: light)
    if fault:
        readings, stated, said, made = FAULT[fault](kind, readings, angles, made, rng)
    made.said = said
    names = ["azimuth_deg", "zenith_deg"] if kind == "faces" else ANGLES
    bench.write(path, [*sensor.names, *names], readings, stated)
    return made


def poses(kind: str, rng: np.random.Generator) -> np.ndarray:
    """Angles (N, 2) of a grid, a grid swept to and fro, or by chance."""
    half = SENSORS[kind].half_deg
    if kind == "faces":
        drawn_at = rng.normal(size=(COUNT, 3))
        drawn_at /= np.linalg.norm(drawn_at, axis=1)[:, None]
        return np.degrees(
            np.column_stack([np.arctan2(drawn_at[:, 1], drawn_at[:, 0]), np.arccos(drawn_at[:, 2])])
        )
    form = int(rng.integers(3))
    if form == 2:
        return rng.uniform(-half, half, (COUNT, 2))
    grid = bench.grid(round(COUNT**0.5), half).reshape(-1, round(COUNT**0.5), 2)
    if form == 1:
        grid = grid.copy()
        grid[1::2] = grid[1::2, ::-1]
    return grid.reshape(-1, 2)


def sun_of(kind: str, angles: np.ndarray) -> np.ndarray:
    """Directions (N, 3) of a sensor's angles (N, 2)."""
    if kind != "faces":
        return bench.sun_of(angles)
    a, z = np.radians(angles).T
    return np.column_stack([np.sin(z) * np.cos(a), np.sin(z) * np.sin(a), np.cos(z)])


def true_error(found: Calibration, kind: str, made: Drawn, seed: int) -> tuple[float, float]:
    """Return the RMS error in flight, degrees, and the share of answers, at fresh poses.

    Readings beyond the calibration's limits are not answered.
    """
    sensor = SENSORS[kind]
    rng = np.random.default_rng([seed, 77])
    if kind == "faces":
        sun = bench.sphere(1500, int(rng.integers(1 << 30)))
    else:
        sun = bench.sun_of(rng.uniform(-sensor.half_deg, sensor.half_deg, (1500, 2)))
    light = sensor.read(sun, int(rng.integers(1 << 30)))
    raw = made.in_flight(light * (made.light if kind != "spot" else 1.0))
    limits = found.limits
    flagged = ((raw <= np.array(limits.low)) | (raw >= np.array(limits.high))).any(axis=1)
    settings = found.settings
    vectors = settings.direction.model_copy(
        update={"form": "vector", "columns": ("sx", "sy", "sz"), "unit": "deg"}
    )
    rows = settings.rows.model_copy(update={"shift": 0})
    settings = settings.model_copy(update={"direction": vectors, "rows": rows})
    keep = ~flagged
    if not keep.any():
        return float("nan"), 0.0
    columns = dict(
        zip([*sensor.names, "sx", "sy", "sz"], np.column_stack([raw, sun])[keep].T, strict=True)
    )
    new = readings_of(Table(columns, 2, "flight", {}), settings)
    error = separation_deg(found.model.predict(new.features, new.context), new.sun)
    known = np.isfinite(error)
    if not known.any():
        return float("nan"), 0.0
    return float(np.sqrt(np.mean(error[known] ** 2))), float(known.sum() / len(sun))


def _removed(kind, readings, angles, made, rng):
    share = rng.uniform(0.03, 0.45)
    count = int(share * len(readings))
    form = ("scattered", "rows", "place")[int(rng.integers(3))]
    if form == "scattered":
        at = rng.choice(len(readings), count, replace=False)
    elif form == "rows":
        at = np.arange(count) + int(rng.integers(len(readings) - count))
    else:
        sun = sun_of(kind, angles)
        at = np.argsort(-(sun @ sun[int(rng.integers(len(sun)))]))[:count]
    readings = readings.copy()
    readings[at] = readings[rng.permutation(at)]
    return readings, angles, f"{share:.2f} of the rows exchanged, {form}", made


def _dark(kind, readings, angles, made, rng):
    dark = rng.uniform(0.03, 0.4) * float(readings.mean())
    made.in_flight, made.light = lambda light: light + dark, 0.9
    return readings + dark, angles, f"dark {dark:.3f}", made


def _inverted(kind, readings, angles, made, rng):
    level = LEVEL * rng.uniform(0.8, 1.5)
    made.in_flight, made.light = lambda light: level - light, 0.9
    return level - readings, angles, f"falling from {level:.2f}", made


def _scale(kind, readings, angles, made, rng):
    factor = 1.0 + rng.choice([-1, 1]) * rng.uniform(0.02, 0.15)
    which = ("all", "first", "half")[int(rng.integers(3))]
    stated = angles.copy()
    if kind == "faces":
        stated[:, 1] *= factor
        which = "zenith"
    elif which == "all":
        stated *= factor
    elif which == "first":
        stated[:, 0] *= factor
    else:
        stated[:, 0] = np.where(angles[:, 0] > 0, factor * angles[:, 0], angles[:, 0])
        made.half = abs(factor - 1.0)
    made.unseen = which in ("all", "first") and kind == "electrodes"
    return readings, stated, f"scale {factor:.3f} of {which}", made


def _sentinels(kind, readings, angles, made, rng):
    value = float(rng.choice([-999.0, 9999.0, -1.0, 0.0, 65535.0]))
    share, lag = rng.uniform(0.02, 0.12), int(rng.integers(4))
    readings = np.roll(readings, lag, axis=0)
    at = rng.choice(len(readings), int(share * len(readings)), replace=False)
    readings[at] = value
    return readings, angles, f"{share:.2f} of the rows {value:g}, {lag} rows late", made


def _clipped(kind, readings, angles, made, rng):
    share = rng.uniform(0.01, 0.15)
    limit = round(float(np.quantile(readings, 1.0 - share)), 6)
    made.in_flight = lambda light: np.minimum(light, limit)
    return np.minimum(readings, limit), angles, f"clipped at {limit:.3f} ({share:.2f})", made


def _lag(kind, readings, angles, made, rng):
    if kind == "faces" or rng.integers(2):
        lag = int(rng.integers(1, 4)) * int(rng.choice([-1, 1]))
        return np.roll(readings, lag, axis=0), angles, f"{lag} rows late", made
    lag = rng.uniform(0.1, 0.9)
    grid = bench.grid(round(COUNT**0.5), SENSORS[kind].half_deg).reshape(-1, round(COUNT**0.5), 2)
    grid = grid.copy()
    grid[1::2] = grid[1::2, ::-1]
    angles = grid.reshape(-1, 2)
    late = angles[1:] * (1.0 - lag) + angles[:-1] * lag
    readings = SENSORS[kind].read(sun_of(kind, late), int(rng.integers(1 << 30)))
    return readings, angles[1:], f"{lag:.2f} of a row late", made


def _lamp(kind, readings, angles, made, rng):
    end = rng.uniform(0.5, 0.95)
    light = np.linspace(1.0, end, len(readings))[:, None]
    return readings * light, angles, f"lamp fades to {end:.2f}", made


FAULT = {
    "removed": _removed, "dark": _dark, "inverted": _inverted, "scale": _scale,
    "sentinels": _sentinels, "clipped": _clipped, "lag": _lag, "lamp": _lamp,
}  # fmt: skip

"""Five kinds of sensors with the same noise everywhere, and models that read each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bench
import numpy as np

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

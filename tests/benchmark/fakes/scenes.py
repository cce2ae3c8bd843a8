"""Scenes and directions that many tests of sensors look at."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from benchmark import datasets
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.scene import Scene


def lit_by(sun: np.ndarray) -> Scene:
    """Suns as bright as the standard one, without stray light."""
    return Scene(sun, np.ones(len(sun)), np.zeros(len(sun)))


def toward(alpha: float, beta: float) -> np.ndarray:
    """One direction (1, 3), by its projection angles in degrees."""
    return from_angles(np.array([alpha]), np.array([beta]))


def incident(theta_deg: float, azimuth_deg: float) -> np.ndarray:
    """One direction (1, 3), by its angle off the boresight and its azimuth."""
    theta, azimuth = math.radians(theta_deg), math.radians(azimuth_deg)
    across = math.sin(theta)
    return np.array([[across * math.cos(azimuth), across * math.sin(azimuth), math.cos(theta)]])


def nominal(name: str) -> Any:
    """The sensor of a data set under its nominal condition."""
    return datasets.get(name).setups["nominal"].sensor


def apart_deg(first: np.ndarray, second: np.ndarray) -> float:
    """The largest angle between directions, near zero."""
    return float(np.degrees(np.linalg.norm(np.cross(first, second), axis=-1)).max())

"""Files of made-up turntables, written apart from the simulator: a camera and a quadrant."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

CENTRE, FOCAL, NOISE = 512.0, 350.0, 0.05
#: Light that each quadrant sees beside its own share.
STRAY = 0.02


def grid(count: int = 25, half: float = 50.0) -> np.ndarray:
    """Angles (N, 2) of a square of poses."""
    line = np.linspace(-half, half, count)
    first, second = np.meshgrid(line, line)
    return np.column_stack([first.ravel(), second.ravel()])


def sun_of(angles: np.ndarray) -> np.ndarray:
    """Directions of rotations, the alpha axis next to the sensor."""
    a, b = np.radians(angles).T
    return np.column_stack([np.sin(b) * np.cos(a), np.sin(a), np.cos(b) * np.cos(a)])


def angles_of(sun: np.ndarray) -> np.ndarray:
    x, y, z = sun.T
    return np.degrees(np.column_stack([np.arctan2(y, np.hypot(x, z)), np.arctan2(x, z)]))


def turn(axis: str, angle: float) -> np.ndarray:
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return {
        "x": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


def spots(sun: np.ndarray, seed: int) -> np.ndarray:
    """Spots of a pinhole camera, slightly tilted, with noise."""
    seen = sun @ (turn("x", 0.4) @ turn("y", -0.3) @ turn("z", 0.5)).T
    tangents = seen[:, :2] / seen[:, 2:]
    noise = np.random.default_rng(seed).normal(0.0, NOISE, tangents.shape)
    return CENTRE + FOCAL * tangents + noise


def quadrants(sun: np.ndarray, seed: int, width: float = 2.0, focal: float = 1.5) -> np.ndarray:
    """Light on four quadrants of a detector under a square aperture of half its width.

    Beyond the edge of the patch light is lost on one side, and the balance falls again.
    """
    tangents = sun[:, :2] / sun[:, 2:]
    x, y = (focal * tangents).T

    def overlap(middle: np.ndarray, low: float, high: float) -> np.ndarray:
        return np.clip(
            np.minimum(middle + width / 2, high) - np.maximum(middle - width / 2, low), 0.0, None
        )

    left, right = overlap(x, -width, 0.0), overlap(x, 0.0, width)
    down, up = overlap(y, -width, 0.0), overlap(y, 0.0, width)
    light = np.column_stack([left * up, right * up, right * down, left * down]) * sun[:, [2]]
    light += STRAY
    return light + np.random.default_rng(seed).normal(0.0, 0.002, light.shape)


def write(path: Path, header: list[str], *columns: np.ndarray) -> Path:
    rows = np.column_stack(columns)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows([[f"{value:.6f}" for value in row] for row in rows])
    return path


HEADER = ["x_px", "y_px", "theta_x_deg", "theta_y_deg"]


def balances(sun: np.ndarray, seed: int) -> np.ndarray:
    """Balances of two pairs of photodiodes whose gains differ and that saturate softly."""
    tangents = sun[:, :2] / sun[:, 2:]
    noise = np.random.default_rng(seed).normal(0.0, 0.003, tangents.shape)
    return np.tanh(0.55 * tangents + [0.02, -0.01]) * [1.0, 0.96] + noise


def electrodes(sun: np.ndarray, seed: int) -> np.ndarray:
    """Currents x+, x-, y+, y- of a position-sensitive detector behind a hole, with barrel error."""
    tangents = sun[:, :2] / sun[:, 2:] @ turn("z", 1.0)[:2, :2].T
    place = 0.4 * tangents * (1.0 - 0.05 * (tangents**2).sum(axis=1))[:, None]
    light = sun[:, 2]
    pairs = [1.0 + place[:, 0], 1.0 - place[:, 0], 1.0 + place[:, 1], 1.0 - place[:, 1]]
    currents = np.column_stack([pair * light for pair in pairs])
    return currents + np.random.default_rng(seed).normal(0.0, 0.002, currents.shape)


def faces(sun: np.ndarray, seed: int) -> np.ndarray:
    """Currents of six solar cells on a box, each a little askew and of its own gain."""
    normals = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
    askew = np.random.default_rng(11).normal(0.0, np.radians(1.0), normals.shape)
    normals = normals + askew
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    gains = np.array([1.0, 0.93, 1.05, 0.98, 1.02, 0.96])
    light = np.maximum(sun @ normals.T, 0.0) * gains
    return light + np.random.default_rng(seed).normal(0.0, 0.004, light.shape)


def sphere(count: int, seed: int) -> np.ndarray:
    """Directions (count, 3) drawn over the whole sphere."""
    drawn = np.random.default_rng(seed).normal(size=(count, 3))
    return drawn / np.linalg.norm(drawn, axis=1)[:, None]

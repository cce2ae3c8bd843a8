"""Sensors by which no method here was chosen: other layouts, other noise, other poses.

Faces that go dark inside the field and across its bands, noise with long tails, a grid of poses.
"""

from __future__ import annotations

import bench
import numpy as np
from uneven import Drawn, Uneven, ball, cone, outwards, square

#: Where a cube's faces look that stands on none of them.
TURNED = np.vstack([one := bench.turn("x", 35.0) @ bench.turn("y", 25.0), -one])
_GOLDEN = (1.0 + 5.0**0.5) / 2.0


def tailed(drawn: Drawn, shape: tuple[int, ...]) -> np.ndarray:
    """Student's t of four freedoms, of unit variance."""
    return np.asarray(drawn.standard_t(4.0, shape) / np.sqrt(2.0))


def steep() -> np.ndarray:
    """A face to the boresight and four tilted by 65 deg, which go dark at 25 deg."""
    turn, tilt = np.radians([0.0, 90.0, 180.0, 270.0]), np.radians(65.0)
    level = np.full(4, np.cos(tilt))
    around = np.column_stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), level])
    return np.vstack([around, [0.0, 0.0, 1.0]])


def corners() -> np.ndarray:
    """Twelve faces that look at the corners of an icosahedron."""
    flat = [(0.0, a, b * _GOLDEN) for a in (1.0, -1.0) for b in (1.0, -1.0)]
    every = np.vstack([np.roll(flat, by, axis=1) for by in range(3)])
    return np.asarray(every / np.linalg.norm(every, axis=1)[:, None])


def of_faces(normals: np.ndarray, noise: float, sun: np.ndarray, drawn: Drawn) -> np.ndarray:
    gains = 1.0 + 0.05 * np.sin(np.arange(len(normals)) * 2.0)
    light = np.maximum(sun @ normals.T, 0.0) * gains
    return np.asarray(light + noise * drawn.normal(size=light.shape) * (1.2 - sun[:, [0]]))


def spots(sun: np.ndarray, drawn: Drawn) -> np.ndarray:
    """Spots with long tails, on one side noisier."""
    found = bench.CENTRE + bench.FOCAL * sun[:, :2] / sun[:, 2:]
    return np.asarray(found + 0.2 * tailed(drawn, found.shape) * (1.0 + 0.8 * sun[:, [1]]))


def quadrants(sun: np.ndarray, drawn: Drawn) -> np.ndarray:
    light = bench.quadrants(sun, int(drawn.integers(1 << 30)))
    return light + 0.006 * tailed(drawn, light.shape) * (0.5 + outwards(sun))


def gridded(count: int, drawn: Drawn) -> np.ndarray:
    """A square grid over 2 x 45 deg, by chance where the poses are no square."""
    side = round(count**0.5)
    return bench.sun_of(bench.grid(side, 45.0)) if side**2 == count else square(45.0)(count, drawn)


def electrodes(sun: np.ndarray, drawn: Drawn) -> np.ndarray:
    currents = bench.electrodes(sun, int(drawn.integers(1 << 30)))
    return currents + drawn.uniform(-0.02, 0.02, currents.shape) * (0.3 + outwards(sun))


def _array(normals: np.ndarray, noise: float) -> tuple[tuple[str, ...], object]:
    names = tuple(f"cell{at}" for at in range(len(normals)))
    return names, lambda sun, drawn: of_faces(normals, noise, sun, drawn)


def array(normals: np.ndarray, noise: float, poses: object) -> Uneven:
    names, read = _array(normals, noise)
    return Uneven(names, poses, read, ("assembled-faces", "polynomial-signals"), "channels")


SENSORS = {
    "tailed spots": Uneven(("x_px", "y_px"), square(45.0), spots, ("homography", "lut-polynomial")),
    "tailed quadrants": Uneven(
        ("q1", "q2", "q3", "q4"), square(28.0), quadrants, ("polynomial-2d", "fourier-balance")
    ),
    "gridded electrodes": Uneven(
        ("x_plus", "x_minus", "y_plus", "y_minus"), gridded, electrodes, ("polynomial-2d", "lsq")
    ),
    "turned cube": array(TURNED, 0.006, ball),
    "steep pyramid": array(steep(), 0.004, cone(60.0)),
    "twelve cells": array(corners(), 0.006, ball),
}

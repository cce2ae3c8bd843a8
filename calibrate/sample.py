"""A sample file: a small camera behind a pinhole on a turntable, made up."""

from __future__ import annotations

from functools import cache

import numpy as np

from algorithms.angles import sun_from_rotations

NAME = "sample.csv"
_STEPS, _HALF_DEG, _SEED = 15, 45.0, 20_260_103
_CENTRE_PX, _FOCAL_PX, _NOISE_PX = (511.2, 509.4), 380.0, 0.04
#: Rows whose second angle was written down wrong, and by how much, degrees.
_WRONG = {37: 3.0, 118: -4.5}


@cache
def sample() -> bytes:
    """Return a CSV file of readings and the turntable's angles; two poses are wrong."""
    line = np.linspace(-_HALF_DEG, _HALF_DEG, _STEPS)
    outer, inner = (grid.ravel() for grid in np.meshgrid(line, line))
    angles = np.column_stack([inner, outer])
    sun = sun_from_rotations(angles, inner="alpha")
    noise = np.random.default_rng(_SEED).normal(0.0, _NOISE_PX, (len(sun), 2))
    spots = np.array(_CENTRE_PX) + _FOCAL_PX * sun[:, :2] / sun[:, 2:] + noise
    stated = angles.copy()
    for row, error in _WRONG.items():
        stated[row, 1] += error
    lines = ["x_px,y_px,theta_x_deg,theta_y_deg"]
    lines += [",".join(f"{value:.3f}" for value in row) for row in np.column_stack([spots, stated])]
    return ("\n".join(lines) + "\n").encode()

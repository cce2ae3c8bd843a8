"""Heads turned by a known angle, and how often intervals hold known parameters."""

import numpy as np

SEEDS = 200


def rotation_about(axis, angle_deg):
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = c
    matrix[i, j], matrix[j, i] = -s, s
    return matrix


def covered(model, truth, features, sun, *, noise, seeds=SEEDS):
    """Share of 95 % intervals, over seeds and parameters, that hold the truth."""
    rng = np.random.default_rng(17)
    held = []
    for _ in range(seeds):
        model.fit(features + noise * rng.standard_normal(features.shape), sun)
        for name, value in truth.items():
            lowest, highest = model.quality_.parameter(name).interval()
            held.append(lowest <= value <= highest)
    return float(np.mean(held))

"""What a fit of a forward model repeats at each trial: tangents in the head, and errors there."""

from __future__ import annotations

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

Circle = tuple[float, float]


@compiled
def tangents_in_head(
    sun: Floats, rotation: Circle, tilt_x: Circle, tilt_y: Circle, out: Floats
) -> None:
    """Turn directions (N, 3) into tangents (N, 2) in the head's frame; NaN rows behind it.

    Turns by their cosines and sines, as `algorithms.calibration.forward.inward`.
    """
    (cz, sz), (cx, sx), (cy, sy) = rotation, tilt_x, tilt_y
    for i in range(len(sun)):
        x, y, z = sun[i, 0], sun[i, 1], sun[i, 2]
        y, z = cx * y + sx * z, cx * z - sx * y
        x, z = cy * x - sy * z, sy * x + cy * z
        x, y = cz * x + sz * y, cz * y - sz * x
        if z > 0:
            out[i, 0], out[i, 1] = x / z, y / z
        else:
            out[i, 0] = out[i, 1] = np.nan


@compiled
def across_axes(steps: Floats, first: Floats, second: Floats, undefined: float) -> None:
    """Turn steps (N, 2) of (s_x, s_y) into those along two axes (N, 3), in place.

    `undefined` for one that is not finite.
    """
    for i in range(len(steps)):
        x, y = steps[i, 0], steps[i, 1]
        along = x * first[i, 0] + y * first[i, 1]
        across = x * second[i, 0] + y * second[i, 1]
        steps[i, 0] = along if np.isfinite(along) else undefined
        steps[i, 1] = across if np.isfinite(across) else undefined

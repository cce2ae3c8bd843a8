"""What a parametric fit repeats at each trial: turns of the head, and errors across the Sun."""

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
def directions_outside(  # noqa: PLR0917 - Numba takes no keyword-only ones
    x: Floats, y: Floats, rotation: Circle, tilt_x: Circle, tilt_y: Circle, out: Floats
) -> None:
    """Turn tangents (N,) in the head's frame into unit vectors (N, 3); NaN rows where behind.

    The inverse of `tangents_in_head`.
    """
    (cz, sz), (cx, sx), (cy, sy) = rotation, tilt_x, tilt_y
    for i in range(len(x)):
        u, v = cz * x[i] - sz * y[i], sz * x[i] + cz * y[i]
        u, w = cy * u + sy, cy - sy * u
        v, w = cx * v - sx * w, sx * v + cx * w
        length = np.sqrt(u * u + v * v + w * w)
        if w > 0 and 0 < length < np.inf:
            out[i, 0], out[i, 1], out[i, 2] = u / length, v / length, w / length
        else:
            out[i] = np.nan


@compiled
def offsets_across(  # noqa: PLR0917 - Numba takes no keyword-only ones
    found: Floats, sun: Floats, first: Floats, second: Floats, off: Floats, lengths: Floats
) -> None:
    """Components of directions (N, 3) along two axes across the true ones, into `off` (N, 2).

    And how far they reach across it and along it, into `lengths` (2, N).
    """
    for i in range(len(found)):
        x, y, z = found[i, 0], found[i, 1], found[i, 2]
        a = x * first[i, 0] + y * first[i, 1] + z * first[i, 2]
        b = x * second[i, 0] + y * second[i, 1] + z * second[i, 2]
        off[i, 0], off[i, 1] = a, b
        lengths[0, i] = np.sqrt(a * a + b * b)
        lengths[1, i] = x * sun[i, 0] + y * sun[i, 1] + z * sun[i, 2]


@compiled
def stretch_to_angles(off: Floats, sines: Floats, angles: Floats, undefined: float) -> None:
    """Bring components (N, 2) of the given sines (N,) to angles (N,), in place.

    `undefined` for one that is not finite.
    """
    for i in range(len(off)):
        ratio = angles[i] / sines[i] if sines[i] > 0 else 1.0
        for k in range(2):
            off[i, k] = off[i, k] * ratio if np.isfinite(off[i, k]) else undefined


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

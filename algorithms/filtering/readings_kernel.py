"""What a sensor reads of a direction, and how that changes: faces with albedo, and spots.

States as `algorithms.filtering.sun_kernel` has them. `chosen` (p,) says which parameter of the
sensor each of a state's is; all others are 0. Known are rate (3), nadir (3) and warmth (1). The
three numbers of a state from `turn` on are the head's turn; there is none where that is 0.
"""

from __future__ import annotations

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.filtering.sun_kernel import heading_slopes, turn_heading


@compiled
def faces(  # noqa: PLR0915, PLR0917 - values and derivatives together
    states: Floats,
    chosen: Floats,
    known: Floats,
    turn: int,
    design: Floats,
    albedo: Floats,
) -> tuple[Floats, Floats]:
    """Signals (B, K) of faces and their derivatives (B, K, n).

    Parameters are the light's level, the albedo's, then a gain a face, two tilts a face. `design`
    (K, 16) holds of each face normal (3), axes across it (6), dark signal, coefficients of the
    cosine, its square and its cube, and of the cosine times warmth, full signal, and a step where
    the Sun begins to light it. `albedo` (12,)
    holds coefficients of what the Earth adds, over the full signal, of ``z^i u^j`` (i, j = 0..2),
    ``w``, ``w u`` and ``w z``: z the cosine of the Sun's zenith distance below the satellite, u the
    face's towards nadir, w towards the Sun's side of it.
    """
    states = turn_heading(states, turn)
    count, number = len(states), len(design)
    n, sensor = states.shape[1] - 7, 2 + 3 * number
    signals = np.empty((count, number))
    slopes = np.zeros((count, number, n))
    values, each = np.empty(sensor), np.empty(sensor)
    for b in range(count):
        values[:] = 0.0
        for p in range(len(chosen)):
            values[int(chosen[p])] = states[b, 12 + p]
        sx, sy, sz = states[b, 6], states[b, 7], states[b, 8]
        zenith = -(known[3] * sx + known[4] * sy + known[5] * sz)
        level, earth = 1.0 + values[0], 1.0 + values[1]
        for k in range(number):
            first, second = values[2 + number + 2 * k], values[3 + number + 2 * k]
            nx = design[k, 0] + first * design[k, 3] + second * design[k, 6]
            ny = design[k, 1] + first * design[k, 4] + second * design[k, 7]
            nz = design[k, 2] + first * design[k, 5] + second * design[k, 8]
            c = nx * sx + ny * sy + nz * sz
            light, slope = 0.0, 0.0
            if c > 0.0:
                linear = design[k, 10] + design[k, 13] * known[6]
                light = ((design[k, 12] * c + design[k, 11]) * c + linear) * c + design[k, 15]
                slope = (3.0 * design[k, 12] * c + 2.0 * design[k, 11]) * c + linear
            u = nx * known[3] + ny * known[4] + nz * known[5]
            w = c + u * zenith
            glow, by_zenith, by_side = 0.0, 0.0, 0.0
            power = 1.0
            for j in range(3):
                glow += power * (albedo[j] + zenith * (albedo[3 + j] + zenith * albedo[6 + j]))
                by_zenith += power * (albedo[3 + j] + 2.0 * zenith * albedo[6 + j])
                power *= u
            glow += w * (albedo[9] + u * albedo[10] + zenith * albedo[11])
            by_zenith += w * albedo[11]
            by_side += albedo[9] + u * albedo[10] + zenith * albedo[11]
            full = design[k, 14]
            gain = 1.0 + values[2 + k]
            signals[b, k] = design[k, 9] + gain * level * (light + earth * full * glow)
            # dw/ds = n - u nadir, dz/ds = -nadir
            outer = gain * level * earth * full
            direct = gain * level * slope + outer * by_side
            under = -outer * (by_zenith + u * by_side)
            gx = direct * nx + under * known[3]
            gy = direct * ny + under * known[4]
            gz = direct * nz + under * known[5]
            slopes[b, k, 0] = gx * states[b, 0] + gy * states[b, 1] + gz * states[b, 2]
            slopes[b, k, 1] = gx * states[b, 3] + gy * states[b, 4] + gz * states[b, 5]
            each[:] = 0.0
            each[0] = gain * (light + earth * full * glow)
            each[1] = gain * level * full * glow
            each[2 + k] = level * (light + earth * full * glow)
            steep = gain * level * slope
            for a in range(2):
                at = 3 + 3 * a
                towards = design[k, at] * sx + design[k, at + 1] * sy + design[k, at + 2] * sz
                each[2 + number + 2 * k + a] = steep * towards
            for p in range(len(chosen)):
                slopes[b, k, 5 + p] = each[int(chosen[p])]
    heading_slopes(states, slopes, turn)
    return signals, slopes


@compiled
def spots(  # noqa: C901, PLR0912, PLR0915, PLR0917 - values and derivatives together
    states: Floats,
    chosen: Floats,
    known: Floats,
    turn: int,
    powers: Floats,
    design: Floats,
    warm: Floats,
) -> tuple[Floats, Floats]:
    """Spots (B, 2), px, and their derivatives (B, 2, n); NaN where the Sun is not in front.

    Parameters are tilts of the head about x and y, focal length (relative) and offsets x and y
    (over the focal length). `powers` (q, 2) are exponents of the tangents, `design` (q, 2)
    coefficients, px; the first of them is of 1, the centre. `warm` (3, 2) are of 1 and the
    tangents, times warmth. The focal length's scale is ``design`` of the first tangent.
    """
    states = turn_heading(states, turn)
    count, n = len(states), states.shape[1] - 7
    found, slopes = np.empty((count, 2)), np.zeros((count, 2, n))
    values, each = np.empty(5), np.empty(5)
    degree = 0
    for q in range(len(powers)):
        degree = max(degree, int(powers[q, 0]), int(powers[q, 1]))
    first, second = np.empty(degree + 1), np.empty(degree + 1)
    scale = 0.0
    for q in range(len(powers)):
        if powers[q, 0] == 1.0 and powers[q, 1] == 0.0:
            scale = abs(design[q, 0])
    for b in range(count):
        values[:] = 0.0
        for p in range(len(chosen)):
            values[int(chosen[p])] = states[b, 12 + p]
        tx, ty = values[0], values[1]
        # a small turn of the head about x, then y
        x = states[b, 6] + ty * states[b, 8]
        y = states[b, 7] - tx * states[b, 8]
        z = states[b, 8] + tx * states[b, 7] - ty * states[b, 6]
        if not z > 0.05:
            found[b] = np.nan
            slopes[b] = np.nan
            continue
        beta, alpha = x / z, y / z
        first[0], second[0] = 1.0, 1.0
        for d in range(degree):
            first[d + 1], second[d + 1] = first[d] * beta, second[d] * alpha
        for axis in range(2):
            value = warm[0, axis] * known[6]
            value += (warm[1, axis] * beta + warm[2, axis] * alpha) * known[6]
            by_beta, by_alpha = warm[1, axis] * known[6], warm[2, axis] * known[6]
            for q in range(len(powers)):
                i, j = int(powers[q, 0]), int(powers[q, 1])
                if i + j == 0:
                    continue
                value += design[q, axis] * first[i] * second[j]
                if i:
                    by_beta += design[q, axis] * i * first[i - 1] * second[j]
                if j:
                    by_alpha += design[q, axis] * j * first[i] * second[j - 1]
            longer = 1.0 + values[2]
            found[b, axis] = design[0, axis] + longer * value + scale * values[3 + axis]
            by_x, by_y = longer * by_beta / z, longer * by_alpha / z
            by_z = -longer * (by_beta * beta + by_alpha * alpha) / z
            # back through the head's turn
            gx = by_x - ty * by_z
            gy = by_y + tx * by_z
            gz = by_z + ty * by_x - tx * by_y
            for e in range(2):
                at = 3 * e
                slopes[b, axis, e] = (
                    gx * states[b, at] + gy * states[b, at + 1] + gz * states[b, at + 2]
                )
            each[:] = 0.0
            each[0] = -by_y * states[b, 8] + by_z * states[b, 7]
            each[1] = by_x * states[b, 8] - by_z * states[b, 6]
            each[2] = value
            each[3 + axis] = scale
            for p in range(len(chosen)):
                slopes[b, axis, 5 + p] = each[int(chosen[p])]
    heading_slopes(states, slopes, turn)
    return found, slopes

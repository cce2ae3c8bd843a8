"""How the Sun's direction moves in a turning body: propagation, errors, Jacobian.

A state is (B, 12 + p): two axes across the direction, the direction, the gyroscope's bias (rad/s)
and p parameters of the sensor. The axes turn with the direction, so that an error's components
keep their meaning from step to step. An error is (B, 5 + p): along both axes (rad), bias,
parameters.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Angle, rad, below which series stand for quotients.
_SMALL = 1e-4


@compiled
def _turn(state: Floats, x: float, y: float, z: float, out: Floats) -> None:
    """Write into `out` (S,) axes and direction of a state (S,) after a turn, a rotation vector."""
    squared = x * x + y * y + z * z
    angle = math.sqrt(squared)
    if angle > _SMALL:
        sine, versine = math.sin(angle) / angle, (1.0 - math.cos(angle)) / squared
    else:
        sine, versine = 1.0 - squared / 6.0, 0.5 - squared / 24.0
    for start in range(0, 9, 3):
        u, v, w = state[start], state[start + 1], state[start + 2]
        cu, cv, cw = y * w - z * v, z * u - x * w, x * v - y * u
        out[start] = u + sine * cu + versine * (y * cw - z * cv)
        out[start + 1] = v + sine * cv + versine * (z * cu - x * cw)
        out[start + 2] = w + sine * cw + versine * (x * cv - y * cu)


@compiled
def propagate(states: Floats, rate: Floats, step_s: float) -> Floats:
    """States (B, S) after a body turned at `rate` (3,), rad/s as read, less its bias."""
    out = states.copy()
    for b in range(len(states)):
        # the Sun stands still: seen from the body it turns by the opposite
        x = -(rate[0] - states[b, 9]) * step_s
        y = -(rate[1] - states[b, 10]) * step_s
        z = -(rate[2] - states[b, 11]) * step_s
        _turn(states[b], x, y, z, out[b])
    return out


@compiled
def advance(states: Floats, rate: Floats, step_s: float) -> tuple[Floats, Floats]:
    """States as `propagate` gives them, and its Jacobian (B, n, n)."""
    count, n = len(states), states.shape[1] - 7
    after, out = propagate(states, rate, step_s), np.zeros((count, n, n))
    turn = np.empty(3)
    for b in range(count):
        for i in range(n):
            out[b, i, i] = 1.0
        squared = 0.0
        for k in range(3):
            turn[k] = -(rate[k] - states[b, 9 + k]) * step_s
            squared += turn[k] * turn[k]
        angle = math.sqrt(squared)
        if angle > _SMALL:
            first = (1.0 - math.cos(angle)) / squared
            second = (angle - math.sin(angle)) / (squared * angle)
        else:
            first, second = 0.5 - squared / 24.0, 1.0 / 6.0 - squared / 120.0
        # rows e J of the left Jacobian J = 1 + first [t] + second [t]^2, e J = e - first t x e ...
        for row in range(2):
            sign = 1.0 if row == 0 else -1.0
            place = 3 if row == 0 else 0  # the other axis
            u, v, w = after[b, place], after[b, place + 1], after[b, place + 2]
            # e [t] is e x t
            cu = v * turn[2] - w * turn[1]
            cv = w * turn[0] - u * turn[2]
            cw = u * turn[1] - v * turn[0]
            du = cv * turn[2] - cw * turn[1]
            dv = cw * turn[0] - cu * turn[2]
            dw = cu * turn[1] - cv * turn[0]
            out[b, row, 2] = sign * step_s * (u + first * cu + second * du)
            out[b, row, 3] = sign * step_s * (v + first * cv + second * dv)
            out[b, row, 4] = sign * step_s * (w + first * cw + second * dw)
    return after, out


@compiled
def add_errors(states: Floats, errors: Floats) -> Floats:
    """States (B, S) with errors (B, n) added; the axes turn with the direction."""
    out = states.copy()
    for b in range(len(states)):
        # from e1 d1 + e2 d2 across the direction: turn about e2 d1 - e1 d2
        x = states[b, 3] * errors[b, 0] - states[b, 0] * errors[b, 1]
        y = states[b, 4] * errors[b, 0] - states[b, 1] * errors[b, 1]
        z = states[b, 5] * errors[b, 0] - states[b, 2] * errors[b, 1]
        _turn(states[b], x, y, z, out[b])
        # unit and across each other to the last bits, however many steps there were
        length = math.sqrt(out[b, 6] ** 2 + out[b, 7] ** 2 + out[b, 8] ** 2)
        for k in range(6, 9):
            out[b, k] /= length
        along = out[b, 0] * out[b, 6] + out[b, 1] * out[b, 7] + out[b, 2] * out[b, 8]
        for k in range(3):
            out[b, k] -= along * out[b, 6 + k]
        length = math.sqrt(out[b, 0] ** 2 + out[b, 1] ** 2 + out[b, 2] ** 2)
        for k in range(3):
            out[b, k] /= length
        for k in range(3):
            i, j = (k + 1) % 3, (k + 2) % 3
            out[b, 3 + k] = out[b, 6 + i] * out[b, j] - out[b, 6 + j] * out[b, i]
        for k in range(2, errors.shape[1]):
            out[b, 7 + k] = states[b, 7 + k] + errors[b, k]
    return out


@compiled
def turn_heading(states: Floats, first: int) -> Floats:
    """States (B, S) as a head sees them that is turned by their three numbers from `first` on.

    The states themselves where `first` is 0.
    """
    if first == 0:
        return states
    out = states.copy()
    for b in range(len(states)):
        x, y, z = states[b, first], states[b, first + 1], states[b, first + 2]
        if x * x + y * y + z * z == 0.0:
            continue
        _turn(states[b], x, y, z, out[b])
    return out


@compiled
def heading_slopes(states: Floats, slopes: Floats, first: int) -> None:
    """Write into `slopes` (B, m, n) how readings change with the head's small turns.

    A turn about an axis moves the direction by their cross product; by the axes across the
    direction, ``a x s = (a.e2) e1 - (a.e1) e2``. Nothing where `first` is 0.
    """
    if first == 0:
        return
    for b in range(len(states)):
        for i in range(slopes.shape[1]):
            for k in range(3):
                # (k x s) . e1 = k . (s x e1) = k . e2, and (k x s) . e2 = -k . e1
                slopes[b, i, first - 7 + k] = (
                    slopes[b, i, 0] * states[b, 3 + k] - slopes[b, i, 1] * states[b, k]
                )


@compiled
def errors_between(states: Floats, origins: Floats) -> Floats:
    """Errors (B, n) that take origins (B, S) to states, as `move` adds them."""
    count, n = len(states), states.shape[1] - 7
    out = np.empty((count, n))
    for b in range(count):
        along, first, second = 0.0, 0.0, 0.0
        for k in range(3):
            along += states[b, 6 + k] * origins[b, 6 + k]
            first += states[b, 6 + k] * origins[b, k]
            second += states[b, 6 + k] * origins[b, 3 + k]
        sine = math.sqrt(first * first + second * second)
        ratio = math.atan2(sine, along) / sine if sine > 1e-12 else 1.0
        out[b, 0], out[b, 1] = ratio * first, ratio * second
        for k in range(2, n):
            out[b, k] = states[b, 7 + k] - origins[b, 7 + k]
    return out

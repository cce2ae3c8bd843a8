"""Steps from raw readings to two features or signals, as they run on board; copied into modules.

Each takes the values (N, W), directions (N, 3), temperatures (N,) and its constants, and returns
values, directions and a status (N,), 0 where it has no objection. The C code has the same steps.
"""

# ruff: noqa: ARG001 - all steps take the same, whether they read it or not

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.contract import Floats

#: Statuses of an answer, in the order of the C code's enumeration.
STATUSES = (
    "OK",
    "NOT_FINITE",
    "DARK",
    "SATURATED",
    "TOO_BRIGHT",
    "TEMPERATURE",
    "OUTSIDE",
    "NO_SOLUTION",
)


def flagged(bad: Any, status: int) -> Any:
    """Return statuses (N,): the given one where bad, else 0."""
    return np.where(bad, status, 0)


def readings(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return signals of raw readings: dark taken off, gain divided out."""
    raw = v[:, c["place"]]
    signals = (raw - c["dark"]) / c["gain"]
    light = signals.sum(axis=1)
    status = flagged(light > c["most"], 4)
    clipped = ((raw <= c["low"]) | (raw >= c["high"])).any(axis=1)
    status = np.where(clipped, 3, status)
    status = np.where(~(light >= c["least"]) | (raw == 0).all(axis=1), 2, status)
    # no number fails the comparison
    status = np.where((np.abs(raw) <= c["largest"]).all(axis=1), status, 1)
    return signals, sun, status


def quadrants(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return balances of quadrants at (-x, +y), (+x, +y), (+x, -y), (-x, -y)."""
    first, second, third, fourth = v[:, :4].T
    total = first + second + third + fourth
    x = (second + third - first - fourth) / total
    y = (first + second - third - fourth) / total
    return np.column_stack([x, y]), sun, flagged(~(total > 0), 2)


def electrodes(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return balances of electrodes x+, x-, y+, y-."""
    along, up = v[:, 0] + v[:, 1], v[:, 2] + v[:, 3]
    balances = np.column_stack([(v[:, 0] - v[:, 1]) / along, (v[:, 2] - v[:, 3]) / up])
    return balances, sun, flagged(~((along > 0) & (up > 0)), 2)


def axes(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return two features swapped, mirrored or rotated."""
    (a, b), (d, e) = c["matrix"]
    x, y = v[:, 0], v[:, 1]
    return np.column_stack([a * x + b * y, d * x + e * y]), sun, flagged(False, 0)


def temperature_range(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Refuse temperatures outside those that were calibrated."""
    return v, sun, flagged(~((kelvin >= c["low"]) & (kelvin <= c["high"])), 5)


def cone(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Refuse directions outside those that were calibrated."""
    past = (sun @ c["normal"].T + c["offset"]).max(axis=1)
    return v, sun, flagged(~(past <= c["margin"]), 6)


def hull(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Refuse features outside those that were calibrated."""
    past = (v[:, :2] @ c["normal"].T + c["offset"]).max(axis=1)
    return v, sun, flagged(~(past <= c["margin"]), 6)


def chebyshev(u: Floats, degree: int) -> list[Floats]:
    """Return Chebyshev's polynomials 0 to degree at u (N,)."""
    found = [np.ones_like(u), u]
    for _ in range(degree - 1):
        found.append(2.0 * u * found[-1] - found[-2])
    return found[: degree + 1]


def polynomial(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return polynomials of two features, and of the temperature."""
    x, y, t = (
        (column - middle) / half
        for column, middle, half in zip(
            (v[:, 0], v[:, 1], kelvin), c["middle"], c["half"], strict=True
        )
    )
    tx, ty, tt = chebyshev(x, c["degree"]), chebyshev(y, c["degree"]), chebyshev(t, c["warm"])
    found = np.zeros((len(v), c["outputs"]))
    numbers = iter(c["coefficients"].reshape(-1))
    for output in range(c["outputs"]):
        for warm in range(c["warm"] + 1):
            for j in range(c["degree"] + 1):
                row = np.zeros(len(v))
                for i in range(c["degree"] + 1 - j):
                    row += next(numbers) * tx[i]
                found[:, output] += ty[j] * row if c["warm"] == 0 else tt[warm] * ty[j] * row
    return found, sun, flagged(False, 0)


def axis_polynomials(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return polynomials of each feature alone."""
    found = np.zeros((len(v), 2))
    for axis in range(2):
        terms = chebyshev((v[:, axis] - c["middle"][axis]) / c["half"][axis], c["degree"])
        for number, term in zip(c["coefficients"][axis], terms, strict=True):
            found[:, axis] += number * term
    return found, sun, flagged(False, 0)


def spline(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return two cubic splines over a grid of nodes, read at two features."""
    cells = (v[:, :2] - c["first"]) * c["per_step"]
    rows, columns = c["nodes"].shape[:2]
    corner = np.floor(np.nan_to_num(cells)).astype(int)
    corner = np.clip(corner, 1, [columns - 3, rows - 3])
    t = cells - corner
    weights = np.stack(
        [
            (1.0 - t) ** 3 / 6.0,
            (t * t * (0.5 * t - 1.0)) + 2.0 / 3.0,
            ((-0.5 * t + 0.5) * t + 0.5) * t + 1.0 / 6.0,
            t**3 / 6.0,
        ]
    )
    found = np.zeros((len(v), 2))
    for j in range(4):
        for i in range(4):
            node = c["nodes"][corner[:, 1] + j - 1, corner[:, 0] + i - 1]
            found += (weights[j, :, 1] * weights[i, :, 0])[:, None] * node
    return found, sun, flagged(False, 0)


def tangents(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions of s_x/s_z and s_y/s_z."""
    length = np.sqrt(v[:, 0] ** 2 + v[:, 1] ** 2 + 1.0)
    found = np.column_stack([v[:, 0], v[:, 1], np.ones(len(v))]) / length[:, None]
    return v, found, flagged(~np.isfinite(length), 7)


def angles(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions of the arc tangents of s_x/s_z and s_y/s_z, in radians."""
    bad = ~(np.abs(v[:, :2]) < np.pi / 2.0).all(axis=1)
    _, found, status = tangents(np.tan(v[:, :2]), sun, kelvin, c)
    return v, found, np.where(bad, 7, status)


def ratio(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions of vectors of any length in front of the sensor."""
    length = np.sqrt((v[:, :3] ** 2).sum(axis=1))
    return v, v[:, :3] / length[:, None], flagged(~(v[:, 2] > 0), 7)


def tangent_sigma(sun: Floats, c: Any) -> Any:
    """Return 1-sigma (N, 2) of two tangent axes at directions (N, 3), degrees."""
    x, y, z = (sun @ c["basis"].T).T
    off = np.degrees(np.arctan2(np.sqrt(x * x + y * y), z))
    place = np.degrees(np.arctan2(y, x)) * (c["SECTORS"] / 360.0) % c["SECTORS"]
    place, off = np.nan_to_num(place), np.nan_to_num(off)
    ring = np.clip(np.searchsorted(c["rings"], off) - 1, 0, c["RINGS"] - 2)
    low, high = c["rings"][ring], c["rings"][ring + 1]
    share = np.clip((off - low) / (high - low), 0.0, 1.0)[:, None]
    sector = place.astype(int)
    rest = (place - sector)[:, None]
    here, beside = sector % c["SECTORS"], (sector + 1) % c["SECTORS"]
    table = c["table"]
    inner = (1.0 - rest) * table[ring, here] + rest * table[ring, beside]
    outer = (1.0 - rest) * table[ring + 1, here] + rest * table[ring + 1, beside]
    found = (1.0 - share) * inner + share * outer
    return found * grazing(sun, c) if c["FACES"] else found


def grazing(sun: Floats, c: Any) -> Any:
    """Return what 1-sigma (N, 2) grows by where light grazes a face."""
    near = np.maximum(1.0 - (sun @ c["normals"].T / c["sine"]) ** 2, 0.0)
    shares = [(near * (axis @ c["normals"].T) ** 2).sum(axis=1) for axis in across(sun)]
    return np.sqrt(1.0 + c["grown"] * np.column_stack(shares))


def across(sun: Floats) -> Any:
    """Return two unit vectors (N, 3) square to directions (N, 3)."""
    start = np.where(np.abs(sun[:, [0]]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    first = np.cross(sun, start)
    first = first / np.sqrt((first**2).sum(axis=1))[:, None]
    return first, np.cross(sun, first)


def turned(sun: Floats, sigma: Floats, rotation: Floats) -> Any:
    """Return directions (N, 3) turned, and 1-sigma (N, 2) along the two axes of the new ones."""
    found = sun @ rotation.T
    before = [axis @ rotation.T for axis in across(sun)]
    parts = [
        sum((sigma[:, j] * (axis * before[j]).sum(axis=1)) ** 2 for j in range(2))
        for axis in across(found)
    ]
    return found, np.sqrt(np.column_stack(parts))

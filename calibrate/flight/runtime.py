"""Steps from raw readings to two features or signals, as they run on board; copied into modules.

Each takes the values (N, W), directions (N, 3), temperatures (N,) and its constants, and returns
values, directions and a status (N,), 0 where it has no objection. The C code has the same steps.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from algorithms.contract import Floats

# ruff: noqa: ARG001 - all steps take the same, whether they read it or not


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


# ruff: noqa: ARG001 - all steps take the same, whether they read it or not


def unit(vectors: Floats, good: Any) -> Any:
    """Return unit vectors (N, 3), and the status: no solution where not good, or of no length."""
    length = np.sqrt((vectors**2).sum(axis=1))
    bad = ~(good & (length > 0) & np.isfinite(length))
    return vectors / length[:, None], flagged(bad, 7)


def warmth(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return signals at the reference temperature: ``I / (1 + C (T - T_0))``."""
    change = 1.0 + c["coefficient"] * (kelvin - c["reference"])[:, None]
    return v / change, sun, flagged(~(change > 0).all(axis=1), 5)


def drift(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return signals times a polynomial of the temperature each, plus another."""
    terms = chebyshev((kelvin - c["middle"]) / c["half"], c["degree"])
    gain, level = np.zeros(v.shape), np.zeros(v.shape)
    for number, term in enumerate(terms):
        gain += term[:, None] * c["gain"][number]
        level += term[:, None] * c["level"][number]
    return v * gain + level, sun, flagged(False, 0)


def angular_loss(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return cosines of incidence of signals, by the inverse of a cubic response."""
    relative = v / c["gain"]
    b0, b1, b2, b3 = c["response"]
    cosine = np.clip(relative / (b0 + b1 + b2 + b3), 0.0, 1.2)
    for _ in range(6):
        value = ((b3 * cosine + b2) * cosine + b1) * cosine + b0
        slope = np.maximum((3.0 * b3 * cosine + 2.0 * b2) * cosine + b1, 0.1 * b1)
        cosine = np.clip(cosine - (value - relative) / slope, 0.0, 1.2)
    return cosine, sun, flagged(False, 0)


def maximum_currents(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return the brighter signal of each pair of opposite faces; the other becomes 0."""
    found = np.zeros(v.shape)
    relative = np.maximum(v / c["full"], 0.0)
    for plus, minus in zip(c["plus"], c["minus"], strict=True):
        kept = np.where(relative[:, plus] >= relative[:, minus], plus, minus)
        rows = np.arange(len(v))
        found[rows, kept] = relative[rows, kept] * c["full"][kept]
    return found, sun, flagged(False, 0)


def brighter_faces(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions of a cube: the brighter face of each pair is a component."""
    plus, minus = v[:, c["plus"]], v[:, c["minus"]]
    brighter = np.maximum(np.maximum(plus, minus), 0.0)
    found, status = unit(np.where(plus >= minus, brighter, -brighter), True)
    return v, found, status


def weighted_normals(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions: the sum of the lit faces' normals, weighted by their signals."""
    found, status = unit(np.maximum(v, 0.0) @ c["normal"], True)
    return v, found, status


def pyramidal(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions by three sums over a pyramid whose faces are all lit."""
    lit = (v > np.maximum(c["dark_share"] * v.max(axis=1), 0.0)[:, None]).all(axis=1)
    found, status = unit(v @ c["weight"], lit)
    return v, found, status


def pyramidal_constant(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions by two sums over a pyramid in which constant light cancels."""
    x, y = (v @ c["weight"]).T
    z = np.sqrt(1.0 - x * x - y * y)
    mean = v.sum(axis=1) / v.shape[1]
    constant = mean * c["coefficient"] - c["up"] * z
    misfit = (v - mean[:, None]) * c["coefficient"] - np.column_stack([x, y]) @ c["normal"].T
    good = (z > 0) & (constant >= -c["misfit"]) & (np.abs(misfit) <= c["misfit"]).all(axis=1)
    return v, np.column_stack([x, y, z]), flagged(~good, 7)


def panoramic(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Solve by weighted least squares over the cosines of the lit cells."""
    relative = v / c["reference"]
    lit = relative >= c["least_cosine"]
    weight = np.where(lit, relative if c["by_signal"] else 1.0, 0.0)
    matrix = np.einsum("nk,ki,kj->nij", weight, c["normal"], c["normal"])
    right = (weight * np.where(lit, relative, 0.0)) @ c["normal"]
    # the adjugate's rows: solves the equations but for a factor
    rows = np.stack(
        [np.cross(matrix[:, 1], matrix[:, 2]), np.cross(matrix[:, 2], matrix[:, 0]),
         np.cross(matrix[:, 0], matrix[:, 1])], axis=1,
    )  # fmt: skip
    determinant = (matrix[:, 0] * rows[:, 0]).sum(axis=1)
    trace = matrix[:, 0, 0] + matrix[:, 1, 1] + matrix[:, 2, 2]
    found, status = unit(
        np.einsum("nij,nj->ni", rows, right), determinant > c["flattest"] * trace**3
    )
    return v, found, status


def trig(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Solve three equations: the fitted cosine of each pair's brighter face."""
    seen = v - c["level"]
    relative = seen / c["amplitude"]
    later = relative[:, c["second"]] > relative[:, c["first"]]
    chosen = np.where(later, seen[:, c["second"]], seen[:, c["first"]])
    octant = later @ np.array([1, 2, 4])
    found = np.einsum("nij,nj->ni", c["inverse"][octant], chosen)
    found, status = unit(found, (chosen > 0).any(axis=1))
    return v, found, status


def trig_averaged(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions of the cosines that the brighter face of each pair gives."""
    vectors, lit = np.zeros((len(v), 3)), np.zeros(len(v), dtype=bool)
    for pair in range(3):
        one, other = v[:, c["first"][pair]], v[:, c["second"][pair]]
        level, single, double = c["curve"][pair]
        above = np.maximum(one, other) - (level - double)
        lit |= above > 0
        root = np.sqrt(single * single + 8.0 * double * above)
        # a curve that falls at first rises only past its lowest point
        falling = not single > 0
        cosine = (root - single) / (4.0 * double) if falling else 2.0 * above / (single + root)
        vectors += np.where(other > one, -cosine, cosine)[:, None] * c["normal"][pair]
    found, status = unit(vectors, lit)
    return v, found, status


def signal_polynomial(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions whose components are polynomials of all signals."""
    scaled = (v - c["middle"]) / c["half"]
    terms = [chebyshev(column, c["degree"]) for column in scaled.T]
    vectors = np.zeros((len(v), 3))
    for powers, coefficients in zip(c["power"], c["coefficients"], strict=True):
        term = np.ones(len(v))
        for signal, power in enumerate(powers):
            if power:
                term = term * terms[signal][power]
        vectors += term[:, None] * coefficients
    outside = ~(np.abs(scaled) <= c["reach"]).all(axis=1)
    found, status = unit(vectors, True)
    return v, found, np.where(outside, 6, status)


def solved(matrix: Floats, right: Floats) -> tuple[Floats, Floats]:
    """Return the solution (N, 3) of symmetric equations (N, 3, 3), and the inverse (N, 3, 3)."""
    rows = np.stack(
        [np.cross(matrix[:, 1], matrix[:, 2]), np.cross(matrix[:, 2], matrix[:, 0]),
         np.cross(matrix[:, 0], matrix[:, 1])], axis=1,
    )  # fmt: skip
    determinant = (matrix[:, 0] * rows[:, 0]).sum(axis=1)
    inverse = rows / np.where(determinant == 0.0, np.nan, determinant)[:, None, None]
    return np.einsum("nij,nj->ni", inverse, right), inverse


def assembled_equations(vector: Floats, light: Floats, c: Any) -> tuple[Floats, Floats, Floats]:
    """Return normal equations (N, 3, 3), right sides (N, 3) and sums of squares (N,)."""
    level = np.sqrt((vector**2).sum(axis=1))
    sun = vector / level[:, None]
    cosine = sun @ c["normal"].T
    b0, b1, b2, b3 = c["response"].T
    front = np.maximum(cosine, 0.0)
    # a line that rises towards the front, whatever the fit says of grazing light
    rise = np.maximum(b1, 0.1 * (b0 + b1 + b2 + b3))
    value = ((b3 * front + b2) * front + b1) * front + b0 + rise * (cosine - front)
    slope = np.where(cosine > 0, (3.0 * b3 * front + 2.0 * b2) * front + b1, rise)
    bend = value / c["width"]
    decay = np.exp(-np.minimum(np.abs(bend), 50.0))
    share = np.where(bend > 0, 1.0, decay) / (1.0 + decay)
    soft = c["width"] * (np.maximum(bend, 0.0) + np.log1p(decay))
    slope = np.where(bend > 40.0, slope, np.where(bend < -40.0, 0.0, slope * share))
    value = np.where(bend > 40.0, value, np.where(bend < -40.0, 0.0, soft))
    residual = (light - level[:, None] * value) / c["noise"]
    along = (value - slope * cosine) / c["noise"]
    row = along[:, :, None] * sun[:, None, :]
    row = row + (slope / c["noise"])[:, :, None] * c["normal"][None, :, :]
    steady = (1.0 - level) / c["level_spread"]
    normal = np.einsum("nki,nkj->nij", row, row)
    normal = normal + np.einsum("ni,nj->nij", sun, sun) / c["level_spread"] ** 2
    right = np.einsum("nki,nk->ni", row, residual) + sun * (steady / c["level_spread"])[:, None]
    return normal, right, (residual**2).sum(axis=1) + steady**2


def assembled_start(light: Floats, c: Any) -> tuple[Floats, Floats]:
    """Return vectors (N, 3) that fit the lit faces' cosines, and whether a face is lit (N,)."""
    lit = light > 3.0 * c["noise"]
    b0, b1, b2, b3 = c["response"].T
    cosine = np.clip(light / (b0 + b1 + b2 + b3), 0.0, 1.2)
    for _ in range(6):
        value = ((b3 * cosine + b2) * cosine + b1) * cosine + b0
        slope = np.maximum((3.0 * b3 * cosine + 2.0 * b2) * cosine + b1, 0.1 * b1)
        cosine = np.clip(cosine - (value - light) / slope, 0.0, 1.2)
    matrix = np.einsum("nk,ki,kj->nij", lit.astype(float), c["normal"], c["normal"])
    vector, _ = solved(matrix + 1e-6 * np.eye(3), (lit * cosine) @ c["normal"])
    # off the ridge between two dark faces, whose side rounding would choose
    length = np.sqrt((vector**2).sum(axis=1))
    return vector + length[:, None] * np.array([6e-4, 5e-4, 7e-4]), lit.any(axis=1)


def assembled_faces(v: Floats, sun: Floats, kelvin: Floats, c: Any) -> Any:
    """Return directions that best explain all signals, by Levenberg and Marquardt's steps."""
    light = v - c["dark"]
    vector, lit = assembled_start(light, c)
    normal, right, cost = assembled_equations(vector, light, c)
    damping = np.full(len(v), 1e-4)
    moving = lit & np.isfinite(cost)
    for _ in range(c["steps"]):
        if not moving.any():
            break
        more = (damping * np.trace(normal, axis1=1, axis2=2))[:, None, None] * np.eye(3)
        step, _ = solved(normal + more, right)
        here = (vector**2).sum(axis=1)
        tried = assembled_equations(vector + step, light, c)
        better = tried[2] <= cost * (1.0 + 1e-12)
        taken = better & moving
        vector = np.where(taken[:, None], vector + step, vector)
        normal = np.where(taken[:, None, None], tried[0], normal)
        right = np.where(taken[:, None], tried[1], right)
        cost = np.where(taken, tried[2], cost)
        damping = np.where(
            better, np.maximum(damping / 10.0, 1e-12), np.minimum(damping * 10.0, 1e6)
        )
        moving &= ~((step**2).sum(axis=1) <= 1e-26 * here)
    found, status = unit(vector, lit)
    _, inverse = solved(normal, right)
    along = np.einsum("nij,ni,nj->n", inverse, found, found)
    spread = (np.trace(inverse, axis1=1, axis2=2) - along) / 2.0 / (vector**2).sum(axis=1)
    return v, found, np.where((spread >= 0) & (spread <= c["worst"]), status, 7)

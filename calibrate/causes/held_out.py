"""Parts of the samples left out, each by itself: whether the stated intervals hold there too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from calibrate.readings import Readings

#: Share of errors that 95 % intervals must hold in each part, and the chance, over all parts, that
#: a part of a sound calibration fails.
COVERED, _CHANCE = 0.90, 0.01
_NORMAL_95 = 1.959964
#: Samples of a part from which it is judged, parts of each kind, and most runs.
_FEWEST, _PARTS, _MOST_RUNS = 20, 5, 40
_SECTORS = 6


@dataclass(frozen=True)
class Part:
    """A part of the samples left out."""

    name: str
    samples: int
    coverage: float  # share of errors, along two axes each, within the 95 % interval
    chance: float  # that so few are within it where it holds 95 %


def parts_of(readings: Readings, along: Floats, sigma_deg: Floats) -> tuple[Part, ...]:
    """Return parts of the field, of time, of the light and of runs, the worst covered first.

    Of samples left out, by their errors (N, 2) along two axes, degrees, NaN where not answered, and
    the stated 1-sigma (N, 2) of each.
    """
    from scipy.stats import binom  # noqa: PLC0415 - SciPy, at the first use

    known = np.asarray(np.isfinite(along + sigma_deg).all(axis=1))
    used = readings.only(known)
    within = np.abs(along[known]) <= _NORMAL_95 * sigma_deg[known]
    found = []
    for name, part in _splits(used):
        count = int(part.sum())
        if count < _FEWEST:
            continue
        held = int(within[part].sum())
        chance = float(binom.cdf(held, 2 * count, 0.95))
        found.append(Part(name, count, held / (2 * count), chance))
    return tuple(sorted(found, key=lambda one: one.coverage))


def uncovered(parts: tuple[Part, ...]) -> Part | None:
    """Return the part that intervals hold least, if that is significantly less than 90 %."""
    limit = _CHANCE / max(len(parts), 1)
    bad = [one for one in parts if one.coverage < COVERED and one.chance < limit]
    return min(bad, key=lambda one: one.coverage, default=None)


def _splits(readings: Readings) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    order = np.argsort(np.lexsort((readings.rows, readings.run)))
    yield from _bins("rows", readings.rows, order)
    middle = readings.sun.mean(axis=0)
    axis = np.array([0.0, 0.0, 1.0]) if middle[2] > 0.3 else _unit(middle)
    off = np.degrees(np.arccos(np.clip(readings.sun @ axis, -1.0, 1.0)))
    yield from _bins("off-axis angles, deg,", off, off)
    across = readings.sun - (readings.sun @ axis)[:, None] * axis
    turn = np.degrees(np.arctan2(across[:, 1], across[:, 0])) % 360.0
    width = 360.0 / _SECTORS
    for at in range(_SECTORS):
        low, high = at * width, (at + 1) * width
        yield f"azimuths of {low:.0f} to {high:.0f} deg", (turn >= low) & (turn < high)
    if readings.raw.shape[1] > 2:
        total = readings.raw.sum(axis=1)
        yield from _bins("light levels", total, total)
    for name, column in readings.context.items():
        yield from _bins(name, column, column)
    numbers = np.unique(readings.run)
    if 1 < len(numbers) <= _MOST_RUNS:
        for number in numbers:
            yield f"run {readings.run_names[number]}", readings.run == number


def _bins(
    name: str, values: Floats | NDArray[np.int64], order: Floats | NDArray[np.int64]
) -> Iterator[tuple[str, NDArray[np.bool_]]]:
    """Yield parts of as many samples, by the order of a quantity, named by its range."""
    if np.ptp(order) == 0:
        return
    rank = np.argsort(np.argsort(order, kind="stable"), kind="stable")
    part = rank * _PARTS // len(order)
    for at in range(_PARTS):
        inside = part == at
        if inside.any():
            yield f"{name} {values[inside].min():.4g} to {values[inside].max():.4g}", inside


def _unit(vector: Floats) -> Floats:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0 else np.array([0.0, 0.0, 1.0])

"""Runs that are off from the others by one rotation, as after a turntable lost its zero."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from calibrate.readings import Readings
from calibrate.robust import normalised, robust_map

_FEWEST, _MOST_RUNS = 20, 40


@dataclass(frozen=True)
class RunOffset:
    """A run whose directions are off by a constant.

    Attributes
    ----------
    run : int
        Its number.
    offset_deg : float
        Size of the rotation, degrees.
    others_deg : float
        Median of the other runs' own, degrees.
    """

    run: int
    offset_deg: float
    others_deg: float


def off_runs(readings: Readings) -> list[RunOffset]:
    """Return runs off from what the others agree on, the farthest first; fewer than half of them.

    The rotation between every two runs that overlap is that between one run's directions and those
    that a map fitted to the other gives; a run's own is the median over the others.
    """
    numbers = [int(n) for n in np.unique(readings.run) if (readings.run == n).sum() >= _FEWEST]
    if not 3 <= len(numbers) <= _MOST_RUNS:
        return []
    parts = {n: readings.only(readings.run == n) for n in numbers}
    maps = {n: robust_map(part.features, part.sun)[0] for n, part in parts.items()}
    turns: dict[int, list[float]] = {n: [] for n in numbers}
    scatters: dict[int, list[float]] = {n: [] for n in numbers}
    for one in numbers:
        for other in numbers:
            if one == other:
                continue
            part = parts[other]
            scaled = (normalised(part.features) - maps[one].middle) / maps[one].width
            shared = (np.abs(scaled) <= 1.0).all(axis=1)
            if shared.sum() < _FEWEST:
                continue
            turn, rest = _rotation(maps[one].predict(part.features[shared]), part.sun[shared])
            for n in (one, other):
                turns[n].append(turn)
                scatters[n].append(rest / np.sqrt(shared.sum()))
    own = {n: float(np.median(turns[n])) for n in numbers if len(turns[n]) >= 4}
    found = []
    for number, size in sorted(own.items(), key=lambda item: -item[1]):
        usual = float(np.median([value for n, value in own.items() if n != number] or [np.inf]))
        if size > max(5.0 * usual, 6.0 * float(np.median(scatters[number])), 1e-6):
            found.append(RunOffset(number, size, usual))
    return found if len(found) < len(numbers) / 2 else []


def _rotation(predicted: Floats, sun: Floats) -> tuple[float, float]:
    """Size of the small rotation between two sets of directions, and what it leaves, degrees."""
    # median of the offsets and not the least-squares rotation: some poses may be wrong
    small = np.cross(predicted, sun)
    design = np.zeros((3 * len(sun), 3))
    for at, axis in enumerate(np.eye(3)):
        design[:, at] = np.cross(axis, predicted).reshape(-1)
    aim = (sun - predicted).reshape(-1)
    weight = np.ones(len(sun))
    turn = np.zeros(3)
    left = small
    for _ in range(20):
        root = np.repeat(np.sqrt(weight), 3)
        turn = np.linalg.lstsq(design * root[:, None], aim * root, rcond=1e-6)[0]
        left = (aim - design @ turn).reshape(-1, 3)
        size = np.linalg.norm(left, axis=1)
        weight = 1.0 / np.maximum(size, max(float(np.median(size)), 1e-12))
    return float(np.degrees(np.linalg.norm(turn))), float(
        np.degrees(np.median(np.linalg.norm(left, axis=1)))
    )

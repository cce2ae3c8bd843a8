"""Samples that are left out of a fit: runs that are off, folds, and what a model contradicts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.chain import Scored
from algorithms.contract import Floats, SensorGeometry
from calibrate.readings import BEHIND, FAINT_ROWS, NO_SUM, Readings
from calibrate.robust import nearest, normalised, robust_map
from calibrate.selection import Candidate, fitted, unbounded

#: Why samples are left out.
WRONG, FOLD = "wrong pose", "reading that another direction gives too"
DUPLICATE = "duplicate of another row"
#: Residuals of samples left out, over their robust scale, that list a sample as wrong after all.
_WRONG_OF_MODEL = 5.0
#: And below which a sample that no smooth map explains is taken back.
_RIGHT_OF_MODEL = 4.0
#: Share of samples that may be wrong.
_MOST_WRONG = 0.25


@dataclass(frozen=True)
class Excluded:
    """A sample that was left out of the fit."""

    source: str  # its run
    row: int  # in its file
    reason: str


def sound_of(readings: Readings) -> tuple[Readings, list[Excluded], list[RunOffset], float | None]:
    """Leave out runs that are off, and what lies beyond a fold."""
    excluded: list[Excluded] = []
    runs = off_runs(readings)
    for one in runs:
        bad = readings.run == one.run
        excluded += excluded_of(bad, _off_by(one.offset_deg), readings)
        readings = readings.only(~bad)
    bad = folded(readings.features, readings.sun)
    fold = None
    if bad.any():
        fold = float(np.degrees(np.arccos(np.clip(readings.sun[bad, 2], -1.0, 1.0)).min()))
        excluded += excluded_of(bad, FOLD, readings)
        readings = readings.only(~bad)
    return readings, excluded, runs, fold


def _off_by(offset_deg: float) -> str:
    """Say how far a run is off; a rotation found by small angles says no more beyond 30 deg."""
    return f"run off by {offset_deg:.2f} deg" if offset_deg < 30.0 else "run off by over 30 deg"


def excluded_of(bad: NDArray[np.bool_], reason: str, among: Readings) -> list[Excluded]:
    """Return the samples of a mask as left out for a reason."""
    return [
        Excluded(among.run_names[among.run[at]], int(among.rows[at]), reason)
        for at in np.flatnonzero(bad)
    ]


def kept_by_model(
    scored: Scored, chosen: Candidate, sound: Readings, readings: Readings, geometry: SensorGeometry
) -> NDArray[np.bool_]:
    """Return which sound samples (N,) the chosen model explains; those it cannot answer stay.

    What no smooth map explained may be what only this model explains, and the other way round.
    """
    model = unbounded(fitted(scored, readings, geometry))
    errors = separation_deg(model.predict(sound.features, sound.context), sound.sun)
    inside = np.isin(_places(sound), _places(readings))
    left_out = chosen.errors
    if left_out is not None and len(left_out) == len(readings):
        known = np.isfinite(left_out)
        at = np.flatnonzero(inside)[known]
        errors[at] = left_out[known]
    usual = 1.4826 * np.maximum(
        float(np.nanmedian(errors[inside])), _around(sound.features, inside, errors)
    )
    kept = errors <= np.where(inside, _WRONG_OF_MODEL, _RIGHT_OF_MODEL) * usual
    kept |= ~np.isfinite(errors) & inside
    return inside if kept.mean() < 1.0 - _MOST_WRONG else kept


def _around(features: Floats, inside: NDArray[np.bool_], errors: Floats) -> Floats:
    """Return the median error (N,) of the samples inside that are nearest in features."""
    used = normalised(features)
    used = used / np.maximum(used.std(axis=0), 1e-12)
    known = np.flatnonzero(inside & np.isfinite(errors))
    near = nearest(used[known], used, min(12, len(known)))[1]
    return np.asarray(np.median(errors[known][near.reshape(len(used), -1)], axis=1))


def _places(readings: Readings) -> NDArray[np.int64]:
    return readings.run * np.int64(10_000_000) + readings.rows


_FEWEST, _MOST_RUNS = 20, 40


@dataclass(frozen=True)
class RunOffset:
    """A run whose directions are off by a constant."""

    run: int  # its number
    offset_deg: float  # size of the rotation
    others_deg: float  # median of the other runs' own


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


#: Share of rows that may be left out without a cause, and with one.
_UNNAMED, _ALL = 0.02, 0.5
#: Wrong poses among the nearest poses of one, over their share of all, from which they gather.
_NEIGHBOURS, _GATHERED = 8, 3.0
_MOST_SCATTERED = 0.15


def unexplained(
    readings: Readings, excluded: Sequence[Excluded], wrong: Readings, half_fov_deg: float | None,
    fold_deg: float | None,
) -> str:  # fmt: skip
    """Return, in a sentence, which rows were left out without a known cause; empty where few were.

    Wrong poses are known as such where they lie among others that are right, at most 15 % of all:
    where they gather, the sensor is what does not do as the others say. What another direction
    reads too is known beyond the stated field of view alone, which a fold's smallest off-axis angle
    tells. A row that is there twice loses nothing of the field and does not count.
    """
    reasons = Counter(one.reason for one in excluded if one.reason != DUPLICATE)
    dropped = {name: n for name, n in readings.dropped.items() if name != BEHIND}
    out = sum(reasons.values()) + sum(dropped.values())
    whole = len(readings) + out
    unnamed = {NO_SUM: dropped.get(NO_SUM, 0)}
    beyond = half_fov_deg is not None and fold_deg is not None and fold_deg >= half_fov_deg
    if not beyond:
        unnamed[FOLD] = reasons[FOLD]
    share = len(wrong) / whole
    if share > _MOST_SCATTERED or _gathered(readings, wrong):
        unnamed[WRONG] = len(wrong)
    count = sum(unnamed.values())
    if count > _UNNAMED * whole:
        said = ", ".join(f"{n} {name}" for name, n in unnamed.items() if n)
        return f"{count} of {whole} rows were left out without a known cause ({said})"
    if out > _ALL * whole:
        most = Counter({**reasons, **dropped}).most_common(3)
        said = ", ".join(f"{n} {name}" for name, n in most)
        return (
            f"{out} of {whole} rows were left out ({said}): what is left is not the sensor's field"
        )
    if dropped.get(FAINT_ROWS, 0) > _ALL * whole:
        return f"{dropped[FAINT_ROWS]} of {whole} rows have hardly any light"
    return ""


def _gathered(readings: Readings, wrong: Readings) -> bool:
    """Say whether wrong poses lie next to each other more than chance has them do."""
    if len(wrong) < _NEIGHBOURS:
        return False
    every = np.vstack([wrong.sun, readings.sun])
    near = nearest(every, wrong.sun, min(_NEIGHBOURS + 1, len(every)))[1][:, 1:]
    share = len(wrong) / len(every)
    return bool((near < len(wrong)).mean() > min(_GATHERED * share, 0.5 + share / 2.0))


_NEAREST = 12
#: Determinant of readings over directions, as a share of its median near the middle of the field,
#: below which directions are not resolved any more; it changes its sign behind a fold.
_LEAST_SHARE = 0.1
#: Samples from which folds are looked for, and the smallest share of samples that is one.
_FEWEST_FOR_FOLDS, _SHARE = 150, 0.01
_APART_DEG = 5.0
#: Spread of poses across the line that they lie nearest to, over that along it.
_ON_A_LINE = 0.1
#: Samples whose neighbours are held at once.
_AT_ONCE = 20_000


def folded(features: Floats, sun: Floats) -> NDArray[np.bool_]:
    """Return which samples (N,) of a frontal sensor lie where readings do not tell the direction.

    Features are (N, F), finite, directions (N, 3). True where readings hardly change with the
    direction or change the other way, and where such a sample, of a direction far away, has the
    same reading.
    """
    nothing = np.zeros(len(sun), dtype=np.bool_)
    if features.shape[1] != 2 or len(sun) < _FEWEST_FOR_FOLDS:
        return nothing
    near = nearest(sun, sun, _NEAREST + 1)[1]
    parts = [
        _slopes(features, sun, near[start : start + _AT_ONCE])
        for start in range(0, len(near), _AT_ONCE)
    ]
    slopes = np.concatenate(parts)
    slope = slopes[:, 0, 0] * slopes[:, 1, 1] - slopes[:, 0, 1] * slopes[:, 1, 0]
    middle = separation_deg(sun, np.broadcast_to(_middle(sun), sun.shape))
    known = np.isfinite(slope)
    if known.sum() < _FEWEST_FOR_FOLDS:
        return nothing
    usual = float(np.median(slope[known & (middle <= np.percentile(middle[known], 25))]))
    flat = slope / usual < _LEAST_SHARE  # False where poses along a line tell no slope
    zone = flat[near].mean(axis=1) > 0.5  # one wrong pose among neighbours decides nothing
    if zone.mean() < _SHARE:
        return nothing
    used = normalised(features)
    used = used / np.maximum(used.std(axis=0), 1e-12)
    inner = np.flatnonzero(~zone)
    step = float(np.median(nearest(used[inner], used[inner], 2)[0][:, 1]))
    away, at = nearest(used[zone], used[inner], 1)
    same = (away < step) & (separation_deg(sun[inner], sun[zone][at]) > _APART_DEG)
    zone[inner[same]] = True
    return np.asarray(zone)


def _middle(sun: Floats) -> Floats:
    total = sun.sum(axis=0)
    return np.asarray(total / np.linalg.norm(total))


def _slopes(features: Floats, sun: Floats, near: NDArray[np.int64]) -> Floats:
    """Change (N, 2, 2) of readings with the angle off the boresight, by the nearest poses.

    Over tangents a fisheye lens, whose image goes with the angle, would seem to turn flat.
    """
    across = np.linalg.norm(sun[:, :2], axis=1)
    angle = np.arctan2(across, sun[:, 2]) / np.maximum(across, 1e-12)
    places = np.where(across > 1e-6, angle, 1.0)[:, None] * sun[:, :2]
    middle = places[near[:, :1]]  # each is its own nearest
    spread = np.linalg.svd(places[near] - places[near].mean(axis=1, keepdims=True))[1]
    design = np.concatenate([np.ones((*near.shape, 1)), places[near] - middle], axis=2)
    aims = features[near]
    weight = np.ones(near.shape)
    fit = np.zeros((len(near), 3, 2))
    for _ in range(6):
        weighted = design * weight[:, :, None]
        normal = np.einsum("nki,nkj->nij", weighted, design)
        normal += 1e-12 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        fit = np.linalg.solve(normal, np.einsum("nki,nkc->nic", weighted, aims))
        size = np.linalg.norm(aims - design @ fit, axis=2)
        weight = 1.0 / np.maximum(size, np.median(size, axis=1, keepdims=True) + 1e-15)
    found = fit[:, 1:]
    found[spread[:, 1] < _ON_A_LINE * spread[:, 0]] = np.nan
    return np.asarray(found)

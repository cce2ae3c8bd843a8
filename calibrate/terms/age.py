"""What a sensor's age did to its readings: gains, offsets and a turn, fitted to a few poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, Self

import numpy as np

from algorithms.contract import Floats
from calibrate.readings import Readings, features_of_signals

#: A gain of each reading; one gain and the offsets, which scale about a centre; the zero of each
#: reading; a turn of the sensor.
Kind = Literal["gain", "scale", "offset", "boresight"]
#: Steps to an answer, of which the first of an offset is at most a tenth of the readings' range.
_MOST_STEPS = 60
_HALVINGS = 8
#: Share of the most that poses tell (squared), below which they do not tell changes apart.
_TOLD = 1e-6
#: Largest first step of a gain's logarithm, and that by which slopes are taken.
_FIRST, _SMALL = 0.3, 1e-4
#: Residuals over their median up to which poses count in full.
_USUAL = 2.0
#: Size over its 1-sigma from which one of several readings changed.
_CLEAR = 3.0
#: Share of the most that a reading tells, below which it tells nothing of its gain.
_TELLS = 0.03


@dataclass(frozen=True)
class Changes:
    """What readings and directions are since a calibration, over what they were."""

    gain: Floats  # (K,), of readings
    offset: Floats  # (K,), added then
    rotation: Floats  # (3, 3), from the old directions to the new ones
    gain_sigma: Floats  # (K,), standard errors; 0 of what did not change
    offset_sigma: Floats
    turn_sigma_deg: float = 0.0

    @classmethod
    def none(cls, count: int) -> Self:
        """Return no change of so many readings."""
        zero = np.zeros(count)
        return cls(np.ones(count), zero, np.eye(3), zero, zero)

    @property
    def turn_deg(self) -> float:
        """Angle of the turn."""
        cosine = (np.trace(self.rotation) - 1.0) / 2.0
        sine = np.linalg.norm(self.rotation - self.rotation.T) / np.sqrt(8.0)
        return float(np.degrees(np.arctan2(sine, cosine)))


def answered(old: Any, readings: Readings, changes: Changes) -> Floats:
    """Return directions (N, 3) by an old calibration of readings that changed."""
    features = features_of_signals((readings.raw - changes.offset) / changes.gain, old.settings)
    return np.asarray(old.predict(features, readings.context) @ changes.rotation.T)


def fit(old: Any, readings: Readings, kinds: Sequence[Kind]) -> Changes:
    """Return the changes of some kinds that explain poses best; wrong poses hardly count.

    Gauss and Newton's steps on the residuals' length, weighted by its inverse. Of gains and offsets
    of single readings, those below three standard errors are taken for none and the others fitted
    again: few poses tell of few changes. A gain that all readings share changes no direction: gains
    are over that of the upper median reading, as cells dim and do not brighten.
    """
    count = readings.raw.shape[1]
    search = _Search(old, readings)
    single = count > 2  # two readings are a place: both move
    free = [(kind, at) for kind in kinds for at in range(_numbers(kind, count))]
    if "scale" in kinds and "offset" not in kinds:
        free += [("offset", at) for at in range(count)]
    begun = Changes.none(count)
    if "boresight" in kinds:
        begun = replace(begun, rotation=search.turn(begun))
    free, held = search.telling(begun, free)
    found, covariance = search.steps(begun, free)
    if "offset" in kinds and old.settings.readings.kind == "quadrants":
        found = _simplest_darks(found)
    if single:
        found, kept = _clear(found, free, covariance, held, search.groups)
        if len(kept) < len(free):
            found, covariance = search.steps(found, kept)
            free = kept
    return _with_errors(found, free, covariance)


Free = tuple[Kind, int]


def _numbers(kind: Kind, count: int) -> int:
    return {"gain": count, "offset": count, "scale": 1, "boresight": 3}[kind]


@dataclass(frozen=True)
class _Search:
    old: Any
    readings: Readings

    def turn(self, changes: Changes) -> Floats:
        """Return the rotation from old directions to those of the poses."""
        predicted = answered(self.old, self.readings, changes)
        known = np.isfinite(predicted).all(axis=1)
        predicted, sun = predicted[known], self.readings.sun[known]
        weight, rotation = np.ones(len(sun)), np.eye(3)
        for _ in range(20):
            u, _, vt = np.linalg.svd((sun * weight[:, None]).T @ predicted)
            rotation = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
            left = np.linalg.norm(sun - predicted @ rotation.T, axis=1)
            weight = 1.0 / np.maximum(left, max(_USUAL * float(np.median(left)), 1e-12))
        return rotation

    @property
    def groups(self) -> tuple[range, ...]:
        """Readings of which a common gain changes no direction: all, or pairs of electrodes."""
        count = self.readings.raw.shape[1]
        size = 2 if self.old.settings.readings.kind == "electrodes" else count
        return tuple(range(at, at + size) for at in range(0, count, size))

    def telling(self, changes: Changes, free: Sequence[Free]) -> tuple[list[Free], set[int]]:
        """Leave out gains that no pose tells, and in a group the one that poses tell most."""
        told = {
            one: float(np.nanmean(self._slope(changes, one) ** 2)) ** 0.5
            for one in free
            if one[0] == "gain"
        }
        if not told:
            return list(free), set()
        most = max(told.values())
        untold = {one for one in told if not told[one] > _TELLS * most}
        held = {max(group, key=lambda at: told["gain", at]) for group in self.groups}
        left = untold | {("gain", at) for at in held}
        return [one for one in free if one not in left], held

    def steps(self, changes: Changes, free: Sequence[Free]) -> tuple[Changes, Floats]:
        """Return the changes by which the poses are explained best, and their covariance."""
        width = np.maximum(np.ptp(self.readings.raw, axis=0), 1e-12)
        size = {"gain": np.ones_like(width), "scale": np.ones(1), "offset": width / 3.0}
        unit = np.array([size[kind][at] if kind in size else 1.0 for kind, at in free])
        largest = _FIRST * unit
        covariance = np.zeros((len(free), len(free)))
        for _ in range(_MOST_STEPS if free else 0):
            left = self.left(changes)
            slopes = np.stack([self._slope(changes, one) for one in free], axis=2)
            usable = np.isfinite(left).all(axis=1) & np.isfinite(slopes).all(axis=(1, 2))
            if usable.sum() < 3:
                break
            length = np.linalg.norm(left[usable], axis=1)
            full = max(_USUAL * float(np.median(length)), 1e-12)
            step, covariance = _solved(
                slopes[usable] * unit, left[usable], 1.0 / np.maximum(length, full)
            )
            step, covariance = step * unit, covariance * np.outer(unit, unit)
            cut = np.clip(step, -largest, largest)
            better = self._shortened(changes, free, cut, full)
            if better is None:
                break
            changes = better
            if (cut != step).any():  # a long way, which few poses close together do not tell
                largest = 2.0 * largest
            elif (np.abs(step) < 1e-8 * unit).all():
                break
        return changes, covariance

    def left(self, changes: Changes) -> Floats:
        """Return what changes leave (N, 3) between poses and answers."""
        return np.asarray(self.readings.sun - answered(self.old, self.readings, changes))

    def _shortened(
        self, changes: Changes, free: Sequence[Free], step: Floats, full: float
    ) -> Changes | None:
        """Return the changes after a step that leaves less, halved until it does; None if none."""
        before = _cost(self.left(changes), full)
        for _ in range(_HALVINGS):
            moved = _moved(changes, free, step)
            if _cost(self.left(moved), full) < before:
                return moved
            step = step / 2.0
        return None

    def _slope(self, changes: Changes, one: Free) -> Floats:
        """Change (N, 3) of the answers by a change of one number."""
        at = answered(self.old, self.readings, changes)
        if one[0] == "boresight":
            return np.cross(np.eye(3)[one[1]], at)
        width = float(np.ptp(self.readings.raw[:, one[1]])) or 1.0
        small = _SMALL * (width if one[0] == "offset" else 1.0)
        moved = _moved(changes, [one], np.array([small]))
        return np.asarray((answered(self.old, self.readings, moved) - at) / small)


def _cost(left: Floats, full: float) -> float:
    """Huber's sum: squares of residuals up to a size, lengths beyond; 2 where not answered."""
    length = np.nan_to_num(np.linalg.norm(left, axis=1), nan=2.0)
    return float(np.where(length < full, length**2 / full, 2.0 * length - full).sum())


def _solved(slopes: Floats, left: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """Return the step (P,) of weighted least squares and its covariance, which errors tell."""
    count = slopes.shape[2]
    design, aim = slopes.reshape(-1, count), left.reshape(-1)
    each = np.repeat(weight, 3)
    inverse = np.linalg.pinv((design * each[:, None]).T @ design, rcond=_TOLD, hermitian=True)
    step = inverse @ (design.T @ (each * aim))
    # of a pose all components err together; a direction has two of them that are free
    scores = np.einsum("nkp,nk,n->np", slopes, left - slopes @ step, weight)
    free = max(1.0 - count / (2.0 * len(left)), 0.1)
    return step, np.asarray(inverse @ (scores.T @ scores) @ inverse / free)


def _moved(changes: Changes, free: Sequence[Free], step: Floats) -> Changes:
    gain, offset, turn = np.log(changes.gain), changes.offset.copy(), np.zeros(3)
    for (kind, at), size in zip(free, step, strict=True):
        if kind == "scale":
            gain += size
        else:
            {"gain": gain, "offset": offset, "boresight": turn}[kind][at] += size
    rotation = _rotation(turn) @ changes.rotation
    return replace(changes, gain=np.exp(np.clip(gain, -20, 20)), offset=offset, rotation=rotation)


def _rotation(turn: Floats) -> Floats:
    """Rotation by a vector, radians."""
    angle = float(np.linalg.norm(turn))
    if angle < 1e-15:
        return np.eye(3)
    x, y, z = turn / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)


def _simplest_darks(found: Changes) -> Changes:
    """Return dark levels of quadrants of which the most stayed.

    What two opposite quadrants gain and the other two lose changes neither balance.
    """
    signs = np.array([1.0, -1.0, 1.0, -1.0])
    return replace(found, offset=found.offset - signs * float(np.median(signs * found.offset)))


def _clear(
    found: Changes,
    free: Sequence[Free],
    covariance: Floats,
    held: set[int],
    groups: Sequence[range],
) -> tuple[Changes, list[Free]]:
    """Return the changes without those of single readings that errors explain; what is left."""
    place = {one: at for at, one in enumerate(free)}
    gain, offset = np.zeros(len(found.gain)), found.offset.copy()
    kept: list[Free] = [one for one in free if one[0] not in {"gain", "offset"}]
    told = {at: np.zeros(len(free)) for at in held}  # by which numbers: none of those held
    told |= {at: np.eye(len(free))[place[kind, at]] for kind, at in free if kind == "gain"}
    for group in groups if told else ():
        logs = {at: float(np.log(found.gain[at])) for at in group if at in told}
        usual = sorted(logs, key=lambda at: logs[at])[len(logs) // 2]
        for at, log in logs.items():
            across = told[at] - told[usual]
            sigma = float(np.sqrt(across @ covariance @ across))
            if abs(log - logs[usual]) > _CLEAR * sigma > 0:
                kept.append(("gain", at))
                gain[at] = log - logs[usual]
    for one in free:
        if one[0] == "offset":
            sigma = float(np.sqrt(covariance[place[one], place[one]]))
            if abs(offset[one[1]]) > _CLEAR * sigma:
                kept.append(one)
            else:
                offset[one[1]] = 0.0
    return replace(found, gain=np.exp(gain), offset=offset), kept


def _with_errors(found: Changes, free: Sequence[Free], covariance: Floats) -> Changes:
    sigma = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    gain, offset, turn = np.zeros_like(found.gain), np.zeros_like(found.offset), 0.0
    for (kind, at), size in zip(free, sigma, strict=True):
        if kind == "scale":
            gain[:] = size * found.gain
        elif kind == "gain":
            gain[at] = size * found.gain[at]
        elif kind == "offset":
            offset[at] = size
        else:
            turn = float(np.hypot(turn, np.degrees(size)))
    return replace(found, gain_sigma=gain, offset_sigma=offset, turn_sigma_deg=turn)

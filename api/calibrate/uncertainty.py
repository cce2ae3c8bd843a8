"""How sure a calibration is: noise of the readings, spread of the fit, intervals that hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Floats, SensorGeometry, UnusableDataError
from api.calibrate.readings import Readings
from api.calibrate.selection import Candidate, fitted

#: 95 % of a normal variable lie within so many standard deviations.
NORMAL_95 = 1.959964
#: Refits with other noise by which a fit's own spread is estimated.
REFITS = 6
#: Poses around one that tell its noise.
_AROUND = 16
_SEED = 20_260_101


@dataclass(frozen=True)
class Intervals:
    """What the stated 1-sigma is multiplied by so that 95 % intervals hold 95 %.

    Attributes
    ----------
    factor : float
        Of the model's own 1-sigma.
    coverage : float
        Share of samples left out within the 95 % interval, with a factor from other samples.
    samples : int
        Of them.
    """

    factor: float
    coverage: float
    samples: int


def tangent_offsets(offsets: Floats, sun: Floats) -> Floats:
    """Return errors (N, 2) along two axes square to the direction, degrees."""
    first = np.cross(sun, np.where(np.abs(sun[:, [0]]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(sun, first)
    along = np.column_stack([(offsets * first).sum(axis=1), (offsets * second).sum(axis=1)])
    return np.asarray(np.degrees(along))


def intervals(candidate: Candidate, readings: Readings) -> Intervals | None:
    """Return the factor for a model's stated 1-sigma, by the samples left out; None for too few."""
    if candidate.offsets is None or candidate.deviation is None:
        return None
    used = _compared(readings, len(candidate.offsets))
    along = np.abs(tangent_offsets(candidate.offsets, used.sun))
    errors = np.asarray(candidate.errors)
    ratio = along / candidate.deviation[:, None]
    usable = np.isfinite(ratio).all(axis=1) & np.isfinite(errors)
    ratio = ratio[usable]
    if len(ratio) < 40:
        return None
    half = np.arange(len(ratio)) % 2 == 0
    within = [float((ratio[test] <= _limit(ratio[~test])).mean()) for test in (half, ~half)]
    return Intervals(_limit(ratio) / NORMAL_95, float(np.mean(within)), len(ratio))


def _limit(ratio: Floats) -> float:
    flat = np.sort(ratio.reshape(-1))
    # as conformal prediction has it: the place that holds 95 % of the next ones too
    return float(flat[min(int(np.ceil(0.95 * (len(flat) + 1))) - 1, len(flat) - 1)])


def _compared(readings: Readings, count: int) -> Readings:
    step = max(-(-len(readings) // count), 1)
    return readings.only(np.arange(0, len(readings), step))


def noise_deg(offsets: Floats, sun: Floats) -> float:
    """Return the RMS noise of samples, degrees: what neighbours in pose differ by.

    A model errs alike on neighbours: half the mean square of their difference is noise.
    """
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    known = np.isfinite(offsets).all(axis=1)
    if known.sum() < 10:
        return float("nan")
    near = np.asarray(cKDTree(sun[known]).query(sun[known], k=2)[1])[:, 1]
    difference = offsets[known] - offsets[known][near]
    square = (difference**2).sum(axis=1)
    return float(np.degrees(np.sqrt(_middle(square) / 2.0)))


def noise_around(offsets: Floats, sun: Floats) -> Floats:
    """Return the RMS noise (N,) of each sample, degrees: as `noise_deg`, of the poses around it."""
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    whole = noise_deg(offsets, sun)
    known = np.flatnonzero(np.isfinite(offsets).all(axis=1))
    if len(known) < 4 * _AROUND:
        return np.full(len(sun), whole)
    tree = cKDTree(sun[known])
    pairs = np.asarray(tree.query(sun[known], k=2)[1])[:, 1]
    square = ((offsets[known] - offsets[known][pairs]) ** 2).sum(axis=1)
    near = np.asarray(tree.query(sun, k=_AROUND)[1])
    around = np.degrees(np.sqrt(np.mean(square[near], axis=1) / 2.0))
    usual = np.sqrt(np.mean(around[known] ** 2))
    return np.asarray(around * (whole / usual) if usual > 0 else around)


def _middle(square: Floats) -> float:
    """Mean of squares without the largest hundredth."""
    kept = np.sort(square)[: max(int(0.99 * len(square)), 1)]
    return float(kept.mean())


def refits(  # noqa: PLR0917 - what a fit is made of
    scored: Scored,
    readings: Readings,
    geometry: SensorGeometry,
    noise: Floats,
    at: Readings,
    count: int = REFITS,
    tick: Callable[[], None] = lambda: None,
) -> Floats:
    """Return directions (count, N, 3) at samples `at`, each by a fit to other noise of size (N,).

    Raises
    ------
    UnusableDataError
        If no refit settles the model.
    """
    found = []
    refusal: UnusableDataError | None = None
    for number in range(count):
        generator = np.random.default_rng(np.random.SeedSequence([_SEED, number]))
        turned = readings.sun + generator.normal(
            0.0, np.radians(noise)[:, None] / np.sqrt(2.0), readings.sun.shape
        )
        turned /= np.linalg.norm(turned, axis=1)[:, None]
        try:
            model = fitted(scored, _with_sun(readings, turned), geometry)
            found.append(model.predict(at.features, at.context))
        except UnusableDataError as error:
            refusal = error
        tick()
    if not found:
        raise refusal or UnusableDataError("no refit settles the model")
    return np.array(found)


def spread_deg(directions: Floats) -> Floats:
    """Return the RMS (N,) over refits (R, N, 3) of directions about their mean, degrees."""
    if len(directions) < 2:
        return np.full(directions.shape[1], np.nan)
    about = directions - directions.mean(axis=0)
    square = (about**2).sum(axis=2).sum(axis=0) / (len(directions) - 1)
    return np.asarray(np.degrees(np.sqrt(square)))


def _with_sun(readings: Readings, sun: Floats) -> Readings:
    from dataclasses import replace  # noqa: PLC0415 - one use

    return replace(readings, sun=sun)

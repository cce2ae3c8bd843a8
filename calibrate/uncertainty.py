"""How sure a calibration is: noise of the readings, spread of the fit, intervals that hold."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Floats, Model, SensorGeometry, UnusableDataError
from calibrate.places import (
    Grazing,
    Grid,
    bilinear,
    grazing_of,
    radial_parts,
    tangent_axes,
)
from calibrate.readings import Readings
from calibrate.robust import nearest
from calibrate.selection import Candidate, fitted, fold_of

#: 95 % of a normal variable lie within so many standard deviations.
NORMAL_95 = 1.959964
#: Refits with other noise by which a fit's own spread is estimated.
REFITS = 6
#: Samples from which intervals are stated.
FEWEST = 40
_FOLDS = 5
#: Smaller errors are rounding, degrees.
_LEAST = 1e-12
#: Poses are told apart to so many digits.
_DIGITS = 6
#: Poses around one that tell its noise.
_AROUND = 16
_SEED = 20_260_101


@dataclass(frozen=True)
class Intervals:
    """The 1-sigma of a direction by its place, so that 95 % intervals hold 95 % everywhere.

    `factor`, part of `sigma_deg` already, is the 95 % quantile of errors over their local scale
    (that of normal errors is 1), from samples that told nothing of the scale. Sector m of M is at
    the azimuth 360 m / M about the axis, from +x towards +y. In the first ring, a point, all
    sectors are the same.
    """

    factor: float
    coverage: float  # share of samples left out within, by a table of others
    samples: int  # left out
    axis: Floats  # (3,), that rings lie about
    rings_deg: Floats  # (K,), off-axis angles of the ring centres, from 0
    sectors: int  # of each ring
    sigma_deg: Floats  # (K, M, 2), half of the 95 % interval over 1.96
    grazing: Grazing = field(default_factory=Grazing.none)  # growth where light grazes a face

    def at(self, sun: Floats) -> Floats:
        """Return the 1-sigma (N, 2) of two tangent axes at directions (N, 3), degrees.

        Bilinear between centres, periodic in azimuth, constant beyond the last ring; NaN of NaN.
        """
        grid = Grid(self.axis, self.rings_deg, self.sectors)
        return bilinear(grid.weights(sun), self.sigma_deg) * self.grazing.times(sun)


def tangent_offsets(offsets: Floats, sun: Floats) -> Floats:
    """Return errors (N, 2) along the two axes of `tangent_axes`, degrees."""
    first, second = tangent_axes(sun)
    along = np.column_stack([(offsets * first).sum(axis=1), (offsets * second).sum(axis=1)])
    return np.asarray(np.degrees(along))


def covariance_of(sigma_deg: Floats, sun: Floats) -> Floats:
    """Return the covariance (N, 3, 3) of unit vectors (N, 3) with a 1-sigma (N, 2) of their axes.

    In radians squared, which those of a unit vector's components are.
    """
    radians = np.radians(sigma_deg)
    axes = np.stack(tangent_axes(sun), axis=1) * radians[:, :, None]
    return np.asarray(np.einsum("nai,naj->nij", axes, axes))


def intervals(offsets: Floats, sun: Floats, faces: Floats | None = None) -> Intervals | None:
    """Return the 1-sigma by place from errors (N, 3) of samples left out; None for too few.

    Of sensors with faces, whose normals are (P, 3), errors where light grazes one of them are first
    brought to the size of those around.

    The scale of errors is estimated by place; what it is multiplied by, from samples that told
    nothing of it: the scale of a fifth of the samples is that of the other four. A fifth is made of
    every fifth pose with all its repeats.
    """
    along = tangent_offsets(offsets, sun)
    known = np.isfinite(along).all(axis=1)
    along, sun, offsets = along[known], sun[known], offsets[known]
    if len(along) < FEWEST:
        return None
    grid = Grid.over(sun)
    grazing = Grazing.none()
    if faces is not None:
        answers = sun + offsets
        answers /= np.linalg.norm(answers, axis=1)[:, None]
        over = np.maximum(np.abs(along), _LEAST) / bilinear(
            grid.weights(sun), scale_of(along, sun, grid)
        )
        grazing = grazing_of(over, answers, faces)
        along = along / grazing.times(answers)
    rings, _ = grid.weights(sun)
    tests = [parts_of(sun, _FOLDS) == number for number in range(_FOLDS)]
    over, inside = np.empty_like(along), np.empty(along.shape, dtype=np.bool_)
    for test in tests:
        table = scale_of(along[~test], sun[~test], grid)
        over[test] = np.maximum(np.abs(along[test]), _LEAST) / bilinear(
            grid.weights(sun[test]), table
        )
    for test in tests:
        inside[test] = over[test] <= _limits(over[~test], rings[~test], rings[test])
    limits = _limits(over, rings, np.eye(len(grid.rings_deg))) / NORMAL_95
    return Intervals(
        limit_of(over) / NORMAL_95, float(inside.mean()), len(along), grid.axis, grid.rings_deg,
        grid.sectors, scale_of(along, sun, grid) * limits[:, :, None], grazing,
    )  # fmt: skip


def _limits(over: Floats, rings: Floats, at: Floats) -> Floats:
    """Return the limits (M, 1) that hold 95 % of errors over their scale (N, 2) at weights `at`."""
    profile = quantile_profile(over, rings, 0.95)
    level = limit_of(over / np.exp(rings @ profile)[:, None])
    return np.asarray(np.exp(at @ profile)[:, None] * level)


def parts_of(sun: Floats, count: int) -> NDArray[np.int64]:
    """Return the part (N,), 0 to count - 1, of directions (N, 3): by chance, repeats in one."""
    if not len(sun):
        return np.zeros(0, dtype=np.int64)
    poses = np.unique(np.round(sun, _DIGITS), axis=0, return_inverse=True)[1].reshape(-1)
    order = np.random.default_rng(_SEED).permutation(int(poses.max()) + 1)
    return np.asarray(order[poses] % count)


def limit_of(sizes: Floats) -> float:
    """Return the limit that holds 95 % of the next errors, too, from sizes of any shape.

    As conformal prediction has it.
    """
    flat = np.sort(sizes.reshape(-1))
    return float(flat[min(int(np.ceil(0.95 * (len(flat) + 1))) - 1, len(flat) - 1)])


def noise_deg(offsets: Floats, sun: Floats) -> float:
    """Return the RMS noise of samples, degrees: what neighbours in pose differ by.

    A model errs alike on neighbours: half the mean square of their difference is noise.
    """
    known = np.isfinite(offsets).all(axis=1)
    if known.sum() < 10:
        return float("nan")
    near = nearest(sun[known], sun[known], 2)[1][:, 1]
    difference = offsets[known] - offsets[known][near]
    square = (difference**2).sum(axis=1)
    return float(np.degrees(np.sqrt(_middle(square) / 2.0)))


def noise_around(offsets: Floats, sun: Floats) -> Floats:
    """Return the RMS noise (N,) of each sample, degrees: as `noise_deg`, of the poses around it."""
    whole = noise_deg(offsets, sun)
    known = np.flatnonzero(np.isfinite(offsets).all(axis=1))
    if len(known) < 4 * _AROUND:
        return np.full(len(sun), whole)
    pairs = nearest(sun[known], sun[known], 2)[1][:, 1]
    square = ((offsets[known] - offsets[known][pairs]) ** 2).sum(axis=1)
    near = nearest(sun[known], sun, _AROUND)[1]
    around = np.degrees(np.sqrt(np.mean(square[near], axis=1) / 2.0))
    usual = np.sqrt(np.mean(around[known] ** 2))
    return np.asarray(around * (whole / usual) if usual > 0 else around)


def _middle(square: Floats) -> float:
    """Mean of squares without the largest hundredth."""
    kept = np.sort(square)[: max(int(0.99 * len(square)), 1)]
    return float(kept.mean())


def rms(errors: Floats) -> float:
    """Return the root mean square of the finite ones of errors; NaN of none."""
    known = errors[np.isfinite(errors)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else float("nan")


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

    UnusableDataError if no refit settles the model.
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
            model = fitted(scored, replace(readings, sun=turned), geometry)
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


#: Parts of the rim that are left out one after the other.
_PARTS = 3


def errors_left_out(  # noqa: PLR0917 - what was fitted, and to what
    scored: Scored, chosen: Candidate, used: Readings, geometry: SensorGeometry, model: Model,
    removed: Readings,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Return errors (M, 3) of samples that a fit did not see, and their true directions (M, 3).

    Errors are predicted minus true, NaN where not answered: of the samples compared on, `used`, and
    of all that were removed because the final fit, `model`, does not explain them. They count as
    others do: no neighbour contradicts them, so that new ones may err as much.
    """
    offsets = _with_rim(scored, chosen, used, geometry)
    if not len(removed):
        return offsets, used.sun
    beside = model.predict(removed.features, removed.context) - removed.sun
    return np.vstack([offsets, beside]), np.vstack([used.sun, removed.sun])


def _with_rim(
    scored: Scored, chosen: Candidate, used: Readings, geometry: SensorGeometry
) -> Floats:
    """Return predicted minus true direction (N, 3) of every sample when it was left out.

    Models are compared without the rim of the field, to which no fit should be continued. But
    errors are largest there: a third of the rim's poses is left out at a time, so that its
    neighbours on the rim stay.
    """
    offsets = np.array(chosen.offsets)
    rim = np.flatnonzero(fold_of(used)[0] < 0)
    part = parts_of(used.sun[rim], _PARTS)
    for number in range(_PARTS):
        out = rim[part == number]
        if not len(out):
            continue
        try:
            model = fitted(scored, used.only(np.setdiff1d(np.arange(len(used)), out)), geometry)
        except UnusableDataError:
            continue
        test = used.only(out)
        offsets[out] = model.predict(test.features, test.context) - test.sun
    return offsets


#: Variance of the logarithm of a 95 % quantile of normal errors, times the count of samples.
_OF_QUANTILE = 0.906
#: Standard deviation of a normal variable over the mean of its size.
_OF_MEAN = 1.253314
#: Samples a cell is worth from which it differs from its ring.
_FEWEST = 3.0
#: Variances from which a difference of the axes is none of chance.
_CERTAIN = 4.0
_ROUNDS = 40


def scale_of(along: Floats, sun: Floats, grid: Grid) -> Floats:
    """Return the standard deviation of errors (K, M, 2) at a grid's centres, degrees.

    Of errors (N, 2) along the tangent axes of directions (N, 3): that of normal errors; of others,
    1.25 times their mean size.
    """
    weights = grid.weights(sun)
    rings, sectors = weights
    table = _of_rings(along, sun, grid, rings)
    sizes = np.maximum(np.abs(along), _LEAST)
    between = np.exp(_between_axes(sizes / bilinear(weights, table)))
    table *= [between, 1.0 / between]
    cells = (rings[:, :, None] * sectors[:, None, :]).reshape(len(rings), -1)
    over = sizes / bilinear(weights, table)
    for axis in range(2):
        of_sectors = _shrunk(over[:, axis], cells).reshape(table.shape[:2])
        of_sectors -= of_sectors.mean(axis=1)[:, None]
        of_sectors[grid.points] = 0.0
        table[..., axis] *= np.exp(of_sectors)
    return _OF_MEAN * table


def _of_rings(along: Floats, sun: Floats, grid: Grid, rings: Floats) -> Floats:
    """Return the mean size of errors (K, M, 2) where those away from the axis differ from others.

    As they do of a spot behind a hole, whose place goes with the tangent of the angle.
    """
    parts = radial_parts(sun, grid.axis)
    away = (along * parts).sum(axis=1)
    across = (along * parts[:, ::-1] * [1.0, -1.0]).sum(axis=1)
    sizes = np.maximum(np.abs(np.column_stack([away, across])), _LEAST)
    profile = _profile(sizes.mean(axis=1), rings)
    contrast = _contrast(sizes / np.exp(rings @ profile)[:, None], rings)
    contrast[grid.points] = 0.0
    centres = grid.centres()
    share = radial_parts(centres.reshape(-1, 3), grid.axis).reshape(*centres.shape[:2], 2) ** 2
    away, across = (np.exp(2.0 * (profile + sign * contrast)) for sign in (1.0, -1.0))
    return np.sqrt(share * away[:, None, None] + (1.0 - share) * across[:, None, None])


def quantile_profile(over: Floats, rings: Floats, share: float) -> Floats:
    """Return the logarithm (K,) of a quantile of values (N, 2) by ring, over that of all."""
    whole = float(np.quantile(over, share))
    order = np.argsort(over, axis=None)
    values = over.reshape(-1)[order]
    found = np.zeros(rings.shape[1])
    for ring in range(len(found)):
        sums = np.cumsum(np.repeat(rings[:, ring], 2)[order])
        at = int(np.searchsorted(sums, share * sums[-1]))
        found[ring] = np.log(max(values[min(at, len(values) - 1)] / whole, 1e-3))
    return _smooth(found, _OF_QUANTILE / np.maximum(2.0 * _counts(rings), 1e-3))


def _profile(sizes: Floats, rings: Floats) -> Floats:
    """Return the logarithm (K,) of the mean of sizes (N,) by ring.

    A smoothing spline by quasi-likelihood of a scale; Fellner and Schall's step sets how smooth.
    It is flat at the axis, as anything smooth around a point is.
    """
    found = np.full(rings.shape[1], np.log(max(float(sizes.mean()), 1e-300)))
    flat = np.diff(np.eye(len(found)), axis=0)
    bend = np.vstack([flat[:1], np.diff(flat, axis=0)])
    penalty, normal, strength = bend.T @ bend, rings.T @ rings, 1.0
    for _ in range(_ROUNDS):
        over = np.clip(sizes / np.exp(rings @ found), 0.0, 20.0)
        inverse = np.linalg.pinv(normal + strength * penalty)
        found = inverse @ (rings.T @ (rings @ found + over - 1.0))
        free = len(bend) - strength * float(np.trace(inverse @ penalty))
        rough = max(float(found @ penalty @ found), 1e-9)
        strength = _bounded(float(over.var()) * free / rough)
    return found


def _contrast(sizes: Floats, rings: Floats) -> Floats:
    """Return half the logarithm (K,) of the first axis' mean size over the second's, by ring."""
    means = np.maximum(rings.T @ sizes, 1e-300)
    chance = (sizes.var(axis=0) / np.maximum(sizes.mean(axis=0), 1e-300) ** 2).sum()
    half = 0.5 * np.log(means[:, 0] / means[:, 1])
    return _smooth(half, 0.25 * chance / np.maximum(_counts(rings), 1e-3))


def _between_axes(over: Floats) -> float:
    """Return half the logarithm of the first axis' mean size over the second's; 0 by chance."""
    means = over.mean(axis=0)
    half = 0.5 * float(np.log(means[0] / means[1]))
    chance = 0.25 * float((over.var(axis=0) / means**2).sum()) / len(over)
    return half * max(half**2 - _CERTAIN * chance, 0.0) / max(half**2, 1e-30)


def _smooth(values: Floats, variance: Floats) -> Floats:
    """Return values (K,) of rings with their variance, as smooth as their differences allow."""
    step = np.diff(np.eye(len(values)), axis=0)
    penalty, normal, strength = step.T @ step, np.diag(1.0 / variance), 1.0
    found = values
    for _ in range(_ROUNDS):
        inverse = np.linalg.pinv(normal + strength * penalty)
        found = inverse @ (normal @ values)
        free = len(step) - strength * float(np.trace(inverse @ penalty))
        strength = _bounded(free / max(float(found @ penalty @ found), 1e-9))
    return found


def _shrunk(sizes: Floats, weights: Floats) -> Floats:
    """Return the logarithm (C,) of the mean of sizes (N,) in each cell over that of all.

    Shrunk to 0 by as much as chance explains of how cells differ; weights are (N, C).
    """
    middle = max(float(sizes.mean()), 1e-300)
    count = _counts(weights)
    means = (weights.T @ sizes) / np.maximum(weights.sum(axis=0), 1e-12)
    found = np.log(np.maximum(means / middle, 0.05))
    chance = float(sizes.var()) / middle**2 / np.maximum(count, 1e-12)
    known = count >= _FEWEST
    if not known.any():
        return np.zeros(len(found))
    excess = float(np.average(found[known] ** 2 - chance[known], weights=count[known]))
    return np.where(known, found * max(excess, 0.0) / (max(excess, 0.0) + chance + 1e-12), 0.0)


def _counts(weights: Floats) -> Floats:
    """Return how many samples of equal weight the weights (N, C) of each cell are worth."""
    square = np.maximum((weights**2).sum(axis=0), 1e-12)
    return np.asarray(weights.sum(axis=0) ** 2 / square)


def _bounded(strength: float) -> float:
    return float(np.clip(strength, 1e-3, 1e8))

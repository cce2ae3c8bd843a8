"""Scale of errors by place: rings about an axis, sectors of azimuth, two tangent axes.

Places that few samples tell borrow from others: rings from their neighbours by a smoothing spline
of the logarithm, an axis from the other and sectors from their ring by empirical Bayes shrinkage.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from calibrate.intervals.places import Grid, bilinear, radial_parts

#: Variance of the logarithm of a 95 % quantile of normal errors, times the count of samples.
_OF_QUANTILE = 0.906
#: Standard deviation of a normal variable over the mean of its size.
_OF_MEAN = 1.253314
#: Samples a cell is worth from which it differs from its ring.
_FEWEST = 3.0
#: Smaller errors are rounding, degrees.
_LEAST = 1e-12
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

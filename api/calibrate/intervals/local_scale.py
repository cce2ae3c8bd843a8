"""Scale of errors by place: rings about an axis, sectors of azimuth, two tangent axes.

Places that few samples tell borrow from others: rings from their neighbours by a smoothing spline
of the logarithm, sectors from their ring and an axis from the other by empirical Bayes shrinkage.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats

#: Most rings, and sectors of each: a table that flight code can hold.
MOST_RINGS, SECTORS = 12, 8
#: Samples for each ring.
_A_RING = 40
#: Share of a 95 % quantile's logarithm: its variance times the count of samples, of normal errors.
_OF_QUANTILE = 0.906
#: Samples a cell is worth from which it differs from its ring.
_FEWEST = 3.0
_ROUNDS = 40


def places(sun: Floats, axis: Floats) -> tuple[Floats, Floats]:
    """Return the angle off an axis (3,) and the azimuth about it, from +x, of directions (N, 3)."""
    first = np.array([1.0, 0.0, 0.0]) if abs(axis[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first = first - (first @ axis) * axis
    first /= np.linalg.norm(first)
    second = np.cross(axis, first)
    along = sun @ axis
    x, y = sun @ first, sun @ second
    return np.degrees(np.arctan2(np.hypot(x, y), along)), np.degrees(np.arctan2(y, x))


def rings_of(off_deg: Floats) -> Floats:
    """Return the off-axis angles (K,) at which the scale is held, degrees, from 0 on."""
    count = int(np.clip(len(off_deg) // _A_RING, 2, MOST_RINGS))
    return np.linspace(0.0, max(float(off_deg.max()), 1e-6), count)


def ring_weights(off_deg: Floats, rings_deg: Floats) -> Floats:
    """Return the weights (N, K) of linear interpolation over rings, constant beyond the ends."""
    at = np.interp(off_deg, rings_deg, np.arange(len(rings_deg), dtype=np.float64))
    return np.maximum(1.0 - np.abs(at[:, None] - np.arange(len(rings_deg))), 0.0)


def sector_weights(azimuth_deg: Floats, sectors: int) -> Floats:
    """Return the weights (N, M) of linear interpolation over azimuth; sector m is at 360 m / M."""
    apart = azimuth_deg[:, None] * sectors / 360.0 - np.arange(sectors)
    apart -= sectors * np.round(apart / sectors)
    return np.maximum(1.0 - np.abs(apart), 0.0)


def scale_of(sizes: Floats, rings: Floats, sectors: Floats, closed: bool) -> Floats:
    """Return the mean size of errors (K, M, 2) at ring and sector centres.

    Parameters
    ----------
    sizes : ndarray, shape (N, 2)
        Of errors along two axes, no sign.
    rings, sectors : ndarray, shapes (N, K) and (N, M)
        Weights of each sample, as `ring_weights` and `sector_weights` give them.
    closed : bool
        Whether the last ring is a point, as the first is: there sectors are the same.
    """
    profile = _profile(sizes.mean(axis=1), rings)
    left = sizes / np.exp(rings @ profile)[:, None]
    contrast = 0.5 * _contrast(left, rings)
    cells = (rings[:, :, None] * sectors[:, None, :]).reshape(len(rings), -1)
    table = np.empty((rings.shape[1], sectors.shape[1], 2))
    for axis, sign in enumerate((1.0, -1.0)):
        of_ring = profile + sign * contrast
        rest = sizes[:, axis] / np.exp(rings @ of_ring)
        of_sectors = _shrunk(rest, cells).reshape(table.shape[:2])
        of_sectors -= of_sectors.mean(axis=1)[:, None]
        of_sectors[[0, -1] if closed else [0]] = 0.0
        table[:, :, axis] = np.exp(of_ring[:, None] + of_sectors)
    return table


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
    """
    found = np.full(rings.shape[1], np.log(max(float(sizes.mean()), 1e-300)))
    bend = np.diff(np.eye(len(found)), min(2, len(found) - 1), axis=0)
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
    """Return the logarithm (K,) of the first axis' mean size over the second's, by ring."""
    means = np.maximum(rings.T @ sizes, 1e-300)
    chance = (sizes.var(axis=0) / np.maximum(sizes.mean(axis=0), 1e-300) ** 2).sum()
    return _smooth(np.log(means[:, 0] / means[:, 1]), chance / np.maximum(_counts(rings), 1e-3))


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

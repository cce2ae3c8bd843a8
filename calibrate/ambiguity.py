"""Folds: directions that readings do not tell apart, as beyond the edge of a quadrant's light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.contract import Floats
from calibrate.robust import normalised

_NEIGHBOURS = 12
#: Determinant of readings over directions, as a share of its median near the middle of the field,
#: below which directions are not resolved any more; it changes its sign behind a fold.
_LEAST_SHARE = 0.1
#: Samples from which folds are looked for, and the smallest share of samples that is one.
_FEWEST, _SHARE = 150, 0.01
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
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    nothing = np.zeros(len(sun), dtype=np.bool_)
    if features.shape[1] != 2 or len(sun) < _FEWEST:
        return nothing
    near = np.asarray(cKDTree(sun).query(sun, k=_NEIGHBOURS + 1)[1])
    parts = [
        _slopes(features, sun, near[start : start + _AT_ONCE])
        for start in range(0, len(near), _AT_ONCE)
    ]
    slopes = np.concatenate(parts)
    slope = slopes[:, 0, 0] * slopes[:, 1, 1] - slopes[:, 0, 1] * slopes[:, 1, 0]
    middle = separation_deg(sun, np.broadcast_to(_middle(sun), sun.shape))
    known = np.isfinite(slope)
    if known.sum() < _FEWEST:
        return nothing
    usual = float(np.median(slope[known & (middle <= np.percentile(middle[known], 25))]))
    flat = slope / usual < _LEAST_SHARE  # False where poses along a line tell no slope
    zone = flat[near].mean(axis=1) > 0.5  # one wrong pose among neighbours decides nothing
    if zone.mean() < _SHARE:
        return nothing
    used = normalised(features)
    used = used / np.maximum(used.std(axis=0), 1e-12)
    inner = np.flatnonzero(~zone)
    step = float(np.median(np.asarray(cKDTree(used[inner]).query(used[inner], k=2)[0])[:, 1]))
    away, at = (np.asarray(a) for a in cKDTree(used[zone]).query(used[inner]))
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

"""Mean shift of many spots towards the histogram of a goal spot, in frames one after another."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.view_kernel import is_whole

Bins = NDArray[np.int64]

_STEPS = 20  # of one spot, at most
_ROUNDS = 3  # of leaving out spots that are not where the others say


@compiled
def _window(bins: Bins, x: float, y: float, radius: float, sums: Floats) -> float:
    """Sum over the pixels within `radius` of (x, y), by the bin they are in.

    `sums` (m, 4) receives the Epanechnikov kernel, the number, and the offsets in x and y; the
    kernel's sum over all bins is returned.
    """
    sums[:] = 0.0
    square = radius * radius
    for i in range(max(math.ceil(y - radius), 0), min(math.floor(y + radius) + 1, bins.shape[0])):
        dy = i - y
        side = math.sqrt(max(square - dy * dy, 0.0))
        left = max(math.ceil(x - side), 0)
        right = min(math.floor(x + side) + 1, bins.shape[1])
        for j in range(left, right):
            dx = j - x
            u = bins[i, j]
            sums[u, 0] += 1.0 - (dx * dx + dy * dy) / square
            sums[u, 1] += 1.0
            sums[u, 2] += dx
            sums[u, 3] += dy
    return float(sums[:, 0].sum())


@compiled
def _similarity(sums: Floats, total: float, goal: Floats) -> float:
    """Bhattacharyya coefficient of a window's histogram and the goal's."""
    found = 0.0
    if total > 0.0:
        for u in range(goal.size):
            found += math.sqrt(max(sums[u, 0], 0.0) / total * goal[u])
    return found


@compiled
def _shift(sums: Floats, total: float, goal: Floats) -> tuple[float, float]:
    """Mean offset of a window's pixels, each weighted by its bin: the mean shift."""
    weight = 0.0
    across = 0.0
    along = 0.0
    for u in range(goal.size):
        if sums[u, 0] > 0.0:
            w = math.sqrt(goal[u] * total / sums[u, 0])
            weight += w * sums[u, 1]
            across += w * sums[u, 2]
            along += w * sums[u, 3]
    if weight > 0.0:
        return across / weight, along / weight
    return 0.0, 0.0


@compiled
def _climb(  # noqa: PLR0917 - Numba takes no keyword-only ones
    bins: Bins,
    x: float,
    y: float,
    radius: float,
    goal: Floats,
    tolerance: float,
    sums: Floats,
) -> tuple[float, float, float]:
    """Shift (x, y) until a step is below `tolerance`; return the place and its similarity.

    A step that lowers the similarity is halved.
    """
    total = _window(bins, x, y, radius, sums)
    here = _similarity(sums, total, goal)
    for _ in range(_STEPS):
        dx, dy = _shift(sums, total, goal)
        total = _window(bins, x + dx, y + dy, radius, sums)
        there = _similarity(sums, total, goal)
        while there < here and math.hypot(dx, dy) > tolerance:
            dx *= 0.5
            dy *= 0.5
            total = _window(bins, x + dx, y + dy, radius, sums)
            there = _similarity(sums, total, goal)
        x += dx
        y += dy
        here = there
        if math.hypot(dx, dy) <= tolerance:
            break
    return x, y, here


@compiled
def _agree(
    spots: Floats, weights: Floats, apertures: Floats, tolerance: float
) -> tuple[float, float, int]:
    """Weighted mean (x, y) of spots less apertures, and the number of spots in it.

    Spots further than `tolerance` from that mean are made NaN, with weight zero.
    """
    x = np.nan
    y = np.nan
    number = 0
    for turn in range(_ROUNDS):
        total = 0.0
        sum_x = 0.0
        sum_y = 0.0
        number = 0
        for a in range(spots.shape[0]):
            if not weights[a] > 0.0:
                continue
            dx = spots[a, 0] - apertures[a, 0]
            dy = spots[a, 1] - apertures[a, 1]
            if turn > 0 and math.hypot(dx - x, dy - y) > tolerance:
                spots[a] = np.nan
                weights[a] = 0.0
                continue
            total += weights[a]
            sum_x += weights[a] * dx
            sum_y += weights[a] * dy
            number += 1
        if number == 0:
            return np.nan, np.nan, 0
        x = sum_x / total
        y = sum_y / total
    return x, y, number


@compiled
def _cut(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any], level: float, step: float, bins: int, left: int, top: int, patch: Bins
) -> None:
    """Write the bins of the pixels from (left, top) on to `patch`; outside the frame 0."""
    height, width = frame.shape
    for i in range(patch.shape[0]):
        for j in range(patch.shape[1]):
            u = 0
            if 0 <= top + i < height and 0 <= left + j < width:
                light = frame[top + i, left + j] - level
                if light > 0.0:
                    u = min(1 + int(light / step), bins - 1)
            patch[i, j] = u


@compiled
def _learn(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    level: float,
    step: float,
    seen: Floats,
    radii: tuple[float, float],
    patch: Bins,
    goal: Floats,
    sums: Floats,
) -> float:
    """Write the mean histogram of the spots seen (A, 2) to `goal`; return its own similarity.

    That is the one of the same spots as candidates; zero where there is none.
    """
    bins = goal.size
    reach = patch.shape[0] // 2
    goal[:] = 0.0
    own = np.zeros((bins, 4))
    for a in range(seen.shape[0]):
        if np.isnan(seen[a, 0]):
            continue
        left = round(seen[a, 0]) - reach
        top = round(seen[a, 1]) - reach
        _cut(frame, level, step, bins, left, top, patch)
        _window(patch, seen[a, 0] - left, seen[a, 1] - top, radii[0], sums)
        goal += sums[:, 0]
        _window(patch, seen[a, 0] - left, seen[a, 1] - top, radii[1], sums)
        own += sums
    goal[0] = 0.0  # the goal is a spot, no background
    total = goal.sum()
    if not total > 0.0:
        return 0.0
    goal /= total
    return _similarity(own, own[:, 0].sum(), goal)


@compiled
def _place(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    level: float,
    step: float,
    x: float,
    y: float,
    radius: float,
    goal: Floats,
    tolerance: float,
    patch: Bins,
    sums: Floats,
) -> tuple[float, float, float]:
    """Shift one spot from (x, y); return its place and similarity, which is 0 where it strays."""
    reach = patch.shape[0] // 2
    left = round(x) - reach
    top = round(y) - reach
    _cut(frame, level, step, goal.size, left, top, patch)
    near_x, near_y, likeness = _climb(patch, x - left, y - top, radius, goal, tolerance, sums)
    if math.hypot(near_x + left - x, near_y + top - y) >= radius:
        likeness = 0.0
    return near_x + left, near_y + top, likeness


@compiled
def shift_spots(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    levels: Floats,
    steps: Floats,
    seen: Floats,
    starts: Floats,
    apertures: Floats,
    margin: float,
    radii: tuple[float, float],
    limits: tuple[float, float, float, float],
    sequence: bool,
    bins: int,
    found: Floats,
    spots: Floats,
    weights: Floats,
) -> int:
    """Shift every spot of every frame (N, H, W) from where it is expected.

    Parameters
    ----------
    levels, steps
        (N,) upper end of the first of `bins` bins, and the width of the others.
    seen
        (M, A, 2) spots of which the mean histogram is the goal; NaN for none.
    starts
        (M, 2) displacement at which each frame starts; NaN for a frame left out.
    apertures, margin
        (A, 3) x, y, width; px that a spot reaches beyond its aperture.
    radii
        Of the goal's kernel and of the candidates', px.
    limits
        Step that ends the shift, px; least similarity over that of the goal's own spots; largest
        distance of a spot from where the others say, px; least share of the expected spots.
    sequence
        Whether a frame's goal is the first frame's, and its starts the spots of the one before;
        then M is 1 and a frame in which too few spots are found ends the sequence. Else M is N.
    found, spots, weights
        (N, 2), (N, A, 2) and (N, A): receive the displacement, the spots, and their similarity
        over that of the goal's own spots; NaN and zero where nothing is found.

    Returns
    -------
    int
        Frames done: N, or the first in which a sequence was lost.
    """
    count, height, width = frames.shape
    tolerance, similar, astray, share = limits
    reach = math.ceil(2.0 * radii[1])
    patch = np.empty((2 * reach + 1, 2 * reach + 1), dtype=np.int64)
    sums = np.empty((bins, 4))
    goal = np.empty(bins)
    reference = 0.0
    x = np.nan
    y = np.nan
    for k in range(count):
        found[k] = np.nan
        spots[k] = np.nan
        weights[k] = 0.0
        fresh = k == 0 or not sequence
        if fresh:
            x, y = starts[k]
            reference = _learn(frames[k], levels[k], steps[k], seen[k], radii, patch, goal, sums)
        expected = 0
        for a in range(apertures.shape[0]):
            at_x = apertures[a, 0] + x
            at_y = apertures[a, 1] + y
            if not fresh and not np.isnan(spots[k - 1, a, 0]):
                at_x, at_y = spots[k - 1, a]
            if not is_whole(at_x, at_y, 0.5 * apertures[a, 2] + margin, height, width):
                continue
            expected += 1
            near_x, near_y, likeness = _place(
                frames[k], levels[k], steps[k], at_x, at_y, radii[1], goal, tolerance, patch, sums
            )
            if likeness > 0.0 and likeness >= similar * reference:
                spots[k, a, 0] = near_x
                spots[k, a, 1] = near_y
                weights[k, a] = likeness / reference
        near_x, near_y, number = _agree(spots[k], weights[k], apertures, astray)
        if number > 0 and number >= share * expected:
            x, y = near_x, near_y
            found[k, 0] = x
            found[k, 1] = y
        else:
            spots[k] = np.nan
            weights[k] = 0.0
            if sequence:
                return k
    return int(count)

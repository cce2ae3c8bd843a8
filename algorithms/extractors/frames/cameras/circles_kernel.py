"""Circles of unknown radius by a Hough transform of edges and their directions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.copies import copy_row

#: Local maxima of the accumulator that are looked at more closely.
_CANDIDATES = 40
_SECTORS = 16
#: An edge belongs to a circle when it lies this close to it and points this close to its centre.
_NEAR = 1.0
#: Largest sine of the angle between an edge's direction and that of the centre.
_ASKEW = 0.35
#: A bright circle is at least this far up the frame's range inside: fainter ones are ghosts.
_BRIGHT = 0.5
#: Where inside, in radii: within the rim's blur, outside a black Sun.
_WITHIN = 0.7
#: Edges this close to a circle, and whose direction has this cosine with it, take part in its fit.
_REACH = 1.5
_ALIGNED = 0.8
#: A dark circle counts from this share of the frame's steepest gradient, as a mean over sectors.
_DARK = 0.2
#: Another circle with this share of the best one's edge leaves open which is the Sun.
_RIVAL = 0.8
#: Root mean square distance of a circle's edges from it, px; scattered edges are further.
_SCATTER = 0.5
_MOVES = 12


@compiled
def _gradient(frame: NDArray[Any], across: Floats, down: Floats, size: Floats) -> float:
    """Write Sobel's gradient, an eighth of its sums, and its size; return the largest size."""
    height, width = frame.shape
    for i in range(1, height - 1):
        above, here, below = frame[i - 1], frame[i], frame[i + 1]
        for j in range(1, width - 1):
            corner = float(below[j + 1]) - float(above[j - 1])
            other = float(above[j + 1]) - float(below[j - 1])
            side = 2.0 * (float(here[j + 1]) - float(here[j - 1]))
            across[i, j] = 0.125 * (corner + other + side)
            side = 2.0 * (float(below[j]) - float(above[j]))
            down[i, j] = 0.125 * (corner - other + side)
        for j in range(1, width - 1):  # by itself, and so by several pixels at a time
            size[i, j] = math.sqrt(across[i, j] * across[i, j] + down[i, j] * down[i, j])
    return float(size.max())


@compiled
def _edges(across: Floats, down: Floats, size: Floats, least: float, edges: Floats) -> int:
    """List where the gradient is largest along itself: (x, y, unit x, unit y, size).

    Interpolated along its steeper axis, to where a parabola through three pixels peaks.
    """
    height, width = size.shape
    count = 0
    for i in range(2, height - 2):
        for j in range(2, width - 2):
            here = size[i, j]
            if not here >= least:
                continue
            x, y = across[i, j] / here, down[i, j] / here
            if abs(x) >= abs(y):
                side = y / x
                up = 1 if side >= 0.0 else -1
                part = abs(side)
                after = size[i, j + 1] * (1 - part) + size[i + up, j + 1] * part
                before = size[i, j - 1] * (1 - part) + size[i - up, j - 1] * part
                step_x, step_y = 1.0, side
            else:
                side = x / y
                up = 1 if side >= 0.0 else -1
                part = abs(side)
                after = size[i + 1, j] * (1 - part) + size[i + 1, j + up] * part
                before = size[i - 1, j] * (1 - part) + size[i - 1, j - up] * part
                step_x, step_y = side, 1.0
            if not (here > before and here >= after):
                continue
            move = 0.5 * (before - after) / (before - 2.0 * here + after)
            edges[count, 0] = j + move * step_x
            edges[count, 1] = i + move * step_y
            edges[count, 2] = x
            edges[count, 3] = y
            edges[count, 4] = here
            count += 1
    return count


@compiled
def _vote(edges: Floats, count: int, smallest: float, largest: float, votes: Floats) -> None:
    """Accumulate votes for centres along every edge's gradient, both ways, one a pixel of radius.

    A vote counts the inverse of the radius: a whole circle gives the same at every size.
    """
    height, width = votes.shape
    votes[:] = 0.0
    for n in range(count):
        for way in (-1.0, 1.0):
            r = smallest
            while r <= largest:
                a = math.floor(edges[n, 0] + way * r * edges[n, 2] + 0.5)
                b = math.floor(edges[n, 1] + way * r * edges[n, 3] + 0.5)
                if not (0 <= a < width and 0 <= b < height):
                    break
                votes[b, a] += 1.0 / r
                r += 1.0


@compiled
def _candidates(votes: Floats, sums: Floats, places: Floats) -> None:
    """List the highest local maxima of sums over 3 x 3 cells as (votes, x, y); zeros before.

    `sums` (H, W) is room for them.
    """
    height, width = votes.shape
    sums[:] = 0.0
    for i in range(1, height - 1):
        for j in range(width):
            sums[i, j] = votes[i - 1, j] + votes[i, j] + votes[i + 1, j]
        before = sums[i, 0]
        for j in range(1, width - 1):
            here = sums[i, j]
            sums[i, j] = before + here + sums[i, j + 1]
            before = here
        sums[i, 0] = 0.0
        sums[i, width - 1] = 0.0
    fewest = 0
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            here = sums[i, j]
            if here <= places[fewest, 0]:
                continue
            highest = here
            for a in range(-1, 2):
                for b in range(-1, 2):
                    highest = max(highest, sums[i + a, j + b])
            if here == highest:
                places[fewest, 0] = here
                places[fewest, 1] = j
                places[fewest, 2] = i
                fewest = int(np.argmin(places[:, 0]))


@compiled
def _radius(  # noqa: PLR0917 - Numba takes no keyword-only ones
    edges: Floats,
    count: int,
    x: float,
    y: float,
    way: float,
    smallest: float,
    largest: float,
    least: float,
    sectors: Floats,
) -> tuple[float, float]:
    """Best circle about (x, y): its mean edge over all sectors and its radius.

    Gradients point outwards where `way` is 1 (a dark circle), inwards where it is -1. `sectors`
    (R, S) is room for the strongest edge of each radius and sector. Zero where no circle has
    edges in the share `least` of its sectors.
    """
    sectors[:] = 0.0
    for n in range(count):
        dx, dy = edges[n, 0] - x, edges[n, 1] - y
        r = math.sqrt(dx * dx + dy * dy)
        if not smallest - 1.0 <= r <= largest:
            continue
        off = abs(dx * edges[n, 3] - dy * edges[n, 2])  # from the centre to the gradient's line
        if off > min(_NEAR + 0.1 * r, _ASKEW * r):
            continue
        if not way * (dx * edges[n, 2] + dy * edges[n, 3]) > 0.0:
            continue
        sector = int((math.atan2(dy, dx) / (2.0 * math.pi) + 1.0) * _SECTORS) % _SECTORS
        cell = int(r + 0.5)
        for bin_ in range(max(cell - 1, 0), min(cell + 2, sectors.shape[0])):
            sectors[bin_, sector] = max(sectors[bin_, sector], edges[n, 4])
    best = 0.0
    radius = 0.0
    for cell in range(sectors.shape[0]):
        total = 0.0
        covered = 0
        for sector in range(_SECTORS):
            total += sectors[cell, sector]
            covered += sectors[cell, sector] > 0.0
        if covered >= least * _SECTORS and total > best * (1.0 + 1e-12):
            best = total
            radius = float(cell)
    return best / _SECTORS, radius


@compiled
def _gather(  # noqa: PLR0917 - Numba takes no keyword-only ones
    edges: Floats,
    count: int,
    way: float,
    circle: tuple[float, float, float],
    matrix: Floats,
    side: Floats,
) -> tuple[int, float]:
    """Gather the normal equations of a circle's move towards the edges near it.

    Returns how many edges these are, and the sum of their squared distances from the circle.
    """
    x, y, radius = circle
    matrix[:] = 0.0
    side[:] = 0.0
    used = 0
    scatter = 0.0
    for n in range(count):
        dx, dy = edges[n, 0] - x, edges[n, 1] - y
        r = math.sqrt(dx * dx + dy * dy)
        if abs(r - radius) > _REACH or r == 0.0:
            continue
        if way * (dx * edges[n, 2] + dy * edges[n, 3]) < _ALIGNED * r:
            continue
        row = (dx / r, dy / r, 1.0)
        used += 1
        scatter += (r - radius) ** 2
        for a in range(3):
            side[a] += row[a] * (r - radius)
            for b in range(3):
                matrix[a, b] += row[a] * row[b]
    return used, scatter


@compiled
def _fit(
    edges: Floats, count: int, way: float, circle: tuple[float, float, float], scattered: float
) -> tuple[float, float, float]:
    """Fit a circle (x, y, r) to edges near one by Gauss-Newton steps.

    NaN where the steps do not end, or edges are more than `scattered` px off it (root mean square).
    """
    x, y, radius = circle
    matrix = np.empty((3, 3))
    side = np.empty(3)
    for _ in range(_MOVES):
        used, scatter = _gather(edges, count, way, (x, y, radius), matrix, side)
        if used < 6 or not abs(np.linalg.det(matrix)) > 1e-6 * used**3:
            return np.nan, np.nan, np.nan
        step = np.linalg.solve(matrix, side)
        x += step[0]
        y += step[1]
        radius += step[2]
        if not (math.hypot(step[0], step[1]) < 4.0 and radius > 0.0):
            return np.nan, np.nan, np.nan
        if abs(step[0]) + abs(step[1]) < 1e-9:
            break
    used, scatter = _gather(edges, count, way, (x, y, radius), matrix, side)
    if scatter > scattered * scattered * used:
        return np.nan, np.nan, np.nan
    return x, y, radius


@compiled
def _bright_inside(frame: NDArray[Any], circle: tuple[float, float, float], level: float) -> bool:
    """Tell whether half of the pixels on a circle within this one are not below a level."""
    height, width = frame.shape
    bright = 0
    for n in range(_SECTORS):
        turn = 2.0 * math.pi * n / _SECTORS
        j = math.floor(circle[0] + _WITHIN * circle[2] * math.cos(turn) + 0.5)
        i = math.floor(circle[1] + _WITHIN * circle[2] * math.sin(turn) + 0.5)
        if 0 <= i < height and 0 <= j < width and frame[i, j] >= level:
            bright += 1
    return 2 * bright >= _SECTORS


@compiled
def _best(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    level: float,
    edges: Floats,
    count: int,
    places: Floats,
    way: float,
    smallest: float,
    largest: float,
    least: float,
    score: float,
    sure: bool,
    sectors: Floats,
    out: Floats,
) -> bool:
    """Write the circle (x, y, r) about one of `places` with most edge to `out`; False if none.

    Where `sure`, NaN is written if another one elsewhere has about as much, and circles that edges
    do not fit are none; else these stay where the accumulator has them. It must have more than
    `score` and, where it is bright, not be below `level` inside.
    """
    scores = np.zeros(len(places))
    circles = np.zeros((len(places), 3))
    best = -1
    for n in range(len(places)):
        x, y = places[n, 1], places[n, 2]
        found, radius = _radius(edges, count, x, y, way, smallest, largest, least, sectors)
        if found <= score:
            continue
        circle = _fit(edges, count, way, (x, y, radius), _SCATTER if sure else math.inf)
        if not smallest <= circle[2] <= largest:
            if sure:
                continue
            circle = (x, y, radius)
        if way < 0.0 and not _bright_inside(frame, circle, level):
            continue
        scores[n] = found
        circles[n, 0], circles[n, 1], circles[n, 2] = circle
        if best < 0 or found > scores[best]:
            best = n
    if best < 0:
        return False
    copy_row(circles[best], out)
    for n in range(len(places)):
        apart = math.hypot(circles[n, 0] - circles[best, 0], circles[n, 1] - circles[best, 1])
        if sure and scores[n] > _RIVAL * scores[best] and apart > circles[best, 2]:
            out[:] = np.nan
            break
    return True


@compiled
def best_circles(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    usable: NDArray[np.bool_],
    edge: float,
    smallest: float,
    largest: float,
    least: float,
    dark_first: bool,
    sure: bool,
    out: Floats,
) -> None:
    """Write each frame's best circle (x, y, r) to `out` (N, 3); NaN where there is none.

    Edges are where the gradient is above the fraction `edge` of the frame's largest; a circle
    has them in the share `least` of its sectors. Bright circles are sought, after dark ones
    where `dark_first`.
    """
    count, height, width = frames.shape
    across = np.zeros((height, width))
    down = np.zeros((height, width))
    size = np.zeros((height, width))
    votes = np.empty((height, width))
    sums = np.empty((height, width))
    edges = np.empty((height * width, 5))
    places = np.empty((_CANDIDATES, 3))
    sectors = np.empty((int(largest) + 2, _SECTORS))
    for k in range(count):
        out[k] = np.nan
        if not usable[k] or height < 5 or width < 5:
            continue
        steepest = _gradient(frames[k], across, down, size)
        if not steepest > 0.0:
            continue
        found = _edges(across, down, size, edge * steepest, edges)
        _vote(edges, found, smallest, largest, votes)
        places[:] = 0.0
        _candidates(votes, sums, places)
        low, high = float(frames[k].min()), float(frames[k].max())
        level = low + _BRIGHT * (high - low)
        for way in (1.0, -1.0):
            if way > 0.0 and not dark_first:
                continue
            score = _DARK * steepest if way > 0.0 else 0.0
            if _best(
                frames[k],
                level,
                edges,
                found,
                places,
                way,
                smallest,
                largest,
                least,
                score,
                sure,
                sectors,
                out[k],
            ):
                break

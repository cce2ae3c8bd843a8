"""Search for the position of a bi-level template that differs least from a bi-level frame."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Share of a level by which a pixel has to be above it: digital numbers are at times half of the
#: brightest, and rounding must not light them.
_LEVEL = 1e-9
#: Pixels by which a good position may differ from the best, in half widths of the template.
_SLACK = 1.0
#: Sub-pixel searches in turn: steps a pixel, and how many are tried to each side.
_SEARCHES = ((4, 6), (8, 8), (16, 16))
_COARSEST_LAST = 0.5  # px, the last step of the coarse search
#: Search for most light: chords of a row, and rounds. Positions compared are a whole pixel apart:
#: where within a pixel its light falls is not known, and over a whole one the error cancels.
_CHORDS = 4
_APART = 1.0
_ROUNDS = 4


@compiled
def _difference(  # noqa: PLR0917 - Numba takes no keyword-only ones
    counts: NDArray[np.int32], lit: int, x: float, y: float, half: float, square: bool
) -> tuple[int, bool]:
    """Pixels in which frame and template differ, and whether the template is inside the frame.

    `counts` (H, W + 1) are the lit pixels of each row before a column.
    """
    height, width = counts.shape[0], counts.shape[1] - 1
    template = 0
    both = 0
    inside = True
    for i in range(math.ceil(y - half), math.floor(y + half) + 1):
        side = half
        if not square:
            side = math.sqrt(max(half * half - (i - y) * (i - y), 0.0))
        first = math.ceil(x - side)
        end = math.floor(x + side) + 1
        if i < 0 or i >= height or first < 0 or end > width:
            inside = False
            if i < 0 or i >= height:
                continue
            first = min(max(first, 0), width)
            end = max(min(end, width), first)
        template += end - first
        both += counts[i, end] - counts[i, first]
    return lit + template - 2 * both, inside


@compiled
def _descend(  # noqa: PLR0917 - Numba takes no keyword-only ones
    counts: NDArray[np.int32], lit: int, x: float, y: float, half: float, square: bool
) -> tuple[float, float, int]:
    """Walk from a position to where the difference is least, in steps halved down to 0.5."""
    least, _ = _difference(counts, lit, x, y, half, square)
    step = max(half, 1.0)
    while step >= _COARSEST_LAST:
        best_x, best_y = x, y
        moved = False
        for a in range(-1, 2):
            for b in range(-1, 2):
                found, _ = _difference(counts, lit, x + a * step, y + b * step, half, square)
                if found < least:
                    least = found
                    best_x, best_y = x + a * step, y + b * step
                    moved = True
        x, y = best_x, best_y
        if not moved:
            step *= 0.5
    return x, y, least


@compiled
def _middle_of_good(  # noqa: PLR0917 - Numba takes no keyword-only ones
    counts: NDArray[np.int32],
    lit: int,
    x: float,
    y: float,
    half: float,
    square: bool,
    steps: int,
    reach: int,
    differences: NDArray[np.int64],
) -> tuple[float, float, int]:
    """Middle of the good positions on a grid about (x, y), and the least difference.

    Good are those that differ in `half` pixels more than the best, about what moving the
    template a quarter of a pixel costs: their set is as symmetric as the spot, and its middle
    depends on many pixels, where that of the best alone hangs on two or three.
    """
    side = 2 * reach + 1
    least = counts.size
    for a in range(side):
        for b in range(side):
            at_x, at_y = x + (a - reach) / steps, y + (b - reach) / steps
            found, _ = _difference(counts, lit, at_x, at_y, half, square)
            differences[a * side + b] = found
            least = min(least, found)
    good = 0
    total_a = 0
    total_b = 0
    for a in range(side):
        for b in range(side):
            if differences[a * side + b] <= least + _SLACK * half:
                good += 1
                total_a += a - reach
                total_b += b - reach
    return x + total_a / (good * steps), y + total_b / (good * steps), least


@compiled
def _search(  # noqa: PLR0917 - Numba takes no keyword-only ones
    counts: NDArray[np.int32],
    lit: int,
    mean: tuple[float, float],
    peak: tuple[int, int],
    half: float,
    square: bool,
    differences: NDArray[np.int64],
) -> tuple[float, float, int]:
    """Walk from the lit pixels' mean and from the brightest, then refine the better place."""
    x, y, least = _descend(counts, lit, mean[0], mean[1], half, square)
    other_x, other_y, other = _descend(counts, lit, float(peak[0]), float(peak[1]), half, square)
    if other < least:
        x, y, least = other_x, other_y, other
    for steps, reach in _SEARCHES:
        x, y, least = _middle_of_good(counts, lit, x, y, half, square, steps, reach, differences)
    return x, y, least


@compiled
def _best_of_brightest(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any], peak: Any, counts: NDArray[np.int32], lit: int, half: float, square: bool
) -> tuple[float, float, int]:
    """First of the brightest pixels at which the difference is least, and that."""
    best_x, best_y = 0.0, 0.0
    least = counts.size + lit
    for i in range(frame.shape[0]):
        for j in range(frame.shape[1]):
            if frame[i, j] == peak:
                found, _ = _difference(counts, lit, float(j), float(i), half, square)
                if found < least:
                    least = found
                    best_x, best_y = float(j), float(i)
    return best_x, best_y, least


@compiled
def best_positions(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    levels: Floats,
    half: float,
    square: bool,
    worst: float,
    brightest: bool,
    out: Floats,
) -> None:
    """Write the position (x, y) of the best template to `out` (N, 2).

    Only the brightest pixels are compared if `brightest`, of which the first best one counts.

    Lit are pixels above a frame's level (N,). `half` is the template's radius or half side, px.
    Positions that differ little are averaged, on finer grids in turn. A NaN row where they differ
    by more than `worst` of the template's pixels, or the template there leaves the frame.
    """
    count, height, width = frames.shape
    counts = np.zeros((height, width + 1), dtype=np.int32)
    differences = np.empty(33 * 33, dtype=np.int64)
    for k in range(count):
        out[k, 0] = np.nan
        out[k, 1] = np.nan
        frame = frames[k]
        level = levels[k] + _LEVEL * abs(levels[k])
        lit = 0
        sum_x = 0.0
        sum_y = 0.0
        peak = frame[0, 0]
        peak_x = 0
        peak_y = 0
        for i in range(height):
            before = 0
            for j in range(width):
                u = frame[i, j]
                if u > level:
                    before += 1
                    sum_x += j
                    sum_y += i
                    if u > peak:
                        peak = u
                        peak_x, peak_y = j, i
                counts[i, j + 1] = before
            lit += before
        if lit == 0:
            continue
        if brightest:
            x, y, least = _best_of_brightest(frame, peak, counts, lit, half, square)
        else:
            start = (sum_x / lit, sum_y / lit)
            x, y, least = _search(counts, lit, start, (peak_x, peak_y), half, square, differences)
        _, inside = _difference(counts, lit, x, y, half, square)
        area = 4 * half * half if square else math.pi * half * half
        if inside and least <= worst * area:
            out[k, 0] = x
            out[k, 1] = y


@compiled
def _light_before(before: Floats, i: int, x: float) -> float:
    """Light of row i left of x, each pixel's spread evenly over it; `before` (H, W + 1) sums it."""
    at = min(max(x + 0.5, 0.0), before.shape[1] - 1.0)
    j = min(int(at), before.shape[1] - 2)
    return float(before[i, j] + (at - j) * (before[i, j + 1] - before[i, j]))


@compiled
def _light_inside(before: Floats, x: float, y: float, half: float, square: bool) -> float:
    """Light inside the outline at (x, y)."""
    total = 0.0
    first = max(math.floor(y - half + 0.5), 0)
    last = min(math.floor(y + half + 0.5), before.shape[0] - 1)
    for i in range(first, last + 1):
        low = max(i - 0.5, y - half)
        share = (min(i + 0.5, y + half) - low) / _CHORDS
        for k in range(1 if square else _CHORDS):
            side = half
            if not square:
                off = low + (k + 0.5) * share - y
                side = math.sqrt(max(half * half - off * off, 0.0))
            light = _light_before(before, i, x + side) - _light_before(before, i, x - side)
            total += light * (share * _CHORDS if square else share)
    return total


@compiled
def most_light(frames: NDArray[Any], half: float, square: bool, out: Floats) -> None:
    """Move positions `out` (N, 2) to where the outline holds most light, by parabolas.

    A NaN row where it has no maximum within a half width of the start, or leaves the frame.
    """
    count, height, width = frames.shape
    before = np.zeros((height, width + 1))
    grid = np.empty((3, 3))
    for k in range(count):
        x, y = out[k, 0], out[k, 1]
        if math.isnan(x) or math.isnan(y):
            continue
        reach = 2.0 * half + 2.0
        for i in range(max(int(y - reach), 0), min(int(y + reach) + 2, height)):
            light = 0.0
            for j in range(width):
                light += frames[k, i, j]
                before[i, j + 1] = light
        found = True
        for _ in range(_ROUNDS):
            for a in range(3):
                for b in range(3):
                    grid[a, b] = _light_inside(
                        before, x + (b - 1) * _APART, y + (a - 1) * _APART, half, square
                    )
            slope_x = grid[0, 2] + grid[1, 2] + grid[2, 2] - grid[0, 0] - grid[1, 0] - grid[2, 0]
            slope_y = grid[2, 0] + grid[2, 1] + grid[2, 2] - grid[0, 0] - grid[0, 1] - grid[0, 2]
            total = grid.sum()
            bend_x = total - 3.0 * (grid[0, 1] + grid[1, 1] + grid[2, 1])
            bend_y = total - 3.0 * (grid[1, 0] + grid[1, 1] + grid[1, 2])
            if not (bend_x < 0.0 and bend_y < 0.0):
                found = False
                break
            # Least squares over nine points: slope = S / (6 d), half bend = B / (6 d^2).
            x -= min(max(_APART * slope_x / (2.0 * bend_x), -1.0), 1.0)
            y -= min(max(_APART * slope_y / (2.0 * bend_y), -1.0), 1.0)
            if abs(x - out[k, 0]) > half or abs(y - out[k, 1]) > half:
                found = False
                break
        inside = x - half >= -0.5 and x + half <= width - 0.5
        inside = inside and y - half >= -0.5 and y + half <= height - 0.5
        out[k, 0] = x if found and inside else np.nan
        out[k, 1] = y if found and inside else np.nan

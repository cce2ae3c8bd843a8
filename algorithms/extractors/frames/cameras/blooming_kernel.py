"""Blooming lines by a Hough transform, and where the gradients around one meet it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Distance from the accumulator's peak within which the middle of a run belongs to the line, px.
_NEAR = 1.5
#: A line is at least this many times longer than wide; a disc is not.
_LENGTH = 4.0
#: Share of a line's rows that have full pixels on it; noise has fewer.
_FILLED = 0.7
#: Neighbours whose light differs by more than this logarithm are not one slope: dead pixels.
_STEEPEST = 0.7
#: Distance along the line within which intersections are averaged, px.
_CLOSE = 3.0
_MOVES = 8
#: Times its width that a line may be wide at the Sun: beyond, other saturated light covers it.
_COVERED = 3.0
#: Difference of the two sides' places, px, from which they do not mean the same Sun.
_APART = 1.0


@compiled
def _runs(frame: NDArray[Any], level: float, runs: Floats) -> int:
    """List the runs of pixels above a level in each row as (middle, row, width); return how many.

    A single pixel that is not above it does not end a run: it may be dead.
    """
    height, width = frame.shape
    count = 0
    for i in range(height):
        j = 0
        while j < width:
            if frame[i, j] > level:
                first = j
                while True:
                    if j + 1 < width and frame[i, j + 1] > level:
                        j += 1
                    elif j + 2 < width and frame[i, j + 2] > level:
                        j += 2
                    else:
                        break
                runs[count, 0] = 0.5 * (first + j)
                runs[count, 1] = i
                runs[count, 2] = j - first + 1
                count += 1
            j += 1
    return count


@compiled
def _peak(runs: Floats, count: int, turns: Floats, votes: Floats) -> tuple[float, float, float]:
    """Accumulate ``H[r, theta]`` over the runs' middles; return its peak as (votes, r, theta).

    A vote is shared between the two cells of 1 px that r falls between; the peak in r is that of
    a parabola through three cells.
    """
    best = 0.0
    best_r = np.nan
    best_turn = np.nan
    shift = votes.size // 2
    for turn in turns:
        c, s = math.cos(turn), math.sin(turn)
        votes[:] = 0.0
        for n in range(count):
            r = runs[n, 0] * c + runs[n, 1] * s + shift
            cell = math.floor(r)
            votes[cell] += 1.0 - (r - cell)
            votes[cell + 1] += r - cell
        cell = np.argmax(votes)
        if votes[cell] > best:
            best = votes[cell]
            below, above = votes[cell - 1], votes[cell + 1]
            bend = below - 2.0 * best + above
            best_r = cell - shift + (0.5 * (below - above) / bend if bend < 0.0 else 0.0)
            best_turn = turn
    return best, best_r, best_turn


@compiled
def _refine(  # noqa: PLR0917 - Numba takes no keyword-only ones
    runs: Floats,
    count: int,
    r: float,
    turn: float,
    widest: float,
    along: tuple[float, float],
) -> float:
    """Mean r of the line's pixels whose place along the line lies in an interval; NaN if none."""
    c, s = math.cos(turn), math.sin(turn)
    total = 0.0
    pixels = 0.0
    for n in range(count):
        place = runs[n, 1] * c - runs[n, 0] * s
        away = runs[n, 0] * c + runs[n, 1] * s - r
        if abs(away) <= _NEAR and runs[n, 2] <= widest and along[0] <= place <= along[1]:
            total += runs[n, 2] * away
            pixels += runs[n, 2]
    return r + total / pixels if pixels > 0.0 else np.nan


@compiled
def _slope(
    frame: NDArray[Any], i: int, j: int, low: float, level: float
) -> tuple[float, float, float]:
    """Light of a pixel above `low` and the gradient (x, y) of its logarithm, which bends little.

    Zeros where the pixel or a neighbour is saturated, or too different to be on the same slope.
    """
    here = float(frame[i, j])
    left, right = float(frame[i, j - 1]), float(frame[i, j + 1])
    above, below = float(frame[i - 1, j]), float(frame[i + 1, j])
    if max(here, left, right, above, below) > level:
        return 0.0, 0.0, 0.0
    light = max(here - low, 1.0)  # what is about dark counts as one unit
    left = math.log(max(left - low, 1.0) / light)
    right = math.log(max(right - low, 1.0) / light)
    above = math.log(max(above - low, 1.0) / light)
    below = math.log(max(below - low, 1.0) / light)
    if max(abs(left), abs(right), abs(above), abs(below)) > _STEEPEST:
        return 0.0, 0.0, 0.0
    return light, 0.5 * (right - left), 0.5 * (below - above)


@compiled
def _highest(votes: Floats) -> int:
    """Cell with most votes after smoothing with (1, 2, 3, 2, 1); 0 where there are none."""
    best = 0.0
    highest = 0
    for cell in range(2, votes.size - 2):
        near = votes[cell - 2] + votes[cell + 2] + 3.0 * votes[cell]
        near += 2.0 * (votes[cell - 1] + votes[cell + 1])
        if near > best:
            best = near
            highest = cell
    return highest


@compiled
def _agreement(places: Floats, count: int, place: float) -> tuple[float, float]:
    """Weighted mean of the places near one, moved onto itself, and how its two sides differ.

    NaN where one side has none.
    """
    sums = np.zeros((2, 2))
    for _ in range(_MOVES):
        sums[:] = 0.0
        for n in range(count):
            off = places[n, 0] - place
            if abs(off) <= _CLOSE:
                side = 1 if places[n, 2] > 0.0 else 0
                sums[side, 0] += places[n, 1]
                sums[side, 1] += places[n, 1] * off
        if not (sums[0, 0] > 0.0 and sums[1, 0] > 0.0):
            return np.nan, np.nan
        place += (sums[0, 1] + sums[1, 1]) / (sums[0, 0] + sums[1, 0])
    return place, sums[1, 1] / sums[1, 0] - sums[0, 1] / sums[0, 0]


@compiled
def _sun_on_line(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    low: float,
    level: float,
    r: float,
    turn: float,
    nearest: float,
    farthest: float,
    places: Floats,
    votes: Floats,
) -> tuple[float, float]:
    """Place along the line where the gradients on both sides meet it.

    Returns the place and the difference between what the two sides say; NaN where one of them
    says nothing. `places` (n, 3) is room for the place, the weight and the side of every
    intersection, `votes` for the accumulator along the line.
    """
    height, width = frame.shape
    c, s = math.cos(turn), math.sin(turn)
    shift = votes.size // 2
    votes[:] = 0.0
    count = 0
    for i in range(1, height - 1):
        middle = (r - i * s) / c
        first = max(int(middle - farthest / c), 1)
        end = min(int(middle + farthest / c) + 2, width - 1)
        for j in range(first, end):
            away = j * c + i * s - r
            if not nearest <= abs(away) <= farthest or count == len(places):
                continue
            light, x, y = _slope(frame, i, j, low, level)
            across = x * c + y * s
            along = y * c - x * s
            if across * away >= 0.0:
                continue  # no slope, or down towards the line
            place = i * c - j * s - along / across * away
            cell = math.floor(place + 0.5) + shift
            if 2 <= cell < votes.size - 2:
                steep = (light * across) ** 2
                votes[cell] += steep
                places[count, 0] = place
                places[count, 1] = steep / (1.0 + (along / across) ** 2)
                places[count, 2] = away
                count += 1
    return _agreement(places, count, float(_highest(votes) - shift))


@compiled
def _typical_width(runs: Floats, count: int, r: float, turn: float) -> float:
    """Median width of the runs whose middle lies on a line."""
    c, s = math.cos(turn), math.sin(turn)
    widths = np.empty(count)
    rows = 0
    for n in range(count):
        if abs(runs[n, 0] * c + runs[n, 1] * s - r) <= _NEAR:
            widths[rows] = runs[n, 2]
            rows += 1
    return float(np.median(widths[:rows]))


@compiled
def _extent(
    runs: Floats, count: int, r: float, turn: float, typical: float
) -> tuple[float, float, float, float, bool]:
    """First and last place of a line, its first and last row, and whether other light covers it.

    The places are not finite where too many rows in between have no run on the line.
    """
    c, s = math.cos(turn), math.sin(turn)
    first, last = np.inf, -np.inf
    top, bottom = np.inf, -np.inf
    covered = False
    rows = 0
    for n in range(count):
        away = abs(runs[n, 0] * c + runs[n, 1] * s - r)
        if away <= 0.5 * runs[n, 2]:
            rows += 1
            covered = covered or runs[n, 2] > _COVERED * typical + 1.0
        if away <= _NEAR and runs[n, 2] <= _widest(typical):
            place = runs[n, 1] * c - runs[n, 0] * s
            first, last = min(first, place), max(last, place)
            top, bottom = min(top, runs[n, 1]), max(bottom, runs[n, 1])
    if not rows >= _FILLED * (bottom - top + 1.0):
        return np.nan, np.nan, top, bottom, covered
    return first, last, top, bottom, covered


@compiled
def _widest(typical: float) -> float:
    """Return the width up to which a run is the line's own and nothing else's."""
    return 1.5 * typical + 1.0


@compiled
def blooming_lines(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    usable: NDArray[np.bool_],
    turns: Floats,
    saturated: float,
    least: int,
    reach: float,
    out: Floats,
) -> None:
    """Write each frame's blooming line and where gradients meet it to `out` (N, 7).

    Columns: the line's ends (x, y, x, y), its votes, and the place (x, y) where gradients meet
    it; NaN where there is no line, or none such: where the two sides do not agree, or other
    saturated light covers the Sun's.
    `turns` are the angles tried, radians off the columns. Pixels above the fraction `saturated`
    of the frame's range make lines of `least` votes or more; gradients count up to `reach` px
    from one.
    """
    count, height, width = frames.shape
    runs = np.empty((height * (width // 2 + 1), 3))
    votes = np.empty(2 * (height + width) + 8)
    room = np.empty((height * (2 * int(reach) + 8), 3))
    for k in range(count):
        out[k] = np.nan
        if not usable[k]:
            continue
        frame = frames[k]
        low, high = float(frame.min()), float(frame.max())
        level = low + saturated * (high - low)
        found = _runs(frame, level, runs)
        most, r, turn = _peak(runs, found, turns, votes)
        if not most >= least:
            continue
        c, s = math.cos(turn), math.sin(turn)
        typical = _typical_width(runs, found, r, turn)
        first, last, top, bottom, covered = _extent(runs, found, r, turn, typical)
        widest = _widest(typical)
        if not last - first >= _LENGTH * typical:
            continue
        whole = _refine(runs, found, r, turn, widest, (first, last))
        place, apart = _sun_on_line(
            frame, low, level, whole, turn, 0.5 * typical + 1.5, reach, room, votes
        )
        # Columns end where their overflow does, so that their lengths tell the middle to a
        # fraction of a pixel: not those cut by the frame's edge, which all end there.
        start = place if top <= 0.0 else first
        end = place if bottom >= height - 1.0 else last
        half = _refine(runs, found, r, turn, widest, (start, end))
        if not math.isnan(half):
            whole = half
        out[k, 0] = whole * c - first * s
        out[k, 1] = whole * s + first * c
        out[k, 2] = whole * c - last * s
        out[k, 3] = whole * s + last * c
        out[k, 4] = most
        inside = first - _NEAR <= place <= last + _NEAR
        if inside and not covered and abs(apart) <= _APART:
            out[k, 5] = whole * c - place * s
            out[k, 6] = whole * s + place * c

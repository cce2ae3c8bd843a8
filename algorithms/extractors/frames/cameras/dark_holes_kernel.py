"""Dark holes within bright surroundings, followed through binary masks of descending thresholds."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.regions import SIDES, flood

#: Squared distance of a hole's pixels from their mean, over that of a disc, up to which it is
#: round: an ellipse of 2.6 : 1.
_ROUND = 1.5
#: A second hole of this share of the largest one's radius leaves open which is the Sun.
_RIVAL = 0.8


@compiled
def blur(frame: NDArray[Any], taps: Floats, rows: Floats, out: Floats) -> None:
    """Write the frame convolved with symmetric taps on both axes to `out`, edges repeated.

    `rows` (H, W) holds the frame convolved along its rows.
    """
    height, width = frame.shape
    reach = taps.size // 2
    for i in range(height):
        for j in range(width):
            total = taps[reach] * frame[i, j]
            for d in range(1, reach + 1):
                left = frame[i, max(j - d, 0)]
                right = frame[i, min(j + d, width - 1)]
                total += taps[reach + d] * (float(left) + float(right))
            rows[i, j] = total
    for i in range(height):
        row = out[i]
        for j in range(width):
            row[j] = taps[reach] * rows[i, j]
        for d in range(1, reach + 1):
            above = rows[max(i - d, 0)]
            below = rows[min(i + d, height - 1)]
            weight = taps[reach + d]
            for j in range(width):
                row[j] += weight * (above[j] + below[j])


@compiled
def _corner(
    marks: NDArray[np.int32], mark: int, pixels: NDArray[np.int64], width: int
) -> tuple[float, float]:
    """Refine the corner (x, y) of a hole's rim: the point that its edges are seen from square on.

    It solves ``sum(n n^T (q - p)) = 0`` over the rim's edges between two pixels, at p with the
    normal n. Normals lie along the axes, so that the two equations come apart.
    """
    x = 0.0
    y = 0.0
    edges_x = 0
    edges_y = 0
    for at in pixels:
        for side in (-1, 1):
            if marks[at + side] != mark:
                edges_x += 1
                x += at % width + 0.5 * side
            if marks[at + side * width] != mark:
                edges_y += 1
                y += at // width + 0.5 * side
    return x / edges_x, y / edges_y


@compiled
def _round(pixels: NDArray[np.int64], count: int, width: int) -> bool:
    """Tell whether a hole is about as compact as a disc."""
    x = 0.0
    y = 0.0
    xx = 0.0
    yy = 0.0
    for n in range(count):
        i, j = pixels[n] // width, pixels[n] % width
        x += j
        y += i
        xx += j * j
        yy += i * i
    spread = (xx + yy) / count - (x * x + y * y) / (count * count)
    # a pixel has an extent of its own: 1/12 along each axis
    return spread + 1.0 / 6.0 <= _ROUND * count / (2.0 * math.pi)


@compiled
def _bright_box(image: Floats, level: float) -> tuple[int, int, int, int]:
    """First and last row and column that hold a pixel above a level."""
    height, width = image.shape
    top, bottom, left, right = height, -1, width, -1
    for i in range(height):
        for j in range(width):
            if image[i, j] > level:
                top = min(top, i)
                bottom = i
                left = min(left, j)
                right = max(right, j)
    return top, bottom, left, right


@compiled
def _seeds(  # noqa: PLR0917 - Numba takes no keyword-only ones
    image: Floats,
    level: float,
    least: float,
    marks: NDArray[np.int32],
    pixels: NDArray[np.int64],
    seeds: NDArray[np.int64],
    sizes: NDArray[np.int64],
) -> None:
    """Find the holes of the mask above a level that have at least `least` pixels and are round.

    Their darkest pixels go to `seeds`, their numbers of pixels to `sizes`; the largest are kept
    where there are more than fit. `marks` and `sizes` are zero before.
    """
    top, bottom, left, right = _bright_box(image, level)
    # The dark that surrounds everything reaches the edge of the box about all light.
    box = image[top : bottom + 1, left : right + 1].copy()
    width = box.shape[1]
    for first in range(box.size):
        if marks[first] != 0 or box.flat[first] > level:
            continue
        count, enclosed = flood(box, first, level, False, SIDES, box.size, 1, marks, pixels)
        if not enclosed or count < least or not _round(pixels, count, width):
            continue
        place = np.argmin(sizes)  # an empty one while there is any: their sizes are zero
        if sizes[place] < count:
            sizes[place] = count
            darkest = _darkest(box, pixels, count)
            seeds[place] = (top + darkest // width) * image.shape[1] + left + darkest % width


@compiled
def _darkest(image: Floats, pixels: NDArray[np.int64], count: int) -> int:
    darkest = pixels[0]
    for n in range(count):
        if image.flat[pixels[n]] < image.flat[darkest]:
            darkest = pixels[n]
    return int(darkest)


@compiled
def _follow(  # noqa: PLR0917 - Numba takes no keyword-only ones
    image: Floats,
    levels: Floats,
    seed: int,
    most: int,
    survivals: int,
    moved: float,
    mark: int,
    marks: NDArray[np.int32],
    pixels: NDArray[np.int64],
) -> tuple[float, float]:
    """Mean (x, y) of a hole's corner over the longest run of levels that it survives.

    NaN where these are fewer than `survivals`. Every level takes a mark of its own from `mark` on.
    """
    survived = 0
    longest = 0
    sum_x = 0.0
    sum_y = 0.0
    last_x = np.nan
    last_y = np.nan
    found_x = np.nan
    found_y = np.nan
    for n in range(levels.size):
        size = 0
        enclosed = False
        if not image.flat[seed] > levels[n]:
            size, enclosed = flood(
                image, seed, levels[n], False, SIDES, most, mark + n, marks, pixels
            )
        if not enclosed:
            last_x = np.nan
            continue
        x, y = _corner(marks, mark + n, pixels[:size], image.shape[1])
        if not math.hypot(x - last_x, y - last_y) <= moved:
            survived = 0
            sum_x = 0.0
            sum_y = 0.0
        survived += 1
        sum_x += x
        sum_y += y
        last_x, last_y = x, y
        if survived > longest:
            longest = survived
            found_x, found_y = sum_x / survived, sum_y / survived
    if longest < survivals:
        return np.nan, np.nan
    return found_x, found_y


@compiled
def black_suns(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    usable: NDArray[np.bool_],
    taps: Floats,
    parts: Floats,
    survivals: int,
    radius: float,
    moved: float,
    out: Floats,
) -> None:
    """Write the centre (x, y) of each frame's black Sun to `out` (N, 2); NaN where there is none.

    Only `usable` frames (N,), which must be finite, are looked at. Thresholds descend through
    `parts`, fractions of the range of the frame blurred with `taps`; a corner survives one
    when it is within `moved` px of where it was at the one before.
    """
    count, height, width = frames.shape
    rows = np.empty((height, width))
    image = np.empty((height, width))
    marks = np.empty(height * width, dtype=np.int32)
    pixels = np.empty(height * width, dtype=np.int64)
    seeds = np.empty(64, dtype=np.int64)
    sizes = np.empty(64, dtype=np.int64)
    for k in range(count):
        out[k, 0] = np.nan
        out[k, 1] = np.nan
        if not usable[k]:
            continue
        blur(frames[k], taps, rows, image)
        low, high = image.min(), image.max()
        if not high > low:
            continue
        marks[:] = 0
        sizes[:] = 0
        middle = low + 0.5 * (parts[0] + parts[-1]) * (high - low)
        _seeds(image, middle, math.pi * radius * radius, marks, pixels, seeds, sizes)
        marks[:] = 0
        levels = low + parts * (high - low)
        best = 0
        second = 0
        for n in range(sizes.size):
            if sizes[n] == 0:
                continue
            mark = 1 + n * levels.size
            x, y = _follow(
                image,
                levels,
                seeds[n],
                min(4 * sizes[n] + 16, pixels.size),
                survivals,
                moved,
                mark,
                marks,
                pixels,
            )
            if math.isnan(x):
                continue
            if sizes[n] > best:
                second = best
                best = sizes[n]
                out[k, 0] = x
                out[k, 1] = y
            else:
                second = max(second, sizes[n])
        if second > _RIVAL * _RIVAL * best:
            out[k, 0] = np.nan
            out[k, 1] = np.nan

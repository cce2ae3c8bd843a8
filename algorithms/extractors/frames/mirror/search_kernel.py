"""Find the one light of each frame: background, lit regions, how large and how compact they are.

Works on the least value of every 2 x 2 block of pixels: there a hot pixel leaves no trace, and a
light of some pixels keeps its shape. Frames are (N, H, W) arrays from
`algorithms.inputs.as_frames`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.mirror.records import Light
from algorithms.kernels.records import Records, record
from algorithms.kernels.regions import join_runs, root_of

#: Standard deviations of a dark pixel by which the brightest block must be above the background,
#: and a lit one; the fraction of the brightest block's light that a lit one must have.
_SEEN, _LIT, _CUT = 5.0, 3.0, 0.3
#: Numbers of the border are left out beyond so many mean departures, then standard deviations.
_FAR, _CLIP = 4.0, 3.5
#: Light of all other regions, over that of the brightest, from which they are a second light.
_RIVAL = 0.15
#: Root of the determinant of the second moments, over that of an ellipse of the same area, above
#: which a region is not one spot: 1.05 for a square.
_LOOSE = 1.25
#: Regions from which on a frame is taken for noise.
_MOST = 256
#: Why there is no light.
DARK, SEVERAL, EDGE = 1, 2, 3


class Run:
    """Lit blocks side by side, and sums over them or, where it is the first, over their region.

    Attributes
    ----------
    parent, first, end
        See `algorithms.kernels.regions`.
    light
        Above the background.
    above, above_x, above_y
        Light above the cut, and that times x and y.
    blocks, x, y, xx, yy, xy
        Number of blocks, and sums of their places and of the products of these.
    left, right, top, bottom
        First and last column, first and last row.
    """

    parent: int
    first: int
    end: int
    light: float
    above: float
    above_x: float
    above_y: float
    blocks: float
    x: float
    y: float
    xx: float
    yy: float
    xy: float
    left: float
    right: float
    top: float
    bottom: float


_RUN = record(Run)


@compiled
def _sum(a: Floats) -> float:
    """Sum in eight sums side by side: one alone waits for itself at every number."""
    whole = a.size - a.size % 8
    s0, s1, s2, s3, s4, s5, s6, s7 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for q in range(0, whole, 8):
        s0 += a[q]
        s1 += a[q + 1]
        s2 += a[q + 2]
        s3 += a[q + 3]
        s4 += a[q + 4]
        s5 += a[q + 5]
        s6 += a[q + 6]
        s7 += a[q + 7]
    for q in range(whole, a.size):
        s0 += a[q]
    return ((s0 + s1) + (s2 + s3)) + ((s4 + s5) + (s6 + s7))


@compiled
def _mean_of_small(a: Floats, size: Floats, far: float, chosen: Floats) -> float:
    """Mean of the numbers in `a` whose `size` is at most `far`; the last is work space."""
    number = 0
    for q in range(a.size):
        near = size[q] <= far
        chosen[q] = a[q] if near else 0.0
        number += near
    return _sum(chosen) / max(number, 1)


@compiled
def _border(frame: NDArray[Any], work: Floats) -> tuple[float, float]:
    """Mean of the outermost pixels, and the variance of one, without those that depart by much.

    The variance is that of neighbours' differences, which a background's slope hardly enters.
    """
    height, width = frame.shape
    around = work[0]
    for j in range(width):
        around[j] = frame[0, j]
        around[width + j] = frame[height - 1, j]
    for i in range(height):
        around[2 * width + i] = frame[i, 0]
        around[2 * width + height + i] = frame[i, width - 1]
    count = 2 * (width + height)
    values, size, chosen = around[:count], work[1, :count], work[2, :count]
    mean = _sum(values) / count
    for _ in range(2):
        for q in range(count):
            size[q] = abs(values[q] - mean)
        before, mean = mean, _mean_of_small(values, size, _FAR * _sum(size) / count, chosen)
        if mean == before:
            break
    squares, size, chosen = work[3, : count - 1], size[: count - 1], chosen[: count - 1]
    for q in range(count - 1):
        e = values[q + 1] - values[q]
        squares[q] = e * e
        size[q] = abs(e)
    far = _FAR * _sum(size) / (count - 1)
    variance = 0.0
    for _ in range(3):
        before, variance = variance, _mean_of_small(squares, size, far, chosen)
        if variance == before:
            break
        far = _CLIP * math.sqrt(variance)
    return mean, 0.5 * variance


@compiled
def _erode(flat: NDArray[Any], width: int, least: NDArray[Any], maxima: NDArray[Any]) -> None:
    """Write the least of each 2 x 2 block to `least` (H - 1, W), rows' largest to `maxima`.

    The frame is `flat`, row after row, so that one loop runs over all of it; where that goes around
    a row's end, the last block stands twice.
    """
    out = least.reshape(least.size)
    below = flat[width:]
    for q in range(out.size - 1):
        a = min(below[q], flat[q])
        b = min(below[q + 1], flat[q + 1])
        out[q] = min(b, a)
    for i in range(maxima.size):
        least[i, width - 1] = least[i, width - 2]
    for i in range(maxima.size):
        row = least[i]
        largest = row[0]
        for j in range(row.size):
            largest = max(largest, row[j])
        maxima[i] = largest


@compiled
def _measure(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: NDArray[Any], i: int, first: int, end: int, base: float, cut: float, run: Run
) -> None:
    """Write the blocks ``first .. end - 1`` of row i, and sums over them, to a run."""
    # Every other block to the other sums: one alone waits for itself.
    light, other, light_x, other_x = 0.0, 0.0, 0.0, 0.0
    n = end - first
    part, x = row[first:end], 0.0
    for q in range(n >> 1):
        u, v = part[2 * q] - base, part[2 * q + 1] - base
        light += u
        other += v
        light_x += x * u
        other_x += (x + 1.0) * v
        x += 2.0
    if n & 1 == 1:
        u = part[n - 1] - base
        light += u
        light_x += (n - 1) * u
    light += other
    x = 0.5 * n * (first + end - 1)
    run.first, run.end = first, end
    run.light = light
    run.above = light - n * (cut - base)
    run.above_x = light_x + other_x + first * light - x * (cut - base)
    run.above_y = i * run.above
    run.blocks, run.x, run.y = n, x, i * n
    run.xx = x * x / n + n * (n * n - 1.0) / 12.0
    run.yy = i * i * n
    run.xy = i * x
    run.left, run.right, run.top, run.bottom = first, end - 1, i, i


@compiled
def _mark_lit(
    row: NDArray[Any], cut: float, columns: NDArray[np.int32], lit: NDArray[np.int32]
) -> tuple[int, int, bool]:
    """Write which of a row's blocks are lit; return the first, the last and whether all between."""
    width, number = columns.size, np.int32(0)
    first, last = np.int32(width), np.int32(-1)
    for j in range(width):
        above = row[j] > cut
        lit[j] = np.int32(1) if above else np.int32(0)
        first = min(first, columns[j] if above else np.int32(width))
        last = max(last, columns[j] if above else np.int32(-1))
        number = np.int32(number + lit[j])
    return int(first), int(last), bool(number == last + 1 - first)


@compiled
def _regions(  # noqa: PLR0917 - Numba takes no keyword-only ones
    least: NDArray[Any],
    maxima: NDArray[Any],
    base: float,
    cut: float,
    columns: NDArray[np.int32],
    lit: NDArray[np.int32],
    runs: Records,
) -> int:
    """Gather the connected regions above a cut; return how many runs there are, -1 for too many.

    The first run of each region, its own parent, receives the region's sums. `columns` (W - 1,)
    are the blocks' numbers; `lit` (W,) is work space.
    """
    number, above, here, end = 0, 0, 0, 0
    for i in range(maxima.size):
        above, here = here, end
        if not maxima[i] > cut:
            continue
        j, last, one = _mark_lit(least[i], cut, columns, lit)
        lit[last + 1] = 0
        while j <= last:
            while lit[j] == 0:  # the last one is not
                j += 1
            first, j = j, last + 1 if one else j
            while lit[j] != 0:  # the one after the last is none
                j += 1
            _measure(least[i], i, first, j, base, cut, runs[end])
            runs[end].parent = end
            end += 1
        number += join_runs(runs, above, here, end)
        if number > _MOST:
            return -1
    for run in range(end):
        first = root_of(runs, run)
        if first != run:
            _join(runs[first], runs[run])
    return end


@compiled
def _join(region: Run, other: Run) -> None:
    """Add the sums of another region to those of one."""
    region.light += other.light
    region.above += other.above
    region.above_x += other.above_x
    region.above_y += other.above_y
    region.blocks += other.blocks
    region.x += other.x
    region.y += other.y
    region.xx += other.xx
    region.yy += other.yy
    region.xy += other.xy
    region.left, region.right = min(region.left, other.left), max(region.right, other.right)
    region.top, region.bottom = min(region.top, other.top), max(region.bottom, other.bottom)


@compiled
def _compact(region: Run) -> bool:
    """Whether a region's blocks lie together as those of an ellipse or a square do."""
    n = region.blocks
    xx = region.xx / n - (region.x / n) ** 2 + 1.0 / 12.0
    yy = region.yy / n - (region.y / n) ** 2 + 1.0 / 12.0
    xy = region.xy / n - region.x * region.y / (n * n)
    area: float = 4.0 * math.pi * math.sqrt(max(xx * yy - xy * xy, 0.0))
    return area <= _LOOSE * max(float(n), 4.0)


@compiled
def _refuse(light: Light, refusal: int) -> None:
    """Say that there is no light, and why."""
    light.middle[:], light.half[:] = np.nan, np.nan
    light.base, light.noise, light.peak, light.fill = np.nan, np.nan, np.nan, np.nan
    light.refusal = refusal


@compiled
def find_lights(frames: NDArray[Any], unusable: NDArray[np.bool_], lights: Records) -> None:
    """Write where the one light of each frame is, or why there is not one."""
    count, height, width = frames.shape
    flat = frames.reshape(count, height * width)
    least = np.empty((height - 1, width), dtype=frames.dtype)
    maxima = np.empty(height - 1, dtype=frames.dtype)
    columns, lit = np.arange(width - 1).astype(np.int32), np.empty(width, dtype=np.int32)
    work = np.empty((4, 2 * (height + width)))
    runs = np.empty(height * (width // 2 + 1), dtype=_RUN)
    for k in range(count):
        light = lights[k]
        _refuse(light, DARK)
        if unusable[k]:
            continue
        frame = frames[k]
        _erode(flat[k], width, least, maxima)
        base, noise = _border(frame, work)
        peak = float(maxima.max()) - base
        sigma = math.sqrt(noise)
        if not peak > _SEEN * sigma:
            continue
        cut = base + max(_CUT * peak, _LIT * sigma)
        number = _regions(least, maxima, base, cut, columns, lit, runs)
        best, total = -1, 0.0
        for run in range(number):
            if runs[run].parent == run:
                total += runs[run].light
                if best < 0 or runs[run].light > runs[best].light:
                    best = run
        if best < 0:
            continue
        s = runs[best]
        inside = s.left > 0 and s.top > 0 and s.right < width - 2 and s.bottom < height - 2
        alone = total - s.light <= _RIVAL * s.light
        if not (s.blocks >= 2 and s.above > 0.0):
            continue
        if not inside or not alone or not _compact(s):
            light.refusal = EDGE if not inside else SEVERAL
            continue
        # A block's middle is half a pixel beyond its first pixel.
        x, y = s.above_x / s.above + 0.5, s.above_y / s.above + 0.5
        light.middle[0], light.middle[1] = x, y
        light.half[0] = max(x - s.left, s.right + 1.0 - x)
        light.half[1] = max(y - s.top, s.bottom + 1.0 - y)
        light.base, light.noise, light.peak = base, noise, peak
        light.fill = s.light / (s.blocks * peak)
        light.refusal = 0

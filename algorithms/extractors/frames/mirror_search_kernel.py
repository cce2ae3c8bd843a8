"""Find the one light of each frame: background, lit regions, how large and how compact they are.

Works on the least value of every 2 x 2 block of pixels: there a hot pixel leaves no trace, and a
light of some pixels keeps its shape. Frames are (N, H, W) arrays from `algorithms.inputs.as_frames`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Standard deviations of a dark pixel by which the brightest block must be above the background,
#: and a lit one; the fraction of the brightest block's light that a lit one must have.
_SEEN, _LIT, _CUT = 5.0, 3.0, 0.3
#: Fits of the background to the border; departures beyond so many deviations are left out.
_FITS, _CLIP = 4, 3.0
#: Variance of a normal variable clipped at three deviations.
_CLIPPED = 0.9733
#: Light of all other regions, over that of the brightest, from which they are a second light.
_RIVAL = 0.15
#: Root of the determinant of the second moments, over that of an ellipse of the same area, above
#: which a region is not one spot: 1.05 for a square.
_LOOSE = 1.25
#: Regions from which on a frame is taken for noise.
_MOST = 256
#: Sums of a region: see `_add_run`.
_SUMS = 14
#: What `find_lights` writes of a frame.
FOUND = 8


@compiled
def _border(frame: NDArray[Any], pixels: Floats) -> tuple[float, float]:
    """Mean and variance of the outermost pixels about a plane; `pixels` (3, P) is work space.

    Fitted several times, each time without those that departed from the last plane by much.
    """
    height, width = frame.shape
    half_x, half_y = 0.5 * (width - 1), 0.5 * (height - 1)
    count = 0
    for i in range(height):
        step = 1 if i in {0, height - 1} else max(width - 1, 1)
        for j in range(0, width, step):
            pixels[0, count] = j - half_x
            pixels[1, count] = i - half_y
            pixels[2, count] = float(frame[i, j])
            count += 1
    first = pixels[2, 0]
    mean, slope_x, slope_y, variance = 0.0, 0.0, 0.0, 0.0
    for fit in range(_FITS):
        far = np.inf if fit == 0 else _CLIP * _CLIP * variance
        number, moved, along_x, along_y, xx, yy, squares = 0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for p in range(count):
            x, y = pixels[0, p], pixels[1, p]
            e = pixels[2, p] - first - mean - slope_x * x - slope_y * y
            if e * e <= far:
                number += 1
                moved += e
                along_x += e * x
                along_y += e * y
                xx += x * x
                yy += y * y
                squares += e * e
        mean += moved / number
        slope_x += along_x / max(xx, 1.0)
        slope_y += along_y / max(yy, 1.0)
        # What the fit takes off is known without another pass: the axes are nearly orthogonal.
        squares -= moved * moved / number + along_x**2 / max(xx, 1.0) + along_y**2 / max(yy, 1.0)
        variance = max(squares / number, 0.0)
        if fit > 0:
            variance /= _CLIPPED
    return first + mean, variance


@compiled
def _erode(frame: NDArray[Any], least: NDArray[Any], maxima: NDArray[Any]) -> None:
    """Write the least of each 2 x 2 block to `least` (H - 1, W - 1), its rows' largest to `maxima`."""
    height, width = frame.shape
    for i in range(height - 1):
        upper, lower, out = frame[i], frame[i + 1], least[i]
        for j in range(width - 1):
            a = upper[j] if upper[j] < lower[j] else lower[j]
            b = upper[j + 1] if upper[j + 1] < lower[j + 1] else lower[j + 1]
            out[j] = a if a < b else b
        # Four side by side: one alone waits for itself at every pixel.
        a = out[0]
        b, c, d = a, a, a
        whole = out.size - out.size % 4
        for j in range(0, whole, 4):
            a = max(a, out[j])
            b = max(b, out[j + 1])
            c = max(c, out[j + 2])
            d = max(d, out[j + 3])
        for j in range(whole, out.size):
            a = max(a, out[j])
        maxima[i] = max(a, b, c, d)


@compiled
def _root(parents: NDArray[np.int64], label: int) -> int:
    while parents[label] != label:
        label = parents[label]
    return label


@compiled
def _add_run(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: NDArray[Any], i: int, first: int, end: int, base: float, cut: float, sums: Floats
) -> None:
    """Add the blocks ``first .. end - 1`` of row i to a region.

    `sums`: light, light above the cut and its x and y; blocks, their x, y, x^2, y^2 and x y;
    first and last column, first and last row.
    """
    light, above, above_x = 0.0, 0.0, 0.0
    for j in range(first, end):
        u = float(row[j])
        light += u - base
        above += u - cut
        above_x += j * (u - cut)
    n = float(end - first)
    x = 0.5 * n * (first + end - 1)
    sums[0] += light
    sums[1] += above
    sums[2] += above_x
    sums[3] += i * above
    sums[4] += n
    sums[5] += x
    sums[6] += i * n
    sums[7] += x * x / n + n * (n * n - 1.0) / 12.0
    sums[8] += i * i * n
    sums[9] += i * x
    sums[10] = min(sums[10], first)
    sums[11] = max(sums[11], end - 1)
    sums[12] = min(sums[12], i)
    sums[13] = max(sums[13], i)


@compiled
def _regions(  # noqa: PLR0917 - Numba takes no keyword-only ones
    least: NDArray[Any],
    maxima: NDArray[Any],
    base: float,
    cut: float,
    runs: NDArray[np.int64],
    parents: NDArray[np.int64],
    sums: Floats,
) -> int:
    """Gather the connected regions above a cut; return how many labels were given, -1 for too many.

    Runs of lit blocks are joined with those of the row above that they touch. `runs` (2, 3, W) is
    work space. A label whose parent is another one has handed its sums over.
    """
    height, width = least.shape
    labels = 0
    above = 0
    for i in range(height):
        before, now = runs[i % 2], runs[1 - i % 2]
        here = 0
        if maxima[i] > cut:
            row = least[i]
            j = 0
            p = 0
            while j < width:
                if not row[j] > cut:
                    j += 1
                    continue
                first = j
                while j < width and row[j] > cut:
                    j += 1
                label = -1
                while p < above and before[1, p] < first:
                    p += 1
                q = p
                while q < above and before[0, q] <= j:
                    other = _root(parents, before[2, q])
                    if label < 0:
                        label = other
                    elif other != label:
                        parents[other] = label
                        for s in range(10):
                            sums[label, s] += sums[other, s]
                        for s in (10, 12):
                            sums[label, s] = min(sums[label, s], sums[other, s])
                            sums[label, s + 1] = max(sums[label, s + 1], sums[other, s + 1])
                    q += 1
                if label < 0:
                    if labels == len(parents):
                        return -1
                    label = labels
                    labels += 1
                    parents[label] = label
                    sums[label, :10] = 0.0
                    sums[label, 10], sums[label, 11] = np.inf, -np.inf
                    sums[label, 12], sums[label, 13] = np.inf, -np.inf
                _add_run(row, i, first, j, base, cut, sums[label])
                now[0, here], now[1, here], now[2, here] = first, j, label
                here += 1
        above = here
    return labels


@compiled
def _compact(s: Floats) -> bool:
    """Whether a region's blocks lie together as those of an ellipse or a square do."""
    n = s[4]
    xx = s[7] / n - (s[5] / n) ** 2 + 1.0 / 12.0
    yy = s[8] / n - (s[6] / n) ** 2 + 1.0 / 12.0
    xy = s[9] / n - s[5] * s[6] / (n * n)
    return 4.0 * math.pi * math.sqrt(max(xx * yy - xy * xy, 0.0)) <= _LOOSE * max(n, 4.0)


@compiled
def find_lights(frames: NDArray[Any], unusable: NDArray[np.bool_], out: Floats) -> None:
    """Write to `out` (N, 8) where the one light of a frame is; NaN rows where there is not one.

    Columns: x, y of its blocks' light above the cut, half its extent along x and y, background,
    variance of a dark pixel, light of the brightest block, and mean light of the lit ones over it.
    """
    count, height, width = frames.shape
    least = np.empty((height - 1, width - 1), dtype=frames.dtype)
    maxima = np.empty(height - 1, dtype=frames.dtype)
    pixels = np.empty((3, 2 * (height + width)))
    runs = np.empty((2, 3, width), dtype=np.int64)
    parents = np.empty(_MOST, dtype=np.int64)
    sums = np.empty((_MOST, _SUMS))
    for k in range(count):
        out[k] = np.nan
        if unusable[k]:
            continue
        frame = frames[k]
        _erode(frame, least, maxima)
        base, noise = _border(frame, pixels)
        peak = float(maxima.max()) - base
        sigma = math.sqrt(noise)
        if not peak > _SEEN * sigma:
            continue
        cut = base + max(_CUT * peak, _LIT * sigma)
        labels = _regions(least, maxima, base, cut, runs, parents, sums)
        best, total = -1, 0.0
        for label in range(labels):
            if parents[label] == label:
                total += sums[label, 0]
                if best < 0 or sums[label, 0] > sums[best, 0]:
                    best = label
        if best < 0:
            continue
        s = sums[best]
        inside = s[10] > 0 and s[12] > 0 and s[11] < width - 2 and s[13] < height - 2
        alone = total - s[0] <= _RIVAL * s[0]
        if not (inside and alone and s[4] >= 2 and s[1] > 0.0 and _compact(s)):
            continue
        # A block's middle is half a pixel beyond its first pixel.
        x, y = s[2] / s[1] + 0.5, s[3] / s[1] + 0.5
        out[k, 0] = x
        out[k, 1] = y
        out[k, 2] = max(x - s[10], s[11] + 1.0 - x)
        out[k, 3] = max(y - s[12], s[13] + 1.0 - y)
        out[k, 4] = base
        out[k, 5] = noise
        out[k, 6] = peak
        out[k, 7] = s[0] / (s[4] * peak)

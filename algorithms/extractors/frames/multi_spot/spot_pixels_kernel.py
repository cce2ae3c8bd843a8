"""The pixels of many spots of one frame, without background, by distance from the middle."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.records import Records, record

#: Reach of a spot's pixels beyond its rim: over its radius, and px; of these the outermost show
#: the background.
_WIDER, _MARGIN, _RING = 0.1, 3.0, 1.5
#: Deviations of the background's slope from which it is one.
_SLOPE = 3.0
#: Deviations of a ring's variance from the median one from which other light is in it.
_UNEVEN = 5.0
#: Rows of a pixel's numbers: column, row, light, distance from its spot's middle, its slopes.
X, Y, U, R, GX, GY = 0, 1, 2, 3, 4, 5


class Form:
    """Shape that all spots of a frame have in common.

    Attributes
    ----------
    xx, xy, yy
        Metric of determinant one in which spots are round.
    radius, reach
        Of the spots and of their pixels in that metric, px.
    noise
        Variance of a background pixel.
    """

    xx: float
    xy: float
    yy: float
    radius: float
    reach: float
    noise: float


FORM = record(Form)


class SlopeSums:
    """Sums over background pixels that tell a slope: number, places, products, with light u.

    Attributes
    ----------
    n, x, y, xx, xy, yy, u, ux, uy
        Places are counted from the first pixel.
    """

    n: float
    x: float
    y: float
    xx: float
    xy: float
    yy: float
    u: float
    ux: float
    uy: float


_SLOPE_SUMS = record(SlopeSums)


@compiled
def _shape(
    frame: NDArray[Any], level: float, spots: Floats, half: int
) -> tuple[float, float, float, float]:
    """Metric (xx, xy, yy) of determinant one that makes the spots round, and their radius in it.

    Of the light above the level within `half` pixels of each spot's middle: its second moments and
    its pixels are those of the median spot, for light that is no spot's own lies beside one or two.
    """
    height, width = frame.shape
    forms = np.zeros((4, spots.shape[0]))
    for s in range(spots.shape[0]):
        x, y = spots[s, 0], spots[s, 1]
        column, line = round(x), round(y)
        xx = 0.0
        xy = 0.0
        yy = 0.0
        light = 0.0
        for i in range(max(line - half, 0), min(line + half + 1, height)):
            for j in range(max(column - half, 0), min(column + half + 1, width)):
                u = frame[i, j] - level
                if u > 0.0:
                    forms[3, s] += 1.0
                    light += u
                    xx += u * (j - x) * (j - x)
                    xy += u * (j - x) * (i - y)
                    yy += u * (i - y) * (i - y)
        if light > 0.0:
            forms[0, s], forms[1, s], forms[2, s] = xx / light, xy / light, yy / light
    xx, xy, yy = np.median(forms[0]), np.median(forms[1]), np.median(forms[2])
    root = math.sqrt(max(xx * yy - xy * xy, 0.0))
    if not root > 1e-3 * (xx + yy):
        return 0.0, 0.0, 0.0, 0.0
    return yy / root, -xy / root, xx / root, math.sqrt(np.median(forms[3]) / math.pi)


@compiled
def _gather(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    floor: float,
    spots: Floats,
    metric: tuple[float, float, float],
    reach: float,
    pixels: Floats,
    ends: NDArray[np.int64],
) -> None:
    """List each spot's pixels as far as `reach`, their light above `floor`, and where they end."""
    height, width = frame.shape
    xx, xy, yy = metric
    high = reach * math.sqrt(xx)
    end = 0
    for s in range(spots.shape[0]):
        x, y = spots[s, 0], spots[s, 1]
        for i in range(max(math.ceil(y - high), 0), min(math.floor(y + high), height - 1) + 1):
            dy = i - y  # where the row cuts the ellipse
            shift = -xy * dy / xx
            side = math.sqrt(max((reach * reach - dy * dy / xx) / xx, 0.0))
            first = max(math.ceil(x + shift - side), 0)
            last = min(math.floor(x + shift + side), width - 1)
            for j in range(first, last + 1):
                pixels[X, end] = j
                pixels[Y, end] = i
                dx = j - x
                pixels[U, end] = frame[i, j] - floor
                pixels[R, end] = math.sqrt(max((xx * dx + 2.0 * xy * dy) * dx + yy * dy * dy, 0.0))
                end += 1
        ends[s] = end


@compiled
def _background(own: Floats, ring: float, mean: float, spread: float) -> tuple[float, float, int]:
    """Mean and variance of a spot's pixels beyond `ring`, and how many are not left out.

    Those further from the mean than `spread` are, once; where that is infinite, those that stand
    out by four deviations.
    """
    variance = 0.0
    n = 0
    for turn in range(2):
        n = 0
        total = 0.0
        square = 0.0
        for p in range(own.shape[1]):
            u = own[U, p] - mean
            if own[R, p] > ring and abs(u) <= spread:
                n += 1
                total += u
                square += u * u
        total /= max(n, 1)
        mean += total
        variance = max(square / max(n, 1) - total * total, 0.0)
        if turn == 0 and spread == math.inf:
            spread = 4.0 * math.sqrt(variance)
    return mean, variance, n


@compiled
def _flatten(pixels: Floats, ends: NDArray[np.int64], ring: float, lights: Floats) -> float:
    """Take off each spot's background and the slope of all, seen beyond `ring`; write the light.

    Pixels that stand out of a spot's ring by four deviations are not of its background. Returns
    the variance of a background pixel: the median spot's, for light that is no spot's own lies
    beside one or two.
    """
    grounds = np.empty((3, ends.size))
    begin = 0
    for s in range(ends.size):
        mean, variance, n = _background(pixels[:, begin : ends[s]], ring, 0.0, math.inf)
        grounds[0, s], grounds[1, s], grounds[2, s] = mean, variance, n
        begin = ends[s]
    noise = float(np.median(grounds[1]))
    # a compiled record does not keep its array, which is freed after its last use
    kept_sums = np.zeros(1, dtype=_SLOPE_SUMS)
    begin = 0
    for s in range(ends.size):
        sums = kept_sums[0]
        own = pixels[:, begin : ends[s]]
        mean, n = grounds[0, s], grounds[2, s]
        spread = 4.0 * math.sqrt(grounds[1, s])
        if grounds[1, s] > noise * (1.0 + _UNEVEN * math.sqrt(2.0 / max(n, 1.0))):
            spread = 4.0 * math.sqrt(noise)
            beyond = own[U][own[R] > ring]
            mean, _, _ = _background(own, ring, float(np.median(beyond)), spread)
        light = 0.0
        for p in range(own.shape[1]):
            u = own[U, p]
            if own[R, p] > ring and abs(u - mean) <= spread:
                x = own[X, p] - pixels[X, 0]
                y = own[Y, p] - pixels[Y, 0]
                sums.n += 1.0
                sums.x += x
                sums.y += y
                sums.xx += x * x
                sums.xy += x * y
                sums.yy += y * y
                sums.u += u
                sums.ux += u * x
                sums.uy += u * y
            own[U, p] = u - mean
            light += u - mean
        lights[s] = light
        begin = ends[s]
    slope_x, slope_y, sure = _slope(kept_sums)
    if sure > _SLOPE * _SLOPE * 2.0 * noise:  # its chi square, of two degrees of freedom
        _tilt(pixels, ends, slope_x, slope_y)
    return noise


@compiled
def _slope(kept_sums: Records) -> tuple[float, float, float]:
    """Slope of the light along x and y of one record of sums, and the squares that it explains."""
    sums = kept_sums[0]
    n = max(sums.n, 1.0)
    xx = sums.xx - sums.x * sums.x / n
    xy = sums.xy - sums.x * sums.y / n
    yy = sums.yy - sums.y * sums.y / n
    ux = sums.ux - sums.u * sums.x / n
    uy = sums.uy - sums.u * sums.y / n
    determinant = xx * yy - xy * xy
    if not determinant > 1e-9 * xx * yy:
        return 0.0, 0.0, 0.0
    slope_x = (yy * ux - xy * uy) / determinant
    slope_y = (xx * uy - xy * ux) / determinant
    return slope_x, slope_y, slope_x * ux + slope_y * uy


@compiled
def _tilt(pixels: Floats, ends: NDArray[np.int64], slope_x: float, slope_y: float) -> None:
    """Take off a slope about the middle of each spot's pixels."""
    begin = 0
    for s in range(ends.size):
        own = pixels[:, begin : ends[s]]
        x = own[X].mean()
        y = own[Y].mean()
        for p in range(own.shape[1]):
            own[U, p] -= slope_x * (own[X, p] - x) + slope_y * (own[Y, p] - y)
        begin = ends[s]


@compiled
def spot_pixels(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    level: float,
    floor: float,
    spots: Floats,
    size: float,
    room: float,
    pixels: Floats,
    ends: NDArray[np.int64],
    lights: Floats,
    form: Form,
) -> bool:
    """List the pixels of each spot and its surroundings; False where they have no common shape.

    Parameters
    ----------
    level, floor
        Above which a pixel of the frame (H, W) is lit; its background.
    spots
        (S, 2) thresholded centroids.
    size, room
        Largest width of a spot, px; how far it may reach before it meets another.
    pixels, ends, lights
        (6, P), of which the first four rows receive column, row, light and distance from the
        spot's middle; (S,) where each spot's end; (S,) its light.
    form
        Receives the shape of the spots.
    """
    half = max(min(math.ceil(0.5 * size) + 2, int(room)), 1)
    xx, xy, yy, radius = _shape(frame, level, spots, half)
    if not 0.0 < radius <= size:
        return False
    wide, high = math.sqrt(yy), math.sqrt(xx)
    reach = min((1.0 + _WIDER) * radius + _MARGIN, max(room, radius) / max(wide, high))
    if (2.0 * reach * wide + 1.0) * (2.0 * reach * high + 1.0) * ends.size > pixels.shape[1]:
        return False
    _gather(frame, floor, spots, (xx, xy, yy), reach, pixels, ends)
    noise = _flatten(pixels, ends, reach - _RING, lights)
    form.xx, form.xy, form.yy = xx, xy, yy
    form.radius, form.reach, form.noise = radius, reach, noise
    return True

"""Centres of spots that have one image in common, its profile taken from all of them together.

Frames are (N, H, W) arrays from `algorithms.inputs.as_frames`; all sums are float64.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Px between the knots of the profile, a cubic spline, and what keeps it smooth where no pixel is.
_KNOTS, _SMOOTH = 0.65, 3e-2
#: Samples of the profile a px, and how many to each side its slopes are weighted by the mean of:
#: sharp weights see the pixels' places.
_FINE, _AROUND = 32, 22
#: Reach of a spot's pixels beyond its rim: over its radius, and px; of these the outermost show
#: the background.
_WIDER, _MARGIN, _RING = 0.1, 3.0, 1.5
#: A pixel is left out that departs from the profile by so many deviations, in rounds.
_BAD, _ROUNDS = 6.0, 3
#: Deviations of the background's slope from which it is one.
_SLOPE = 3.0
#: Steps of a spot's centre; none leads further than this share of its radius.
_STEPS, _ASTRAY = 2, 0.5
#: Least light of a spot over the mean.
_LIGHT = 0.2
#: Variance of the profile's slope, over that of a pixel and the number of them between knots.
_UNSURE = 4.0
#: Rows of a pixel's numbers: column, row, light, distance from its spot's middle, its slopes.
_X, _Y, _U, _R, _GX, _GY = 0, 1, 2, 3, 4, 5

# One interval of a cubic B-spline: the powers of t in each of the four that are not zero there.
_BASIS = (
    np.array(
        [[1.0, -3.0, 3.0, -1.0], [4.0, 0.0, -6.0, 3.0], [1.0, 3.0, 3.0, -3.0], [0.0, 0.0, 0.0, 1.0]]
    )
    / 6.0
)


@compiled
def _shape(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any], level: float, spots: Floats, half: int
) -> tuple[float, float, float, float]:
    """Metric (xx, xy, yy) of determinant one that makes the spots round, and their radius in it.

    Of the light above the level within `half` pixels of each spot's middle.
    """
    height, width = frame.shape
    xx = 0.0
    xy = 0.0
    yy = 0.0
    light = 0.0
    pixels = 0
    for s in range(spots.shape[0]):
        x, y = spots[s, 0], spots[s, 1]
        column, line = round(x), round(y)
        for i in range(max(line - half, 0), min(line + half + 1, height)):
            for j in range(max(column - half, 0), min(column + half + 1, width)):
                u = frame[i, j] - level
                if u > 0.0:
                    pixels += 1
                    light += u
                    xx += u * (j - x) * (j - x)
                    xy += u * (j - x) * (i - y)
                    yy += u * (i - y) * (i - y)
    root = math.sqrt(max(xx * yy - xy * xy, 0.0))
    area = pixels / spots.shape[0]
    if not root > 1e-3 * (xx + yy):
        return 0.0, 0.0, 0.0, 0.0
    return yy / root, -xy / root, xx / root, math.sqrt(area / math.pi)


@compiled
def _measure(pixels: Floats, x: float, y: float, metric: tuple[float, float, float]) -> None:
    """Write the distances of one spot's pixels (6, P) from its middle, and their slopes."""
    xx, xy, yy = metric
    across, along = pixels[_X], pixels[_Y]
    r, gx, gy = pixels[_R], pixels[_GX], pixels[_GY]
    for p in range(r.size):
        dx = across[p] - x
        dy = along[p] - y
        a = xx * dx + xy * dy
        b = xy * dx + yy * dy
        far = math.sqrt(max(a * dx + b * dy, 1e-18))
        inverse = 1.0 / far
        r[p] = far
        gx[p] = a * inverse
        gy[p] = b * inverse


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
    xx, xy, _ = metric
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
                pixels[_X, end] = j
                pixels[_Y, end] = i
                pixels[_U, end] = frame[i, j] - floor
                end += 1
        ends[s] = end


@compiled
def _flatten(pixels: Floats, ends: NDArray[np.int64], ring: float, lights: Floats) -> float:
    """Take off each spot's background and the slope of all, seen beyond `ring`; write the light.

    Pixels that stand out of a spot's ring by four deviations are not of its background. Returns
    the variance of a background pixel.
    """
    sums = np.zeros(9)  # n, x, y, xx, xy, yy, u, ux, uy about the first pixel
    squares = 0.0
    begin = 0
    for s in range(ends.size):
        own = pixels[:, begin : ends[s]]
        mean = 0.0
        spread = math.inf
        for _ in range(2):
            n = 0
            total = 0.0
            square = 0.0
            for p in range(own.shape[1]):
                u = own[_U, p] - mean
                if own[_R, p] > ring and abs(u) <= spread:
                    n += 1
                    total += u
                    square += u * u
            total /= max(n, 1)
            mean += total
            variance = max(square / max(n, 1) - total * total, 0.0)
            spread = 4.0 * math.sqrt(variance)
        squares += variance * n
        light = 0.0
        for p in range(own.shape[1]):
            u = own[_U, p]
            if own[_R, p] > ring and abs(u - mean) <= spread:
                x = own[_X, p] - pixels[_X, 0]
                y = own[_Y, p] - pixels[_Y, 0]
                sums[0] += 1.0
                sums[1] += x
                sums[2] += y
                sums[3] += x * x
                sums[4] += x * y
                sums[5] += y * y
                sums[6] += u
                sums[7] += u * x
                sums[8] += u * y
            own[_U, p] = u - mean
            light += u - mean
        lights[s] = light
        begin = ends[s]
    n = max(sums[0], 1.0)
    noise = squares / n
    xx = sums[3] - sums[1] * sums[1] / n
    xy = sums[4] - sums[1] * sums[2] / n
    yy = sums[5] - sums[2] * sums[2] / n
    ux = sums[7] - sums[6] * sums[1] / n
    uy = sums[8] - sums[6] * sums[2] / n
    determinant = xx * yy - xy * xy
    if determinant > 1e-9 * xx * yy:
        slope_x = (yy * ux - xy * uy) / determinant
        slope_y = (xx * uy - xy * ux) / determinant
        # its chi square, of two degrees of freedom
        if slope_x * ux + slope_y * uy > _SLOPE * _SLOPE * 2.0 * noise:
            _tilt(pixels, ends, slope_x, slope_y, lights)
    return noise


@compiled
def _tilt(
    pixels: Floats, ends: NDArray[np.int64], slope_x: float, slope_y: float, lights: Floats
) -> None:
    """Take off a slope about the middle of each spot's pixels."""
    begin = 0
    for s in range(ends.size):
        own = pixels[:, begin : ends[s]]
        x = own[_X].mean()
        y = own[_Y].mean()
        for p in range(own.shape[1]):
            own[_U, p] -= slope_x * (own[_X, p] - x) + slope_y * (own[_Y, p] - y)
        begin = ends[s]


@compiled
def _spline(  # noqa: PLR0917 - Numba takes no keyword-only ones
    pixels: Floats,
    ends: NDArray[np.int64],
    shares: Floats,
    kept: NDArray[np.bool_],
    table: Floats,
    moments: Floats,
    band: Floats,
) -> None:
    """Fit the profile, light over a spot's share against distance, to all pixels kept.

    `table` (M, 6) receives, interval by interval, the powers of what is past the knot in it, and
    how many pixels there are.
    """
    intervals = table.shape[0]
    moments[:] = 0.0
    begin = 0
    for s in range(ends.size):
        inverse = 1.0 / shares[s] if shares[s] > 0.0 else 0.0
        for p in range(begin, ends[s] if inverse > 0.0 else begin):
            if not kept[p]:
                continue
            u = pixels[_U, p] * inverse
            t = pixels[_R, p] * (1.0 / _KNOTS)
            m = np.uint32(t)
            t -= m
            at = moments[m]
            t2 = t * t
            t3 = t2 * t
            at[0] += 1.0
            at[1] += t
            at[2] += t2
            at[3] += t3
            at[4] += t2 * t2
            at[5] += t3 * t2
            at[6] += t3 * t3
            at[7] += u
            at[8] += u * t
            at[9] += u * t2
            at[10] += u * t3
        begin = ends[s]
    unknowns = intervals + 3
    band[:] = 0.0  # (unknowns, 5): diagonal, three below it, right side
    for m in range(intervals):
        for a in range(4):
            for i in range(4):
                band[m + a, 4] += _BASIS[a, i] * moments[m, 7 + i]
                for b in range(a + 1):
                    for j in range(4):
                        band[m + a, a - b] += _BASIS[a, i] * _BASIS[b, j] * moments[m, i + j]
    smooth = _SMOOTH * max(band[:unknowns, 0].mean(), 1e-300)
    for c in range(unknowns - 2):  # squares of second differences 1, -2, 1
        band[c, 0] += smooth
        band[c + 1, 0] += 4.0 * smooth
        band[c + 2, 0] += smooth
        band[c + 1, 1] -= 2.0 * smooth
        band[c + 2, 1] -= 2.0 * smooth
        band[c + 2, 2] += smooth
    for i in range(unknowns):  # Cholesky; the lower triangle takes the matrix's place
        for d in range(min(i, 3), -1, -1):
            j = i - d
            total = band[i, d]
            for k in range(max(i - 3, 0), j):
                total -= band[i, i - k] * band[j, j - k]
            band[i, d] = math.sqrt(max(total, 1e-300)) if d == 0 else total / band[j, 0]
        for d in range(1, min(i, 3) + 1):
            band[i, 4] -= band[i, d] * band[i - d, 4]
        band[i, 4] /= band[i, 0]
    for i in range(unknowns - 1, -1, -1):
        for d in range(1, min(3, unknowns - 1 - i) + 1):
            band[i, 4] -= band[i + d, d] * band[i + d, 4]
        band[i, 4] /= band[i, 0]
    for m in range(intervals):
        for i in range(4):
            total = 0.0
            for a in range(4):
                total += _BASIS[a, i] * band[m + a, 4]
            table[m, i] = total
        table[m, 4] = moments[m, 0]


@compiled
def _sample(table: Floats, fine: Floats) -> None:
    """Write the profile, its slope, the mean of both around, and the pixels between knots.

    Columns of `fine` (F, 5), `_FINE` rows a px. The middle repeats itself on its other side.
    """
    intervals = table.shape[0]
    for f in range(fine.shape[0]):
        t = f * (1.0 / (_FINE * _KNOTS))
        m = min(int(t), intervals - 1)
        t = min(t - m, 1.0)
        at = table[m]
        fine[f, 0] = at[0] + t * (at[1] + t * (at[2] + t * at[3]))
        fine[f, 1] = (at[1] + t * (2.0 * at[2] + t * 3.0 * at[3])) * (1.0 / _KNOTS)
        fine[f, 4] = at[4]
    last = fine.shape[0] - 1
    for f in range(fine.shape[0]):
        near = abs(f - _AROUND)
        far = min(f + _AROUND, last)
        fine[f, 2] = (fine[far, 0] - fine[near, 0]) * (_FINE / (2.0 * _AROUND))
        fine[f, 3] = 0.25 * (fine[near, 0] + fine[far, 0]) + 0.5 * fine[f, 0]


@compiled
def _variances(  # noqa: PLR0917 - Numba takes no keyword-only ones
    pixels: Floats,
    ends: NDArray[np.int64],
    shares: Floats,
    fine: Floats,
    noise: float,
    kept: NDArray[np.bool_],
) -> tuple[float, bool]:
    """Variance of lit pixels over their light, and whether more pixels were found to be bad."""
    gain = 0.0
    changed = False
    for turn in range(2):
        excess = 0.0
        light = 0.0
        begin = 0
        for s in range(ends.size):
            for p in range(begin, ends[s] if shares[s] > 0.0 else begin):
                if not kept[p]:
                    continue
                t = pixels[_R, p] * _FINE
                m = np.uint32(t)
                t -= m
                value = shares[s] * (fine[m, 0] + t * (fine[m + 1, 0] - fine[m, 0]))
                e = pixels[_U, p] - value
                value = max(value, 0.0)
                if turn > 0 and e * e > _BAD * _BAD * (noise + gain * value):
                    kept[p] = False
                    changed = True
                    continue
                excess += e * e - noise
                light += value
            begin = ends[s]
        gain = max(excess / light, 0.0) if light > 0.0 else 0.0
    return gain, changed


@compiled
def _step(  # noqa: PLR0917 - Numba takes no keyword-only ones
    own: Floats,
    kept: NDArray[np.bool_],
    share: float,
    fine: Floats,
    noise: float,
    gain: float,
    out: Floats,
) -> bool:
    """Write the step of one spot's centre, its variance and the misfit to `out` (4,)."""
    a_xx = 0.0
    a_xy = 0.0
    a_yy = 0.0
    b_x = 0.0
    b_y = 0.0
    misfit = 0.0
    number = 0
    for p in range(own.shape[1]):
        if not kept[p]:
            continue
        t = own[_R, p] * _FINE
        m = np.uint32(t)
        t -= m
        e = own[_U, p] - share * (fine[m, 0] + t * (fine[m + 1, 0] - fine[m, 0]))
        variance = noise + gain * max(share * fine[m, 3], 0.0)
        misfit += e * e / variance
        number += 1
        # Of the squared slope, what its own noise explains is no slope.
        slope = share * fine[m, 2]
        sure = slope * slope * max(fine[m, 4], 1.0)
        if sure <= _UNSURE * variance:
            continue
        weight = slope * (1.0 - _UNSURE * variance / sure) / variance
        slope = share * fine[m, 1]
        gx, gy = own[_GX, p], own[_GY, p]
        b_x -= weight * gx * e
        b_y -= weight * gy * e
        a_xx += weight * slope * gx * gx
        a_xy += weight * slope * gx * gy
        a_yy += weight * slope * gy * gy
    determinant = a_xx * a_yy - a_xy * a_xy
    if not determinant > 1e-9 * a_xx * a_yy:
        return False
    out[0] = (a_yy * b_x - a_xy * b_y) / determinant
    out[1] = (a_xx * b_y - a_xy * b_x) / determinant
    out[2] = 0.5 * (a_xx + a_yy) / determinant
    out[3] = misfit / max(number, 1)
    return True


@compiled
def shared_profile(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    levels: Floats,
    floors: Floats,
    starts: Floats,
    size: float,
    room: float,
    centres: Floats,
    variances: Floats,
    misfits: Floats,
) -> None:
    """Find the centres of each frame's spots by the profile that all of them have in common.

    Parameters
    ----------
    levels, floors
        (N,) above which a pixel of the frames (N, H, W) is lit; their background.
    starts
        (N, A, 2) thresholded centroids, NaN for none.
    size, room
        Largest width of a spot, px; how far it may reach before it meets another.
    centres, variances, misfits
        (N, A, 2), (N, A) and (N, A): receive the centres, NaN for none, the variance of one
        along an axis, px^2, and the mean squared departure of its pixels, in their variances.
    """
    height, width = frames.shape[1:]
    half = max(min(math.ceil(0.5 * size) + 2, int(room)), 1)
    side = 2 * math.ceil(2.0 * size + _MARGIN) + 3
    capacity = starts.shape[1] * min(side * side, height * width)
    pixels = np.empty((6, capacity))
    kept = np.empty(capacity, dtype=np.bool_)
    spots = np.empty((starts.shape[1], 2))
    which = np.empty(starts.shape[1], dtype=np.int64)
    ends = np.empty(starts.shape[1], dtype=np.int64)
    shares = np.empty(starts.shape[1])
    intervals = int((0.5 * side + 3.0) / _KNOTS) + 2
    table = np.empty((intervals, 6))
    fine = np.empty((int((intervals + 1) * _KNOTS * _FINE), 5))
    moments = np.empty((intervals, 11))
    band = np.empty((intervals + 3, 5))
    out = np.empty((starts.shape[1], 4))
    for k in range(frames.shape[0]):
        centres[k] = np.nan
        variances[k] = np.nan
        misfits[k] = np.nan
        number = 0
        for a in range(starts.shape[1]):
            if starts[k, a, 0] >= 0.0:  # not where it is NaN
                spots[number] = starts[k, a]
                which[number] = a
                number += 1
        if number == 0:
            continue
        xx, xy, yy, radius = _shape(frames[k], levels[k], spots[:number], half)
        if not 0.0 < radius <= size:
            continue
        metric = (xx, xy, yy)
        wide, high = math.sqrt(yy), math.sqrt(xx)
        reach = min((1.0 + _WIDER) * radius + _MARGIN, max(room, radius) / max(wide, high))
        if (2 * reach * wide + 1) * (2 * reach * high + 1) > side * side:
            continue
        _gather(
            frames[k], floors[k], spots[:number], metric, reach, pixels, ends[:number]
        )
        _lay(pixels, ends[:number], spots, metric)
        noise = _flatten(pixels, ends[:number], reach - _RING, shares[:number])
        mean = shares[:number].mean()
        for s in range(number):
            shares[s] = shares[s] / mean if shares[s] > _LIGHT * mean else 0.0
        kept[: ends[number - 1]] = True
        noise = max(noise, 1e-300)
        gain = 0.0
        of = table[: int(reach / _KNOTS) + 2]
        for turn in range(_STEPS):
            if turn > 0:
                _lay(pixels, ends[:number], spots, metric)
            for _ in range(_ROUNDS):
                _spline(pixels, ends[:number], shares, kept, of, moments[: len(of)], band)
                _sample(of, fine)
                gain, changed = _variances(pixels, ends[:number], shares, fine, noise, kept)
                if not changed:
                    break
            begin = 0
            for s in range(number):
                found = shares[s] > 0.0 and _step(
                    pixels[:, begin : ends[s]],
                    kept[begin : ends[s]],
                    shares[s],
                    fine,
                    noise,
                    gain,
                    out[s],
                )
                if found and max(abs(out[s, 0]), abs(out[s, 1])) < _ASTRAY * radius:
                    spots[s, 0] += out[s, 0]
                    spots[s, 1] += out[s, 1]
                else:
                    shares[s] = 0.0
                begin = ends[s]
        for s in range(number):
            if shares[s] > 0.0:
                centres[k, which[s]] = spots[s]
                variances[k, which[s]] = out[s, 2]
                misfits[k, which[s]] = out[s, 3]


@compiled
def _lay(
    pixels: Floats,
    ends: NDArray[np.int64],
    spots: Floats,
    metric: tuple[float, float, float],
) -> None:
    """Measure all spots' pixels from their middles."""
    begin = 0
    for s in range(ends.size):
        _measure(pixels[:, begin : ends[s]], spots[s, 0], spots[s, 1], metric)
        begin = ends[s]

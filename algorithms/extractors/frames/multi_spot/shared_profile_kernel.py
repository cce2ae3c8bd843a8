"""Centres of spots that have one image in common, its profile taken from all of them together."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.spot_pixels_kernel import GX, GY, Form, R, U, X, Y
from algorithms.kernels.records import Records, record

#: Px between the knots of the profile, a cubic spline, and what keeps it smooth where no pixel is.
_KNOTS, _SMOOTH = 0.65, 3e-2
#: Samples of the profile a px, and how many to each side its slopes are weighted by the mean of:
#: sharp weights see the pixels' places.
_FINE, _AROUND = 32, 22
#: A pixel is left out that departs from the profile by so many deviations, in rounds.
_BAD, _ROUNDS = 6.0, 3
#: What a spline misses of a sharp rim, over the peak: pixels are not trusted to better than that.
_FLOOR = 0.002
#: Steps of a spot's centre; none leads further, px.
_STEPS, _ASTRAY = 2, 0.7
#: Least light of a spot over the mean.
_LIGHT = 0.2
#: Variance of the profile's slope, over that of a pixel and the number of them between knots.
_UNSURE = 4.0


class Sample:
    """The profile at one distance from a spot's middle.

    Attributes
    ----------
    light, slope
        Of a spot of the mean light.
    slope_around, light_around
        Means of both around.
    pixels
        That tell the profile between its knots.
    """

    light: float
    slope: float
    slope_around: float
    light_around: float
    pixels: float


_SAMPLE = record(Sample)

# One interval of a cubic B-spline: the powers of t in each of the four that are not zero there.
_BASIS = (
    np.array(
        [[1.0, -3.0, 3.0, -1.0], [4.0, 0.0, -6.0, 3.0], [1.0, 3.0, 3.0, -3.0], [0.0, 0.0, 0.0, 1.0]]
    )
    / 6.0
)


@compiled
def _measure(pixels: Floats, x: float, y: float, metric: tuple[float, float, float]) -> None:
    """Write the distances of one spot's pixels (6, P) from its middle, and their slopes."""
    xx, xy, yy = metric
    across, along = pixels[X], pixels[Y]
    r, gx, gy = pixels[R], pixels[GX], pixels[GY]
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


@compiled
def _moments(
    pixels: Floats,
    ends: NDArray[np.int64],
    shares: Floats,
    kept: NDArray[np.bool_],
    moments: Floats,
) -> None:
    """Sum, interval by interval, powers of what pixels are past the knot, and with their light."""
    moments[:] = 0.0
    begin = 0
    for s in range(ends.size):
        inverse = 1.0 / shares[s] if shares[s] > 0.0 else 0.0
        for p in range(begin, ends[s] if inverse > 0.0 else begin):
            if not kept[p]:
                continue
            u = pixels[U, p] * inverse
            t = pixels[R, p] * (1.0 / _KNOTS)
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


@compiled
def _system(moments: Floats, band: Floats) -> None:
    """Write the normal equations of the spline (M + 3, 5): diagonal, three below, right side."""
    intervals = moments.shape[0]
    unknowns = intervals + 3
    band[:] = 0.0
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


@compiled
def _solve(band: Floats) -> None:
    """Solve the equations by Cholesky; the lower triangle and the solution take their place."""
    unknowns = band.shape[0]
    for i in range(unknowns):
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

    `table` (M, 5) receives, interval by interval, the powers of what is past the knot in it, and
    how many pixels there are.
    """
    _moments(pixels, ends, shares, kept, moments)
    _system(moments, band)
    _solve(band)
    intervals = table.shape[0]
    for m in range(intervals):
        for i in range(4):
            total = 0.0
            for a in range(4):
                total += _BASIS[a, i] * band[m + a, 4]
            table[m, i] = total
        table[m, 4] = moments[m, 0]


@compiled
def _sample(table: Floats, fine: Records) -> None:
    """Write `_FINE` samples a px of the profile. The middle repeats itself on its other side."""
    intervals = table.shape[0]
    for f in range(fine.shape[0]):
        t = f * (1.0 / (_FINE * _KNOTS))
        m = min(int(t), intervals - 1)
        t = min(t - m, 1.0)
        at = table[m]
        fine[f].light = at[0] + t * (at[1] + t * (at[2] + t * at[3]))
        fine[f].slope = (at[1] + t * (2.0 * at[2] + t * 3.0 * at[3])) * (1.0 / _KNOTS)
        fine[f].pixels = at[4]
    last = fine.shape[0] - 1
    for f in range(fine.shape[0]):
        near = fine[abs(f - _AROUND)].light
        far = fine[min(f + _AROUND, last)].light
        fine[f].slope_around = (far - near) * (_FINE / (2.0 * _AROUND))
        fine[f].light_around = 0.25 * (near + far) + 0.5 * fine[f].light


@compiled
def _at(fine: Records, r: float) -> tuple[Any, float]:
    """Last sample before the distance r, and the profile there, interpolated."""
    t = r * _FINE
    m = np.uint32(t)
    t -= m
    return m, fine[m].light + t * (fine[m + 1].light - fine[m].light)


@compiled
def _variances(  # noqa: PLR0917 - Numba takes no keyword-only ones
    pixels: Floats,
    ends: NDArray[np.int64],
    shares: Floats,
    fine: Records,
    noise: float,
    kept: NDArray[np.bool_],
) -> tuple[float, bool]:
    """Variance of lit pixels over their light, and whether more pixels were found to be bad.

    The variance is that of the median spot: light that is no spot's own makes one or two scatter.
    """
    gain = 0.0
    changed = False
    gains = np.empty(ends.size)
    for turn in range(2):
        count = 0
        begin = 0
        for s in range(ends.size):
            excess = 0.0
            light = 0.0
            for p in range(begin, ends[s] if shares[s] > 0.0 else begin):
                if not kept[p]:
                    continue
                value = shares[s] * _at(fine, pixels[R, p])[1]
                e = pixels[U, p] - value
                value = max(value, 0.0)
                if turn > 0 and e * e > _BAD * _BAD * (noise + gain * value):
                    kept[p] = False
                    changed = True
                    continue
                excess += e * e - noise
                light += value
            begin = ends[s]
            if light > 0.0:
                gains[count] = excess / light
                count += 1
        gain = max(float(np.median(gains[:count])), 0.0) if count > 0 else 0.0
    return gain, changed


@compiled
def _step(  # noqa: PLR0917 - Numba takes no keyword-only ones
    own: Floats,
    kept: NDArray[np.bool_],
    share: float,
    fine: Records,
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
    squares = 0.0
    misfit = 0.0
    number = 0
    for p in range(own.shape[1]):
        if not kept[p]:
            continue
        m, light = _at(fine, own[R, p])
        here = fine[m]
        e = own[U, p] - share * light
        variance = noise + gain * max(share * here.light_around, 0.0)
        misfit += e * e / variance
        number += 1
        # Of the squared slope, what its own noise explains is no slope.
        slope = share * here.slope_around
        sure = slope * slope * max(here.pixels, 1.0)
        if sure <= _UNSURE * variance:
            continue
        weight = slope * (1.0 - _UNSURE * variance / sure) / variance
        slope = share * here.slope
        gx, gy = own[GX, p], own[GY, p]
        b_x -= weight * gx * e
        b_y -= weight * gy * e
        squares += weight * weight * variance * (gx * gx + gy * gy)
        a_xx += weight * slope * gx * gx
        a_xy += weight * slope * gx * gy
        a_yy += weight * slope * gy * gy
    determinant = a_xx * a_yy - a_xy * a_xy
    if not determinant > 1e-9 * a_xx * a_yy:
        return False
    out[0] = (a_yy * b_x - a_xy * b_y) / determinant
    out[1] = (a_xx * b_y - a_xy * b_x) / determinant
    # all around the spot, half of the squares is along either axis
    out[2] = 0.25 * squares * (a_xx * a_xx + a_yy * a_yy + 2.0 * a_xy * a_xy) / determinant**2
    out[3] = misfit / max(number, 1)
    return True


@compiled
def shared_profile(  # noqa: PLR0917 - Numba takes no keyword-only ones
    pixels: Floats,
    ends: NDArray[np.int64],
    shares: Floats,
    spots: Floats,
    form: Form,
    variances: Floats,
    misfits: Floats,
) -> None:
    """Move the spots of a frame to where they fit the profile that all of them have in common.

    Parameters
    ----------
    pixels, ends, form
        As `spot_pixels_kernel.spot_pixels` writes them.
    shares
        (S,) of the spots' light; used up.
    spots
        (S, 2) rough centres, moved to the found ones; NaN where none is.
    variances, misfits
        (S,): receive the variance of a centre along an axis, px^2, and the mean squared
        departure of a spot's pixels, in their variances.
    """
    number = ends.size
    metric = (form.xx, form.xy, form.yy)
    reach = form.reach
    brightest = pixels[U, : ends[number - 1]].max()
    noise = max(form.noise, (_FLOOR * brightest) ** 2, 1e-300)
    intervals = int(reach / _KNOTS) + 4  # what a step may move a pixel further out
    table = np.empty((intervals, 5))
    moments = np.empty((intervals, 11))
    band = np.empty((intervals + 3, 5))
    fine = np.empty(int((intervals + 1) * _KNOTS * _FINE), dtype=_SAMPLE)
    kept = np.ones(ends[number - 1], dtype=np.bool_)
    out = np.empty((number, 4))
    mean = shares.mean()
    for s in range(number):
        shares[s] = shares[s] / mean if shares[s] > _LIGHT * mean else 0.0
    for turn in range(_STEPS):
        _lay(pixels, ends, spots, metric)
        gain = 0.0
        for _ in range(_ROUNDS if turn == 0 else 1):
            _spline(pixels, ends, shares, kept, table, moments, band)
            _sample(table, fine)
            gain, changed = _variances(pixels, ends, shares, fine, noise, kept)
            if not changed:
                break
        begin = 0
        for s in range(number):
            own, used = pixels[:, begin : ends[s]], kept[begin : ends[s]]
            found = shares[s] > 0.0 and _step(own, used, shares[s], fine, noise, gain, out[s])
            if found and max(abs(out[s, 0]), abs(out[s, 1])) < _ASTRAY:
                spots[s, 0] += out[s, 0]
                spots[s, 1] += out[s, 1]
            else:
                shares[s] = 0.0
            begin = ends[s]
    for s in range(number):
        variances[s] = out[s, 2]
        misfits[s] = out[s, 3]
        if not shares[s] > 0.0:
            spots[s] = np.nan

"""Where a known pattern of slits has its light on a line of pixels, and phases of that light.

Lines are (R, L) float64. ``places`` (S,) are the spots' positions at zero shift, px, and `groups`
(S,) say which of the G shifts moves each: spots of equal slant keep their distances.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Counts = NDArray[np.int64]

#: Light away from the pattern, as a fraction of the pattern's weakest spot, that makes it unsure.
_RIVAL = 0.5
#: Steps a pixel of the first search for the least projection; Newton's steps that follow it.
_STEPS = 4
_NEWTON = 6


@compiled
def _least_scores(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: Floats, places: Counts, groups: Counts, group: int, low: int, out: Floats
) -> None:
    """Write the least score of a group's spots at each shift to `out`, shift ``n - low`` at n."""
    first = True
    for i in range(places.size):
        if groups[i] == group:
            start = places[i] - low
            if first:
                out[:] = row[start : start + out.size]
                first = False
            else:
                for n in range(out.size):
                    out[n] = min(out[n], row[start + n])


@compiled
def _apart(places: Counts, groups: Counts, first: int, second: int, apart: float) -> bool:
    """Whether the spots of two groups at these shifts keep their distance."""
    for i in range(places.size):
        for j in range(places.size):
            gap = abs(places[i] + first - places[j] - second)
            if groups[i] == 0 and groups[j] == 1 and gap < apart:
                return False
    return True


@compiled
def _alone(  # noqa: PLR0917 - Numba takes no keyword-only ones
    row: Floats,
    floor: float,
    level: float,
    places: Counts,
    groups: Counts,
    shifts: Counts,
    clear_of: int,
) -> bool:
    """Whether no score further than `clear_of` from all spots comes near their level."""
    near = np.zeros(row.size, dtype=np.bool_)
    for i in range(places.size):
        at = places[i] + shifts[groups[i]]
        near[max(at - clear_of, 0) : at + clear_of + 1] = True
    for j in range(row.size):
        if not near[j] and row[j] - floor >= _RIVAL * (level - floor):
            return False
    return True


@compiled
def _plateau_middle(scores: Floats, first: int, plateau: int) -> float:
    """Return the middle of the equal scores from the first to `plateau` pixels after it."""
    last = first
    for n in range(first, min(first + plateau + 1, scores.size)):
        if scores[n] == scores[first]:
            last = n
    return 0.5 * (first + last)


@compiled
def _best_pair(  # noqa: PLR0917 - Numba takes no keyword-only ones
    first: Floats,
    second: Floats,
    low: Counts,
    places: Counts,
    groups: Counts,
    tangents: Floats,
    reach: float,
    apart: float,
) -> tuple[int, int]:
    """Find the indices of the largest sum that a Sun can cast; -1 where there is none.

    Index n of a group is its shift ``n - low``.
    """
    best = -1
    best_other = -1
    top = -np.inf
    bright = second.max()
    slope = tangents[1] - tangents[0]
    far = reach * abs(slope)
    widest = math.floor(reach * (1 + abs(tangents[0])))
    bottom = max(low[0] - widest, 0)
    limit = min(low[0] + widest + 1, first.size)
    if limit <= bottom:
        return best, best_other
    # Brightest first: what is darker than a pair found cannot be in a better one.
    start = bottom + np.argmax(first[bottom:limit])
    for turn in range(bottom - 1, limit):
        n = start if turn < bottom else turn
        if not first[n] + bright > top:
            continue
        shift = n - low[0]
        begin = max(math.ceil(shift - far) + low[1], 0)
        end = min(math.floor(shift + far) + low[1] + 1, second.size)
        for m in range(begin, end):
            if not first[n] + second[m] > top:
                continue
            other = m - low[1]
            if abs(shift - (other - shift) / slope * tangents[0]) > reach:
                continue
            if _apart(places, groups, shift, other, apart):
                top = first[n] + second[m]
                best = n
                best_other = m
    return best, best_other


@compiled
def match(  # noqa: PLR0917 - Numba takes no keyword-only ones
    scores: Floats,
    floors: Floats,
    places: Counts,
    groups: Counts,
    tangents: Floats,
    reach: float,
    apart: float,
    clear_of: int,
    plateau: int,
    out: Floats,
) -> None:
    """Write the shifts at which the pattern's least score is largest to `out` (R, G).

    Each group of spots has as its score at a shift the least of its spots' ones (maxi-min). With
    two groups the pair with the largest sum counts, among those that a displacement within
    `reach` on both axes explains and that leave all spots of different groups `apart`. Of equal
    scores within `plateau` pixels from the first the middle counts. NaN where the score is not
    above the floor (R,), or where light further than `clear_of` from all spots is half as bright.
    """
    rows, length = scores.shape
    kinds = tangents.size
    low = np.full(kinds, length)
    high = np.full(kinds, -length)
    for i in range(places.size):
        low[groups[i]] = min(low[groups[i]], places[i])
        high[groups[i]] = max(high[groups[i]], places[i])
    ends = length - high + low
    if ends.min() <= 0:
        out[:] = np.nan
        return
    least = np.empty((kinds, ends.max()))
    best = np.zeros(kinds, dtype=np.int64)
    for r in range(rows):
        out[r] = np.nan
        row = scores[r]
        level = np.inf
        for g in range(kinds):
            _least_scores(row, places, groups, g, low[g], least[g, : ends[g]])
        if kinds == 1:
            best[0] = np.argmax(least[0, : ends[0]])
        else:
            best[0], best[1] = _best_pair(
                least[0, : ends[0]],
                least[1, : ends[1]],
                low,
                places,
                groups,
                tangents,
                reach,
                apart,
            )
        for g in range(kinds):
            level = min(level, least[g, best[g]]) if best[g] >= 0 else -np.inf
        if level > floors[r] and _alone(
            row, floors[r], level, places, groups, best - low, clear_of
        ):
            for g in range(kinds):
                out[r, g] = _plateau_middle(least[g, : ends[g]], best[g], plateau) - low[g]


@compiled
def cross_spectra(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Floats,
    floors: Floats,
    shifts: Floats,
    places: Floats,
    groups: Counts,
    half: int,
    period: int,
    reference: Floats,
    out: NDArray[np.complex128],
) -> None:
    """Write the pattern's cross-spectra with its spots' references to `out` (R, G, K).

    A window of ``2 half + 1`` pixels about each spot is transformed at the frequencies 0 to K - 1
    over `period`, its floor (R,) taken off, multiplied by its reference's spectrum (S, K), real,
    and summed over the spots of a group, each turned back by where its shift (R, G) puts it. A
    NaN row where a shift is NaN or a window leaves the line.
    """
    rows, length = lines.shape
    spots, frequencies = reference.shape
    cosine = np.empty(period)
    sine = np.empty(period)
    for n in range(period):
        cosine[n] = math.cos(2 * math.pi * n / period)
        sine[n] = math.sin(2 * math.pi * n / period)
    for r in range(rows):
        out[r] = 0.0
        for i in range(spots):
            g = groups[i]
            at = places[i] + shifts[r, g]
            if not (half - 0.5 <= at <= length - 1 - half + 0.49):
                out[r, g] = np.nan
                continue
            centre = round(at)
            if centre < half or centre > length - 1 - half:
                out[r, g] = np.nan
                continue
            for k in range(frequencies):
                real = 0.0
                imaginary = 0.0
                place = (-half * k) % period
                for n in range(centre - half, centre + half + 1):
                    u = lines[r, n] - floors[r]
                    real += u * cosine[place]
                    imaginary -= u * sine[place]
                    place += k
                    if place >= period:
                        place -= period
                angle = 2 * math.pi * k * (at - centre) / period
                turn = complex(math.cos(angle), math.sin(angle))
                out[r, g, k] += complex(real, imaginary) * turn * reference[i, k]


@compiled
def phase_slopes(
    spectra: NDArray[np.complex128], weights: Floats, period: int, out: Floats
) -> None:
    """Write the shifts, px, that the phases of spectra (R, G, K) are linear in to `out` (R, G).

    The phases of frequencies 1 to K - 1 are unwrapped one after the other to the branch next to
    the line fitted to those before, then fitted with `weights` (K,); the line meets zero at
    frequency zero.
    """
    rows, kinds, frequencies = spectra.shape
    for r in range(rows):
        for g in range(kinds):
            moment = 0.0
            square = 0.0
            for k in range(1, frequencies):
                value = spectra[r, g, k]
                phase = math.atan2(value.imag, value.real)
                if square > 0:
                    ahead = k * moment / square
                    phase += 2 * math.pi * np.rint((ahead - phase) / (2 * math.pi))
                moment += weights[k] * k * phase
                square += weights[k] * k * k
            out[r, g] = -period / (2 * math.pi) * moment / square if square > 0 else np.nan


@compiled
def frequency_correlations(spectra: NDArray[np.complex128], out: NDArray[np.complex128]) -> None:
    """Write the Toeplitz matrices of spectra (R, G, K)'s own correlation to `out` (R, G, K, K).

    A spectrum of real light is continued to the frequencies ``1 - K .. K - 1`` by its conjugate;
    entry (i, j) is its correlation at the lag i - j. Zero where a spectrum is not finite.
    """
    rows, kinds, frequencies = spectra.shape
    series = np.empty(2 * frequencies - 1, dtype=np.complex128)
    for r in range(rows):
        for g in range(kinds):
            out[r, g] = 0.0
            for k in range(frequencies):
                value = spectra[r, g, k]
                series[frequencies - 1 + k] = value
                series[frequencies - 1 - k] = value.conjugate()
            if not np.isfinite(series).all():
                continue
            for lag in range(frequencies):
                total = complex(0.0, 0.0)
                for k in range(series.size - lag):
                    total += series[k + lag] * series[k].conjugate()
                for i in range(lag, frequencies):
                    out[r, g, i, i - lag] = total
                    out[r, g, i - lag, i] = total.conjugate()


@compiled
def least_projections(
    signals: NDArray[np.complex128], powers: Floats, period: int, reach: float, out: Floats
) -> None:
    """Write the shift, px, of least projection on the noise subspace to `out` (R, G).

    `signals` (R, G, K) are the unit eigenvectors of the signal, the only ones that are not of
    noise, so the projection of ``b = powers exp(-2 pi j k shift / period)`` on the others is
    ``|b|^2 - |signal^H b|^2``. It is searched over `reach` to both sides, then off the grid.
    """
    rows, kinds, frequencies = signals.shape
    step = 2 * math.pi / period
    tries = math.ceil(reach * _STEPS)
    for r in range(rows):
        for g in range(kinds):
            out[r, g] = np.nan
            best = 0.0
            most = -1.0
            for t in range(-tries, tries + 1):
                shift = t / _STEPS
                total = complex(0.0, 0.0)
                for k in range(frequencies):
                    angle = step * k * shift
                    turn = complex(math.cos(angle), -math.sin(angle))
                    total += signals[r, g, k].conjugate() * powers[k] * turn
                size = total.real * total.real + total.imag * total.imag
                if size > most:
                    most = size
                    best = shift
            shift = best
            for _ in range(_NEWTON):
                value = complex(0.0, 0.0)
                slope = complex(0.0, 0.0)
                bend = complex(0.0, 0.0)
                for k in range(frequencies):
                    angle = step * k * shift
                    turn = complex(math.cos(angle), -math.sin(angle))
                    term = signals[r, g, k].conjugate() * powers[k] * turn
                    value += term
                    slope += complex(0.0, -step * k) * term
                    bend -= (step * k) * (step * k) * term
                first = (value.conjugate() * slope).real
                second = (slope.conjugate() * slope + value.conjugate() * bend).real
                if not second < 0:
                    break
                shift -= first / second
            if most > 0 and abs(shift - best) <= 1.0 / _STEPS:
                out[r, g] = shift

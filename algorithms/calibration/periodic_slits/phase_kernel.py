"""Where a pattern of equal slits is on a line of pixels, by the phase of all of its light."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Share of one slit's light by which the best place must beat the next.
_CLEAR = 0.4
#: Least share of their mean light that each slit has.
_LIT = 0.3


@compiled
def _between(sums: Floats, start: float, end: float) -> float:
    """Light from `start` to `end`, px; pixel n covers [n - 0.5, n + 0.5]."""
    total = 0.0
    for sign, at in ((1.0, end), (-1.0, start)):
        place = min(max(at + 0.5, 0.0), float(len(sums) - 1))
        n = min(int(place), len(sums) - 2)
        total += sign * (sums[n] + (place - n) * (sums[n + 1] - sums[n]))
    return total


@compiled
def _phase(line: Floats, start: float, end: float, wave: Floats) -> tuple[float, float]:
    """Cosine and sine sums of a line's light from `start` to `end` by a wave (L, 2)."""
    first = max(int(np.floor(start + 0.5)), 0)
    last = min(int(np.floor(end + 0.5)), len(line) - 1)
    cosine = 0.0
    sine = 0.0
    for n in range(first, last + 1):
        share = min(end, n + 0.5) - max(start, n - 0.5)
        cosine += share * line[n] * wave[n, 0]
        sine += share * line[n] * wave[n, 1]
    return cosine, sine


@compiled
def _all_lit(sums: Floats, slits: Floats, reach: float, place: float, mean: float) -> bool:
    """Whether each slit at a place has a share of their mean light: none is off the line."""
    for slit in slits:
        if not _between(sums, slit + place - reach, slit + place + reach) >= _LIT * mean:
            return False
    return True


@compiled
def correlate(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Floats, slits: Floats, period: float, wave: Floats, least: float, shifts: Floats
) -> None:
    """Write the shift (R,) of a reticle of equally spaced slits on each line, px.

    The phase of the whole line's light by the reticle's period tells the shift but for whole
    periods; of these, that under which the reticle as a whole has most light, by `_CLEAR` of what
    one slit has. Then the phase of the light under the reticle alone. `slits` (S,) are their
    places at zero shift, `wave` (L, 2) cosine and sine of the period, `least` the least contrast:
    the phase's length over the light. NaN where no reticle is seen.
    """
    half = 0.5 * period
    size = lines.shape[1]
    sums = np.empty(size + 1)
    turn = 2.0 * math.pi / period
    for r in range(lines.shape[0]):
        line = lines[r]
        shifts[r] = math.nan
        sums[0] = 0.0
        for n in range(size):
            sums[n + 1] = sums[n] + line[n]
        cosine, sine = _phase(line, -0.5, size - 0.5, wave)
        shift = math.atan2(sine, cosine) / turn - slits[0]
        low = -0.5 - slits[0] + half
        shift -= period * math.floor((shift - low) / period)
        best, second, place = 0.0, 0.0, math.nan
        while slits[-1] + half + shift <= size - 0.5:
            light = _between(sums, slits[0] - half + shift, slits[-1] + half + shift)
            if light > best:
                best, second, place = light, best, shift
            elif light > second:
                second = light
            shift += period
        mean = best / len(slits)
        if not (best - second >= _CLEAR * mean and _all_lit(sums, slits, half, place, mean)):
            continue
        cosine, sine = _phase(line, slits[0] - half + place, slits[-1] + half + place, wave)
        if not math.hypot(cosine, sine) >= least * best:
            continue
        off = math.atan2(sine, cosine) / turn - slits[0] - place
        shifts[r] = place + off - period * math.floor(off / period + 0.5)


@compiled
def _code(sums: Floats, slits: Floats, gaps: Floats, reach: float, shift: float) -> float:
    """Light of the slits less that of as many gaps: of the mean of them."""
    light = 0.0
    for slit in slits:
        light += _between(sums, slit + shift - reach, slit + shift + reach)
    dark = 0.0
    for gap in gaps:
        dark += _between(sums, gap + shift - reach, gap + shift + reach)
    return light - dark


@compiled
def _coded_place(  # noqa: PLR0917 - Numba takes no keyword-only ones
    sums: Floats,
    slits: Floats,
    gaps: Floats,
    period: float,
    low: float,
    high: float,
    scores: Floats,
) -> tuple[float, float, float]:
    """Most light that the code has at a whole step from `low`, that of its rivals, and where."""
    steps = min(int(high - low) + 1, len(scores))
    best, rival, place = -math.inf, -math.inf, math.nan
    for step in range(steps):
        scores[step] = _code(sums, slits, gaps, 0.25 * period, low + step)
        if scores[step] > best:
            best, place = scores[step], low + step
    for step in range(steps):
        if abs(low + step - place) > 0.5 * period:
            rival = max(rival, scores[step])
    return best, rival, place


@compiled
def read_vernier(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lines: Floats,
    slits: Floats,
    gaps: Floats,
    period: float,
    mark: int,
    wave: Floats,
    least: float,
    shifts: Floats,
) -> None:
    """Write the shift (R,) of an optical vernier's moving scale on each line, px.

    The position code tells the shift to a pixel: where `slits` (S,) are lit and `gaps` (G,), the
    ones left out and those beyond the ends, are dark. Then each slit's light is compared with the
    marks of `mark` pixels, the fixed scale: its phase by `wave` (L, 2), less what the vernier has
    gained from slit to slit, is the shift within a mark, alike for all slits. NaN where the code
    is not there, or two shifts more than a pixel apart explain it.
    """
    half = 0.5 * period
    size = lines.shape[1]
    sums, scores = np.empty(size + 1), np.empty(size + 1)
    turn = 2.0 * math.pi / mark
    # where each slit would be among the marks at zero shift
    gains = np.column_stack((np.cos(turn * slits), np.sin(turn * slits)))
    for r in range(lines.shape[0]):
        line = lines[r]
        shifts[r] = math.nan
        sums[0] = 0.0
        for n in range(size):
            sums[n + 1] = sums[n] + line[n]
        low = -0.5 - slits[0] + half
        high = size - 0.5 - slits[-1] - half
        best, rival, place = _coded_place(sums, slits, gaps, period, low, high, scores)
        total = _between(sums, slits[0] - half + place, slits[-1] + half + place)
        mean = total / len(slits)
        if not (best > 0.0 and best - rival >= _CLEAR * mean):
            continue
        if not _all_lit(sums, slits, half, place, mean):
            continue
        cosine = 0.0
        sine = 0.0
        for k in range(len(slits)):
            start = slits[k] + place - half
            c, s = _phase(line, start, start + period, wave)
            cosine += c * gains[k, 0] + s * gains[k, 1]
            sine += s * gains[k, 0] - c * gains[k, 1]
        if not math.hypot(cosine, sine) >= least * total:
            continue
        off = math.atan2(sine, cosine) / turn - place
        shifts[r] = place + off - mark * math.floor(off / mark + 0.5)


def waves(size: int, period: float) -> NDArray[np.float64]:
    """Cosine and sine (size, 2) of a period, px, at each pixel."""
    turns = 2.0 * np.pi * np.arange(size) / period
    return np.column_stack([np.cos(turns), np.sin(turns)])

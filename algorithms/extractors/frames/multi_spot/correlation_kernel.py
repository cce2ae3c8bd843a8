"""Correlation of windows about many spots with templates, summed, in frames one after another."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.view_kernel import is_whole

_ROUNDS = 5  # of moving the windows, at most
_STAY = 0.5  # px from the windows' centres within which they stay


@compiled
def _correlate(window: Floats, template: Floats, out: Floats) -> None:
    """``out[m, n] = sum_ij window[m + i, n + j] template[i, j]``."""
    lags = out.shape[0]
    side = template.shape[0]
    out[:] = 0.0
    for i in range(side):
        for j in range(side):
            t = template[i, j]
            if t == 0.0:
                continue
            for m in range(lags):
                row = window[i + m, j : j + lags]
                total = out[m]
                for n in range(lags):
                    total[n] += t * row[n]


@compiled
def _offset(profile: Floats) -> float:
    """Offset of a symmetric hill from the middle of its profile, which need not show all of it.

    The centroid of a hill cut off at both ends moves by a part of the hill's own move. Two
    windows that leave out the last and the first entry see the same hill one step apart.
    """
    lags = profile.size
    low = profile.min()
    early = 0.0
    early_moment = 0.0
    late = 0.0
    late_moment = 0.0
    for m in range(lags - 1):
        early += profile[m] - low
        early_moment += (profile[m] - low) * (m - 0.5 * (lags - 2))
        late += profile[m + 1] - low
        late_moment += (profile[m + 1] - low) * (m - 0.5 * (lags - 2))
    if not (early > 0.0 and late > 0.0):
        return np.nan
    first = early_moment / early
    last = late_moment / late
    gain = first - last  # of a step
    if not gain > 0.0:
        return np.nan
    return 0.5 * (first + last) / gain


@compiled
def _cut(frame: NDArray[Any], floor: float, column: int, line: int, window: Floats) -> None:
    """Write the light about a pixel to `window`; outside the frame there is none."""
    height, width = frame.shape
    reach = window.shape[0] // 2
    for i in range(window.shape[0]):
        for j in range(window.shape[1]):
            r = line - reach + i
            c = column - reach + j
            inside = 0 <= r < height and 0 <= c < width
            window[i, j] = frame[r, c] - floor if inside else 0.0


@compiled
def _sum_up(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    floor: float,
    x: float,
    y: float,
    apertures: Floats,
    templates: Floats,
    kinds: NDArray[np.int64],
    margin: float,
    window: Floats,
    total: Floats,
    single: Floats,
) -> tuple[float, float, float, int]:
    """Sum the correlations in windows that stand at displacement (x, y).

    Returns the displacement that the sum (`total`) gives, the light in it and the number of
    apertures whose spot should be whole in the frame. `single` (A, 3) receives each spot's own
    place and light, NaN for those that should not.
    """
    height, width = frame.shape
    one = np.empty_like(total)
    total[:] = 0.0
    single[:] = np.nan
    expected = 0
    light = 0.0
    away_x = 0.0
    away_y = 0.0
    for a in range(apertures.shape[0]):
        at_x = apertures[a, 0] + x
        at_y = apertures[a, 1] + y
        if not is_whole(at_x, at_y, 0.5 * apertures[a, 2] + margin, height, width):
            continue
        expected += 1
        column = math.floor(at_x + 0.5)
        line = math.floor(at_y + 0.5)
        _cut(frame, floor, column, line, window)
        _correlate(window, templates[kinds[a]], one)
        total += one
        weight = one.sum()
        light += weight
        away_x += weight * (column - apertures[a, 0])
        away_y += weight * (line - apertures[a, 1])
        single[a, 0] = column + _offset(one.sum(axis=0))
        single[a, 1] = line + _offset(one.sum(axis=1))
        single[a, 2] = weight
    if not light > 0.0:
        return np.nan, np.nan, 0.0, expected
    moved_x = _offset(total.sum(axis=0))
    moved_y = _offset(total.sum(axis=1))
    return away_x / light + moved_x, away_y / light + moved_y, light, expected


@compiled
def correlate_spots(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    floors: Floats,
    starts: Floats,
    apertures: Floats,
    templates: Floats,
    kinds: NDArray[np.int64],
    lags: int,
    margin: float,
    limits: tuple[float, float],
    sequence: bool,
    found: Floats,
    spots: Floats,
) -> int:
    """Correlate each frame (N, H, W) with the templates about where the spots are expected.

    Parameters
    ----------
    floors
        (N,) background, taken off and assumed outside the frame; NaN for a frame left out.
    starts
        (M, 2) displacement at which each frame's windows stand; NaN for a frame left out.
    apertures, margin
        (A, 3) x, y, width; px that a spot reaches beyond its aperture.
    templates, kinds
        (K, T, T) gray values, centred, T odd; (A,) which of them is an aperture's.
    lags
        Correlation elements an axis, odd.
    limits
        Least light of a spot, over the mean of all; least share of the expected spots.
    sequence
        Whether a frame's windows stand where the spots of the one before were; then M is 1 and a
        frame in which too few spots are found ends the sequence. Else M is N.
    found, spots
        (N, 2) and (N, A, 2): receive the displacement and the single spots; NaN for none.

    Returns
    -------
    int
        Frames done: N, or the first in which a sequence was lost.
    """
    least, share = limits
    reach = (templates.shape[1] + lags) // 2 - 1  # of a window: both are odd
    window = np.empty((2 * reach + 1, 2 * reach + 1))
    total = np.empty((lags, lags))
    single = np.empty((apertures.shape[0], 3))
    x = np.nan
    y = np.nan
    for k in range(frames.shape[0]):
        found[k] = np.nan
        spots[k] = np.nan
        if k == 0 or not sequence:
            x, y = starts[k]
        settled = False
        light = 0.0
        expected = 0
        for _ in range(_ROUNDS):
            to_x, to_y, light, expected = _sum_up(
                frames[k],
                floors[k],
                x,
                y,
                apertures,
                templates,
                kinds,
                margin,
                window,
                total,
                single,
            )
            if not (np.isfinite(to_x) and np.isfinite(to_y)):
                break
            settled = abs(to_x - x) <= _STAY and abs(to_y - y) <= _STAY
            # a hill whose top is outside the matrix gives a direction, no distance
            x += min(max(to_x - x, -0.5 * lags), 0.5 * lags)
            y += min(max(to_y - y, -0.5 * lags), 0.5 * lags)
            if settled:
                break
        present = 0
        for a in range(apertures.shape[0]):
            if settled and single[a, 2] >= least * light / expected:
                present += 1
                spots[k, a] = single[a, :2]
        if present > 0 and present >= share * expected:
            found[k, 0] = x
            found[k, 1] = y
        else:
            spots[k] = np.nan
            if sequence:
                return k
    return int(frames.shape[0])

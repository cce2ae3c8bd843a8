"""Centres, covariances and doubts of point-symmetric spots: one frame or window each.

What `algorithms.extractors.frames.mirror.MirrorRegistration` does to whole frames, for whoever
has windows of frames. Stages of compiled loops are run here one after the other, on as many frames
at once as the processor's cache holds: the light is found (`mirror_search_kernel`), the pixels
about its middle are paired (`mirror_pairs_kernel`); then, by turns, the displacement is fitted
(`mirror_fit_kernel`) and pairs that depart are left out (`mirror_outlier_kernel`). After the first
turn the background's slope is taken off (`mirror_ring_kernel`); shapes are looked at in the end
(`mirror_shape_kernel`).

The stages share these arrays, a row a frame. Lengths are in pixels, light is over the peak's.

- `boxes`: first column and row, last row and number of columns of the window about the middle;
  the stride, columns and rows before the core, rows of the core's upper half.
- `s`, `d`: means and differences of the window's pairs, upper half, row after row a stride apart;
  those of `s` after 7 rows and 8 numbers of margin.
- `keep`: what a pair of the core counts: 1, a half in a middle row, 0 for one left out, and -1 for
  one to be replaced. `e`: what the fit leaves of the difference; `slack`: the size of its slopes.
- `states`: variance of a dark pixel, and what light adds to it; displacement d along x and y;
  covariance xx, yy, xy of the centre; noise's share in the weighting; how the centre moves with
  the sums that the fit solves for (4); the new value of column 1; pairs left out; the departures
  of those in clusters; whether it is done.
"""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats
from algorithms.extractors.frames import (
    mirror_fit_kernel,
    mirror_outlier_kernel,
    mirror_pairs_kernel,
    mirror_ring_kernel,
    mirror_search_kernel,
    mirror_shape_kernel,
)
from algorithms.inputs import Frames, as_frames
from algorithms.kernels import moments
from algorithms.measurement import Doubt, as_bad, without_bad

#: Turns of fit and leaving out; middles that are tried.
_TURNS, _CENTRES = 6, 3
#: d, px, from which another middle is nearer.
_FAR = 0.75
#: Numbers that the stages share are at most so many a line of all frames of a chunk.
_CHUNK = 2**16
#: Limits of light in departing clusters, and of what neighbours miss alike: see `_doubts`.
_CLUSTERS, _ALIKE = 0.02, 0.003
#: Standard deviation of the centre, px, over which it is not known.
_UNSURE = 0.5
#: From the lit light's centroid, in half extents and px, no registration leads further.
_ASTRAY, _ASTRAY_PX = 0.25, 0.75
_KEPT = threading.local()


def register(frames: Frames, bad: NDArray[np.bool_] | None = None) -> tuple[Floats, Floats, Any]:
    count, height, width = frames.shape
    centres = np.full((count, 2), np.nan)
    covariances = np.full((count, 2, 2), np.nan)
    doubts = np.zeros(count, dtype=np.int64)
    lights = np.full((count, mirror_search_kernel.FOUND), np.nan)
    if min(height, width) >= 5:
        unusable = np.empty(count, dtype=np.bool_)
        moments.unusable(frames, frames.dtype.kind == "f", unusable)
        mirror_search_kernel.find_lights(frames, unusable, lights)
    mask = np.zeros((0, 0), dtype=np.bool_) if bad is None else bad
    seen = np.flatnonzero(~np.isnan(lights[:, 0]))
    if len(seen) == 0:
        return centres, covariances, doubts
    lengths = _lengths(lights[seen], height, width)
    step = max(1, min(len(seen), int(_CHUNK / np.median(lengths))))
    length = int(lengths.max()) + 64
    space = _space((5 * step + 16) * length)
    lines = space[: 5 * step * length].reshape(5, step, length)
    work = space[5 * step * length :].reshape(16, length)
    lights = lights[seen]
    n = len(seen)
    states, slopes = np.zeros((n, 18)), np.zeros((n, 11))
    boxes, middles = np.zeros((n, 8), dtype=np.int64), np.empty((n, 2), dtype=np.int64)
    shapes = np.full((n, mirror_shape_kernel.SHAPE), np.nan)
    for begin in range(0, n, step):
        part = slice(begin, begin + step)
        _chunk(frames, seen[part], lights[part], mask, lines, work, boxes[part], middles[part], states[part], slopes[part], shapes[part])
    global LAST
    LAST = (lights, boxes, states, slopes, shapes)
    centres[seen], covariances[seen], doubts[seen] = _answers(lights, boxes, middles, states, shapes)
    return centres, covariances, doubts


def _space(size: int) -> NDArray[np.float32]:
    """Work space of so many numbers, kept between calls, one a thread: new memory is slow."""
    space: NDArray[np.float32] | None = getattr(_KEPT, "space", None)
    if space is None or space.size < size:
        space = _KEPT.space = np.empty(size, dtype=np.float32)
    return space[:size]


def _lengths(lights: Floats, height: int, width: int) -> NDArray[np.int64]:
    """Numbers that a line of each window may take."""
    wider = 1.1 + 1.5 * (1.0 - np.clip(lights[:, 7:8], 0.5, 1.0))  # as `pair_up` does
    half = wider * lights[:, 2:4] + 3.0
    half += np.maximum(7.0, 0.25 * half)
    across = np.minimum(2.0 * half[:, 0] + 2.0, width + 7) + 7.0
    along = np.minimum(half[:, 1] + 2.0, (height + 2) // 2) + 14.0
    return (across * along + 160.0).astype(np.int64)


def _chunk(
    frames: Frames, which: NDArray[np.int64], lights: Floats, bad: NDArray[np.bool_], lines: Any, work,
    boxes, middles, states, slopes, shapes
) -> None:
    """Centres, covariances and doubts of the frames `which`."""
    n = len(which)
    s, d, keep, e, slack = lines
    states[:, 0] = lights[:, 5] / lights[:, 6] ** 2
    middles[:] = np.rint(2.0 * lights[:, :2])
    states[:, 2:4] = 2.0 * lights[:, :2] - middles
    todo = np.arange(n)
    mirror_pairs_kernel.pair_up(frames, which, todo, lights, middles, bad, boxes, s, d, keep, states)
    far = mirror_fit_kernel.fit(todo, boxes, True, slopes, s, d, keep, e, slack, work, states)
    for _ in range(_CENTRES - 1):
        if far == 0:
            break
        again = np.flatnonzero(np.abs(states[:, 2:4]).max(axis=1) > _FAR)
        moved = np.rint(np.clip(states[again, 2:4], -4.0, 4.0)).astype(np.int64)
        states[again, 2:4] -= moved
        middles[again] += moved
        states[again, 4] = 0.0
        mirror_pairs_kernel.pair_up(
            frames, which, again, lights, middles, bad, boxes, s, d, keep, states
        )
        far = mirror_fit_kernel.fit(again, boxes, True, slopes, s, d, keep, e, slack, work, states)
    left = n
    for turn in range(_TURNS):
        if turn:
            mirror_fit_kernel.fit(
                todo[:left], boxes, False, slopes, s, d, keep, e, slack, work, states
            )
        left = mirror_outlier_kernel.leave_out(
            todo[:left], boxes, turn == 0, bad, s, d, keep, e, slack, work, states
        )
        if turn == 0:
            mirror_ring_kernel.flatten(todo[:left], boxes, lights, s, d, work, states, slopes)
        if left == 0:
            break
    todo = np.arange(n)
    mirror_shape_kernel.shapes(todo, boxes, s, keep, e, slack, work, states, shapes)


def _answers(lights, boxes, middles, states, shapes):
    centres = 0.5 * (middles + states[:, 2:4])
    covariances = np.empty((len(centres), 2, 2))
    scatter = shapes[:, 7]
    covariances[:, 0, 0], covariances[:, 1, 1] = states[:, 4] * scatter, states[:, 5] * scatter
    covariances[:, 0, 1] = covariances[:, 1, 0] = states[:, 6] * scatter
    doubts = np.zeros(len(centres), dtype=np.int64)
    lost = ~np.isfinite(states[:, 4])
    doubts[lost] |= int(Doubt.NO_SPOT)
    doubts[boxes[:, 3] == 0] |= int(Doubt.CUT)
    far = np.abs(centres - lights[:, :2]) > _ASTRAY * lights[:, 2:4] + _ASTRAY_PX
    with np.errstate(invalid="ignore"):
        crooked = far.any(axis=1) | (shapes[:, 0] > _CLUSTERS) | (shapes[:, 1] > _ALIKE)
        doubts[crooked & ~lost] |= int(Doubt.NOT_SYMMETRIC)
        unsure = np.maximum(states[:, 4], states[:, 5]) > _UNSURE**2
        doubts[unsure & ~lost] |= int(Doubt.NO_SPOT)
    refused = doubts != 0
    centres[refused] = np.nan
    covariances[refused] = np.nan
    return centres, covariances, doubts

"""Centres, covariances and doubts of point-symmetric spots: one frame or window each.

What `algorithms.extractors.frames.mirror.MirrorRegistration` does to whole frames, for whoever
has windows of frames. Stages of compiled loops are run here one after the other, on as many frames
at once as the processor's cache holds: the light is found (`mirror_search_kernel`), the pixels
about its middle are paired (`mirror_pairs_kernel`); then, by turns, the displacement is fitted
(`mirror_fit_kernel`) and pairs that depart are left out (`mirror_outlier_kernel`). After the first
turn the background's slope is taken off (`mirror_ring_kernel`); shapes are looked at in the end
(`mirror_shape_kernel`, `mirror_ghost_kernel`).

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
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats
from algorithms.inputs import Frames, as_frames
from algorithms.measurement import Doubt, Measurement, as_bad, as_batch, without_bad

#: Turns of fit and leaving out; middles that are tried; d, px, from which another one is nearer.
_TURNS, _CENTRES, _FAR = 6, 3, 0.75
#: Numbers in a line of all frames that are worked on at once: with five lines, 1.3 MB.
_CHUNK = 2**16
#: Light that departs in clusters of pairs, over the spot's, and the square of what neighbours miss
#: alike, over that of the light: above either, the spot is not symmetric.
_CLUSTERS, _ALIKE = 0.02, 0.0006
#: Mean square of the departures, over what is expected, from which there is a ghost, and from which
#: the spot is not symmetric; more, over the high outline's area, where few pixels tell.
_SCATTER_GHOST, _SCATTER, _GHOST_FEW, _SCATTER_FEW = 1.8, 3.5, 100.0, 150.0
#: The outlines of one spot are alike at all heights: largest ratio of the squared ratios of their
#: extents, more by 1 over the area, by the cube of that, as few pixels have the outline of their
#: grid, and by the noise; px by which the extents may differ.
_UNLIKE, _UNLIKE_FEW, _UNLIKE_GRID, _UNLIKE_NOISE = 1.26, 5.0, 300.0, 1.5
_UNLIKE_PX, _UNLIKE_NOISE_PX = 0.42, 3.0
#: Area of an ellipse with an outline's second moments over its own: 1.05 for a square.
_WAIST, _WAIST_FEW, _WAIST_NOISE = 1.065, 2.0, 0.8
#: Pixels of a sharp high outline that tell its shape; over the low one's, of what is but a top
#: where two lights overlap: 0.24 for a Gaussian.
_SHARP, _TOP = 12.0, 0.15
#: Standard deviation of the centre, px, over which it is not known.
_UNSURE = 0.5
#: From the lit light's centroid, in half extents and px, no registration leads further.
_ASTRAY, _ASTRAY_PX = 0.25, 0.75
#: Chi squared of what is skew, over the scatter, and its share of the light, squared, from both of
#: which on there is a second light upon the spot.
_SKEW, _SKEW_LIGHT = 20.0, 0.0004
#: Columns that `mirror_shape_kernel.shapes` and `mirror_ghost_kernel.skewness` write.
_SHAPE = 15
_KEPT = threading.local()


class Registered(NamedTuple):
    """What is found of frames (N, H, W), and how their pixels scatter.

    Attributes
    ----------
    found
        Centres, covariances and doubts.
    noise
        (N, 2) variance of a dark pixel, and what a unit of light adds to it; NaN where nothing was
        found to tell it by.
    """

    found: Measurement
    noise: Floats


def register(
    observations: ArrayLike, bad: ArrayLike | None = None, longest_px: float | None = None
) -> Measurement:
    """Register each frame's or window's spot against its own mirror image.

    Parameters
    ----------
    observations : array_like, shape (N, H, W) or (H, W)
        Frames, or windows of frames, that hold one spot each and some background around it.
    bad : array_like of bool, shape (H, W), optional
        Pixels to leave out, the same in all frames.
    longest_px : float, optional
        Longest half axis that one spot's outline has, where a design tells: outlines up to it are
        of one spot, whatever their shape, which fringes make resemble that of two, and skew where
        light is oblique.

    Returns
    -------
    Measurement
        Centres (N, 2) ``(x, y)`` px from the first pixel's middle, their covariance (N, 2, 2) px^2
        and doubts (N,): `NO_SPOT`, `SEVERAL_SPOTS`, `CUT` and `NOT_SYMMETRIC` say why a row is
        NaN; `SATURATED` and `GHOST` stand beside an answer too.

    Raises
    ------
    ValueError
        If the frames are not three-dimensional, empty, masked or not real numbers, or the mask is
        not a boolean one of a frame's shape that leaves pixels.

    Examples
    --------
    >>> y, x = np.mgrid[:40, :40]
    >>> disc = 900 / (1 + np.exp(2 * (np.hypot(x - 21.3, y - 18.8) - 7)))
    >>> windows = np.random.default_rng(1).normal(50 + disc, 5.0)
    >>> found = register(windows)
    >>> found.features.round(1), found.deviations.round(3), found.doubts
    (array([[21.3, 18.8]]), array([[0.003, 0.003]]), array([0]))
    """
    return registered(observations, bad, longest_px).found


def registered(
    observations: ArrayLike, bad: ArrayLike | None = None, longest_px: float | None = None
) -> Registered:
    """Register as `register` does, and tell the noise of each frame too."""
    from algorithms.extractors.frames import mirror_search_kernel as search  # noqa: PLC0415 - Numba
    from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at first use

    batch = as_batch(observations, "frames")
    frames = as_frames(batch)
    mask = np.zeros((0, 0), dtype=np.bool_)
    if bad is not None:
        mask = as_bad(bad, frames.shape[1:], "mirror registration")
        frames = as_frames(without_bad(frames, mask, "mirror registration"))
    count, height, width = frames.shape
    found = Measurement(
        np.full((count, 2), np.nan),
        np.full((count, 2, 2), np.nan),
        np.full(count, int(Doubt.NO_SPOT), dtype=np.int64),
    )
    result = Registered(found, np.full((count, 2), np.nan))
    if min(height, width) < 5:
        return result
    lights = np.empty((count, search.FOUND))
    unusable = np.empty(count, dtype=np.bool_)
    moments.unusable(frames, frames.dtype.kind == "f", unusable)
    search.find_lights(frames, unusable, lights)
    why = lights[:, 8]
    found.doubts[why == search.SEVERAL] = int(Doubt.SEVERAL_SPOTS)
    found.doubts[why == search.EDGE] = int(Doubt.CUT)
    seen = np.flatnonzero(why == 0.0)
    if len(seen):
        _register_seen(frames, seen, lights[seen], mask, longest_px, result)
    return result


def _register_seen(  # noqa: PLR0917 - what is known of the frames
    frames: Frames,
    seen: NDArray[np.int64],
    lights: Floats,
    mask: NDArray[np.bool_],
    longest_px: float | None,
    result: Registered,
) -> None:
    """Write centres, covariances, doubts and noise of the frames `seen`, chunk by chunk."""
    n = len(seen)
    lengths = _lengths(lights, *frames.shape[1:])
    step = max(1, min(n, int(_CHUNK / np.median(lengths))))
    length = int(lengths.max()) + 64
    space = _space((5 * step + 16) * length)
    lines = space[: 5 * step * length].reshape(5, step, length)
    work = space[5 * step * length :].reshape(16, length)
    states, slopes = np.zeros((n, 18)), np.zeros((n, 9))
    boxes, middles = np.zeros((n, 8), dtype=np.int64), np.empty((n, 2), dtype=np.int64)
    shapes = np.full((n, _SHAPE), np.nan)
    for begin in range(0, n, step):
        part = slice(begin, begin + step)
        state = _State(boxes[part], middles[part], states[part], slopes[part], shapes[part])
        _chunk(frames, seen[part], lights[part], mask, lines, work, state)
    centres = 0.5 * (middles + states[:, 2:4])
    saturated = _saturated(frames, seen, lights)
    doubts = _doubts(lights, boxes, states, shapes, centres, saturated)
    noise = np.sqrt(states[:, 0])
    several, skew = _unlike(shapes, noise), _skew(shapes) & ~saturated
    if longest_px is not None:  # what no longer than one spot is has fringes, oblique ones too
        several &= _long(shapes, longest_px)
        skew &= _long(shapes, longest_px)
    settled = np.isfinite(states[:, 4])
    doubts[several & settled] |= int(Doubt.SEVERAL_SPOTS)
    doubts[skew & settled] |= int(Doubt.NOT_SYMMETRIC)
    refused = (doubts & ~int(Doubt.SATURATED | Doubt.GHOST)) != 0
    scatter = shapes[:, 7]
    covariance = states[:, [4, 6, 6, 5]] * scatter[:, None]
    centres[refused], covariance[refused] = np.nan, np.nan
    found = result.found
    peak = lights[:, 6]
    result.noise[seen] = np.column_stack([states[:, 0] * peak**2, states[:, 1] * peak])
    found.features[seen] = centres
    found.covariance[seen] = covariance.reshape(n, 2, 2)
    found.doubts[seen] = doubts


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


@dataclass(frozen=True)
class _State:
    """What the stages know of the frames of a chunk."""

    boxes: NDArray[np.int64]
    middles: NDArray[np.int64]
    states: Floats
    slopes: Floats
    shapes: Floats


def _chunk(  # noqa: PLR0917 - the stages' arrays, in their order
    frames: Frames,
    which: NDArray[np.int64],
    lights: Floats,
    bad: NDArray[np.bool_],
    lines: NDArray[np.float32],
    work: NDArray[np.float32],
    state: _State,
) -> None:
    """Run the stages on the frames `which`."""
    from algorithms.extractors.frames import (  # noqa: PLC0415 - Numba, at first use
        mirror_fit_kernel,
        mirror_ghost_kernel,
        mirror_outlier_kernel,
        mirror_pairs_kernel,
        mirror_ring_kernel,
        mirror_shape_kernel,
    )

    n = len(which)
    s, d, keep, e, slack = lines
    boxes, middles, states = state.boxes, state.middles, state.states
    slopes, shapes = state.slopes, state.shapes
    states[:, 0] = lights[:, 5] / lights[:, 6] ** 2
    middles[:] = np.rint(2.0 * lights[:, :2])
    states[:, 2:4] = 2.0 * lights[:, :2] - middles
    todo = np.arange(n)
    mirror_pairs_kernel.pair_up(
        frames, which, todo, lights, middles, bad, boxes, s, d, keep, states
    )
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
    mirror_shape_kernel.shapes(todo, boxes, s, keep, e, slack, work, states, shapes[:, :13])
    mirror_ghost_kernel.skewness(boxes, s, keep, e, states, shapes[:, 13:])


def _doubts(  # noqa: PLR0917 - what is known of each
    lights: Floats,
    boxes: NDArray[np.int64],
    states: Floats,
    shapes: Floats,
    centres: Floats,
    saturated: NDArray[np.bool_],
) -> NDArray[np.int64]:
    """Say what speaks against each answer."""
    doubts = np.where(saturated, int(Doubt.SATURATED), 0).astype(np.int64)
    lost = ~np.isfinite(states[:, 4])
    doubts[lost] |= int(Doubt.NO_SPOT)
    doubts[boxes[:, 3] == 0] |= int(Doubt.CUT)
    clusters, alike, area, scatter, departing = shapes.T[[0, 1, 5, 7, 11]]
    far = np.abs(centres - lights[:, :2]) > _ASTRAY * lights[:, 2:4] + _ASTRAY_PX
    with np.errstate(invalid="ignore", divide="ignore"):
        ghost = departing > _SCATTER_GHOST + _GHOST_FEW / area
        crooked = far.any(axis=1) | (clusters > _CLUSTERS) | (alike > _ALIKE)
        crooked |= ~saturated & (departing > _SCATTER + _SCATTER_FEW / area)
        doubts[crooked & ~lost] |= int(Doubt.NOT_SYMMETRIC)
        doubts[ghost & ~lost & ~saturated] |= int(Doubt.GHOST)
        unsure = np.maximum(states[:, 4], states[:, 5]) * scatter > _UNSURE**2
        doubts[unsure & ~lost] |= int(Doubt.NO_SPOT)
    return doubts


def _unlike(shapes: Floats, noise: Floats) -> NDArray[np.bool_]:
    """Whether outlines are not those of one spot: they have a waist, or differ with height."""
    wide, narrow, minor, area, waist = shapes.T[2:7]
    sharp_wide, sharp_narrow, base = shapes.T[8:11]
    with np.errstate(invalid="ignore", divide="ignore"):
        several = waist > _WAIST + _WAIST_FEW / area + _WAIST_NOISE * noise
        for one, other, tells in (
            (wide, narrow, area > 0.0),
            (sharp_wide, sharp_narrow, (area >= _SHARP) & (area < _TOP * base)),
        ):
            most = _UNLIKE + _UNLIKE_FEW / area + _UNLIKE_GRID / area**3 + _UNLIKE_NOISE * noise
            unlike = one > most * other
            apart = 2.0 * np.sqrt(minor) * (np.sqrt(one) - np.sqrt(other))
            several |= tells & unlike & (apart > _UNLIKE_PX + _UNLIKE_NOISE_PX * noise)
    return np.asarray(several)


def _skew(shapes: Floats) -> NDArray[np.bool_]:
    """Whether there is odd light in the spot, surely and by much: that of another one upon it."""
    scatter, skew, share = shapes.T[[7, 13, 14]]
    with np.errstate(invalid="ignore"):
        return np.asarray((skew > _SKEW * scatter) & (share > _SKEW_LIGHT))


def _long(shapes: Floats, longest_px: float) -> NDArray[np.bool_]:
    """Whether outlines are longer than one spot's: by their half axis, of second moments."""
    return np.asarray(2.0 * np.sqrt(shapes[:, 12]) > longest_px)


def _saturated(frames: Frames, seen: NDArray[np.int64], lights: Floats) -> NDArray[np.bool_]:
    """Whether neighbouring pixels of the spot are at ``2**bits - 1``, the most of a converter."""
    found = np.zeros(len(seen), dtype=np.bool_)
    brightest = np.rint(lights[:, 4] + lights[:, 6])
    most = np.isin(brightest, 2.0 ** np.arange(8, 17) - 1.0)
    for k in np.flatnonzero(most & (np.abs(brightest - lights[:, 4] - lights[:, 6]) < 1e-6)):
        largest = frames[seen[k]].max()
        found[k] = largest == brightest[k]
    return found

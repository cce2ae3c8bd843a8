"""Centres, covariances and flags of point-symmetric spots: one frame or window each.

What `mirror.extractor.MirrorRegistration` does to whole frames, for whoever has windows of frames.
On as many frames at once as the processor's cache holds, the light is found (`search_kernel`) and
the pixels about its middle are paired (`pairs_kernel`); by turns, the displacement is fitted
(`fit_kernel`) and pairs that depart are left out (`outlier_kernel`), after the first turn without
the background's slope (`ring_kernel`). Numbers that tell one spot (`shape_kernel`, `ghost_kernel`)
decide what speaks against an answer (`flags_kernel`).

About a point m / 2, m whole, pixels x and m - x pair without interpolation. With f the spot about
its centre c, d = 2 c - m and u = x - m / 2, a pair's difference is ``D = f(u - d/2) - f(u + d/2)``
and its mean ``S = (f(u - d/2) + f(u + d/2)) / 2``, so that ``D = -2 tanh(d . grad / 2) S``: a
filter on S that depends on d alone. Noise of D and S is independent, and so is that of different
pairs: d solves the weighted least squares of D on the slopes of S, by steps. Half of the Fisher
information about c is in f(u - d/2), half in its mirror image, and an unknown but symmetric f is
orthogonal to both: nothing of the Cramer-Rao bound is lost.

A weight is one over the variance, that of a dark pixel and what the mean light around adds: weights
as sharp as a rim would turn what slopes miss of it into a share of d. The slopes that weigh are
smoothed as long as that lowers the variance, and products with those that predict are freed of the
noise that both have in common.

The stages share these arrays, a row a frame. Lengths are in pixels, light is over the peak's.

- `lights`, `boxes`, `states`, `grounds` and `forms`: see `records`.
- `s`, `d`: means and differences of the window's pairs, upper half, row after row a stride apart;
  those of `s` after 7 rows and 8 numbers of margin.
- `keep`: what a pair of the core counts: 1, a half in a middle row, 0 for one left out, and -1 for
  one to be replaced. `e`: what the fit leaves of the difference; `slack`: the size of its slopes.
"""

from __future__ import annotations

import threading
from functools import cache
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import Floats
from algorithms.extractors.frames.mirror.records import BACKGROUND, BOX, FORM, LIGHT, STATE
from algorithms.inputs import Frames, as_frames
from algorithms.kernels.records import Records
from algorithms.measurement import Measurement, QualityFlag, as_bad, as_batch, without_bad

#: Turns of fit and leaving out; middles that are tried; d, px, from which another one is nearer.
_TURNS, _CENTRES, _FAR = 6, 3, 0.75
#: Numbers in all lines of the frames that are worked on at once: 1 MB, and at most 16 MB where one
#: window is much larger than the others, as long as its lines.
_CHUNK, _MOST = 2**18, 2**22
_KEPT = threading.local()


class Registration(NamedTuple):
    """What is found of frames (N, H, W), and how their pixels scatter.

    Attributes
    ----------
    found
        Centres, covariances and flags.
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
        and flags (N,): `NO_SPOT`, `SEVERAL_SPOTS`, `CUT` and `NOT_SYMMETRIC` say why a row is
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
    >>> found.features.round(1), found.deviations.round(3), found.flags
    (array([[21.3, 18.8]]), array([[0.003, 0.003]]), array([0]))
    """
    return register_frames(observations, bad, longest_px).found


def register_frames(
    observations: ArrayLike, bad: ArrayLike | None = None, longest_px: float | None = None
) -> Registration:
    """Register as `register` does, and tell the noise of each frame too."""
    kernels = _kernels()
    search = kernels.search
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
        np.full(count, int(QualityFlag.NO_SPOT), dtype=np.int64),
    )
    result = Registration(found, np.full((count, 2), np.nan))
    if min(height, width) < 5:
        return result
    lights = np.empty(count, dtype=LIGHT)
    unusable = kernels.moments.unusable_frames(frames)
    search.find_lights(frames, unusable, lights)
    why = lights["refusal"]
    found.flags[why == search.SEVERAL] = int(QualityFlag.SEVERAL_SPOTS)
    found.flags[why == search.EDGE] = int(QualityFlag.CUT)
    seen = np.flatnonzero(why == 0)
    if len(seen):
        _register_seen(frames, seen, lights[seen], mask, longest_px, result)
    return result


def _register_seen(  # noqa: PLR0917 - what is known of the frames
    frames: Frames,
    seen: NDArray[np.int64],
    lights: Records,
    mask: NDArray[np.bool_],
    longest_px: float | None,
    result: Registration,
) -> None:
    """Write centres, covariances, flags and noise of the frames `seen`, chunk by chunk."""
    kernels, n = _kernels(), len(seen)
    numbers = np.empty(3, dtype=np.int64)
    states, grounds = np.zeros(n, dtype=STATE), np.zeros(n, dtype=BACKGROUND)
    boxes, middles = np.zeros(n, dtype=BOX), np.empty((n, 2), dtype=np.int64)
    forms = np.zeros(n, dtype=FORM)
    kernels.pairs.begin(lights, frames.shape[1], frames.shape[2], middles, states, numbers)
    length, core, total = numbers.tolist()
    step = max(1, min(n, _CHUNK * n // total, _MOST // (2 * length + 3 * core)))
    one, other = 2 * step * length, 3 * step * core
    space = _space(one + other + 16 * length)
    s, d = space[:one].reshape(2, step, length)
    lines = (s, d, *space[one : one + other].reshape(3, step, core))
    work = space[one + other :].reshape(16, length)
    for begin in range(0, n, step):
        part = slice(begin, begin + step)
        state = _State(boxes[part], middles[part], states[part], grounds[part], forms[part])
        _chunk(frames, seen[part], lights[part], mask, lines, work, state)
    found = result.found
    kernels.flags.conclude(
        frames,
        seen,
        -np.inf if longest_px is None else longest_px,
        lights,
        boxes,
        middles,
        states,
        forms,
        found.features,
        found.covariance,
        found.flags,
        result.noise,
    )


class _Kernels(NamedTuple):
    """Modules of compiled loops."""

    moments: ModuleType
    search: ModuleType
    pairs: ModuleType
    fit: ModuleType
    outliers: ModuleType
    ring: ModuleType
    shape: ModuleType
    ghost: ModuleType
    flags: ModuleType


@cache
def _kernels() -> _Kernels:
    """Load Numba at first use; from then on that costs nothing."""
    from algorithms.extractors.frames.mirror import (  # noqa: PLC0415
        fit_kernel,
        flags_kernel,
        ghost_kernel,
        outlier_kernel,
        pairs_kernel,
        ring_kernel,
        search_kernel,
        shape_kernel,
    )
    from algorithms.kernels import moments  # noqa: PLC0415

    return _Kernels(
        moments,
        search_kernel,
        pairs_kernel,
        fit_kernel,
        outlier_kernel,
        ring_kernel,
        shape_kernel,
        ghost_kernel,
        flags_kernel,
    )


def _space(size: int) -> NDArray[np.float32]:
    """Work space of so many numbers, kept between calls, one a thread: new memory is slow."""
    space: NDArray[np.float32] | None = getattr(_KEPT, "space", None)
    if space is None or space.size < size:
        space = _KEPT.space = np.empty(size, dtype=np.float32)
    return space[:size]


class _State(NamedTuple):
    """What the stages know of the frames of a chunk."""

    boxes: Records
    middles: NDArray[np.int64]
    states: Records
    grounds: Records
    forms: Records


def _chunk(  # noqa: PLR0917 - the stages' arrays, in their order
    frames: Frames,
    which: NDArray[np.int64],
    lights: Records,
    bad: NDArray[np.bool_],
    lines: tuple[NDArray[np.float32], ...],
    work: NDArray[np.float32],
    state: _State,
) -> None:
    """Run the stages on the frames `which`."""
    kernels, n = _kernels(), len(which)
    fit, leave_out, pair_up = kernels.fit.fit, kernels.outliers.leave_out, kernels.pairs.pair_up
    s, d, keep, e, slack = lines
    boxes, middles, states = state.boxes, state.middles, state.states
    grounds, forms = state.grounds, state.forms
    every, todo = np.arange(n), np.arange(n)
    pair_up(frames, which, todo, lights, middles, bad, boxes, s, d, keep, work, states)
    far = fit(todo, boxes, True, grounds, s, d, keep, e, slack, work, states)
    for _ in range(_CENTRES - 1):
        if far == 0:
            break
        again = np.flatnonzero(np.abs(states["d"]).max(axis=1) > _FAR)
        moved = np.rint(np.clip(states["d"][again], -4.0, 4.0)).astype(np.int64)
        states["d"][again] -= moved
        middles[again] += moved
        states["xx"][again] = 0.0
        pair_up(frames, which, again, lights, middles, bad, boxes, s, d, keep, work, states)
        far = fit(again, boxes, True, grounds, s, d, keep, e, slack, work, states)
    left = n
    for turn in range(_TURNS):
        if turn:
            fit(todo[:left], boxes, False, grounds, s, d, keep, e, slack, work, states)
        left = leave_out(todo[:left], boxes, turn == 0, bad, s, d, keep, e, slack, work, states)
        if turn == 0:
            kernels.ring.flatten(todo[:left], boxes, lights, s, d, work, states, grounds)
        if left == 0:
            break
    kernels.shape.shapes(every, boxes, s, keep, e, slack, work, states, forms)
    kernels.ghost.skewness(boxes, s, keep, e, work, states, forms)

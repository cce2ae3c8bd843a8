"""Centres of a frame's spots by first moments under Gaussian windows that move with them.

The windows of all spots of a frame share one shape, the ellipse that their common image fills.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

#: Deviations of a window that are summed, and that must be within the frame; least width over the
#: spots' to which one at the edge may shrink.
_REACH, _INSIDE, _LEAST = 2.8, 2.5, 0.6
#: Rounds that settle the shape, steps for a centre, last step and largest one, px.
_ROUNDS, _STEPS, _SETTLED, _LARGEST = 6, 25, 1e-8, 0.7
#: A centre may be so far from where it was looked for, px; deviations of a shape are at least so.
_ASTRAY, _NARROWEST = 2.0, 0.7


def window_centres(  # noqa: PLR0917 - the spots, and the windows
    frame: NDArray[Any],
    floor: float,
    starts: Floats,
    deviation: float,
    cap: float,
    factor: float,
) -> Floats:
    """Centres and light of spots near `starts`.

    Parameters
    ----------
    frame : ndarray, shape (H, W)
        One frame.
    floor : float
        Its background.
    starts : ndarray, shape (n, 2)
        Where spots are, to a pixel.
    deviation : float
        Of a spot, px, to begin with.
    cap : float
        Half the side of what may be summed around a spot, px.
    factor : float
        Width of the windows over that of the Gaussian that fits the spots best.

    Returns
    -------
    ndarray, shape (n, 3)
        ``x, y`` px and the light under the window, less the background; NaN where a spot is within
        the edge, or not found.
    """
    found = np.full((len(starts), 3), np.nan)
    shape = np.eye(2) * deviation**2
    centres = starts.copy()
    limit = (cap / _REACH) ** 2
    for turn in range(_ROUNDS + 1):
        last = turn == _ROUNDS
        if last:
            shape = _bounded(factor**2 * shape, limit)
        scale = _scales(centres, shape, frame.shape)
        seen = np.flatnonzero(scale * factor >= _LEAST if last else scale >= 1.0)
        if not len(seen):
            return found
        scale = scale[seen]
        light, x, y = _cut(frame, floor, centres[seen], shape)
        inverse = np.linalg.inv(shape) / scale[:, None, None] ** 2
        place, weighed, moved = _climb(light, x, y, centres[seen], inverse, _STEPS if last else 3)
        near = np.hypot(*(place - starts[seen]).T) < _ASTRAY
        if last:
            near &= (moved < 1e-4) & (weighed.sum(axis=(1, 2)) > 0.0)
            found[seen[near], :2] = place[near]
            found[seen[near], 2] = weighed[near].sum(axis=(1, 2))
            return found
        centres[seen[near]] = place[near]
        shape = _matched(weighed, x, y, place, limit)
    return found


def _scales(centres: Floats, shape: Floats, size: tuple[int, ...]) -> Floats:
    """How much windows (n,) must shrink to stay within the frame; 1 at most."""
    far = np.array([size[1], size[0]]) - 0.5 - centres
    room = np.minimum(centres + 0.5, far)
    reach = _INSIDE * np.sqrt(np.diag(shape))
    return np.asarray(np.clip((room / reach).min(axis=1), 0.0, 1.0))


def _cut(
    frame: NDArray[Any], floor: float, centres: Floats, shape: Floats
) -> tuple[Floats, Floats, Floats]:
    """Light (n, w, w) around centres, and the columns and rows (n, w) it is of."""
    reach = int(np.ceil(_REACH * np.sqrt(np.linalg.eigvalsh(shape)[1])))
    x, y = (np.rint(centres).astype(np.int64)[:, :, None] + np.arange(-reach, reach + 1)).transpose(
        1, 0, 2
    )
    height, width = frame.shape
    inside = ((y >= 0) & (y < height))[:, :, None] & ((x >= 0) & (x < width))[:, None, :]
    rows, columns = y.clip(0, height - 1), x.clip(0, width - 1)
    light = frame[rows[:, :, None], columns[:, None, :]].astype(np.float64) - floor
    return np.where(inside, light, 0.0), x.astype(np.float64), y.astype(np.float64)


def _climb(  # noqa: PLR0917 - the spots, and where to begin
    light: Floats, x: Floats, y: Floats, start: Floats, inverse: Floats, steps: int
) -> tuple[Floats, Floats, Floats]:
    """Centres (n, 2) about which the weighed light has no first moment, by Newton's method.

    With it the weighed light, and the length (n,) of the last step.
    """
    centres = start.copy()
    a, b, c = (inverse[:, i, j, None, None] for i, j in ((0, 0), (0, 1), (1, 1)))
    for _ in range(steps):
        u = x[:, None, :] - centres[:, 0, None, None]
        v = y[:, :, None] - centres[:, 1, None, None]
        p, q = a * u + b * v, b * u + c * v
        weighed = light * np.exp(-0.5 * (u * p + v * q))
        total = weighed.sum(axis=(1, 2))
        gx, gy = (weighed * p).sum(axis=(1, 2)), (weighed * q).sum(axis=(1, 2))
        xx = a[:, 0, 0] * total - (weighed * p * p).sum(axis=(1, 2))
        yy = c[:, 0, 0] * total - (weighed * q * q).sum(axis=(1, 2))
        xy = b[:, 0, 0] * total - (weighed * p * q).sum(axis=(1, 2))
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            step = np.stack([gx * yy - gy * xy, gy * xx - gx * xy], axis=1)
            step /= (xx * yy - xy * xy)[:, None]
        step = np.clip(np.nan_to_num(step), -_LARGEST, _LARGEST)
        centres += step
        moved = np.abs(step).max(axis=1)
        if (moved < _SETTLED).all():
            break
    return centres, weighed, moved


def _matched(weighed: Floats, x: Floats, y: Floats, centres: Floats, limit: float) -> Floats:
    """Covariance (2, 2) of the Gaussian whose light, so weighed, has these second moments."""
    u = x[:, None, :] - centres[:, 0, None, None]
    v = y[:, :, None] - centres[:, 1, None, None]
    total = weighed.sum()
    with np.errstate(invalid="ignore", divide="ignore"):
        moments = np.array([(weighed * m).sum() / total for m in (u * u, u * v, v * v)])
    if not np.isfinite(moments).all():
        return np.eye(2)
    # a Gaussian under a window of its own shape has half of its moments
    return _bounded(2.0 * moments[[0, 1, 1, 2]].reshape(2, 2), limit)


def _bounded(shape: Floats, limit: float) -> Floats:
    """Return the covariance (2, 2), variances along its axes kept within bounds."""
    values, axes = np.linalg.eigh(shape)
    return np.asarray((axes * np.clip(values, _NARROWEST**2, max(limit, 1.0))) @ axes.T)

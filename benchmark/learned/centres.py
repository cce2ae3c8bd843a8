"""Centres by heat map: a small network sees a window and says which of its light to weigh.

The last layer gives two heat maps, one an axis. A map is turned into weights that sum to one, the
light of each pixel times the softmax of the map; the centre is the mean of the pixels' coordinates
so weighed (soft-argmax). Maps of zeros are the plain centroid of the window.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import cv2
import numpy as np

from algorithms.contract import Floats
from benchmark.learned.network import INPUT, Floats32, Layer, Network, convolutions

#: Pixels that a batch is moved by at random while it is learned from, either way.
MARGIN_PX = 2


@dataclass(frozen=True)
class Look:
    """What a network is shown of a frame.

    Attributes
    ----------
    window_px
        Side of the square window, a multiple of 8, of pixels as they are after pooling.
    box_px
        The window is around the brightest mean over a square so wide; 0 where it is the frame.
    pool
        Pixels an axis that are averaged first.
    """

    window_px: int
    box_px: int
    pool: int = 1


class Windows(NamedTuple):
    """Windows (N, 1, S, S), 1 at the brightest; their first pixels (N, 2), in pooled pixels.

    `bright` (N,) is the frame's brightest mean of 3 x 3 pixels, `beyond` (N,) the brightest mean
    over the box with its middle outside the window, over that of the whole frame.
    """

    light: Floats32
    corner: Floats
    bright: Floats
    beyond: Floats


def windows(look: Look, corrected: Any, margin: int = 0) -> Windows:
    """Cut windows out of corrected frames (N, R, C), wider by a margin; zeros beyond the edge.

    Light is over the brightest mean of 3 by 3 pixels; a frame without any light is left as it is.
    """
    side = look.window_px + 2 * margin
    found = np.zeros((len(corrected), 1, side, side), dtype=np.float32)
    corners, brights = np.zeros((len(corrected), 2)), np.zeros((len(corrected), 2))
    for k, frame in enumerate(_averaged(np.asarray(corrected, dtype=np.float32), look.pool)):
        box = (look.box_px or 3,) * 2
        means = cv2.blur(frame, box, borderType=cv2.BORDER_CONSTANT)
        most, (x, y) = float(means.max()), (size // 2 for size in frame.shape[::-1])
        if look.box_px:
            y, x = divmod(int(means.argmax()), means.shape[1])
        left, top = x - side // 2, y - side // 2
        within = slice(max(top, 0), top + side), slice(max(left, 0), left + side)
        bright, shown = float(cv2.blur(frame, (3, 3)).max()), frame[within]
        rows = slice(max(-top, 0), max(-top, 0) + shown.shape[0])
        columns = slice(max(-left, 0), max(-left, 0) + shown.shape[1])
        found[k, 0, rows, columns] = shown / bright if bright > 0 else shown
        means[within] = 0.0
        corners[k], brights[k] = (left, top), (bright, means.max() / most if most > 0 else np.nan)
    return Windows(found, corners, *brights.T)


def _averaged(frames: Floats32, pool: int) -> Floats32:
    """Return means of pool by pool pixels; odd last rows and columns are left out."""
    count, rows, columns = (len(frames), *(size // pool for size in frames.shape[1:]))
    even = frames[:, : rows * pool, : columns * pool]
    return np.asarray(even.reshape(count, rows, pool, columns, pool).mean(axis=(2, 4)))


def folded(light: Floats32) -> Floats32:
    """Fold windows (N, 1, S, S) into (N, 4, S/2, S/2): 2 x 2 pixels become channels."""
    count, _, side, _ = light.shape
    parts = light.reshape(count, side // 2, 2, side // 2, 2).transpose(0, 2, 4, 1, 3)
    return np.ascontiguousarray(parts.reshape(count, 4, side // 2, side // 2))


def unfolded(heat: Floats32) -> Floats32:
    """Return heat maps (N, 2, S, S) of what the network gives, (N, 8, S/2, S/2)."""
    count, _, half, _ = heat.shape
    parts = heat.reshape(count, 2, 2, 2, half, half).transpose(0, 1, 4, 2, 5, 3)
    return np.asarray(parts.reshape(count, 2, 2 * half, 2 * half))


def layers(width: int = 16) -> tuple[Layer, ...]:
    """Return the layers of a network that is given folded windows."""
    return tuple(_layers(width))


def _layers(width: int) -> Iterator[Layer]:
    yield from convolutions("fine", (4, width, width), INPUT)
    yield Layer("half", "maximum", ("fine1.relu",))
    yield from convolutions("coarse", (width, width), "half")
    yield Layer("up", "double", ("coarse0.relu",))
    yield Layer("both", "concatenate", ("fine1.relu", "up"))
    yield from convolutions("last", (2 * width, width), "both")
    yield Layer("heat", "convolution", ("last0.relu",), (8, width, 1, 1))


class Seen(NamedTuple):
    """What heat maps say: centres (N, 2) in the window, and standard deviations (N, 2) of them."""

    centre: Floats
    spread: Floats


def soft_argmax(heat: Any, light: Any) -> Seen:
    """Return centres and spreads by heat maps (N, 2, S, S) of windows (N, 1, S, S).

    A window without light has NaN.
    """
    logits = np.asarray(heat, dtype=np.float64)
    shares = np.exp(logits - logits.max(axis=(2, 3), keepdims=True))
    shares *= np.maximum(np.asarray(light, dtype=np.float64), 0.0)
    with np.errstate(invalid="ignore"):
        shares /= shares.sum(axis=(2, 3), keepdims=True)
    along = shares[:, 0].sum(axis=1), shares[:, 1].sum(axis=2)
    places = np.arange(logits.shape[3], dtype=np.float64)
    centre = np.stack([part @ places for part in along], axis=1)
    spread = np.stack([part @ places**2 for part in along], axis=1) - centre**2
    return Seen(centre, np.sqrt(np.maximum(spread, 0.0)))


@dataclass(frozen=True)
class CentreReader:
    """A network with what it is shown, and the limits within which it answers.

    `limits` are (low, high) of each of the `statistics`; None answers all.
    """

    network: Network | None
    look: Look
    limits: Sequence[tuple[float, float]] | None = None

    def read(self, corrected: Any) -> tuple[Floats, Floats]:
        """Centres (N, 2) in the frames' pixels, NaN beyond the limits, and statistics (N, 4).

        The statistics are logarithms of both spreads, px, of the frame's brightest mean, and of
        what is beyond the window (`Windows`), 1e-3 at least.
        Without a network the centre is the centroid of the window.
        """
        shown = windows(self.look, corrected)
        side = self.look.window_px
        heat = np.zeros((len(shown.light), 2, side, side), dtype=np.float32)
        if self.network is not None:
            heat = unfolded(self.network(folded(shown.light)))
        seen = soft_argmax(heat, shown.light)
        pool = self.look.pool
        centres = (seen.centre + shown.corner) * pool + (pool - 1) / 2.0
        found = np.column_stack([seen.spread, shown.bright, shown.beyond])
        statistics = np.log(np.maximum(found, 1e-3))
        if self.limits is not None:
            low, high = np.asarray(self.limits).T
            centres[~((statistics >= low) & (statistics <= high)).all(axis=1)] = np.nan
        return centres, statistics

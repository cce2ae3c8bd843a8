"""Frames of one spot, drawn afresh: other shapes, stray light, defects, two lights, no Sun.

Unless a set says otherwise: half a width of 8 px, peak 2000 e-, background 20 e-, read noise 10 e-,
12 bit at one electron a digital number, 64 x 64 px. What each set draws was settled before any
method was measured on it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.synthetic_features.light import position_bound
from benchmark.synthetic_features.shapes import (
    BACKGROUND_E,
    Shape,
    airy,
    disc,
    gaussian,
    limb_darkened,
    read_out,
    render,
    square,
    stretch,
    variance_e,
)

#: What a method is held to on a set, if to anything.
Kind = Literal["symmetric", "stray", "fault"]
#: Draws so many spots' centres (N, 2), and the other light (N, H, W) or (1,), e-.
Scenery = Callable[[np.random.Generator, int, "FrameSet"], tuple[Floats, Floats]]
#: Changes readings (N, H, W) where pixels are broken.
Breaks = Callable[[np.random.Generator, NDArray[Any], Floats], None]

#: Frames of one stream: the first frames are the same whatever number is asked for.
_BATCH = 25
#: Pixels of the spots that the bound is averaged over.
_BOUND_PIXELS = 100_000


@dataclass(frozen=True)
class Scenes:
    """What was drawn.

    Attributes
    ----------
    frames
        (N, H, W).
    centres
        (N, 2) px; NaN where no answer is right.
    bound_px
        Root mean square Cramer-Rao bound of one axis with shape and all other light known but for
        the spot's brightness and the background's level; NaN where there is no spot.
    """

    frames: NDArray[Any]
    centres: Floats
    bound_px: float


def _within(rng: np.random.Generator, count: int, chosen: FrameSet) -> Floats:
    """Centres (N, 2) of spots all of which is in the frame."""
    last = chosen.size_px - 1.0
    margin = min(math.ceil(chosen.shape.longest_px) + 8.0, last / 2.0 - 1.0)
    return rng.uniform(margin, last - margin, (count, 2))


def single_spot(rng: np.random.Generator, count: int, chosen: FrameSet) -> tuple[Floats, Floats]:
    """One spot anywhere, and no other light."""
    return _within(rng, count, chosen), np.zeros(1)


@dataclass(frozen=True)
class FrameSet:
    """One kind of frame.

    Attributes
    ----------
    name, group
        Names its random stream, and the table it is printed in.
    kind
        ``symmetric``: one point-symmetric spot. ``stray``: in light that is not its own.
        ``fault``: what must not be answered wrongly.
    shape
        Of the spot.
    size_px, peak_e, bits
        Side of the frame, the spot's height, and the converter's.
    turned
        Whether spots are turned at random.
    scenery
        Draws the centres and light that is not the spot's.
    breaks
        Puts broken pixels into what was read.
    sun
        Whether there is a spot at all.
    """

    name: str
    group: str
    kind: Kind
    shape: Shape
    size_px: int = 64
    peak_e: float = 2000.0
    bits: int = 12
    turned: bool = False
    scenery: Scenery = single_spot
    breaks: Breaks | None = None
    sun: bool = True

    def draw(self, seed: int | str, count: int) -> Scenes:
        """Return the first `count` frames of this set under a seed."""
        frames = np.empty((count, self.size_px, self.size_px), dtype=np.uint16)
        centres = np.empty((count, 2))
        bound = math.nan
        for first in range(0, count, _BATCH):
            rng = generator("robustness", seed, self.name, first // _BATCH)
            places, light = self.scenery(rng, _BATCH, self)
            turns = rng.uniform(0.0, math.pi, _BATCH) * self.turned
            mean = np.full((_BATCH, self.size_px, self.size_px), BACKGROUND_E) + light
            if self.sun:
                if first == 0:
                    bound = self._bound_px(places, turns, mean)
                mean += self.peak_e * render(self.shape, places, turns, self.size_px)
            read = read_out(mean, self.bits, rng)
            if self.breaks is not None:
                self.breaks(rng, read, places)
            part = slice(first, min(first + _BATCH, count))
            frames[part] = read[: count - first]
            centres[part] = places[: count - first] if self.sun else math.nan
        return Scenes(frames, centres, bound)

    def _bound_px(self, places: Floats, turns: Floats, other: Floats) -> float:
        few = min(max(_BOUND_PIXELS // self.size_px**2, 2), len(places))

        def mean(at: Floats) -> Floats:
            return other[:few] + self.peak_e * render(self.shape, at, turns[:few], self.size_px)

        return position_bound(
            mean,
            places[:few],
            lambda here: [here - other[:few], np.ones_like(here)],
            variance_e,
        )


def _directions(rng: np.random.Generator, count: int) -> Floats:
    turns = rng.uniform(0.0, 2.0 * math.pi, count)
    return np.column_stack([np.cos(turns), np.sin(turns)])


def _gradient(rng: np.random.Generator, count: int, chosen: FrameSet) -> tuple[Floats, Floats]:
    """Light that rises by a tenth of the peak across the frame, in any direction."""
    across = np.arange(chosen.size_px) / (chosen.size_px - 1.0) - 0.5
    x, y = _directions(rng, count).T[:, :, None, None]
    # never below nothing: along a diagonal it falls by 0.71 from the middle to a corner
    light = 0.1 * chosen.peak_e * (0.75 + x * across[None, None, :] + y * across[None, :, None])
    return _within(rng, count, chosen), np.asarray(light)


def _glare(rng: np.random.Generator, count: int, chosen: FrameSet) -> tuple[Floats, Floats]:
    """Add a broad lobe beside it: 5 to 10 % of the peak, sigma 12 to 20 px, 5 to 20 px off."""
    centres = _within(rng, count, chosen)
    height = chosen.peak_e * rng.uniform(0.05, 0.10, (count, 1, 1))
    sigma = rng.uniform(12.0, 20.0, (count, 1, 1))
    middle = centres + rng.uniform(5.0, 20.0, (count, 1)) * _directions(rng, count)
    axis = np.arange(chosen.size_px)
    x = axis[None, None, :] - middle[:, 0, None, None]
    y = axis[None, :, None] - middle[:, 1, None, None]
    return centres, np.asarray(height * np.exp(-(x**2 + y**2) / (2.0 * sigma**2)))


def _second(share: float, least: float, most: float) -> Scenery:
    """Another spot of the same shape with a share of the light, this far off in any direction."""

    def scenery(rng: np.random.Generator, count: int, chosen: FrameSet) -> tuple[Floats, Floats]:
        middle = (chosen.size_px - 1) / 2.0 + rng.uniform(-5.0, 5.0, (count, 2))
        half = rng.uniform(least, most, (count, 1)) / 2.0 * _directions(rng, count)
        other = render(chosen.shape, middle - half, np.zeros(count), chosen.size_px)
        return middle + half, share * chosen.peak_e * other

    return scenery


def _over_the_edge(rng: np.random.Generator, count: int, chosen: FrameSet) -> tuple[Floats, Floats]:
    """Spots of which an edge takes a part: the centre from half a radius out to 0.9 in."""
    centres = _within(rng, count, chosen)
    depth = chosen.shape.half_px * rng.uniform(-0.5, 0.9, count) - 0.5
    axis, far = rng.integers(2, size=count), rng.integers(2, size=count)
    centres[np.arange(count), axis] = np.where(far, chosen.size_px - 1.0 - depth, depth)
    return centres, np.zeros(1)


def _hot(number: int) -> Breaks:
    """So many pixels anywhere in the frame read the largest number."""

    def breaks(rng: np.random.Generator, frames: NDArray[Any], _: Floats) -> None:
        for frame in frames:
            at = rng.choice(frame.size, number, replace=False)
            frame.flat[at] = 4095

    return breaks


def _dead(number: int) -> Breaks:
    """So many pixels of the disc read nothing."""

    def breaks(rng: np.random.Generator, frames: NDArray[Any], centres: Floats) -> None:
        y, x = np.indices(frames.shape[1:])
        for frame, centre in zip(frames, centres, strict=True):
            lit = np.flatnonzero(np.hypot(x - centre[0], y - centre[1]) < _RADIUS)
            frame.flat[rng.choice(lit, number, replace=False)] = 0

    return breaks


_RADIUS = 8.0
_DISC = disc(_RADIUS)
_SHAPES, _SIZES, _OTHER, _DEFECTS = "shapes", "sizes", "stray light and lights", "defects, no Sun"

FRAME_SETS: tuple[FrameSet, ...] = (
    FrameSet("disc", _SHAPES, "symmetric", _DISC),
    FrameSet("gaussian", _SHAPES, "symmetric", gaussian(3.0)),
    FrameSet("airy", _SHAPES, "symmetric", airy(_RADIUS)),
    *(
        FrameSet(
            f"ellipse {incidence}", _SHAPES, "symmetric", stretch(_RADIUS, incidence), turned=True
        )
        for incidence in (30, 45, 60)
    ),
    FrameSet("square", _SHAPES, "symmetric", square(_RADIUS)),
    FrameSet("square turned", _SHAPES, "symmetric", square(_RADIUS), turned=True),
    *(
        FrameSet(f"r {radius:g}", _SIZES, "symmetric", disc(radius), size_px=size)
        for radius, size in ((2.0, 64), (2.5, 64), (4.0, 64), (20.0, 64), (50.0, 256), (150.0, 512))
    ),
    # a signal over noise of 200
    FrameSet("r 2.5 bright", _SIZES, "symmetric", disc(2.5), peak_e=4e4, bits=16),
    FrameSet("r 8 bright", _SIZES, "symmetric", _DISC, peak_e=4e4, bits=16),
    FrameSet("limb, gradient", _OTHER, "stray", limb_darkened(_RADIUS), scenery=_gradient),
    FrameSet("glare", _OTHER, "stray", _DISC, scenery=_glare),
    FrameSet("ghost apart", _OTHER, "fault", _DISC, scenery=_second(0.5, 18.0, 24.0)),
    FrameSet("ghost upon it", _OTHER, "fault", _DISC, scenery=_second(0.5, 5.0, 18.0)),
    FrameSet("two apart", _OTHER, "fault", _DISC, scenery=_second(1.0, 18.0, 24.0)),
    FrameSet("two overlap", _OTHER, "fault", _DISC, scenery=_second(1.0, 5.0, 18.0)),
    FrameSet("edge-cut", _OTHER, "fault", _DISC, scenery=_over_the_edge),
    FrameSet("5 hot", _DEFECTS, "fault", _DISC, breaks=_hot(5)),
    FrameSet("5 dead", _DEFECTS, "fault", _DISC, breaks=_dead(5)),
    FrameSet("weak, 1 hot", _DEFECTS, "fault", _DISC, peak_e=150.0, breaks=_hot(1)),
    FrameSet("no Sun", _DEFECTS, "fault", _DISC, sun=False),
    FrameSet("no Sun, 1 hot", _DEFECTS, "fault", _DISC, sun=False, breaks=_hot(1)),
)

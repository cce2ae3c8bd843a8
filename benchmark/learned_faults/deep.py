"""A sparse network (SSCNN) for masks of many holes: the whole frame straight to two angles.

As `benchmark.learned.sparse`, convolutions are over lit sites alone (Graham2017), so that one never
sees from one spot to another over dark pixels. Between convolutions sites are therefore merged two
by two, until spots of one group are neighbours and their distances, which are the code, can be
read. The last sites' coordinates and values are averaged by weights that the network gives, and
dense layers take these means to the tangents of both angles and to how far off they may be.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.learned.centres import Look, windows
from benchmark.learned.network import INPUT, Floats32, Layer, Network, chained, convolutions, dense
from benchmark.learned.sparse import sites_of, submanifold

#: The network that is kept.
WEIGHTS = Path(__file__).with_name("sscnn-cmos-encoded.npz")
#: The whole frame, averaged to 64 x 64 pixels.
LOOK = Look(64, 0, pool=4)
#: Channels of both convolutions of each level, whose sites are twice as wide as before.
WIDTHS = (8, 16, 32, 64)
#: Means over sites that the dense layers are given, and what is averaged: places and channels.
HEADS, AVERAGED = 4, 2 + WIDTHS[-1]
#: Frames that are evaluated together; memory only.
_TOGETHER = 32

Sites = NDArray[np.int64]


def layers(hidden: int = 64) -> tuple[Layer, ...]:
    """Return the layers.

    The last gives the tangents of beta and alpha, and the logarithm of how far off they are, deg.
    """
    return tuple(_layers(hidden))


def _layers(hidden: int) -> Iterator[Layer]:
    before, of = 1, INPUT
    for level, width in enumerate(WIDTHS):
        yield from convolutions(f"level{level}_", (before, width, width), of)
        before, of = width, f"level{level}_1.relu"
        if level + 1 < len(WIDTHS):
            yield Layer(f"merged{level}", "maximum", (of,))
            of = f"merged{level}"
    yield Layer("heads", "convolution", (of,), (HEADS, before, 1, 1))
    yield Layer("linear", "dense", ("heads",), (2, HEADS * AVERAGED))
    yield from chained(
        ("hidden0", "dense", (hidden, HEADS * AVERAGED)),
        ("hidden0.relu", "relu", ()),
        ("hidden1", "dense", (hidden, hidden)),
        ("hidden1.relu", "relu", ()),
        ("angles", "dense", (3, hidden)),
        of="heads",
    )


def merged(values: Floats32, sites: Sites) -> tuple[Floats32, Sites]:
    """Merge sites (S, 3) two by two along both axes; values (S, C) become the largest of each."""
    found: Sites
    found, to = np.unique(sites // [1, 2, 2], axis=0, return_inverse=True)
    most: Floats32 = np.full((len(found), values.shape[1]), -np.inf, dtype=np.float32)
    np.maximum.at(most, to.reshape(-1), values)
    return most, found


def places(size: int) -> Floats32:
    """Return the middles of sites along an axis, from -1 to 1 between the frame's edges."""
    return np.asarray((2.0 * np.arange(size) + 1.0) / size - 1.0, dtype=np.float32)


@dataclass(frozen=True)
class DeepReader:
    """A network of these layers, and the limits within which it answers.

    `limits` are (low, high) of each statistic of `read`; None answers all.
    """

    network: Network
    limits: Sequence[tuple[float, float]] | None = None

    def read(self, corrected: Any) -> tuple[Floats, Floats]:
        """(N, 2) tangents of beta and alpha, NaN beyond the limits, and statistics (N, 3).

        The statistics are logarithms of the number of sites and of the frame's brightest mean,
        1e-3 at least, and of the deviation that the network states, degrees.
        """
        parts = [
            self._part(corrected[start : start + _TOGETHER])
            for start in range(0, len(corrected), _TOGETHER)
        ]
        tangents, said = (np.concatenate(column) for column in zip(*parts, strict=True))
        if self.limits is not None:
            low, high = np.asarray(self.limits).T
            tangents[~((said >= low) & (said <= high)).all(axis=1)] = np.nan
        return tangents, said

    def _part(self, corrected: Any) -> tuple[Floats, Floats]:
        light, bright = shown(corrected)
        sites, weights = sites_of(light), self.network.weights
        lit = np.bincount(sites[:, 0], minlength=len(light))
        values = light[:, 0][tuple(sites.T)][:, None]
        for level in range(len(WIDTHS)):
            if level:
                values, sites = merged(values, sites)
            for k in range(2):
                found = submanifold(*weights[f"level{level}_{k}"], values, sites)
                values = np.maximum(found, np.float32(0.0))
        logits = submanifold(*weights["heads"], values, sites)
        means = _means(len(light), sites, logits, values)
        bent = means
        for name in ("hidden0", "hidden1"):
            bent = np.maximum(dense(*weights[name], bent), np.float32(0.0))
        found = dense(*weights["angles"], bent).astype(np.float64)
        tangents = found[:, :2] + dense(*weights["linear"], means)
        said = np.log(np.maximum(np.column_stack([lit, bright]), 1e-3))
        return np.asarray(tangents), np.column_stack([said, found[:, 2]])


def shown(corrected: Any) -> tuple[Floats32, Floats]:
    """Return what a network is shown (N, 1, 64, 64) of frames, and the brightest mean (N,) of each.

    Light above the frame's median, over the brightest mean of 3 by 3 averaged pixels.
    """
    frames = np.asarray(corrected, dtype=np.float32)
    found = windows(LOOK, frames - np.median(frames[:, ::4, ::4], axis=(1, 2), keepdims=True))
    return found.light, found.bright


def _means(count: int, sites: Sites, logits: Floats32, values: Floats32) -> Floats32:
    """(N, HEADS * AVERAGED) means of places and values by weights exp(logits); NaN without sites.

    Of each head in turn: x, y, then the values.
    """
    frame, along = sites[:, 0], places(LOOK.window_px >> (len(WIDTHS) - 1))
    most = np.full((count, HEADS), -np.inf, dtype=np.float32)
    np.maximum.at(most, frame, logits)
    shares = np.exp(logits - most[frame])
    averaged = np.column_stack([along[sites[:, 2]], along[sites[:, 1]], values])
    total = np.zeros((count, HEADS, 1), dtype=np.float32)
    np.add.at(total, frame, shares[:, :, None])
    moments = np.zeros((count, HEADS, averaged.shape[1]), dtype=np.float32)
    np.add.at(moments, frame, shares[:, :, None] * averaged[:, None])
    with np.errstate(invalid="ignore"):
        return np.asarray((moments / total).reshape(count, -1))

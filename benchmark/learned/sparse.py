"""Sparse submanifold convolution (SSCNN): from the lit pixels of a frame straight to two angles.

Only pixels above a threshold are sites; a convolution is computed there alone, and sees no others
(Graham2017), so that the cost goes with the light and not with the detector. After Herman2025c,
which proposes such a network for frames of a digital sun sensor; of its layers only the abstract
could be read, so these are ours: convolutions over sites, means of the sites' coordinates weighed
by light and by what the network says, and dense layers to the tangents of both angles.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.learned.centres import Look, Windows, windows
from benchmark.learned.network import INPUT, Floats32, Layer, Network, chained, convolutions, dense

#: Share of the brightest mean above which a pixel is lit.
LIT = 0.05
#: Means of coordinates that the dense layers are given.
HEADS = 4


def sites_of(light: Floats32) -> NDArray[np.int64]:
    """(S, 3) frame, row and column of the lit pixels of windows (N, 1, H, W), in order."""
    return np.argwhere(light[:, 0] > LIT)


def submanifold(
    weight: Floats32, bias: Floats32, of: Floats32, sites: NDArray[np.int64]
) -> Floats32:
    """Correlate sites' values (S, C) with kernels (O, C, k, k), over sites alone: (S, O).

    A neighbour that is no site counts as zero, and pixels that are none get no value.
    """
    size = weight.shape[2]
    margin = size // 2
    frames, rows, columns = sites.max(axis=0, initial=0) + 1
    numbers = np.full((frames, rows + 2 * margin, columns + 2 * margin), len(sites))
    at = sites[:, 0], sites[:, 1] + margin, sites[:, 2] + margin
    numbers[at] = np.arange(len(sites))
    known = np.vstack([of, np.zeros((1, of.shape[1]), dtype=np.float32)])
    found = np.broadcast_to(bias, (len(sites), len(bias))).copy()
    for i in range(size):
        for j in range(size):
            near = numbers[at[0], at[1] + i - margin, at[2] + j - margin]
            found += known[near] @ weight[:, :, i, j].T
    return found


def layers(width: int = 8, hidden: int = 32) -> tuple[Layer, ...]:
    """Return the layers: convolutions over sites, heads, then dense ones with a linear way by."""
    return tuple(_layers(width, hidden))


def _layers(width: int, hidden: int) -> Iterator[Layer]:
    yield from convolutions("site", (1, width, width, width), INPUT)
    yield Layer("heads", "convolution", ("site2.relu",), (HEADS, width, 1, 1))
    yield Layer("linear", "dense", ("heads",), (2, 2 * HEADS))
    yield from chained(
        ("hidden0", "dense", (hidden, 2 * HEADS)),
        ("hidden0.relu", "relu", ()),
        ("hidden1", "dense", (hidden, hidden)),
        ("hidden1.relu", "relu", ()),
        ("angles", "dense", (2, hidden)),
        of="heads",
    )


@dataclass(frozen=True)
class SparseReader:
    """A network of these layers, and what it is shown.

    `centre_px` and `scale_px` take detector coordinates to about -1 to 1; `limits` are (low, high)
    of each statistic, None answers all.
    """

    network: Network
    look: Look
    centre_px: tuple[float, float]
    scale_px: float
    limits: Sequence[tuple[float, float]] | None = None

    def read(self, corrected: Any, origin_px: Any) -> tuple[Floats, Floats]:
        """(N, 2) tangents of beta and alpha, NaN beyond the limits, and statistics (N, 3).

        The statistics are logarithms of the number of sites, of the frame's brightest mean, and
        of what is beyond the window (`Windows`), 1e-3 at least.
        """
        shown = windows(self.look, corrected)
        sites = sites_of(shown.light)
        found = self._tangents(shown, origin_px, sites).astype(np.float64)
        lit = np.bincount(sites[:, 0], minlength=len(found))
        said = np.log(np.maximum(np.column_stack([lit, shown.bright, shown.beyond]), 1e-3))
        if self.limits is not None:
            low, high = np.asarray(self.limits).T
            found[~((said >= low) & (said <= high)).all(axis=1)] = np.nan
        return found, said

    def _tangents(self, shown: Windows, origin_px: Any, sites: NDArray[np.int64]) -> Floats32:
        weights = self.network.weights
        values = light = shown.light[:, 0][tuple(sites.T)][:, None]
        for k in range(3):
            values = np.maximum(submanifold(*weights[f"site{k}"], values, sites), 0.0)
        logits = submanifold(*weights["heads"], values, sites)
        places = coordinates(self, shown, origin_px, sites)
        means = _means(len(shown.light), sites[:, 0], np.exp(logits) * light, places)
        return dense(*weights["linear"], means) + self._bent(means)

    def _bent(self, means: Floats32) -> Floats32:
        values, weights = means, self.network.weights
        for name in ("hidden0", "hidden1"):
            values = np.maximum(dense(*weights[name], values), np.float32(0.0))
        return dense(*weights["angles"], values)


def coordinates(
    reader: SparseReader, shown: Windows, origin_px: Any, sites: NDArray[np.int64]
) -> Floats32:
    """(S, 2) detector coordinates of sites, about -1 to 1."""
    first = shown.corner + (0.0 if origin_px is None else origin_px) - reader.centre_px
    places = (first[sites[:, 0]] + sites[:, 2:0:-1]) / reader.scale_px
    return np.asarray(places, dtype=np.float32)


def _means(count: int, frame: NDArray[np.int64], weights: Floats32, places: Floats32) -> Floats32:
    """(N, 2 H) means of places by weights (S, H): x of every head, then y; NaN without sites."""
    total = np.zeros((count, weights.shape[1]))
    np.add.at(total, frame, weights)
    found = []
    for axis in range(2):
        moments = np.zeros_like(total)
        np.add.at(moments, frame, weights * places[:, axis : axis + 1])
        with np.errstate(invalid="ignore"):
            found.append(moments / total)
    return np.concatenate(found, axis=1).astype(np.float32)

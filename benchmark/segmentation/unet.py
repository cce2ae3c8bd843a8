"""A U-Net of three levels that marks the Sun's image: its layers, what it is given, its masks."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.learned.network import INPUT, Floats32, Layer, Network, convolutions

#: Channels of its three levels, each of two convolutions down, the upper ones of two up again.
CHANNELS = (8, 16, 32)
#: Largest side of what it is given: of larger frames 2 x 2 pixels are averaged.
_LARGEST_PX = 128
#: Digital numbers (twice the read noise) from which its first channel is logarithmic, and where
#: full scale comes to about 1.
_LINEAR_DN, _SCALE = 2.0, 6.0
_WEIGHTS = Path(__file__).parent / "weights"


def layers() -> Iterator[Layer]:
    """Yield the layers; the last gives the logarithm of the odds, one channel."""
    top, middle, bottom = CHANNELS
    yield from convolutions("first", (2, top, top), INPUT)
    yield Layer("half", "maximum", ("first1.relu",))
    yield from convolutions("second", (top, middle, middle), "half")
    yield Layer("quarter", "maximum", ("second1.relu",))
    yield from convolutions("third", (middle, bottom, bottom), "quarter")
    yield Layer("up", "double", ("third1.relu",))
    yield Layer("beside", "concatenate", ("up", "second1.relu"))
    yield from convolutions("fourth", (bottom + middle, middle, middle), "beside")
    yield Layer("whole", "double", ("fourth1.relu",))
    yield Layer("together", "concatenate", ("whole", "first1.relu"))
    yield from convolutions("fifth", (middle + top, top, top), "together")
    yield Layer("odds", "convolution", ("fifth1.relu",), (1, top, 1, 1))


def block_of(frames: NDArray[Any]) -> int:
    """Pixels an axis that are averaged before the network."""
    return 1 if max(frames.shape[1:]) <= _LARGEST_PX else 2


def averaged(frames: NDArray[Any]) -> NDArray[Any]:
    """Return frames (N, H, W) averaged over blocks as the network is given them."""
    block = block_of(frames)
    count, rows, columns = frames.shape
    blocks = frames.reshape(count, rows // block, block, columns // block, block)
    return np.asarray(blocks.mean(axis=(2, 4)))


def channels(frames: Floats) -> Floats32:
    """(N, 2, h, w) of frames (N, H, W): light above the median on a bent scale, and over the peak.

    The first tells dim light from noise, the second what is brightest.
    """
    seen = averaged(frames)
    light = seen - np.median(seen, axis=(1, 2), keepdims=True)
    bent = np.arcsinh(light / _LINEAR_DN) / _SCALE
    peak = np.maximum(light.max(axis=(1, 2), keepdims=True), 1e-6)
    return np.stack([bent, light / peak], axis=1).astype(np.float32)


def chances(network: Network, frames: Floats) -> Floats:
    """(N, H, W) chance of each pixel to be lit by the Sun."""
    odds = network(channels(frames))[:, 0].astype(np.float64)
    found = 1.0 / (1.0 + np.exp(-np.clip(odds, -30.0, 30.0)))
    block = block_of(frames)
    return np.asarray(found.repeat(block, axis=1).repeat(block, axis=2))


def weights_of(board: str) -> Path:
    """Return the file of a data set's network."""
    return _WEIGHTS / f"{board}.npz"


@lru_cache(8)
def trained(board: str) -> Network:
    """Return a data set's network as it is kept."""
    return Network.load(weights_of(board))

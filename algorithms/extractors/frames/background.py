"""The level a frame has where no light of the spot falls, estimated from the frame itself."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.row_arithmetic import medians

Background = Literal["none", "border", "median"]
"""``none``: zero. ``border``: median of the outermost pixels, right while the spot keeps off the
edge. ``median``: median of all pixels, right while the spot covers less than half of them."""


def background_level(frames: NDArray[Any], background: Background) -> Floats:
    """Background of each frame (N,), in the frames' unit; NaN where a pixel used is NaN."""
    if background == "none":
        return np.zeros(len(frames))
    if background == "border":
        border = np.ones(frames.shape[1:], dtype=np.bool_)
        border[1:-1, 1:-1] = False
        pixels = frames[:, border]
    else:
        pixels = frames.reshape(len(frames), -1)
    with np.errstate(invalid="ignore", over="ignore"):
        return medians(pixels)

"""A square window that follows the spot, so that far pixels add no noise to its centroid."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

Windows = NDArray[np.int64]

MAX_MOVES = 10
"""Window moves after which the last centroid stands: a spot alone settles in two or three."""


def require_window(window_px: int | None, by: str) -> None:
    """Raise ValueError unless `window_px` is None or an odd number of pixels from 3 up."""
    if window_px is not None and (window_px < 3 or window_px % 2 == 0):
        raise ValueError(f"{by}: window_px must be None or odd and at least 3; got {window_px!r}")


def centred_windows(centres: Floats, window_px: int, height: int, width: int) -> Windows:
    """Half-open (first row, end row, first column, end column) around (x, y), cut at the edge."""
    half = window_px // 2
    x, y = np.rint(centres).astype(np.int64).T
    return np.column_stack(
        [
            np.clip(y - half, 0, height),
            np.clip(y + half + 1, 0, height),
            np.clip(x - half, 0, width),
            np.clip(x + half + 1, 0, width),
        ]
    )


def follow_spot(
    start: Floats, window_px: int, shape: tuple[int, int], centroid: Callable[[Windows], Floats]
) -> Floats:
    """Centroids in windows moved onto the centroid they give until they stay.

    Parameters
    ----------
    start : ndarray, shape (N, 2)
        First window centres (x, y), px.
    window_px : int
        Odd side of the window, px.
    shape : tuple of int
        Height and width of the frames.
    centroid : callable
        Centroids (N, 2) of all frames, given their windows (N, 4).

    Returns
    -------
    ndarray, shape (N, 2)
        (x, y) in frame coordinates, NaN rows where the window held nothing.
    """
    height, width = shape
    centres = start
    windows = centred_windows(centres, window_px, height, width)
    found = centroid(windows)
    for _ in range(MAX_MOVES):
        inside = (found >= 0) & (found <= np.array([width - 1, height - 1]))
        centres = np.where(inside.all(axis=1, keepdims=True), found, centres)
        moved = centred_windows(centres, window_px, height, width)
        if np.array_equal(moved, windows):
            break
        windows = moved
        found = centroid(windows)
    return found

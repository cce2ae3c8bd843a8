"""Each spot of a frame above a fraction of its own brightness: position and light."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.regions import SIDES_AND_CORNERS, flood

#: Share of a spot's lit pixels whose mean is its brightness.
_BRIGHTEST = 0.25


@compiled
def own_threshold(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    floors: Floats,
    levels: Floats,
    fraction: float,
    least: float,
    most: float,
    counts: NDArray[np.int64],
    spots: Floats,
) -> None:
    """Replace spots (N, S, 3) found above one level of a frame by those above their own.

    Position and light of the touching pixels above `floors` plus `fraction` of the mean of the
    spot's brightest quarter. Spots that then touch the edge, or have less than `least` or more
    than `most` pixels, are taken out; `counts` (N,) is how many there are.
    """
    height, width = frames.shape[1:]
    marks = np.zeros(height * width, dtype=np.int32)
    room = int(most)
    pixels = np.empty(max(room, 1), dtype=np.int64)
    values = np.empty(max(room, 1))
    mark = 0
    for k in range(frames.shape[0]):
        frame = frames[k]
        kept = 0
        for s in range(counts[k]):
            first = int(spots[k, s, 1] + 0.5) * width + int(spots[k, s, 0] + 0.5)
            level = levels[k]
            number = 0
            for _ in range(2):  # all of the spot, then what is above its own level
                mark += 1
                number, whole = flood(
                    frame, first, level, True, SIDES_AND_CORNERS, room, mark, marks, pixels
                )
                if number == 0 or not whole or not frame[first // width, first % width] > level:
                    number = 0
                    break
                for n in range(number):
                    values[n] = frame[pixels[n] // width, pixels[n] % width]
                top = max(int(_BRIGHTEST * number), 1)
                values[:number].sort()
                level = floors[k] + fraction * (values[number - top : number].mean() - floors[k])
            if number < least:
                continue
            level = max(level, floors[k])
            mark += 1
            number, whole = flood(
                frame, first, level, True, SIDES_AND_CORNERS, room, mark, marks, pixels
            )
            if number < least or not whole:
                continue
            light, x, y = 0.0, 0.0, 0.0
            for n in range(number):
                row = pixels[n] // width
                column = pixels[n] % width
                u = frame[row, column] - level
                light += u
                x += u * column
                y += u * row
            spots[k, kept, 0] = x / light
            spots[k, kept, 1] = y / light
            spots[k, kept, 2] = light
            kept += 1
        for s in range(kept, counts[k]):
            spots[k, s] = 0.0
        counts[k] = kept

"""Readings corrected by dark and relative gain, and bad pixels by their neighbours."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats


@compiled
def correct(  # noqa: PLR0917 - a kernel has no keywords
    readings: NDArray[Any],
    origin: NDArray[Any],
    dark: Floats,
    gain: Floats,
    full_scale: float,
    plateau: float,
    out: Floats,
) -> None:
    """Subtract the dark and divide by the gain where windows (N, H, W) at (x, y) show the detector.

    Readings from `full_scale` on become `plateau`.
    """
    count, height, width = readings.shape
    for y in range(height):  # of all windows: one detector's rows of dark and gain stay at hand
        for n in range(count):
            left, top = origin[n, 0], origin[n, 1]
            read, light = readings[n, y], out[n, y]
            lightless = dark[top + y, left : left + width]
            response = gain[top + y, left : left + width]
            for x in range(width):
                value = float(read[x])
                corrected = (value - lightless[x]) / response[x]
                light[x] = plateau if value >= full_scale else corrected


@compiled
def replace_bad(  # noqa: PLR0917 - as above
    values: Floats,
    origin: NDArray[Any],
    bad: NDArray[Any],
    places: NDArray[Any],
    down: int,
    across: int,
) -> None:
    """Put the mean of good neighbours in each bad pixel's place, 0 where there are none.

    `places` (B, 2) are the rows and columns of the bad pixels, `down` and `across` how far
    neighbours are looked for.
    """
    count, height, width = values.shape
    for n in range(count):
        left, top = origin[n, 0], origin[n, 1]
        for k in range(len(places)):
            y, x = places[k, 0] - top, places[k, 1] - left
            if not (0 <= y < height and 0 <= x < width):
                continue
            total, good = 0.0, 0
            for i in range(max(y - down, 0), min(y + down + 1, height)):
                for j in range(max(x - across, 0), min(x + across + 1, width)):
                    if not bad[top + i, left + j]:
                        total += values[n, i, j]
                        good += 1
            values[n, y, x] = total / good if good else 0.0

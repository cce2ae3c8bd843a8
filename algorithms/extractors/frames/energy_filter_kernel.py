"""Time-domain filter of a sequence of frames, pixel by pixel, with a gain set by what changes.

Frames are (N, H, W) arrays from `algorithms.inputs.as_frames`, in the order of time.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats


@compiled
def border_level(frame: NDArray[Any]) -> tuple[float, float]:
    """Mean and variance of the outermost pixels."""
    height, width = frame.shape
    first = float(frame[0, 0])
    total = 0.0
    squares = 0.0
    for i in range(height):
        step = 1 if i in {0, height - 1} else max(width - 1, 1)
        for j in range(0, width, step):
            u = float(frame[i, j]) - first
            total += u
            squares += u * u
    count = 2 * width + 2 * max(height - 2, 0)
    mean = total / count
    return first + mean, max(squares / count - mean * mean, 0.0)


@compiled
def energy_centre(energies: Floats, cut: float, spread: float, centre: Floats) -> int:
    """Write the centroid of what energies exceed a cut by to `centre` (2,); return how many do.

    Zero where they reach the border, are fewer than two, or lie further apart than one spot's: the
    ellipse of their second moments is more than `spread` times as large as they are. Even light
    fills its ellipse, however long it is drawn out; two spots leave most of it dark.
    """
    height, width = energies.shape
    light, light_x, light_y = 0.0, 0.0, 0.0
    pixels, pixels_x, pixels_y = 0, 0, 0
    squares_x, squares_y, products = 0, 0, 0
    for i in range(height):
        row = energies[i]
        for j in range(width):
            if row[j] > cut:
                if i in {0, height - 1} or j in {0, width - 1}:
                    return 0
                u = row[j] - cut
                light += u
                light_x += j * u
                light_y += i * u
                pixels += 1
                pixels_x += j
                pixels_y += i
                squares_x += j * j
                squares_y += i * i
                products += i * j
    if pixels < 2:
        return 0
    x, y = pixels_x / pixels, pixels_y / pixels
    extent = 1.0 / 12.0  # of a pixel itself
    xx = squares_x / pixels - x * x + extent
    yy = squares_y / pixels - y * y + extent
    xy = products / pixels - x * y
    if 4.0 * math.pi * math.sqrt(max(xx * yy - xy * xy, 0.0)) > spread * pixels:
        return 0
    centre[0] = light_x / light
    centre[1] = light_y / light
    return pixels


@compiled
def shift_of(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    energies: Floats,
    base: float,
    cut: float,
    information: Floats,
    shift: Floats,
) -> float:
    """Least-squares shift (x, y) of a frame against the energies; return a pixel's variance.

    Over the pixels above the cut, by the energies' slopes; `information` receives the sums of
    their products xx, xy, yy. NaN where the light there is not that of the energies within half.
    """
    height, width = energies.shape
    a_xx, a_xy, a_yy, b_x, b_y, squares = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    light, more, pixels = 0.0, 0.0, 0
    for i in range(1, height - 1):
        for j in range(1, width - 1):
            if energies[i, j] > cut:
                g_x = 0.5 * (energies[i, j + 1] - energies[i, j - 1])
                g_y = 0.5 * (energies[i + 1, j] - energies[i - 1, j])
                change = frame[i, j] - energies[i, j]
                a_xx += g_x * g_x
                a_xy += g_x * g_y
                a_yy += g_y * g_y
                b_x -= g_x * change
                b_y -= g_y * change
                squares += change * change
                light += energies[i, j] - base
                more += change
                pixels += 1
    information[0], information[1], information[2] = a_xx, a_xy, a_yy
    determinant = a_xx * a_yy - a_xy * a_xy
    if pixels < 4 or not determinant > 1e-12 * a_xx * a_yy or abs(more) > 0.5 * light:
        return math.nan
    shift[0] = (a_yy * b_x - a_xy * b_y) / determinant
    shift[1] = (a_xx * b_y - a_xy * b_x) / determinant
    explained = shift[0] * b_x + shift[1] * b_y
    return float(max(squares - explained, 0.0) / (pixels - 2))


@compiled
def size_of(shift: Floats, information: Floats) -> float:
    """Square of a shift in units of what a variance of one lets it scatter."""
    x, y = shift
    return float(information[0] * x * x + 2 * information[1] * x * y + information[2] * y * y)


@compiled
def filter_sequence(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    usable: NDArray[np.bool_],
    significance: float,
    fraction: float,
    spread: float,
    memory: int,
    drift: float,
    weight: float,
    out: Floats,
    lengths: NDArray[np.int64],
) -> None:
    """Write the centres of the filtered energies to `out` (N, 2), and of how many frames each is.

    A frame's energies are averaged with those before it, of at most `memory` frames and since the
    light moved: since a frame's shift, or the mean shift of late ones, each weighed by `weight`
    against those before, exceeded its variance by the factor `drift`. NaN and zero where a frame is
    not usable, which the filter passes over, or shows no spot, which starts it anew.
    """
    count, height, width = frames.shape
    energies = np.zeros((height, width))
    shift, mean_shift = np.zeros(2), np.zeros(2)
    information, centre = np.zeros(3), np.zeros(2)
    base, noise, cut = 0.0, 0.0, 0.0
    length = 0
    for k in range(count):
        out[k] = np.nan
        lengths[k] = 0
        if not usable[k]:
            continue
        frame = frames[k]
        if length > 0 and memory > 1:
            variance = shift_of(frame, energies, base, cut, information, shift)
            mean_shift += weight * (shift - mean_shift)
            # Late frames' mean varies by w / (2 - w) of one's, and the energies add their own.
            scatter = variance * (1.0 + 1.0 / length)
            moved = size_of(shift, information) > drift * scatter
            moved |= size_of(mean_shift, information) > drift * scatter * weight / (2 - weight)
            if moved or math.isnan(variance):
                length = 0
        level, variance = border_level(frame)
        if length == 0:
            mean_shift[:] = 0.0
            base, noise = 0.0, 0.0
        length = min(length + 1, memory)
        share = 1.0 / length
        base += share * (level - base)
        noise += share * (variance - noise)
        largest = -np.inf
        for i in range(height):
            for j in range(width):
                if length == 1:
                    energies[i, j] = frame[i, j]
                else:
                    energies[i, j] += share * (frame[i, j] - energies[i, j])
                largest = max(largest, energies[i, j])
        cut = base + max(significance * math.sqrt(noise * share), fraction * (largest - base))
        if largest > cut and energy_centre(energies, cut, spread, centre) > 0:
            out[k] = centre
            lengths[k] = length
        else:
            length = 0

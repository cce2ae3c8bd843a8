"""Compiled readings of pixels near light (loaded on first use: Numba)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Places = NDArray[np.int32]


@compiled
def mark_boxes(near: NDArray[np.bool_], boxes: NDArray[np.int64], margin: int) -> None:
    """Mark the pixels (rows, columns) of boxes (B, 4), first and past-last column and row.

    And so many beside them.
    """
    rows, columns = near.shape
    for left, right, top, bottom in boxes:
        if right <= left or bottom <= top:
            continue
        for row in range(max(top - margin, 0), min(bottom + margin, rows)):
            near[row, max(left - margin, 0) : min(right + margin, columns)] = True


@compiled
def list_items(
    pixels: Places, near: NDArray[np.bool_], unit: tuple[Floats, Floats], sums: Floats
) -> int:
    """List the marked pixels, and sum up the others.

    Parameters
    ----------
    pixels
        (rows columns,): first of it are places in the flattened frame, as many as returned.
    near
        (rows, columns) marks; taken back.
    unit
        Two of (rows, columns).
    sums
        (3, columns): number of the others, and sums of both over them.
    """
    one, two = unit
    count = 0
    sums[:] = 0.0
    for row in range(near.shape[0]):
        for column in range(near.shape[1]):
            if near[row, column]:
                pixels[count] = row * near.shape[1] + column
                count += 1
                near[row, column] = False
            else:
                sums[0, column] += 1.0
                sums[1, column] += one[row, column]
                sums[2, column] += two[row, column]
    return count


@compiled
def take(out: NDArray[np.float32], frame: Floats, pixels: Places, share: float) -> None:
    """Write the light of some pixels of a frame, after crosstalk.

    Parameters
    ----------
    out
        (P,), overwritten up to the first pixel below 0.
    frame
        (rows, columns) light.
    pixels
        (P,) places in the flattened frame; -1 for none, last.
    share
        Of a pixel's light that its four neighbours collect; light goes on beyond the edges.
    """
    rows, columns = frame.shape
    for k in range(pixels.shape[0]):
        if pixels[k] < 0:
            break
        y, x = divmod(pixels[k], columns)
        light = frame[y, x]
        if share > 0.0:
            around = frame[max(y - 1, 0), x] + frame[min(y + 1, rows - 1), x]
            around += frame[y, max(x - 1, 0)] + frame[y, min(x + 1, columns - 1)]
            light = (1.0 - share) * light + share / 4.0 * around
        out[k] = light


@compiled
def column_light(
    out: Floats, light: NDArray[np.float32], earth: Floats, pixels: Places, levels: Floats
) -> None:
    """Add what falls on the listed pixels of every column, (N, columns).

    Parameters
    ----------
    out
        (N, columns), added to.
    light, earth, pixels
        (N, P) of mean sunlight, of other light, and places in the flattened frame.
    levels
        (N, 2) sunlight and even stray light.
    """
    columns = out.shape[1]
    for n in range(pixels.shape[0]):
        for k in range(pixels.shape[1]):
            if pixels[n, k] < 0:
                break
            seen = light[n, k] * levels[n, 0] + levels[n, 1] + earth[n, k]
            out[n, pixels[n, k] % columns] += seen


@compiled
def read_out(
    out: Floats,
    light: tuple[NDArray[np.float32], Floats, Floats, Floats],
    pixels: Places,
    unit: tuple[Floats, Floats, Floats],
    numbers: tuple[float, float, float, float],
) -> None:
    """Write mean digital numbers of the listed pixels, (N, P) of a wider array; 0 for none.

    Parameters
    ----------
    out
        (N, P or more), overwritten in its first P columns.
    light
        (N, P) of mean sunlight, (N, P) of other light; what smear adds in every column
        (N, columns), or (N, 0) for nothing; (N, 2) sunlight and even stray light.
    pixels
        (N, P) places in the flattened frame; -1 for none, last.
    unit
        (N, P) electrons a unit of light, and dark ones; (columns,) electrons of the amplifiers.
    numbers
        Full well, electrons; share of an electron that each other one takes (non-linearity);
        electrons a digital number; offset.
    """
    lit, earth, smear, levels = light
    gain, dark, amplifiers = unit
    well, bend, per_number, offset = numbers
    columns = amplifiers.shape[0]
    for n in range(pixels.shape[0]):
        for k in range(pixels.shape[1]):
            place = pixels[n, k]
            if place < 0:
                out[n, k] = 0.0
                continue
            seen = lit[n, k] * levels[n, 0] + levels[n, 1] + earth[n, k]
            column = place % columns
            if smear.shape[1] > 0:
                seen += smear[n, column]
            electrons = min(seen * gain[n, k] + dark[n, k], well)
            electrons *= 1.0 - bend * electrons
            out[n, k] = (electrons + amplifiers[column]) / per_number + offset

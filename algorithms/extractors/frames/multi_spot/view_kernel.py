"""What a frame shows of a mask's apertures under each displacement: spots, darkness, cut spots."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.records import (
    Flags,
    Matches,
    Partners,
    Seen,
    States,
    Views,
)

#: What a frame shows of an aperture: less than half of its place, neither its spot nor darkness,
#: its spot, darkness or a spot of another place. `evidence_kernel` reads them.
OUT, UNSURE, SPOT, DARK = 0, 1, 2, 3
#: Share of lit pixels at an aperture's place below which it is dark: a hot one is no spot.
_LIT = 0.25
#: A spot with less than this share of the usual light may be a reflection.
_DIM = 0.8


@compiled
def is_whole(x: float, y: float, half: float, height: int, width: int) -> bool:
    """Whether a spot of this half width is whole in the frame; not where it is NaN."""
    return half <= x < width - 1 - half and half <= y < height - 1 - half


@compiled
def _is_dark(frame: NDArray[Any], level: float, x: float, y: float, radius: float) -> bool:
    """Whether few of the pixels within `radius` of (x, y) are above the level."""
    height, width = frame.shape
    lit = 0
    pixels = 0
    for i in range(max(math.ceil(y - radius), 0), min(math.floor(y + radius), height - 1) + 1):
        side = math.sqrt(max(radius * radius - (i - y) * (i - y), 0.0))
        for j in range(max(math.ceil(x - side), 0), min(math.floor(x + side), width - 1) + 1):
            pixels += 1
            lit += frame[i, j] > level
    return lit < _LIT * pixels


@compiled
def _is_near(spots: Floats, x: float, y: float, radius: float) -> bool:
    """Whether the middle of a whole spot is within `radius` of (x, y)."""
    for s in range(spots.shape[0]):
        dx = spots[s, 0] - x
        dy = spots[s, 1] - y
        if dx * dx + dy * dy < radius * radius:
            return True
    return False


@compiled
def _look(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: NDArray[Any],
    level: float,
    apertures: Floats,
    margin: float,
    x: float,
    y: float,
    spots: Floats,
    partner: Partners,
    state: States,
) -> tuple[int, int]:
    """Write what the frame shows of each aperture; return how many spots, and whole places."""
    height, width = frame.shape
    found = 0
    whole = 0
    for a in range(apertures.shape[0]):
        px = apertures[a, 0] + x
        py = apertures[a, 1] + y
        half = 0.5 * apertures[a, 2]
        whole += is_whole(px, py, half + margin, height, width)
        if partner[a] >= 0:
            state[a] = SPOT
            found += 1
        elif not (1.0 <= px <= width - 2.0 and 1.0 <= py <= height - 2.0):
            state[a] = OUT
        elif _is_dark(frame, level, px, py, max(half - 1.0, 1.0)) or _is_near(spots, px, py, half):
            state[a] = DARK
        else:
            state[a] = UNSURE
    return found, whole


@compiled
def _cut_partners(  # noqa: PLR0917 - Numba takes no keyword-only ones
    cuts: Floats, apertures: Floats, x: float, y: float, margin: float, dim: float, out: Partners
) -> None:
    """Write the aperture that each spot cut by the edge lies on, -1 for none or a dim one."""
    for c in range(out.size):
        out[c] = -1
        if cuts[c, 2] < dim:
            continue
        for a in range(apertures.shape[0]):
            reach = 0.5 * apertures[a, 2] + margin
            dx = cuts[c, 0] - apertures[a, 0] - x
            dy = cuts[c, 1] - apertures[a, 1] - y
            if dx * dx + dy * dy < reach * reach:
                out[c] = a
                break


@compiled
def _usual(spots: Floats, partner: Partners, bright: Flags) -> float:
    """Mark the spots (S,) that are not much dimmer than those of the pattern; return the limit.

    Compared is the light of a lit pixel, which does not depend on an aperture's size, and that of
    the spot, which does not depend on where a small one falls on its pixels: dim ones lack both.
    """
    lights = np.empty((2, partner.size))
    number = 0
    for a in range(partner.size):
        if partner[a] >= 0:
            lights[0, number] = spots[partner[a], 3] / spots[partner[a], 2]
            lights[1, number] = spots[partner[a], 3]
            number += 1
    least = _DIM * np.median(lights[0, :number])
    whole = _DIM * np.median(lights[1, :number])
    for s in range(bright.size):
        bright[s] = spots[s, 3] >= least * spots[s, 2] or spots[s, 3] >= whole
    return float(least)


@compiled
def look(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    levels: Floats,
    seen: Seen,
    apertures: Floats,
    margin: float,
    share: float,
    matches: Matches,
    views: Views,
) -> None:
    """Write what each frame shows under the displacements that match most of its spots.

    Parameters
    ----------
    levels
        (N,) above which a pixel of the frames (N, H, W) is lit.
    seen, apertures, matches
        The frames' spots; (A, 3) x, y, width; displacements.
    margin
        Px that a spot reaches beyond its aperture.
    share
        Least share of the spots that should be whole in the frame.
    views
        Receives what is seen.
    """
    for k in range(frames.shape[0]):
        if matches.kept[k] == 0:
            continue
        spots = seen.spots[k, : seen.counts[k]]
        cut = seen.cuts[k, : seen.cut_counts[k]]
        dim = _usual(spots, matches.partners[k, 0], views.bright[k, : spots.shape[0]])
        for h in range(matches.kept[k]):
            x, y = matches.places[k, h]
            partner, state = matches.partners[k, h], views.states[k, h]
            found, whole = _look(
                frames[k], levels[k], apertures, margin, x, y, spots, partner, state
            )
            views.enough[k, h] = found >= share * whole
            _cut_partners(cut, apertures, x, y, margin, dim, views.cut_to[k, h, : cut.shape[0]])

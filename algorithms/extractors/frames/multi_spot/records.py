"""What the stages of `aperture_pattern.find_pattern` hand on: masks, spots, matches and views.

N frames have S spots each at most, C of them cut by the edge; a mask has A apertures, of which K
displacements are compared.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

Indices = NDArray[np.int64]
Partners = NDArray[np.int32]
States = NDArray[np.int8]
Flags = NDArray[np.bool_]


class Lattice(NamedTuple):
    """The apertures of a mask, and which of them is near a point.

    Attributes
    ----------
    apertures
        (A, 3) x, y from the middle of the mask, and width, px.
    table
        (R, C) the aperture in a cell, -1 for none.
    corner, cell_px
        (2,) of the table's first cell; length of a side.
    nearest_px
        Least distance of two apertures, infinite for one.
    lines
        (2, A) in which column and row each is.
    """

    apertures: Floats
    table: Indices
    corner: Floats
    cell_px: float
    nearest_px: float
    lines: Indices


class Seen(NamedTuple):
    """Spots of frames.

    Attributes
    ----------
    spots, counts
        (N, S, 4) mean x and y of whole ones, weighted by the light above the level, the number of
        pixels and that light; (N,) how many there are.
    cuts, cut_counts
        (N, C, 3) mean x and y of those that the edge cuts, the light of a pixel; how many.
    """

    spots: Floats
    counts: Indices
    cuts: Floats
    cut_counts: Indices


class Matches(NamedTuple):
    """Displacements of the mask that match most of a frame's spots, best first.

    Attributes
    ----------
    places
        (N, K, 2) x and y.
    partners
        (N, K, A) spot of each aperture, -1 for none.
    kept
        (N,) how many displacements there are.
    """

    places: Floats
    partners: Partners
    kept: Indices


class Views(NamedTuple):
    """What frames show under each displacement.

    Attributes
    ----------
    states
        (N, K, A) `view_kernel.OUT`, `UNSURE`, `SPOT` or `DARK` of each aperture.
    cut_to
        (N, K, C) aperture on which each bright spot that the edge cuts lies, or -1.
    bright
        (N, S) which spots are not much dimmer than those of the first displacement.
    enough
        (N, K) whether the least share of the spots is found.
    """

    states: States
    cut_to: Partners
    bright: Flags
    enough: Flags


class FrameView(NamedTuple):
    """What one frame shows under each of H displacements.

    Attributes
    ----------
    spots, places
        (S, 4) and (H, 2).
    partners, cut_to, states, bright
        (H, A), (H, C), (H, A) and (S,): see `Matches` and `Views`.
    near, numbers
        (H, A) the apertures in view or with a cut spot, rising, and (H,) how many these are.
    shown
        (H, 2, A) apertures in view of each column and row.
    outside
        (H,) price of a Sun out of the field.
    """

    spots: Floats
    places: Floats
    partners: Partners
    cut_to: Partners
    states: States
    bright: Flags
    near: Indices
    numbers: Indices
    shown: Indices
    outside: Floats


class Work(NamedTuple):
    """Work space for spots (S,), apertures (A,) and lines of them (L,) and (2, L)."""

    owner: Indices
    taken: Flags
    faults: Flags
    faulty: Indices
    beside: Indices
    limit: Floats
    sums: Floats

"""Match spots to the apertures that cast them: the displacements that explain most of them."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.records import (
    Indices,
    Lattice,
    Matches,
    Partners,
    Seen,
)
from algorithms.kernels.copies import copy_row

Votes = NDArray[np.int16]

#: Displacements tried, those that most pairs of a spot and an aperture vote for.
_CANDIDATES = 64
#: Qualities that differ by less are equal: of displacements by whole periods of a mask they are, up
#: to rounding, which must not choose those that are compared. The one with more votes is first.
_EQUAL = 1e-6
#: Rounds of matching and averaging; the first reaches further, by _REACH tolerances.
_ROUNDS = 4
_REACH = 2.0


@compiled
def nearest_aperture(lattice: Lattice, x: float, y: float, reach: float) -> tuple[int, float]:
    """Aperture nearest to a point within `reach`, and its squared distance; -1 for none."""
    table, corner, cell = lattice.table, lattice.corner, lattice.cell_px
    best = -1
    least = reach * reach
    top = max(math.floor((y - reach - corner[1]) / cell), 0)
    bottom = min(math.floor((y + reach - corner[1]) / cell) + 1, table.shape[0])
    left = max(math.floor((x - reach - corner[0]) / cell), 0)
    right = min(math.floor((x + reach - corner[0]) / cell) + 1, table.shape[1])
    for i in range(top, bottom):
        for j in range(left, right):
            a = table[i, j]
            if a >= 0:
                dx = x - lattice.apertures[a, 0]
                dy = y - lattice.apertures[a, 1]
                distance = dx * dx + dy * dy
                if distance < least:
                    least = distance
                    best = a
    return best, least


@compiled
def _cast(spots: Floats, apertures: Floats, cell: float, ballot: Votes, touched: Indices) -> int:
    """Add the vote of each pair of spot and aperture; write the cells voted for, return how many.

    A pair votes for its displacement; `ballot` starts one cell below the least there can be.
    """
    flat = ballot.ravel()
    low_x = apertures[:, 0].max()
    low_y = apertures[:, 1].max()
    cells = 0
    for s in range(spots.shape[0]):
        for a in range(apertures.shape[0]):
            j = int((spots[s, 0] - apertures[a, 0] + low_x) / cell) + 1
            i = int((spots[s, 1] - apertures[a, 1] + low_y) / cell) + 1
            at = i * ballot.shape[1] + j
            if flat[at] == 0:
                touched[cells] = at
                cells += 1
            flat[at] += 1
    return cells


@compiled
def _around(ballot: Votes, at: int) -> int:
    """Votes of a cell and its eight neighbours."""
    i, j = at // ballot.shape[1], at % ballot.shape[1]
    votes = 0
    for line in range(i - 1, i + 2):
        for column in range(j - 1, j + 2):
            votes += ballot[line, column]
    return votes


@compiled
def _is_peak(ballot: Votes, at: int) -> bool:
    """Whether no neighbour of a cell has more votes, and none before it as many."""
    i, j = at // ballot.shape[1], at % ballot.shape[1]
    for line in range(i - 1, i + 2):
        for column in range(j - 1, j + 2):
            other = ballot[line, column]
            before = line < i or (line == i and column < j)
            if other > ballot[i, j] or (before and other == ballot[i, j]):
                return False
    return True


@compiled
def _rank(ballot: Votes, touched: Indices, arounds: Votes, best: Indices, votes: Indices) -> int:
    """Write the peaks of the ballot with most votes around them to `best`; return how many.

    Those with less than a third of the most are chance pairs. `arounds` is room for the votes
    around each cell touched: the ballot is larger than a cache.
    """
    most = 0
    for place in range(touched.size):
        arounds[place] = _around(ballot, touched[place])
        most = max(most, arounds[place])
    kept = 0
    for number in range(touched.size):
        at = touched[number]
        around = arounds[number]
        full = kept == best.size
        if around < max(most // 3, 1) or (full and around <= votes[kept - 1]):
            continue
        if not _is_peak(ballot, at):
            continue
        place = kept - 1 if full else kept
        while place > 0 and votes[place - 1] < around:
            votes[place] = votes[place - 1]
            best[place] = best[place - 1]
            place -= 1
        votes[place] = around
        best[place] = at
        kept = min(kept + 1, best.size)
    return kept


@compiled
def _pair(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats,
    lattice: Lattice,
    x: float,
    y: float,
    reach: float,
    partner: Indices,
    distance: Floats,
    matched: Indices,
) -> int:
    """Write the nearest spot of each aperture moved by (x, y), and which have one, rising."""
    number = 0
    for s in range(spots.shape[0]):
        a, squared = nearest_aperture(lattice, spots[s, 0] - x, spots[s, 1] - y, reach)
        if a < 0 or (partner[a] >= 0 and not squared < distance[a]):
            continue
        if partner[a] < 0:
            at = number
            while at > 0 and matched[at - 1] > a:
                matched[at] = matched[at - 1]
                at -= 1
            matched[at] = a
            number += 1
        partner[a] = s
        distance[a] = squared
    return number


@compiled
def _fit(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats,
    lattice: Lattice,
    x: float,
    y: float,
    tolerance: float,
    partner: Indices,
    distance: Floats,
    matched: Indices,
) -> tuple[float, float, float, int]:
    """Displacement near (x, y) under which spots lie on apertures, its quality and their number.

    `partner` (A,) receives the spot of each aperture, or -1, and `matched` (S,) which have one. The
    quality is the sum over these of one less their squared distance in tolerances.
    """
    number = 0
    quality = 0.0
    partner[:] = -1
    for turn in range(_ROUNDS):
        reach = tolerance * (_REACH if turn == 0 else 1.0)
        for n in range(number):
            partner[matched[n]] = -1
        number = _pair(spots, lattice, x, y, reach, partner, distance, matched)
        quality = 0.0
        sum_x = 0.0
        sum_y = 0.0
        for a in matched[:number]:
            quality += 1.0 - distance[a] / (reach * reach)
            sum_x += spots[partner[a], 0] - lattice.apertures[a, 0]
            sum_y += spots[partner[a], 1] - lattice.apertures[a, 1]
        if number == 0:
            break
        if turn < _ROUNDS - 1:
            before_x, before_y = x, y
            x = sum_x / number
            y = sum_y / number
            if turn > 0 and x == before_x and y == before_y:
                break  # another round would find the same
    return x, y, quality, number


@compiled
def _distinct(places: Floats, number: int, x: float, y: float, tolerance: float) -> bool:
    """Whether none of the first `number` places is the same as (x, y)."""
    for c in range(number):
        if abs(places[c, 0] - x) < tolerance and abs(places[c, 1] - y) < tolerance:
            return False
    return True


@compiled
def _explanations(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats,
    lattice: Lattice,
    tolerance: float,
    slack: float,
    starts: Floats,
    votes: Indices,
    places: Floats,
    partners: Partners,
) -> int:
    """Write the displacements near `starts` (C, 2) that match most spots; return how many.

    `votes` (C,), in falling order, are the most spots that a start can match; `places` (K, 2) and
    `partners` (K, A) receive displacements and matches, best first.
    """
    room, number = partners.shape
    partner, distance = np.empty(number, dtype=np.int64), np.empty(number)
    met = np.empty(spots.shape[0], dtype=np.int64)
    score = np.empty(room)
    kept = 0
    most = 0
    for c in range(votes.size):
        if votes[c] < most - slack or (kept == room and votes[c] <= score[kept - 1]):
            break  # no spot adds more than one
        x, y, quality, matched = _fit(
            spots, lattice, starts[c, 0], starts[c, 1], tolerance, partner, distance, met
        )
        most = max(most, matched)
        if matched == 0 or not _distinct(places, kept, x, y, tolerance):
            continue
        if kept == room and quality <= score[kept - 1] + _EQUAL:
            continue
        at = kept - 1 if kept == room else kept
        while at > 0 and score[at - 1] < quality - _EQUAL:
            score[at] = score[at - 1]
            copy_row(places[at - 1], places[at])
            copy_row(partners[at - 1], partners[at])
            at -= 1
        score[at] = quality
        places[at, 0] = x
        places[at, 1] = y
        for a in range(number):
            partners[at, a] = partner[a]
        kept = min(kept + 1, room)
    return kept


@compiled
def match(  # noqa: PLR0917 - Numba takes no keyword-only ones
    seen: Seen,
    lattice: Lattice,
    frame: tuple[int, int],
    tolerance: float,
    slack: float,
    matches: Matches,
) -> None:
    """Find the displacements of the apertures that match most of each frame's spots.

    Which of them it is, `evidence_kernel.decide` tells.

    Parameters
    ----------
    seen, lattice
        The frames' spots and the mask.
    frame
        Height and width.
    tolerance
        Largest distance of a spot from its place, px.
    slack
        Spots that a displacement may match less than the best one: others are out of question.
    matches
        Receives the displacements, by falling quality of the match (see `_fit`).
    """
    height, width = frame
    apertures, counts = lattice.apertures, seen.counts
    low_x = apertures[:, 0].max()
    low_y = apertures[:, 1].max()
    wide = width + low_x - apertures[:, 0].min()
    high = height + low_y - apertures[:, 1].min()
    ballot = np.zeros((int(high / tolerance) + 4, int(wide / tolerance) + 4), dtype=np.int16)
    touched = np.empty(max(counts.max(), 1) * apertures.shape[0], dtype=np.int64)
    arounds = np.empty(touched.size, dtype=np.int16)
    best = np.empty(_CANDIDATES, dtype=np.int64)
    votes = np.empty(_CANDIDATES, dtype=np.int64)
    starts = np.empty((_CANDIDATES, 2))
    for k in range(counts.size):
        matches.kept[k] = 0
        if counts[k] < 1:
            continue
        spots = seen.spots[k, : counts[k]]
        cells = _cast(spots, apertures, tolerance, ballot, touched)
        candidates = _rank(ballot, touched[:cells], arounds, best, votes)
        for at in touched[:cells]:
            ballot.ravel()[at] = 0
        for c in range(candidates):
            starts[c, 0] = (best[c] % ballot.shape[1] - 0.5) * tolerance - low_x
            starts[c, 1] = (best[c] // ballot.shape[1] - 0.5) * tolerance - low_y
        matches.kept[k] = _explanations(
            spots,
            lattice,
            tolerance,
            slack,
            starts[:candidates],
            votes[:candidates],
            matches.places[k],
            matches.partners[k],
        )

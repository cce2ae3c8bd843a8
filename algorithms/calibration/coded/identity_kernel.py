"""Which part of a coded mask a list of spots shows: hypotheses, and the one of fewest faults.

A hypothesis is a displacement of the mask on the detector. It explains a spot that falls where it
has an aperture; its faults are the spots it leaves unexplained and the apertures in view that it
finds dark. `algorithms.calibration.coded.table` makes the arguments: spots (K, 3), x and y in px
and the logarithm of the width of an aperture with their light; `Code`, the apertures by y,
their cells and the table of spacings; and the view, the detector and how far light reaches on it.
`Room` holds hypotheses (H, 3), displacement and logarithm of light's width over the apertures', how
many spots they leave (H,), and the aperture of each spot (K,).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.kernels.copies import copy_row

Indices = NDArray[np.int64]
Room = tuple[Floats, Indices, Indices]
Code = tuple[Floats, Indices, Floats, Indices, Indices, Floats]

#: Pairs of neighbouring spots that are looked up, the rarest spacings first.
_PAIRS = 10
#: Spots that the correlation's peak is looked for from.
_ANCHORS = 4
#: Spots left unexplained by a peak that is looked for before lower ones.
_HIGH = 1


@compiled
def leave(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats, count: int, room: Room, number: int, most: int, slack: int, code: Code
) -> None:
    """Write how many spots each of the first `number` hypotheses leaves unexplained.

    Where more than `most` are left, or than the fewest yet and `slack`, it may be any number above.
    """
    places, cells, grid, _, _, _ = code
    trials, left, _ = room
    corner_x, corner_y, cells_px, tolerance, size = grid
    rows, columns = cells.shape
    for h in range(number):
        over = 0
        for s in range(count):
            x = spots[s, 0] - trials[h, 0]
            y = spots[s, 1] - trials[h, 1]
            # cells at the rim are empty; no branch depends on what is found, which is random
            i = min(max(int((y - corner_y) * cells_px), 0), rows - 1)
            j = min(max(int((x - corner_x) * cells_px), 0), columns - 1)
            a = cells[i, j]
            k = max(a, 0)
            over += 1 - int(
                (a >= 0)
                & (abs(places[k, 0] - x) <= tolerance)
                & (abs(places[k, 1] - y) <= tolerance)
                & (abs(spots[s, 2] - places[k, 2] - trials[h, 2]) <= size)
            )
            if over > most:
                break
        left[h] = over
        most = min(most, over + slack)


@compiled
def partners_of(spots: Floats, count: int, at: Floats, code: Code, partners: Indices) -> int:
    """Write each spot's aperture by one hypothesis, or -1; return how many have none."""
    places, cells, grid, _, _, _ = code
    left = 0
    for s in range(count):
        x = spots[s, 0] - at[0]
        y = spots[s, 1] - at[1]
        i = min(max(int((y - grid[1]) * grid[2]), 0), cells.shape[0] - 1)
        j = min(max(int((x - grid[0]) * grid[2]), 0), cells.shape[1] - 1)
        a = cells[i, j]
        if a >= 0 and not (
            abs(places[a, 0] - x) <= grid[3]
            and abs(places[a, 1] - y) <= grid[3]
            and abs(spots[s, 2] - places[a, 2] - at[2]) <= grid[4]
        ):
            a = -1
        for earlier in range(s if a >= 0 else 0):  # a hole casts one spot: a piece tells nothing
            if partners[earlier] == a:
                a = -1
                break
        partners[s] = a
        left += a < 0
    return left


@compiled
def find_dark(  # noqa: PLR0917 - Numba takes no keyword-only ones
    count: int, at: Floats, most: int, code: Code, view: Floats, partners: Indices
) -> int:
    """Apertures well in view of which no spot is seen; stops after more than `most`."""
    places = code[0]
    slope = ((at[0] - view[2]) ** 2 + (at[1] - view[3]) ** 2) / view[4] ** 2
    margin = view[5] + view[6] * (1.0 + slope)
    closed = 0
    first, last = 0, places.shape[0]
    while first < last:  # the first that is not above the view
        middle = (first + last) // 2
        if places[middle, 1] + at[1] < margin:
            first = middle + 1
        else:
            last = middle
    for a in range(first, places.shape[0]):
        if places[a, 1] + at[1] > view[1] - 1 - margin:
            break
        if not margin <= places[a, 0] + at[0] <= view[0] - 1 - margin:
            continue
        seen = False
        for s in range(count):
            seen |= partners[s] == a
        closed += not seen
        if closed > most:
            break
    return closed


@compiled
def are_near(spots: Floats, i: int, j: int, reach: float) -> bool:
    """Whether two spots are within reach of each other along both axes."""
    return bool(abs(spots[j, 0] - spots[i, 0]) <= reach and abs(spots[j, 1] - spots[i, 1]) <= reach)


@compiled
def _entries(spots: Floats, i: int, j: int, line: int, code: Code) -> tuple[int, int]:
    """First and past-last entry of the table in row `line` (0 to 2) around a spacing."""
    table = code[5]
    row = int((spots[j, 1] - spots[i, 1] + table[0]) / table[1]) + line
    cell = row * int(table[3]) + int((spots[j, 0] - spots[i, 0] + table[0]) / table[1])
    return code[3][cell], code[3][cell + 3]


@compiled
def spacings(spots: Floats, i: int, j: int, code: Code) -> int:
    """Count the mask's pairs that may be as far apart as two spots."""
    number = 0
    for line in range(3):
        first, last = _entries(spots, i, j, line, code)
        number += last - first
    return number


@compiled
def name_of(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats, i: int, j: int, own: int, code: Code, trials: Floats
) -> int:
    """Write the hypotheses that the spacing of two spots names, but `own` aperture's; how many."""
    places, grid, pairs, table = code[0], code[2], code[4], code[5]
    number = 0
    for line in range(3):
        first, last = _entries(spots, i, j, line, code)
        for entry in range(first, last):
            a = pairs[entry, 0]
            b = pairs[entry, 1]
            if a == own or number == len(trials):
                continue
            fits = True
            for axis in range(3):
                here = spots[i, axis] - places[a, axis]
                there = spots[j, axis] - places[b, axis]
                fits &= abs(there - here) <= (table[2] if axis < 2 else 2.0 * grid[4])
                trials[number, axis] = 0.5 * (here + there)
            if fits:
                number += 1
    return number


@compiled
def places_of_spot(spots: Floats, i: int, own: int, code: Code, trials: Floats) -> int:
    """Write the hypotheses that one spot allows, but `own` aperture's; return how many."""
    number = 0
    for a in range(code[0].shape[0]):
        if a != own:
            for axis in range(3):
                trials[number, axis] = spots[i, axis] - code[0][a, axis]
            number += 1
    return number


@compiled
def _rarest(spots: Floats, count: int, code: Code, rare: Indices) -> int:
    """Write hits and spots of the neighbours whose spacing is on the mask least often."""
    found = 0
    for i in range(count):
        for j in range(i + 1, count):
            if not are_near(spots, i, j, code[5][0]):
                continue
            number = spacings(spots, i, j, code)
            if number == 0 or (found == len(rare) and number >= rare[found - 1, 0]):
                continue
            k = min(found, len(rare) - 1)
            found = k + 1
            while k > 0 and rare[k - 1, 0] > number:
                rare[k] = rare[k - 1]
                k -= 1
            rare[k, 0] = number
            rare[k, 1] = i
            rare[k, 2] = j
    return found


@compiled
def room_for(lists: Floats, code: Code) -> Room:
    """Room for as many hypotheses as apertures."""
    return (
        np.empty((len(code[0]), 3)),
        np.empty(len(code[0]), dtype=np.int64),
        np.empty(lists.shape[1], dtype=np.int64),
    )


@compiled
def _improve(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats,
    count: int,
    room: Room,
    number: int,
    most: int,
    code: Code,
    view: Floats,
    best: int,
    found: Floats,
) -> int:
    """Faults of the best hypothesis after those in `room`; `found` is where it is."""
    trials, left, partners = room
    fewest = min(most, best - 1)
    leave(spots, count, room, number, fewest, 0, code)
    for h in range(number):
        fewest = min(fewest, left[h])
    for h in range(number):
        if left[h] == fewest and fewest < best:
            partners_of(spots, count, trials[h], code, partners)
            faults = fewest + find_dark(count, trials[h], best - fewest, code, view, partners)
            if faults < best:
                best = faults
                copy_row(trials[h], found)
    return best


@compiled
def search_spacings(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lists: Floats,
    counts: Indices,
    code: Code,
    view: Floats,
    share: float,
    found: Floats,
    faults: Indices,
) -> None:
    """Write each list's place of fewest faults (N, 3), of those that rare spacings name.

    Of places that explain at least `share` of the spots; NaN where there is none.
    """
    rare = np.empty((_PAIRS, 3), dtype=np.int64)
    room = room_for(lists, code)
    for k in range(lists.shape[0]):
        spots, count = lists[k], counts[k]
        best = count + len(code[0])
        most = int((1.0 - share) * count)
        found[k] = math.nan
        for pair in range(_rarest(spots, count, code, rare)):
            if best == 0:
                break
            number = name_of(spots, rare[pair, 1], rare[pair, 2], -1, code, room[0])
            best = _improve(spots, count, room, number, most, code, view, best, found[k])
        faults[k] = best


@compiled
def search_correlation(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lists: Floats,
    counts: Indices,
    code: Code,
    view: Floats,
    share: float,
    found: Floats,
    faults: Indices,
) -> None:
    """Write each list's place of fewest faults (N, 3), of the correlation's highest peaks.

    The correlation of spots and apertures is the number of spots explained. It is above zero only
    where a spot falls on an aperture: it is looked at where one of the first few spots does, until
    a higher peak would explain one of those before. As `search_spacings` otherwise.
    """
    room = room_for(lists, code)
    for k in range(lists.shape[0]):
        spots, count = lists[k], counts[k]
        best = count + len(code[0])
        all_left = int((1.0 - share) * count)
        found[k] = math.nan
        for most in (min(_HIGH, all_left), all_left):
            for s in range(min(count, _ANCHORS)):
                if best <= s:
                    break
                number = places_of_spot(spots, s, -1, code, room[0])
                best = _improve(spots, count, room, number, most, code, view, best, found[k])
        faults[k] = best

"""Which displacement of a mask a frame shows: what is lit and what is dark under each."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.view_kernel import DARK, OUT

Indices = NDArray[np.int64]
Partners = NDArray[np.int32]
States = NDArray[np.int8]
Flags = NDArray[np.bool_]

#: What `decide` says of a frame: an answer, no pattern found, several that it may be, and an answer
#: that it is not, should lines be seen twice in full light.
FOUND, NOTHING, SEVERAL, DOUBTFUL = 0, 1, 2, 3
#: Price of a dark line of apertures, and of one of it: one over those in view, within limits.
_DARKNESS, _DARK_ONE = 1.0, (0.25, 0.34)
#: The same of lit ones that a displacement leaves unexplained: no reflection is as bright as they.
#: For a doubt suffices a line of them that may be one of its own seen twice: as a dark one.
_LIGHT, _LIGHT_ONE, _DOUBLED = 2.0, (0.8, 0.8), 1.0
#: The same of a Sun out of the field.
_OUTSIDE = 1.0
#: By how much more than the faults allowed a rival must cost: no more than a spot beside its place.
_CLEAR = 0.04
_EVEN = 1e-9  # rounding speaks for none of two displacements


@compiled
def _price(  # noqa: PLR0917 - Numba takes no keyword-only ones
    faults: Flags,
    lines: Indices,
    shown: Indices,
    line: float,
    limits: tuple[float, float],
    limit: Floats,
    sums: Floats,
) -> float:
    """Price of the faulty, in columns or rows as is cheaper; that of a line has a limit (2, A)."""
    least, most = limits
    best = math.inf
    for axis in range(2):
        sums[:] = 0.0
        for a in range(faults.size):
            if faults[a]:
                one = line / max(shown[axis, lines[axis, a]], 1)
                sums[lines[axis, a]] += min(max(one, least), most)
        total = 0.0
        for a in range(sums.size):
            total += min(sums[a], limit[axis, a])
        best = min(best, total)
    return best


@compiled
def _dark_alone(  # noqa: PLR0917 - Numba takes no keyword-only ones
    state: States,
    partner: Partners,
    bright: Flags,
    apertures: Floats,
    away_x: float,
    away_y: float,
    near: float,
    faults: Flags,
) -> bool:
    """Mark the dark places of one displacement where the other, `away` from it, has no aperture.

    Its spots that are dimmer than usual, as reflections are, count as dark.
    """
    some = False
    for a in range(state.size):
        dim = partner[a] >= 0 and not bright[partner[a]]
        faults[a] = dim or state[a] == DARK
        if not faults[a]:
            continue
        for b in range(state.size):
            dx = apertures[a, 0] + away_x - apertures[b, 0]
            dy = apertures[a, 1] + away_y - apertures[b, 1]
            if dx * dx + dy * dy < near * near:
                faults[a] = False
                break
        some |= faults[a]
    return some


@compiled
def _lit_alone(  # noqa: PLR0917 - Numba takes no keyword-only ones
    partner: Partners,
    cut: Partners,
    other: Partners,
    other_cut: Partners,
    bright: Flags,
    taken: Flags,
    faults: Flags,
) -> bool:
    """Mark the apertures whose spots, whole or cut, only this displacement explains."""
    taken[:] = False
    for a in range(other.size):
        if other[a] >= 0:
            taken[other[a]] = True
    some = False
    for a in range(partner.size):
        s = partner[a]
        faults[a] = s >= 0 and not taken[s] and bright[s]
        some |= faults[a]
    for c in range(cut.size):
        if cut[c] >= 0 and other_cut[c] < 0:
            faults[cut[c]] = True
            some = True
    return some


@compiled
def _is_beside(at: float, partner: Partners, places: Floats, axis: int, away: float) -> bool:
    """Whether all of the places (A, 3) that have a spot are on one side of `at` along an axis."""
    below = above = False
    for a in range(partner.size):
        if partner[a] >= 0:
            below |= places[a, axis] + away < at
            above |= places[a, axis] + away > at
    return not (below and above)


@compiled
def _limit_doubled(  # noqa: PLR0917 - Numba takes no keyword-only ones
    faults: Flags,
    apertures: Floats,
    lines: Indices,
    other: Partners,
    away_x: float,
    away_y: float,
    near: float,
    doubled: float,
    work: tuple[Indices, Indices],
    limit: Floats,
) -> None:
    """Write the limit (2, A) of each line's price: less where it may be one of the other's twice.

    The faulty of a line are, where they lie beyond all spots of the `other` displacement, which is
    `away` from this one, and a line of it has an aperture beside each of them.
    """
    faulty, beside = work
    for axis in range(2):
        across, along = (away_x, away_y) if axis == 0 else (away_y, away_x)
        limit[axis, :] = _LIGHT
        faulty[:] = 0
        for a in range(faults.size):
            faulty[lines[axis, a]] += faults[a]
        for a in range(faults.size):
            line = lines[axis, a]
            if faulty[line] == 0:
                continue
            number = faulty[line]
            faulty[line] = 0  # each line is looked at once
            if not _is_beside(apertures[a, axis], other, apertures, axis, across):
                continue
            beside[:] = 0
            for b in range(faults.size):
                if not faults[b] or lines[axis, b] != line:
                    continue
                for c in range(faults.size):
                    off = apertures[b, 1 - axis] - along - apertures[c, 1 - axis]
                    beside[lines[axis, c]] += abs(off) < near
            if beside.max() >= number:
                limit[axis, line] = doubled


@compiled
def _closer(  # noqa: PLR0917 - Numba takes no keyword-only ones
    one: int,
    other: int,
    spots: Floats,
    places: Floats,
    partners: Partners,
    apertures: Floats,
    tolerance: float,
    owner: Indices,
) -> float:
    """By how much spots that both explain lie nearer to their places under `one`: squares."""
    owner[:] = -1
    for a in range(partners.shape[1]):
        if partners[one, a] >= 0:
            owner[partners[one, a]] = a
    closer = 0.0
    for b in range(partners.shape[1]):
        s = partners[other, b]
        if s >= 0 and owner[s] >= 0:
            a = owner[s]
            closer += (spots[s, 0] - apertures[b, 0] - places[other, 0]) ** 2
            closer += (spots[s, 1] - apertures[b, 1] - places[other, 1]) ** 2
            closer -= (spots[s, 0] - apertures[a, 0] - places[one, 0]) ** 2
            closer -= (spots[s, 1] - apertures[a, 1] - places[one, 1]) ** 2
    return closer / (tolerance * tolerance)


@compiled
def _ahead(  # noqa: PLR0917 - Numba takes no keyword-only ones
    one: int,
    other: int,
    spots: Floats,
    places: Floats,
    view: tuple[Partners, Partners, States, Indices, Flags, Floats],
    mask: tuple[Floats, Indices],
    tolerance: float,
    doubled: float,
    work: tuple[Indices, Indices, Indices, Flags, Flags, Floats, Floats],
) -> float:
    """By how much more the frame speaks against the `other` displacement than against `one`."""
    partners, cut_to, state, shown, bright, outside = view
    apertures, lines = mask
    owner, faulty, beside, taken, faults, limit, sums = work
    ahead = _closer(one, other, spots, places, partners, apertures, tolerance, owner)
    for side in range(2):
        a, b = (other, one) if side == 0 else (one, other)
        price = outside[a]
        away_x = places[a, 0] - places[b, 0]
        away_y = places[a, 1] - places[b, 1]
        if _dark_alone(
            state[a], partners[a], bright, apertures, away_x, away_y, 2.0 * tolerance, faults
        ):
            limit[:] = _DARKNESS
            price += _price(faults, lines, shown[a], _DARKNESS, _DARK_ONE, limit, sums)
        if _lit_alone(partners[b], cut_to[b], partners[a], cut_to[a], bright, taken, faults):
            _limit_doubled(
                faults,
                apertures,
                lines,
                partners[a],
                away_x,
                away_y,
                tolerance,
                doubled,
                (faulty, beside),
                limit,
            )
            price += _price(faults, lines, shown[b], _LIGHT, _LIGHT_ONE, limit, sums)
        ahead += price if side == 0 else -price
    return ahead


@compiled
def _is_thin(partner: Partners, lines: Indices, allowed: float, work: Indices) -> bool:
    """Whether all spots are in so few lines that all of them may be faulty, of a mask of more."""
    for axis in range(2):
        work[:] = 0
        for a in range(partner.size):
            if partner[a] >= 0:
                work[lines[axis, a]] = 1
        if work.sum() <= allowed < lines[axis].max() + 1:
            return True
    return False


@compiled
def _choose(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats,
    places: Floats,
    view: tuple[Partners, Partners, States, Indices, Flags, Floats],
    mask: tuple[Floats, Indices],
    enough: Flags,
    limits: tuple[float, float],
    last: tuple[float, float, float],
    work: tuple[Indices, Indices, Indices, Flags, Flags, Floats, Floats],
) -> tuple[int, int]:
    """Return the displacement that every other exceeds by enough, or -1, and why there is none.

    `view` is what `decide` saw under each, `limits` the tolerance and the faults allowed; of those
    nearer, the one within a reach of the last frame's is it too: `last` is x, y and reach.
    """
    tolerance, allowed = limits
    best = 0
    for h in range(1, places.shape[0]):
        if _ahead(best, h, spots, places, view, mask, tolerance, _LIGHT, work) < -_EVEN:
            best = h
    doubtful = _is_thin(view[0][best], mask[1], allowed, work[1])
    near_last = 0
    answer = -1
    others = 0
    for h in range(places.shape[0]):
        if h != best:
            ahead = _ahead(best, h, spots, places, view, mask, tolerance, _DOUBLED, work)
            doubtful |= ahead < allowed + _CLEAR
            ahead = _ahead(best, h, spots, places, view, mask, tolerance, _LIGHT, work)
            if ahead >= allowed + _CLEAR:
                continue
            others += 1
        away = math.hypot(places[h, 0] - last[0], places[h, 1] - last[1])
        if enough[h] and away <= last[2]:  # never where nothing is known of the last
            near_last += 1
            answer = h
    if others == 0 and not enough[best]:
        return -1, NOTHING
    if others == 0:
        return best, DOUBTFUL if doubtful else FOUND
    return (answer, FOUND) if near_last == 1 else (-1, SEVERAL)


@compiled
def decide(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats,
    counts: Indices,
    cut_counts: Indices,
    apertures: Floats,
    lines: Indices,
    tolerance: float,
    limits: tuple[float, float],
    field: tuple[float, float, float],
    places: Floats,
    partners: Partners,
    kept: Indices,
    states: States,
    cut_to: Partners,
    bright: Flags,
    enough: Flags,
    displacement: Floats,
    chosen: Indices,
    reason: Indices,
) -> None:
    """Choose each frame's displacement by what it shows of every aperture, in view and cut.

    Against a displacement speak places in view that are dark where another one has no aperture,
    spots that only the other explains or lie nearer to, and a Sun out of the field; a whole dark
    line is one fault, and what is out of view speaks for neither. The answer is what every other
    exceeds by enough, doubtful where one does not if a line seen twice is one fault, too.

    Parameters
    ----------
    spots, counts, cut_counts
        As `spots_kernel.segment` writes them.
    apertures, lines
        (A, 3) x, y, width; (2, A) in which column and row of the mask each is.
    tolerance
        Largest distance of a spot from its place, px.
    limits
        Faults allowed: lines of apertures that may be dark or doubled; px from the frame before's
        displacement within which one of several left open is the answer: 0 where frames are no
        sequence.
    field
        x and y of the middle of the field, and how far displacements are from it along an axis.
    places, partners, kept
        As `aperture_grid_kernel.match` writes them.
    states, cut_to, bright, enough
        As `view_kernel.look` writes them.
    displacement, chosen, reason
        (N, 2), (N, A) and (N,): receive the displacement, NaN where none is found, the spot of
        each aperture, -1 for none, and FOUND, NOTHING, SEVERAL or DOUBTFUL.
    """
    allowed, reach = limits
    room = places.shape[1]
    number = apertures.shape[0]
    shown = np.empty((room, 2, number), dtype=np.int64)
    outside = np.empty(room)
    work = (
        np.empty(spots.shape[1], dtype=np.int64),
        np.empty(number, dtype=np.int64),
        np.empty(number, dtype=np.int64),
        np.empty(spots.shape[1], dtype=np.bool_),
        np.empty(number, dtype=np.bool_),
        np.empty((2, number)),
        np.empty(number),
    )
    last = (np.nan, np.nan, reach)
    for k in range(places.shape[0]):
        displacement[k] = np.nan
        chosen[k] = -1
        reason[k] = NOTHING
        answer = -1
        if kept[k] > 0:
            for h in range(kept[k]):
                shown[h] = 0
                for a in range(number):
                    if states[k, h, a] != OUT:  # in view
                        shown[h, 0, lines[0, a]] += 1
                        shown[h, 1, lines[1, a]] += 1
                away = max(abs(places[k, h, 0] - field[0]), abs(places[k, h, 1] - field[1]))
                outside[h] = _OUTSIDE if away > field[2] else 0.0
            cut = cut_to[k, :, : cut_counts[k]]
            view = (partners[k], cut, states[k], shown, bright[k], outside)
            answer, reason[k] = _choose(
                spots[k, : counts[k]],
                places[k, : kept[k]],
                view,
                (apertures, lines),
                enough[k],
                (tolerance, allowed),
                last,
                work,
            )
        last = (np.nan, np.nan, reach)
        if answer >= 0:
            displacement[k] = places[k, answer]
            for a in range(number):
                chosen[k, a] = partners[k, answer, a]
            if reach > 0.0:
                last = (places[k, answer, 0], places[k, answer, 1], reach)

"""Which displacement of a mask a frame shows: what is lit and what is dark under each."""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.aperture_grid_kernel import nearest_aperture
from algorithms.extractors.frames.multi_spot.records import (
    Flags,
    FrameView,
    Indices,
    Lattice,
    Matches,
    Partners,
    Seen,
    States,
    Views,
    Work,
)
from algorithms.extractors.frames.multi_spot.view_kernel import DARK, OUT
from algorithms.kernels.copies import copy_row

#: What `decide` says of a frame: an answer, no pattern found, several that it may be, and an answer
#: that it is not, should lines be seen twice in full light.
FOUND, NOTHING, SEVERAL, UNCERTAIN = 0, 1, 2, 3
#: Price of a dark line of apertures, and of one of it: one over those in view, within limits.
_DARKNESS, _DARK_ONE = 1.0, (0.25, 0.34)
#: The same of lit ones that a displacement leaves unexplained: no reflection is as bright as they.
#: A line of them that may be one of its own seen twice makes an answer uncertain: as a dark one.
_LIGHT, _LIGHT_ONE, _DOUBLED = 2.0, (0.8, 0.8), 1.0
#: The same of a Sun out of the field.
_OUTSIDE = 1.0
#: By how much more than the faults allowed a rival must cost: no more than a spot beside its place.
_CLEAR = 0.04
_EVEN = 1e-9  # rounding speaks for none of two displacements


@compiled
def _price(  # noqa: PLR0917 - Numba takes no keyword-only ones
    near: Indices,
    lines: Indices,
    shown: Indices,
    line: float,
    limits: tuple[float, float],
    work: Work,
) -> float:
    """Price of the faulty ones, in columns or rows as is cheaper; that of a line has a limit."""
    least, most = limits
    sums = work.sums
    best = math.inf
    for axis in range(2):
        sums[:] = 0.0
        for a in near:
            if work.faults[a]:
                one = line / max(shown[axis, lines[axis, a]], 1)
                sums[lines[axis, a]] += min(max(one, least), most)
        total = 0.0
        for n in range(sums.size):
            total += min(sums[n], work.limit[axis, n])
        best = min(best, total)
    return best


@compiled
def _dark_alone(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: FrameView,
    h: int,
    lattice: Lattice,
    away_x: float,
    away_y: float,
    reach: float,
    faults: Flags,
) -> bool:
    """Mark the dark places of displacement h where the other, `away` from it, has no aperture.

    Its spots that are dimmer than usual, as reflections are, count as dark.
    """
    partner, state, apertures = frame.partners[h], frame.states[h], lattice.apertures
    some = False
    for a in frame.near[h, : frame.numbers[h]]:
        dim = partner[a] >= 0 and not frame.bright[partner[a]]
        faults[a] = dim or state[a] == DARK
        if faults[a]:
            x, y = apertures[a, 0] + away_x, apertures[a, 1] + away_y
            faults[a] = nearest_aperture(lattice, x, y, reach)[0] < 0
            some |= faults[a]
    return some


@compiled
def _lit_alone(frame: FrameView, h: int, other: int, taken: Flags, faults: Flags) -> bool:
    """Mark the apertures whose spots, whole or cut, only displacement h explains."""
    partner, cut, other_cut = frame.partners[h], frame.cut_to[h], frame.cut_to[other]
    taken[:] = False
    for a in frame.near[other, : frame.numbers[other]]:
        if frame.partners[other, a] >= 0:
            taken[frame.partners[other, a]] = True
    some = False
    for a in frame.near[h, : frame.numbers[h]]:
        s = partner[a]
        faults[a] = s >= 0 and not taken[s] and frame.bright[s]
        some |= faults[a]
    for c in range(cut.size):
        if cut[c] >= 0 and other_cut[c] < 0:
            faults[cut[c]] = True
            some = True
    return some


@compiled
def _is_beside(  # noqa: PLR0917 - Numba takes no keyword-only ones
    at: float, frame: FrameView, h: int, apertures: Floats, axis: int, away: float
) -> bool:
    """Whether all apertures that have a spot under h are on one side of `at` along an axis."""
    below = above = False
    for a in frame.near[h, : frame.numbers[h]]:
        if frame.partners[h, a] >= 0:
            below |= apertures[a, axis] + away < at
            above |= apertures[a, axis] + away > at
    return not (below and above)


@compiled
def _limit_doubled(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: FrameView,
    h: int,
    other: int,
    lattice: Lattice,
    away_x: float,
    away_y: float,
    tolerance: float,
    work: Work,
) -> bool:
    """Lower the limits of lines of h that may be the other displacement's seen twice; if any.

    The faulty of a line are, where they lie beyond all spots of the `other` displacement, which is
    `away` from this one, and a line of it has an aperture beside each of them.
    """
    apertures, lines, faults = lattice.apertures, lattice.lines, work.faults
    faulty, beside = work.faulty, work.beside
    near = frame.near[h, : frame.numbers[h]]
    some = False
    for axis in range(2):
        across, along = (away_x, away_y) if axis == 0 else (away_y, away_x)
        faulty[:] = 0
        for a in near:
            faulty[lines[axis, a]] += faults[a]
        for a in near:
            line = lines[axis, a]
            number = faulty[line]
            faulty[line] = 0  # each line is looked at once
            if number == 0 or not _is_beside(
                apertures[a, axis], frame, other, apertures, axis, across
            ):
                continue
            beside[:] = 0
            for b in near:
                if not faults[b] or lines[axis, b] != line:
                    continue
                for c in range(faults.size):
                    off = apertures[b, 1 - axis] - along - apertures[c, 1 - axis]
                    beside[lines[axis, c]] += abs(off) < tolerance
            if beside.max() >= number:
                work.limit[axis, line] = _DOUBLED
                some = True
    return some


@compiled
def _closer(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frame: FrameView, one: int, other: int, apertures: Floats, tolerance: float, owner: Indices
) -> float:
    """By how much spots that both explain lie nearer to their places under `one`: squares."""
    spots, places, partners = frame.spots, frame.places, frame.partners
    owner[:] = -1
    for a in frame.near[one, : frame.numbers[one]]:
        if partners[one, a] >= 0:
            owner[partners[one, a]] = a
    closer = 0.0
    for b in frame.near[other, : frame.numbers[other]]:
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
    frame: FrameView, one: int, other: int, lattice: Lattice, tolerance: float, work: Work
) -> tuple[float, float]:
    """By how much more the frame speaks against the `other` displacement than against `one`.

    The same if a line of lit ones that may be one of the other's seen twice is one fault.
    """
    places, lines = frame.places, lattice.lines
    ahead = _closer(frame, one, other, lattice.apertures, tolerance, work.owner)
    doubled = ahead
    for a, b, sign in ((other, one, 1.0), (one, other, -1.0)):
        price = frame.outside[a]
        away_x = places[a, 0] - places[b, 0]
        away_y = places[a, 1] - places[b, 1]
        if _dark_alone(frame, a, lattice, away_x, away_y, 2.0 * tolerance, work.faults):
            work.limit[:] = _DARKNESS
            near = frame.near[a, : frame.numbers[a]]
            price += _price(near, lines, frame.shown[a], _DARKNESS, _DARK_ONE, work)
        twice = price
        if _lit_alone(frame, b, a, work.taken, work.faults):
            work.limit[:] = _LIGHT
            near, shown = frame.near[b, : frame.numbers[b]], frame.shown[b]
            lit = _price(near, lines, shown, _LIGHT, _LIGHT_ONE, work)
            price += lit
            if _limit_doubled(frame, b, a, lattice, away_x, away_y, tolerance, work):
                lit = _price(near, lines, shown, _LIGHT, _LIGHT_ONE, work)
            twice += lit
        ahead += sign * price
        doubled += sign * twice
    return ahead, doubled


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
    frame: FrameView,
    lattice: Lattice,
    enough: Flags,
    limits: tuple[float, float],
    last: tuple[float, float, float],
    work: Work,
) -> tuple[int, int]:
    """Return the displacement that every other exceeds by enough, or -1, and why there is none.

    `limits` are the tolerance and the faults allowed; of those nearer, the one within a reach of
    the last frame's is it too: `last` is x, y and reach.
    """
    tolerance, allowed = limits
    places = frame.places
    ahead = np.empty((places.shape[0], 2))
    best = 0
    for h in range(1, places.shape[0]):
        ahead[h, 0], ahead[h, 1] = _ahead(frame, best, h, lattice, tolerance, work)
        if ahead[h, 0] < -_EVEN:
            best = h
    for h in range(best):  # compared with another one above
        ahead[h, 0], ahead[h, 1] = _ahead(frame, best, h, lattice, tolerance, work)
    uncertain = _is_thin(frame.partners[best], lattice.lines, allowed, work.faulty)
    near_last = 0
    answer = -1
    others = 0
    for h in range(places.shape[0]):
        if h != best:
            uncertain |= ahead[h, 1] < allowed + _CLEAR
            if ahead[h, 0] >= allowed + _CLEAR:
                continue
            others += 1
        away = math.hypot(places[h, 0] - last[0], places[h, 1] - last[1])
        if enough[h] and away <= last[2]:  # never where nothing is known of the last
            near_last += 1
            answer = h
    if others == 0 and not enough[best]:
        return -1, NOTHING
    if others == 0:
        return best, UNCERTAIN if uncertain else FOUND
    return (answer, FOUND) if near_last == 1 else (-1, SEVERAL)


@compiled
def _take_stock(  # noqa: PLR0917 - Numba takes no keyword-only ones
    states: States,
    cut_to: Partners,
    lines: Indices,
    near: Indices,
    shown: Indices,
    faults: Flags,
) -> int:
    """Write the apertures in view or with a cut spot, and how many of a line are in view.

    Return how many are written; `faults` is work space.
    """
    faults[:] = False
    for c in range(cut_to.size):
        if cut_to[c] >= 0:
            faults[cut_to[c]] = True
    shown[:] = 0
    number = 0
    for a in range(states.size):
        if states[a] != OUT:
            shown[0, lines[0, a]] += 1
            shown[1, lines[1, a]] += 1
        if states[a] != OUT or faults[a]:
            near[number] = a
            number += 1
    return number


@compiled
def decide(  # noqa: PLR0917 - Numba takes no keyword-only ones
    seen: Seen,
    lattice: Lattice,
    tolerance: float,
    limits: tuple[float, float],
    field: tuple[float, float, float],
    matches: Matches,
    views: Views,
    displacement: Floats,
    chosen: Indices,
    reason: Indices,
) -> None:
    """Choose each frame's displacement by what it shows of every aperture, in view and cut.

    Against a displacement speak places in view that are dark where another one has no aperture,
    spots that only the other explains or lie nearer to, and a Sun out of the field; a whole dark
    line is one fault, and what is out of view speaks for neither. The answer is what every other
    exceeds by enough, uncertain where one does not if a line seen twice is one fault, too.

    Parameters
    ----------
    seen, lattice, matches, views
        The frames' spots, the mask, displacements and what is seen under them.
    tolerance
        Largest distance of a spot from its place, px.
    limits
        Faults allowed: lines of apertures that may be dark or doubled; px from the frame before's
        displacement within which one of several left open is the answer: 0 where frames are no
        sequence.
    field
        x and y of the middle of the field, and how far displacements are from it along an axis.
    displacement, chosen, reason
        (N, 2), (N, A) and (N,): receive the displacement, NaN where none is found, the spot of
        each aperture, -1 for none, and FOUND, NOTHING, SEVERAL or UNCERTAIN.
    """
    allowed, reach = limits
    places, kept = matches.places, matches.kept
    room, number = places.shape[1], lattice.apertures.shape[0]
    line_count = max(lattice.lines[0].max(), lattice.lines[1].max()) + 1
    near, numbers = np.empty((room, number), dtype=np.int64), np.empty(room, dtype=np.int64)
    shown, outside = np.empty((room, 2, line_count), dtype=np.int64), np.empty(room)
    work = Work(
        np.empty(seen.spots.shape[1], dtype=np.int64),
        np.empty(seen.spots.shape[1], dtype=np.bool_),
        np.empty(number, dtype=np.bool_),
        np.empty(line_count, dtype=np.int64),
        np.empty(line_count, dtype=np.int64),
        np.empty((2, line_count)),
        np.empty(line_count),
    )
    last = (np.nan, np.nan, reach)
    for k in range(places.shape[0]):
        displacement[k] = np.nan
        chosen[k] = -1
        reason[k] = NOTHING
        answer = -1
        if kept[k] > 0:
            cut_to, states = views.cut_to[k, :, : seen.cut_counts[k]], views.states[k]
            for h in range(kept[k]):
                numbers[h] = _take_stock(
                    states[h], cut_to[h], lattice.lines, near[h], shown[h], work.faults
                )
                away = max(abs(places[k, h, 0] - field[0]), abs(places[k, h, 1] - field[1]))
                outside[h] = _OUTSIDE if away > field[2] else 0.0
            frame = FrameView(
                seen.spots[k, : seen.counts[k]],
                places[k, : kept[k]],
                matches.partners[k],
                cut_to,
                states,
                views.bright[k],
                near,
                numbers,
                shown,
                outside,
            )
            answer, reason[k] = _choose(
                frame, lattice, views.enough[k], (tolerance, allowed), last, work
            )
        last = (np.nan, np.nan, reach)
        if answer >= 0:
            copy_row(places[k, answer], displacement[k])
            for a in range(number):
                chosen[k, a] = matches.partners[k, answer, a]
            if reach > 0.0:
                last = (places[k, answer, 0], places[k, answer, 1], reach)

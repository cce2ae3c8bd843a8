"""How surely a list of spots shows one part of a coded mask: evidence for all places of it.

The evidence for a place is the logarithm of how likely it makes the list. Spots that it explains
lie about their apertures with one deviation: that of the design or, rarely, one that the list alone
tells, which makes residuals ``t``-distributed. Any other spot is stray light somewhere on the
detector, and an aperture in view without a spot is closed. So a spot that fills a wide tolerance
tells no place from the next, and a list whose spots do is said to show several.

What is handed around is said in `algorithms.calibration.coded.identity_kernel`.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.calibration.coded.identity_kernel import (
    Code,
    Indices,
    Room,
    are_near,
    find_dark,
    leave,
    name_of,
    partners_of,
    places_of_spot,
    room_for,
    spacings,
)
from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Of a spot's variance by design, then of one not known: degrees of freedom, px^2, and the cost
#: that it is so; cost of a spot unexplained, and of an aperture dark on a broken mask; odds asked
#: for; room for a displacement and for a spot; cost of an aperture dark on a whole mask, and share
#: of broken ones; deviation of the logarithm of a width by design, 0 where widths are no code, and
#: of one that dirt or a neighbour changes, and share of such. Costs, odds and room are logarithms.
Noise = tuple[
    *tuple[float, float, float],
    *tuple[float, float, float],
    *tuple[float, float, float, float, float],
    *tuple[float, float],
    *tuple[float, float, float],
]
_UNEXPLAINED, _DARK, _ODDS, _MASK, _VIEW, _WHOLE, _BROKEN = 6, 7, 8, 9, 10, 11, 12
_WIDTH, _ODD_WIDTH, _ODD = 13, 14, 15

#: What is said of a list: read, nothing to read, several places that it may show.
READ, NOTHING, SEVERAL = 0, 1, 2


@compiled
def _pair(spots: Floats, count: int, most: int, code: Code) -> Indices:
    """Partner of each spot in sets that share none, more than `most` sets; itself alone.

    A neighbour, of those that are left the one whose spacing is on the mask least often. -1 for a
    spot in no set, and throughout where there are not so many sets.
    """
    mates = np.full(count, -1, dtype=np.int64)
    sets = 0
    for i in range(count):
        if mates[i] >= 0:
            continue
        mates[i] = i
        sets += 1
        fewest = -1
        for j in range(i + 1, count):
            if mates[j] < 0 and are_near(spots, i, j, code[5][0]):
                number = spacings(spots, i, j, code)
                if fewest < 0 or number < fewest:
                    fewest = number
                    mates[i] = j
        if mates[i] != i:
            mates[mates[i]] = i
    if sets <= most:
        for i in range(count):
            mates[i] = i if count > most else -1
    return mates


@compiled
def _agreement(dimensions: int, squares: float, noise: Noise) -> float:
    """Logarithm of the density of residuals, of the design's noise or of an unknown one."""
    found = -math.inf
    for prior in range(2):
        freedom, variance, cost = noise[3 * prior], noise[3 * prior + 1], noise[3 * prior + 2]
        all_of = 0.5 * (freedom + dimensions)
        evidence = (
            math.lgamma(all_of)
            - math.lgamma(0.5 * freedom)
            - 0.5 * dimensions * math.log(math.pi * freedom * variance)
            - all_of * math.log1p(squares / (freedom * variance))
            - cost
        )
        high, low = max(found, evidence), min(found, evidence)
        found = high + math.log1p(math.exp(low - high))
    return found


@compiled
def _dark_odds(dark_ones: int, noise: Noise) -> float:
    """Logarithm of the odds of apertures being dark: on whole masks hardly any is."""
    whole, broken = -dark_ones * noise[_WHOLE], -dark_ones * noise[_DARK]
    return math.log((1.0 - noise[_BROKEN]) * math.exp(whole) + noise[_BROKEN] * math.exp(broken))


@compiled
def _width_evidence(off: float, noise: Noise) -> float:
    """Logarithm of the density of a width's residual, over that of one nothing is known of."""
    design, odd = off / noise[_WIDTH], off / noise[_ODD_WIDTH]
    evidence = (1.0 - noise[_ODD]) * math.exp(-0.5 * design * design) / noise[_WIDTH]
    evidence += noise[_ODD] * math.exp(-0.5 * odd * odd) / noise[_ODD_WIDTH]
    return math.log(max(evidence * noise[_ODD_WIDTH], noise[_ODD] * 1e-3))


@compiled
def _widths(spots: Floats, count: int, places: Floats, partners: Indices, noise: Noise) -> float:
    """Evidence for the partners from widths estimated from light, about their median."""
    off = np.empty(count)
    number = 0
    for s in range(count):
        if partners[s] >= 0:
            off[number] = spots[s, 2] - places[partners[s], 2]
            number += 1
    middle = np.median(off[:number])
    found = 0.0
    for s in range(number):
        found += _width_evidence(off[s] - middle, noise)
    return found


@compiled
def _at_most(count: int, left: int, noise: Noise) -> float:
    """Evidence for a place that leaves so many of the spots: no place that does has more."""
    found = _agreement(max(2 * (count - left) - 2, 0), 0.0, noise) - left * noise[_UNEXPLAINED]
    if noise[_WIDTH] > 0.0:
        found += (count - left) * _width_evidence(0.0, noise)
    return found


@compiled
def _evidence(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats,
    count: int,
    at: Floats,
    least: float,
    code: Code,
    view: Floats,
    noise: Noise,
    partners: Indices,
) -> float:
    """Logarithm of how likely a place makes the spots; `at` goes to the middle of its own.

    Minus infinity where it is less than `least`, or the place explains no two.
    """
    places = code[0]
    left, squares, x, y = 0, 0.0, 0.0, 0.0
    for _ in range(2):  # from the one or two spots that named the place, then from all
        left = partners_of(spots, count, at, code, partners)
        if count - left < 2:
            return -math.inf
        x, y, squares = 0.0, 0.0, 0.0
        for s in range(count):
            if partners[s] >= 0:
                x += spots[s, 0] - places[partners[s], 0]
                y += spots[s, 1] - places[partners[s], 1]
        x, y = x / (count - left), y / (count - left)
        for s in range(count):
            if partners[s] >= 0:
                squares += (spots[s, 0] - places[partners[s], 0] - x) ** 2
                squares += (spots[s, 1] - places[partners[s], 1] - y) ** 2
        at[0], at[1] = x, y
    found = _agreement(2 * (count - left) - 2, squares, noise) - left * noise[_UNEXPLAINED]
    if noise[_WIDTH] > 0.0:
        found += _widths(spots, count, places, partners, noise)
    if found < least:
        return -math.inf
    closed = find_dark(
        count, at, int(min((found - least) / noise[_DARK], 1e6)), code, view, partners
    )
    found += _dark_odds(closed, noise)
    return found if found >= least else -math.inf


@compiled
def _compare(  # noqa: C901, PLR0912, PLR0917 - one pass over places; positional for Numba
    spots: Floats,
    count: int,
    code: Code,
    view: Floats,
    noise: Noise,
    room: Room,
    place: Floats,
) -> tuple[float, float]:
    """Evidence for the likeliest place, to which `place` is moved, and for the next likely one.

    Exactly, as far as the next one is within the odds asked for: such a place leaves some
    spots at most, and of one set more that share none it explains one whole. Sets are two
    neighbours, whose spacing the table has, or a spot alone.
    """
    trials, left, partners = room
    apart = 2.0 * code[2][3]
    nothing = noise[_MASK] - count * noise[_VIEW]
    best, second = nothing, -math.inf
    known = not math.isnan(place[0])
    if known:
        best = max(_evidence(spots, count, place, -math.inf, code, view, noise, partners), nothing)
    most = 0
    while most < count and _at_most(count, most + 1, noise) >= best - noise[_ODDS]:
        most += 1
    mates = _pair(spots, count, most, code)
    sets = 0
    for i in range(count):
        if sets > most:
            break
        if mates[i] < i:  # no set, or one that was looked at
            continue
        sets += 1
        if mates[i] == i:
            number = places_of_spot(spots, i, -1, code, trials)
        else:
            number = name_of(spots, i, mates[i], -1, code, trials)
        leave(spots, count, room, number, most, most, code)
        for h in range(number):
            if left[h] > most:
                continue
            at = trials[h]
            evidence = _evidence(spots, count, at, best - noise[_ODDS], code, view, noise, partners)
            if evidence == -math.inf:
                continue
            if known and abs(at[0] - place[0]) <= apart and abs(at[1] - place[1]) <= apart:
                best = max(best, evidence)
            elif evidence > best:
                if known:
                    second = best
                best, known = evidence, True
                place[:] = at
            else:
                second = max(second, evidence)
    if sets <= most:  # other places cannot be determined
        second = best
    return best, second


@compiled
def decide(  # noqa: PLR0917 - Numba takes no keyword-only ones
    lists: Floats,
    counts: Indices,
    code: Code,
    view: Floats,
    rules: tuple[int, float],
    noise: Noise,
    found: Floats,
    partners: Indices,
    verdicts: Indices,
) -> None:
    """Keep of the likeliest places those that are likelier than every other by far.

    `code` has the widest tolerance that noise may ask for. `rules`: spots a place must explain;
    share of the spots, and of the apertures in view, that it must. `found` (N, 3) is a search's,
    and moved to the likeliest. `partners` (N, K) receives the aperture of each spot, -1 for none;
    `verdicts` (N,) what is said of the list.
    """
    agreeing, share = rules
    room = room_for(lists, code)
    for k in range(lists.shape[0]):
        spots, count, own = lists[k], counts[k], partners[k]
        own[:] = -1
        verdicts[k] = NOTHING
        if count < agreeing:
            continue
        best, second = _compare(spots, count, code, view, noise, room, found[k])
        if math.isnan(found[k, 0]) or best < noise[_MASK] - count * noise[_VIEW] + noise[_ODDS]:
            continue
        explained = count - partners_of(spots, count, found[k], code, own)
        lit = explained + find_dark(count, found[k], len(code[0]), code, view, own)
        if explained >= max(float(agreeing), share * count, share * lit):
            verdicts[k] = READ if best - second >= noise[_ODDS] else SEVERAL
        if verdicts[k] != READ:
            own[:] = -1

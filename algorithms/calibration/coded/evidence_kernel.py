"""How surely a list of spots shows one part of a coded mask: evidence for all places of it.

The evidence for a place is the logarithm of how likely it makes the list. Spots that it explains
lie about their apertures with one deviation, which the list itself tells, beside a prior of few
degrees of freedom: ``t``-distributed residuals. Any other spot is stray light somewhere on the
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
    dark,
    leave,
    named,
    near,
    of_one,
    partners_of,
    room_for,
)
from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Prior of a spot's variance: degrees of freedom and px^2; cost of a spot unexplained and of an
#: aperture dark; odds asked for; room for displacements and for a spot. All but the first two are
#: logarithms.
Noise = tuple[float, float, float, float, float, float, float]

#: What is said of a list: read, nothing to read, several places that it may show.
READ, NOTHING, SEVERAL = 0, 1, 2


@compiled
def _paired(spots: Floats, count: int, most: int, reach: float) -> Indices:
    """Partner of each spot in sets that share none, more than `most` sets; itself alone.

    -1 for a spot in no set, and throughout where there are not so many sets.
    """
    mates = np.full(count, -1, dtype=np.int64)
    sets = 0
    for i in range(count):
        if mates[i] >= 0:
            continue
        mates[i] = i
        sets += 1
        for j in range(i + 1, count):
            if mates[j] < 0 and near(spots, i, j, reach):
                mates[i] = j
                mates[j] = i
                break
    if sets <= most:
        for i in range(count):
            mates[i] = i if count > most else -1
    return mates


@compiled
def _agreement(dimensions: int, squares: float, noise: Noise) -> float:
    """Logarithm of the density of residuals whose deviation is not known but for its prior."""
    freedom, variance = noise[0], noise[1]
    all_of = 0.5 * (freedom + dimensions)
    return (
        math.lgamma(all_of)
        - math.lgamma(0.5 * freedom)
        - 0.5 * dimensions * math.log(math.pi * freedom * variance)
        - all_of * math.log1p(squares / (freedom * variance))
    )


@compiled
def _at_most(count: int, left: int, noise: Noise) -> float:
    """Evidence for a place that leaves so many of the spots: no place that does has more."""
    return _agreement(max(2 * (count - left) - 2, 0), 0.0, noise) - left * noise[2]


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
    """Logarithm of how likely a place makes the spots; `at` goes to the middle of those it explains.

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
    found = _agreement(2 * (count - left) - 2, squares, noise) - left * noise[2]
    if found < least:
        return -math.inf
    closed = dark(count, at, int(min((found - least) / noise[3], 1e6)), code, view, partners)
    found -= closed * noise[3]
    return found if found >= least else -math.inf


@compiled
def _compared(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats,
    count: int,
    code: Code,
    view: Floats,
    noise: Noise,
    room: Room,
    place: Floats,
) -> tuple[float, float]:
    """Evidence for the likeliest place, to which `place` is moved, and for the next likely one.

    Exactly, as far as the next one is within the odds of noise[4]: such a place leaves some
    spots at most, and of one set more that share none it explains one whole. Sets are two
    neighbours, whose spacing the table has, or a spot alone.
    """
    trials, left, partners = room
    apart = 2.0 * code[2][3]
    nothing = noise[5] - count * noise[6]
    best, second = nothing, -math.inf
    known = not math.isnan(place[0])
    if known:
        best = max(
            _evidence(spots, count, place, -math.inf, code, view, noise, partners), nothing
        )
    most = 0
    while most < count and _at_most(count, most + 1, noise) >= best - noise[4]:
        most += 1
    mates = _paired(spots, count, most, code[5][0])
    sets = 0
    for i in range(count):
        if sets > most:
            break
        if mates[i] < i:  # no set, or one that was looked at
            continue
        sets += 1
        if mates[i] == i:
            number = of_one(spots, i, -1, code, trials)
        else:
            number = named(spots, i, mates[i], -1, code, trials)
        leave(spots, count, room, number, most, most, code)
        for h in range(number):
            if left[h] > most:
                continue
            at = trials[h]
            told = _evidence(spots, count, at, best - noise[4], code, view, noise, partners)
            if told == -math.inf:
                continue
            if known and abs(at[0] - place[0]) <= apart and abs(at[1] - place[1]) <= apart:
                best = max(best, told)
            elif told > best:
                if known:
                    second = best
                best, known = told, True
                place[:] = at
            else:
                second = max(second, told)
    if sets <= most:  # other places cannot be told
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
        best, second = _compared(spots, count, code, view, noise, room, found[k])
        if math.isnan(found[k, 0]) or best < noise[5] - count * noise[6] + noise[4]:
            continue
        explained = count - partners_of(spots, count, found[k], code, own)
        lit = explained + dark(count, found[k], len(code[0]), code, view, own)
        if explained >= max(float(agreeing), share * count, share * lit):
            verdicts[k] = READ if best - second >= noise[4] else SEVERAL
        if verdicts[k] != READ:
            own[:] = -1

"""Which displacement of a mask a frame shows: what is lit and what is dark under each."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.compiled import compiled
from algorithms.contract import Floats

Indices = NDArray[np.int64]
Partners = NDArray[np.int32]
States = NDArray[np.int8]
Flags = NDArray[np.bool_]

#: What a frame shows of an aperture: less than half of its place, neither its spot nor darkness,
#: its spot, darkness or a spot of another place.
_OUT, _UNSURE, _SPOT, _DARK = 0, 1, 2, 3
#: Share of lit pixels at an aperture's place below which it is dark: a hot one is no spot.
_LIT = 0.25
#: A spot with less than this share of the usual light may be a reflection.
_DIM = 0.8
#: Price of a dark line of apertures, and of one of it: one over those in view, within limits.
_DARKNESS, _DARK_ONE = 1.0, (0.25, 0.34)
#: The same of lit ones that a displacement leaves unexplained: no reflection is as bright as they.
_LIGHT, _LIGHT_ONE = 2.0, (0.8, 0.8)
#: By how much more than the faults allowed a rival must cost: no more than a spot beside its place.
_CLEAR = 0.04


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
        edge = half + margin
        whole += edge <= px < width - 1 - edge and edge <= py < height - 1 - edge
        if partner[a] >= 0:
            state[a] = _SPOT
            found += 1
        elif not (1.0 <= px <= width - 2.0 and 1.0 <= py <= height - 2.0):
            state[a] = _OUT
        elif _is_dark(frame, level, px, py, max(half - 1.0, 1.0)) or _is_near(spots, px, py, half):
            state[a] = _DARK
        else:
            state[a] = _UNSURE
    return found, whole


@compiled
def _shown(state: States, lines: Indices, out: Indices) -> None:
    """Write how many apertures of each line of columns and of rows (2, A) are in view."""
    out[:] = 0
    for a in range(state.size):
        if state[a] != _OUT:
            out[0, lines[0, a]] += 1
            out[1, lines[1, a]] += 1


@compiled
def _price(  # noqa: PLR0917 - Numba takes no keyword-only ones
    faults: Flags,
    lines: Indices,
    shown: Indices,
    line: float,
    limits: tuple[float, float],
    sums: Floats,
) -> float:
    """Price of the faulty, in columns or rows as is cheaper; that of a line has a limit."""
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
            total += min(sums[a], line)
        best = min(best, total)
    return best


@compiled
def _dark_alone(  # noqa: PLR0917 - Numba takes no keyword-only ones
    state: States, apertures: Floats, away_x: float, away_y: float, near: float, faults: Flags
) -> bool:
    """Mark the dark places of one displacement where the other, `away` from it, has no aperture."""
    some = False
    for a in range(state.size):
        faults[a] = state[a] == _DARK
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

    Compared is the light of a lit pixel, which does not depend on an aperture's size.
    """
    lights = np.empty(partner.size)
    number = 0
    for a in range(partner.size):
        if partner[a] >= 0:
            lights[number] = spots[partner[a], 3] / spots[partner[a], 2]
            number += 1
    least = _DIM * np.median(lights[:number])
    for s in range(bright.size):
        bright[s] = spots[s, 3] >= least * spots[s, 2]
    return float(least)


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
    view: tuple[Partners, Partners, States, Indices, Flags],
    mask: tuple[Floats, Indices],
    tolerance: float,
    work: tuple[Indices, Flags, Flags, Floats],
) -> float:
    """By how much more the frame speaks against the `other` displacement than against `one`."""
    partners, cut_to, state, shown, bright = view
    apertures, lines = mask
    owner, taken, faults, sums = work
    ahead = _closer(one, other, spots, places, partners, apertures, tolerance, owner)
    for side in range(2):
        a, b = (other, one) if side == 0 else (one, other)
        price = 0.0
        away_x = places[a, 0] - places[b, 0]
        away_y = places[a, 1] - places[b, 1]
        if _dark_alone(state[a], apertures, away_x, away_y, 2.0 * tolerance, faults):
            price += _price(faults, lines, shown[a], _DARKNESS, _DARK_ONE, sums)
        if _lit_alone(partners[b], cut_to[b], partners[a], cut_to[a], bright, taken, faults):
            price += _price(faults, lines, shown[b], _LIGHT, _LIGHT_ONE, sums)
        ahead += price if side == 0 else -price
    return ahead


@compiled
def _choose(  # noqa: PLR0917 - Numba takes no keyword-only ones
    spots: Floats,
    places: Floats,
    view: tuple[Partners, Partners, States, Indices, Flags],
    mask: tuple[Floats, Indices],
    enough: Flags,
    limits: tuple[float, float],
    last: tuple[float, float, float],
    work: tuple[Indices, Flags, Flags, Floats],
) -> int:
    """Return the displacement that every other exceeds by enough, or -1.

    `view` is what `decide` saw under each, `limits` the tolerance and what is enough; of those
    nearer, the one within a reach of the last frame's is it too: `last` is x, y and reach.
    """
    tolerance, clear = limits
    best = 0
    for h in range(1, places.shape[0]):
        if _ahead(best, h, spots, places, view, mask, tolerance, work) < 0.0:
            best = h
    near_last = 0
    answer = -1
    others = 0
    for h in range(places.shape[0]):
        if h != best:
            if _ahead(best, h, spots, places, view, mask, tolerance, work) >= clear:
                continue
            others += 1
        away = math.hypot(places[h, 0] - last[0], places[h, 1] - last[1])
        if enough[h] and away <= last[2]:  # never where nothing is known of the last
            near_last += 1
            answer = h
    if others == 0:
        return best if enough[best] else -1
    return answer if near_last == 1 else -1


@compiled
def decide(  # noqa: PLR0917 - Numba takes no keyword-only ones
    frames: NDArray[Any],
    levels: Floats,
    spots: Floats,
    counts: Indices,
    cuts: Floats,
    cut_counts: Indices,
    apertures: Floats,
    lines: Indices,
    margin: float,
    tolerance: float,
    limits: tuple[float, float, float],
    places: Floats,
    partners: Partners,
    kept: Indices,
    displacement: Floats,
    chosen: Indices,
) -> None:
    """Choose each frame's displacement by what it shows of every aperture, in view and cut.

    Against a displacement speak places in view that are dark where another one has no aperture,
    spots that only the other explains or lie nearer to; a whole line of them is one fault, and
    what is out of view speaks for neither. The answer is what every other exceeds by enough.

    Parameters
    ----------
    levels
        (N,) above which a pixel of the frames (N, H, W) is lit.
    spots, counts, cuts, cut_counts
        As `spots_kernel.segment` writes them.
    apertures, lines
        (A, 3) x, y, width; (2, A) in which column and row of the mask each is.
    margin, tolerance
        Px that a spot reaches beyond its aperture; largest distance of a spot from its place.
    limits
        Faults allowed: lines of apertures that may be dark or doubled; least share of the
        spots that should be whole in the frame; px from the frame before's displacement within
        which one of several left open is the answer: 0 where frames are no sequence.
    places, partners, kept
        As `aperture_grid_kernel.match` writes them.
    displacement, chosen
        (N, 2) and (N, A): receive the displacement, NaN where none is found, and the spot of
        each aperture, -1 for none.
    """
    allowed, share, reach = limits
    room = places.shape[1]
    number = apertures.shape[0]
    state = np.empty((room, number), dtype=np.int8)
    shown = np.empty((room, 2, number), dtype=np.int64)
    cut_to = np.empty((room, cuts.shape[1]), dtype=np.int32)
    enough = np.empty(room, dtype=np.bool_)
    bright = np.empty(spots.shape[1], dtype=np.bool_)
    work = (
        np.empty(spots.shape[1], dtype=np.int64),
        np.empty(spots.shape[1], dtype=np.bool_),
        np.empty(number, dtype=np.bool_),
        np.empty(number),
    )
    last = (np.nan, np.nan, reach)
    for k in range(frames.shape[0]):
        displacement[k] = np.nan
        chosen[k] = -1
        answer = -1
        if kept[k] > 0:
            seen = spots[k, : counts[k]]
            cut = cuts[k, : cut_counts[k]]
            dim = _usual(seen, partners[k, 0], bright[: counts[k]])
            for h in range(kept[k]):
                x, y = places[k, h]
                found, whole = _look(
                    frames[k], levels[k], apertures, margin, x, y, seen, partners[k, h], state[h]
                )
                enough[h] = found >= share * whole
                _shown(state[h], lines, shown[h])
                _cut_partners(cut, apertures, x, y, margin, dim, cut_to[h, : cut_counts[k]])
            view = (partners[k], cut_to[:, : cut_counts[k]], state, shown, bright)
            answer = _choose(
                seen,
                places[k, : kept[k]],
                view,
                (apertures, lines),
                enough,
                (tolerance, allowed + _CLEAR),
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

"""Compiled light through the tracks of a code dial (loaded on first use: Numba)."""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

Interval = tuple[float, float]

_NODES, _SHARES = np.polynomial.legendre.leggauss(3)


@compiled
def _open_length(u: float, track: Floats, numbers: Floats) -> float:
    """Open length of a track from the dial's left end to `u`, weighted by its transmission."""
    kind, period, cell, square = track[0], numbers[0], numbers[1], numbers[2]
    reach = cell * (track.shape[0] - 5) / 2.0
    u = min(max(u - track[3], -reach), reach)
    if kind == 0.0:
        place = (u + reach) / cell
        number = min(int(place), track.shape[0] - 6)
        below, above = track[4 + number], track[5 + number]
        return float(below + (above - below) * (place - number))
    # rows F1..F4 transmit (1 - cos)/2, (1 - sin)/2, (1 + cos)/2, (1 + sin)/2 of the phase
    if square > 0.0:
        turn = u / period - kind / 4.0
        whole = math.floor(turn)
        return float(period * (whole / 2.0 + min(turn - whole, 0.5)))
    phase = 2.0 * math.pi * u / period
    wave = -math.sin(phase)
    if kind == 2.0:
        wave = math.cos(phase)
    elif kind == 3.0:
        wave = math.sin(phase)
    elif kind == 4.0:
        wave = -math.cos(phase)
    return float(u / 2.0 + period / (4.0 * math.pi) * wave)


@compiled
def _chord(v: float, lower: Floats, upper: Floats, numbers: Floats) -> Interval:
    """Both ends of the slit's light on the line at `v`; left > right where there is none."""
    x, y, a, b, c, s = numbers[3:]
    du, dv = upper[0] - lower[0], upper[1] - lower[1]
    a = a - abs(c * du + s * dv) / 2.0
    b = b - abs(c * dv - s * du) / 2.0
    middle = x + (lower[0] + upper[0]) / 2.0
    off = v - y - (lower[1] + upper[1]) / 2.0
    left, right = (-a - s * off) / c, (a - s * off) / c
    if s != 0.0:
        one, two = (c * off - b) / s, (c * off + b) / s
        left, right = max(left, min(one, two)), min(right, max(one, two))
    elif abs(off) > b:
        right = left - 1.0
    return middle + left, middle + right


@compiled
def _past(line: float, edge: Floats, scale: float) -> float:
    """Light that diffraction carries past a line this far inside the light, as a length."""
    reach = (edge.shape[0] - 2) // 2
    place = line / scale * edge[-1]
    if abs(place) >= reach:
        return 0.0
    place += reach
    node = int(place)
    return float(scale * (edge[node] + (place - node) * (edge[node + 1] - edge[node])))


@compiled
def _carry(ends: Interval, track: Floats, numbers: Floats, edge: Floats, scale: float) -> float:
    """Open length that diffraction at both ends of the slit's light adds to a track's.

    At each border of the pattern where it opens, light from further along is won or lost.
    """
    left, right = ends
    kind, period, cell, square = track[0], numbers[0], numbers[1], numbers[2]
    total = 0.0
    if kind == 0.0:
        cells = track.shape[0] - 5
        first, width, before = track[3] - cell * cells / 2.0, cell, 0.0
        for border in range(cells + 1):
            after = 0.0
            if border < cells:
                after = (track[5 + border] - track[4 + border]) / cell
            if after != before:
                line = first + border * width
                total += (after - before) * (
                    _past(right - line, edge, scale) - _past(line - left, edge, scale)
                )
            before = after
    elif square > 0.0:
        half = period / 2.0
        origin = track[3] + kind / 4.0 * period
        far = scale * ((edge.shape[0] - 2) // 2) / edge[-1]
        last = math.ceil((right + far - origin) / half)
        for border in range(math.floor((left - far - origin) / half), last + 1):
            line = origin + border * half
            step = 1.0 if border % 2 == 0 else -1.0
            total += step * (_past(right - line, edge, scale) - _past(line - left, edge, scale))
    return total


@compiled
def read_dial(
    out: Floats,
    tracks: Floats,
    sunlight: tuple[Floats, Floats],
    numbers: Floats,
    diffraction: tuple[Floats, Floats],
) -> None:
    """Write the light behind every track of one dial, in units of the slit's width.

    Parameters
    ----------
    out
        (N, T), overwritten; mm: times a track's height it is the light's flux.
    tracks
        (T, 4 + cells + 1): kind (0 coarse, 1 to 4 for the fine rows F1 to F4), middle across the
        dial, half height, displacement of the pattern along it, mm; then, of coarse tracks, the
        open length from the left end to each cell's edge, mm.
    sunlight
        (2, N, K, 2) displacement of the slit's lower and upper rims, mm, (u, v), and (N, K) light
        of each of the K points of the Sun.
    numbers
        (9,) fine period and cell, mm; 1 for square fine rows, 0 for sinusoidal ones; the slit's
        row of `Mask.table` without its kind.
    diffraction
        `edge_light.light_across_edge` with its steps a unit behind it, empty for geometric light;
        (N,) the length of its unit, mm. Sinusoidal rows, of which it changes little, stay
        geometric.
    """
    tilted = numbers[8] != 0.0
    rims, light = sunlight
    edge, scale = diffraction
    for n in range(out.shape[0]):
        for t in range(tracks.shape[0]):
            track = tracks[t]
            total = 0.0
            for k in range(light.shape[1]):
                lower, upper = rims[0, n, k], rims[1, n, k]
                # a slit parallel to the tracks' normal lights every line of a track alike
                for q in range(3 if tilted else 1):
                    node, share = (_NODES[q], _SHARES[q] / 2.0) if tilted else (0.0, 1.0)
                    left, right = _chord(track[1] + node * track[2], lower, upper, numbers)
                    if right > left:
                        passed = _open_length(right, track, numbers)
                        passed -= _open_length(left, track, numbers)
                        if edge.shape[0] > 0:
                            passed += _carry((left, right), track, numbers, edge, scale[n])
                        total += light[n, k] * share * passed
            out[n, t] = total

"""Compiled light of the sunlit Earth: its radiance, and sums of it (loaded on first use: Numba).

Lengths along lines of sight are in units of the distance to Earth's centre. An Earth is an array
(5,): its radius in that unit, the reflectance of clear and of clouded ground, then of the cloud
field the threshold and the width of the passage from clear to clouded. Waves (M, 4) are the cloud
field's wave vectors and phases; without any, all ground is clear.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.compiled import compiled
from algorithms.contract import Floats

#: Three numbers instead of an array: nothing to allocate in the innermost loops.
Vector = tuple[float, float, float]
#: Cosines of so many angles, a power of two, around the circle, and the angle between them.
_STEPS = 4096
_STEP, _PER_RADIAN = 2.0 * math.pi / _STEPS, _STEPS / (2.0 * math.pi)
_COSINES = np.array([math.cos(n * _STEP) for n in range(_STEPS)])


@compiled
def _field(x: float, y: float, z: float, waves: Floats) -> float:
    """Cloud field over a point of the ground, a unit vector from Earth's centre."""
    field = 0.0
    for m in range(waves.shape[0]):
        field += math.cos(waves[m, 0] * x + waves[m, 1] * y + waves[m, 2] * z + waves[m, 3])
    return field * math.sqrt(2.0 / waves.shape[0])


@compiled
def _cover(x: float, y: float, z: float, earth: Floats, waves: Floats) -> float:
    """Share of clouds over a point of the ground, a unit vector from Earth's centre.

    Most ground is clear or clouded altogether, which a table of cosines is exact enough to tell.
    """
    count, rough = waves.shape[0], 0.0
    for m in range(count):
        phase = waves[m, 0] * x + waves[m, 1] * y + waves[m, 2] * z + waves[m, 3]
        rough += _COSINES[math.floor(phase * _PER_RADIAN) & (_STEPS - 1)]
    scale = math.sqrt(2.0 / count) / earth[4]
    cover = rough * scale - earth[3] / earth[4] + 0.5
    # a cosine changes by no more than its angle; a thousandth for rounding
    error = 1.001 * count * _STEP * scale
    if cover < -error:
        return 0.0
    if cover > 1.0 + error:
        return 1.0
    return float(min(max((_field(x, y, z, waves) - earth[3]) / earth[4] + 0.5, 0.0), 1.0))


@compiled
def cover_of(out: Floats, ground: Floats, earth: Floats, waves: Floats) -> None:
    """Write the share of clouds (P,) over ground (P, 3)."""
    for p in range(out.shape[0]):
        out[p] = _cover(ground[p, 0], ground[p, 1], ground[p, 2], earth, waves)


@compiled
def field_of(out: Floats, ground: Floats, waves: Floats) -> None:
    """Write the cloud field (P,) over ground (P, 3)."""
    for p in range(out.shape[0]):
        out[p] = _field(ground[p, 0], ground[p, 1], ground[p, 2], waves)


@compiled
def _radiance(sight: Vector, nadir: Vector, sun: Vector, earth: Floats, waves: Floats) -> float:
    """Radiance along a line of sight, in units of mean normal sunlight a steradian."""
    along = sight[0] * nadir[0] + sight[1] * nadir[1] + sight[2] * nadir[2]
    square = along * along - 1.0 + earth[0] * earth[0]
    if along <= 0.0 or square <= 0.0:
        return 0.0
    distance = along - math.sqrt(square)
    x = (distance * sight[0] - nadir[0]) / earth[0]
    y = (distance * sight[1] - nadir[1]) / earth[0]
    z = (distance * sight[2] - nadir[2]) / earth[0]
    lit = x * sun[0] + y * sun[1] + z * sun[2]
    if lit <= 0.0:
        return 0.0
    reflectance = earth[1]
    if waves.shape[0] > 0:
        reflectance += (earth[2] - earth[1]) * _cover(x, y, z, earth, waves)
    return float(reflectance * lit / math.pi)


@compiled
def gather(
    out: Floats,
    sky: tuple[Floats, Floats],
    scene: tuple[Floats, Floats],
    world: tuple[Floats, Floats],
) -> None:
    """Write what elements receive from the Earth, (N, K).

    Parameters
    ----------
    out
        (N, K), overwritten.
    sky
        (J, 3) directions, and (J, K) response to each times its solid angle.
    scene
        (N, 3) nadir, and (N, 3) Sun.
    world
        Earth (5,) and waves (M, 4).
    """
    directions, weights = sky
    nadir, sun = scene
    earth, waves = world
    out[:] = 0.0
    for n in range(out.shape[0]):
        below = nadir[n, 0], nadir[n, 1], nadir[n, 2]
        above = sun[n, 0], sun[n, 1], sun[n, 2]
        for j in range(directions.shape[0]):
            sight = directions[j, 0], directions[j, 1], directions[j, 2]
            light = _radiance(sight, below, above, earth, waves)
            if light > 0.0:
                for k in range(out.shape[1]):
                    out[n, k] += light * weights[j, k]


@compiled
def _open_share(hole: Floats, x: float, y: float) -> float:
    """Share of a hole's area that both rims leave open, one displaced by (x, y)."""
    if hole[3] > 0.5:
        across = abs(hole[6] * x + hole[7] * y) / (2.0 * hole[4])
        along = abs(hole[6] * y - hole[7] * x) / (2.0 * hole[5])
        return float(max(1.0 - across, 0.0) * max(1.0 - along, 0.0))
    apart = min(math.sqrt(x * x + y * y) / (2.0 * hole[4]), 1.0)
    return float(2.0 / math.pi * (math.acos(apart) - apart * math.sqrt(1.0 - apart * apart)))


@compiled
def _towards(x: float, y: float, table: Floats, step: float) -> Vector:
    """Line of sight from a point (x, y) beside an opening's foot; no farther than tabulated."""
    radius = math.sqrt(x * x + y * y)
    place = min(radius / step, table.shape[0] - 1.000001)
    node = int(place)
    sine = table[node, 0] + (place - node) * (table[node + 1, 0] - table[node, 0])
    turn = sine / radius if radius > 0.0 else 0.0
    return turn * x, turn * y, math.sqrt(1.0 - sine * sine)


@compiled
def _in_view(box: Floats, table: Floats, step: float, nadir: Floats, reach: float) -> bool:
    """Whether a cone about all lines of sight of a window meets that of the Earth.

    `box` (4,) holds the least and largest x and y of points from openings.
    """
    x, y, z = _towards((box[0] + box[1]) / 2.0, (box[2] + box[3]) / 2.0, table, step)
    widest = 1.0
    for corner in range(4):
        u, v, w = _towards(box[corner % 2], box[2 + corner // 2], table, step)
        widest = min(widest, x * u + y * v + z * w)
    off = math.acos(min(max(x * nadir[0] + y * nadir[1] + z * nadir[2], -1.0), 1.0))
    return off < math.acos(widest) + math.asin(reach)


@compiled
def behind_mask(
    out: Floats,
    grid: tuple[Floats, Floats],
    mask: tuple[Floats, Floats, float, float],
    scene: tuple[Floats, Floats],
    world: tuple[Floats, Floats],
) -> None:
    """Write the Earth's irradiance at points of the detector, (N, R, C).

    Parameters
    ----------
    out
        (N, R, C), overwritten; units of mean normal sunlight.
    grid
        (N, 2) first point's place from the mask's middle, mm; (2,) steps along x and y, mm.
    mask
        (Q, 8) points of the openings: x, y, area, mm and mm^2, then kind, half widths, cosine and
        sine as in `Mask.table`; (T, 2) sine of the incidence that lands at a distance and the
        light a square millimetre of opening gives there; the table's step, mm; the foil's
        thickness, mm.
    scene, world
        As of `gather`.
    """
    first, steps = grid
    holes, table, step, thickness = mask
    nadir, sun = scene
    earth, waves = world
    last = table.shape[0] - 1
    box = np.empty(4)
    spans = steps[0] * (out.shape[2] - 1), steps[1] * (out.shape[1] - 1)
    for n in range(out.shape[0]):
        for axis in range(2):
            box[2 * axis] = first[n, axis] - holes[:, axis].max()
            box[2 * axis + 1] = first[n, axis] + spans[axis] - holes[:, axis].min()
        if not _in_view(box, table, step, nadir[n], earth[0]):
            out[n] = 0.0
            continue
        below = nadir[n, 0], nadir[n, 1], nadir[n, 2]
        above = sun[n, 0], sun[n, 1], sun[n, 2]
        for row in range(out.shape[1]):
            for column in range(out.shape[2]):
                total = 0.0
                for q in range(holes.shape[0]):
                    x = first[n, 0] + column * steps[0] - holes[q, 0]
                    y = first[n, 1] + row * steps[1] - holes[q, 1]
                    place = math.sqrt(x * x + y * y) / step
                    node = int(place)
                    if node >= last:
                        continue
                    sight = _towards(x, y, table, step)
                    light = _radiance(sight, below, above, earth, waves)
                    if light > 0.0:
                        share = table[node, 1]
                        share += (place - node) * (table[node + 1, 1] - table[node, 1])
                        if thickness > 0.0:
                            slope = thickness / sight[2]
                            share *= _open_share(holes[q], slope * sight[0], slope * sight[1])
                        total += light * share * holes[q, 2]
                out[n, row, column] = total


@compiled
def add_between(light: Floats, nodes: Floats) -> None:
    """Add to frames (N, H, W) what lies between nodes (N, R, C) over their corners, bilinearly.

    Node (0, 0) is the first pixel's centre, the last one the last pixel's; one node along an axis
    stands for all of it.
    """
    rows, columns = light.shape[1], light.shape[2]
    tall, wide = nodes.shape[1], nodes.shape[2]
    for n in range(light.shape[0]):
        for row in range(rows):
            y = row * (tall - 1) / max(rows - 1, 1)
            top = min(int(y), max(tall - 2, 0))
            low = min(top + 1, tall - 1)
            v = y - top
            for column in range(columns):
                x = column * (wide - 1) / max(columns - 1, 1)
                left = min(int(x), max(wide - 2, 0))
                right = min(left + 1, wide - 1)
                u = x - left
                above = nodes[n, top, left] + u * (nodes[n, top, right] - nodes[n, top, left])
                below = nodes[n, low, left] + u * (nodes[n, low, right] - nodes[n, low, left])
                light[n, row, column] += above + v * (below - above)

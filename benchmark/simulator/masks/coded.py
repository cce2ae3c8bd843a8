"""Masks larger than their detector, whose local pattern tells which part of them is seen.

The Sun's direction decides which part of the mask throws its light on the detector, so that one
small detector serves every sub-field in turn (the survey's model:code).
"""

from __future__ import annotations

import math

from benchmark.seeds import generator
from benchmark.simulator.masks.apertures import Aperture, Mask


def subfield_pitch_mm(subfields: int, half_field_deg: float, focal_length_mm: float) -> float:
    """Distance of neighbouring groups, for `subfields` an axis over +-`half_field_deg`."""
    return 2.0 * focal_length_mm * math.tan(math.radians(half_field_deg)) / subfields


def spacing_coded(
    subfields: int,
    *,
    pitch_mm: float,
    diameter_mm: float,
    first_mm: float,
    step_mm: float,
    thickness_mm: float = 0.0,
) -> Mask:
    """Return groups of three round apertures whose spacings name the sub-field (Wei2014).

    Group (i, j) of `subfields` x `subfields`, i along x, has a corner aperture, one at
    ``first + i step`` in +x and one at ``first + j step`` in +y from it. Groups stand on a square
    lattice of `pitch_mm`, each centred in its cell up to half its own code. The gap from a
    group's second aperture to the next corner is larger than every coded spacing, so that no two
    apertures of different groups look like a pair.

    Apertures are ordered row of groups by row, in a group corner, +x, +y.

    Raises
    ------
    ValueError
        When spacings do not exceed the diameter, or a gap between groups could be read as a code.
    """
    longest = first_mm + (subfields - 1) * step_mm
    if first_mm <= diameter_mm:
        raise ValueError(f"first_mm must exceed the diameter of {diameter_mm} mm; got {first_mm}")
    if pitch_mm - longest <= longest + step_mm:
        raise ValueError(
            f"spacings up to {longest:.4g} mm are ambiguous in cells of {pitch_mm:.4g} mm: the "
            f"gap to the next group must exceed {longest + step_mm:.4g} mm"
        )
    apertures = []
    back = (first_mm + longest) / 4.0  # half the mean spacing
    for j in range(subfields):
        for i in range(subfields):
            x = (i - (subfields - 1) / 2.0) * pitch_mm - back
            y = (j - (subfields - 1) / 2.0) * pitch_mm - back
            across, along = first_mm + i * step_mm, first_mm + j * step_mm
            apertures += [
                _hole(diameter_mm, x, y),
                _hole(diameter_mm, x + across, y),
                _hole(diameter_mm, x, y + along),
            ]
    return Mask(tuple(apertures), thickness_mm)


def compound_eye(
    apertures: int,
    rings: int,
    *,
    pitch_mm: float,
    diameter_mm: float,
    code_mm: float,
    focal_length_mm: float,
    thickness_mm: float = 0.0,
) -> Mask:
    """Return a lensless compound eye: a disc of apertures divided into hexagonal sub-eyes.

    The layout of Zhang2021 as the survey tells it: a round pattern of apertures of varying size,
    coded sub-eye by sub-eye. Here the `apertures` innermost points of a triangular lattice of
    `pitch_mm` belong to the nearest of ``3 rings (rings + 1) + 1`` sub-eyes, also on a triangular
    lattice. Within a sub-eye each aperture is moved by `code_mm` in a direction drawn for that
    sub-eye alone, so that correlation finds the sub-eye seen; its diameter is `diameter_mm`
    times ``sqrt(1/cos(theta))`` at the sub-eye's centre, which keeps the Fresnel number along
    the slant ray.

    Ordered from the middle out.

    Raises
    ------
    ValueError
        When moved apertures could overlap.
    """
    radius = pitch_mm * math.sqrt(apertures * math.sqrt(3.0) / 2.0 / math.pi)
    steepest = math.sqrt(math.hypot(1.0, radius / focal_length_mm))
    if pitch_mm - 2.0 * code_mm <= diameter_mm * steepest:
        raise ValueError(
            f"apertures of up to {diameter_mm * steepest:.4g} mm moved by {code_mm} mm overlap at "
            f"a pitch of {pitch_mm} mm"
        )
    reach = math.ceil(radius / pitch_mm) + 2
    points = sorted(_triangular(reach, pitch_mm), key=_from_middle)[:apertures]
    # sub-eyes of equal area: as many cells as there are centres fill the disc
    cells = 3 * rings * (rings + 1) + 1
    apart = radius * math.sqrt(2.0 * math.pi / (math.sqrt(3.0) * cells))
    centres = [
        (x, y)
        for q, r, (x, y) in _triangular_indexed(rings, apart)
        if max(abs(q), abs(r), abs(q + r)) <= rings
    ]
    streams = [generator("compound-eye", "code", k) for k in range(len(centres))]
    holes = []
    for x, y in points:
        eye = min(range(len(centres)), key=lambda k: math.dist(centres[k], (x, y)))
        turn = 2.0 * math.pi * streams[eye].random()
        slant = math.hypot(1.0, math.hypot(*centres[eye]) / focal_length_mm)
        holes.append(
            _hole(
                diameter_mm * math.sqrt(slant),
                x + code_mm * math.cos(turn),
                y + code_mm * math.sin(turn),
            )
        )
    return Mask(tuple(holes), thickness_mm)


def _hole(diameter_mm: float, x_mm: float, y_mm: float) -> Aperture:
    # drawings are made in tenths of a micrometre
    return Aperture(
        "round", round(diameter_mm, 4), round(diameter_mm, 4), round(x_mm, 4), round(y_mm, 4)
    )


def _triangular_indexed(reach: int, pitch: float) -> list[tuple[int, int, tuple[float, float]]]:
    steps = range(-reach, reach + 1)
    rise = math.sqrt(3.0) / 2.0
    return [(q, r, ((q + r / 2.0) * pitch, r * rise * pitch)) for r in steps for q in steps]


def _triangular(reach: int, pitch: float) -> list[tuple[float, float]]:
    return [point for _, _, point in _triangular_indexed(2 * reach, pitch)]


def _from_middle(point: tuple[float, float]) -> tuple[float, float]:
    """Sort by distance, then by angle; rounded, so that equal distances are equal."""
    return round(math.hypot(*point), 6), round(math.atan2(point[1], point[0]), 6)

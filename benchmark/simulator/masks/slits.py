"""Layouts of slits over a linear array, and how a built slit plate stands off it.

Coordinates are those of one array: u along it, v across it, origin above its middle. A slit of
slant rho crosses the array's axis at its position; its spot falls ``D_u + D_v tan(rho)`` from
there when the mask's shadow is displaced by D.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from benchmark.simulator.masks.apertures import Aperture, Mask


@dataclass(frozen=True)
class SlitErrors:
    """How the plate with the slits stands over the arrays (eq:slit, KeQiang2020).

    Attributes
    ----------
    deflection_deg
        Rotation of the plate in its own plane, from the detector's x towards its y axis: the
        slit is not square to the array.
    inclination_deg
        Tilt of the plate about each array's axis: one end of the slit is higher than the other.
        The far end (+v) is the higher one where it is positive. A point Sun then puts a slit's
        spot at ``h tan(u) / (1 + tan(v) tan(inclination))`` instead of ``h tan(u)``, with u and
        v the angles along and across the array; the survey's delta has the other sign.
    """

    deflection_deg: float = 0.0
    inclination_deg: float = 0.0


def slit(
    width_mm: float, length_mm: float, position_mm: float = 0.0, slant_deg: float = 0.0
) -> Aperture:
    """One slit; the width is across the slit, the slant 0 for one square to the array."""
    return Aperture("rectangle", width_mm, length_mm, x_mm=position_mm, rotation_deg=slant_deg)


def slit_row(
    positions_mm: Sequence[float], width_mm: float, length_mm: float, thickness_mm: float = 0.0
) -> Mask:
    """Slits square to the array: one is the single slit, several the multi-slit mask."""
    return Mask(tuple(slit(width_mm, length_mm, at) for at in positions_mm), thickness_mm)


def n_slit(
    spacing_mm: float, slant_deg: float, width_mm: float, length_mm: float, thickness_mm: float
) -> Mask:
    """Two parallel slanted slits `spacing_mm` on either side of one square to the array.

    The survey's N (model:nslit, Maji2015): the middle spot moves with one angle only, both
    others with both. `length_mm` is what the slits span across the array.
    """
    slanted = [_spanning(length_mm, width_mm, at, slant_deg) for at in (-spacing_mm, spacing_mm)]
    return Mask((slanted[0], slit(width_mm, length_mm), slanted[1]), thickness_mm)


def v_slit(
    positions_mm: tuple[float, float],
    slant_deg: float,
    width_mm: float,
    length_mm: float,
    thickness_mm: float,
) -> Mask:
    """Put slits at two positions: one square to the array, then a slanted one (model:vslit)."""
    return Mask(
        (
            slit(width_mm, length_mm, positions_mm[0]),
            _spanning(length_mm, width_mm, positions_mm[1], slant_deg),
        ),
        thickness_mm,
    )


def crossed_pairs(
    middle_mm: float,
    spacings_mm: tuple[float, float],
    width_mm: float,
    length_mm: float,
    thickness_mm: float,
) -> Mask:
    """Two pairs of parallel slits at right angles to each other, at 45 deg to the array.

    The pair at ``-middle_mm`` slants by -45, the one at ``+middle_mm`` by +45 deg, so their
    spots move by ``D_u - D_v`` and ``D_u + D_v``. The two spacings, one a pair, tell them apart.
    """
    return Mask(
        tuple(
            _spanning(length_mm, width_mm, middle + side * spacing / 2.0, slant)
            for middle, spacing, slant in (
                (-middle_mm, spacings_mm[0], -45.0),
                (middle_mm, spacings_mm[1], 45.0),
            )
            for side in (-1.0, 1.0)
        ),
        thickness_mm,
    )


def periodic(
    count: int,
    period_mm: float,
    width_mm: float,
    length_mm: float,
    thickness_mm: float = 0.0,
) -> Mask:
    """`count` equally spaced slits about the middle (model:periodic)."""
    places = [(number - (count - 1) / 2.0) * period_mm for number in range(count)]
    return slit_row(places, width_mm, length_mm, thickness_mm)


def without(mask: Mask, closed: Sequence[int]) -> Mask:
    """Return the mask without the apertures of these numbers (position codes are gaps)."""
    kept = tuple(a for number, a in enumerate(mask.apertures) if number not in set(closed))
    return Mask(kept, mask.thickness_mm)


def slit_rows(mask: Mask) -> tuple[tuple[float, float, float], ...]:
    """(position mm, slant deg, width mm) of every slit: `SensorGeometry.slits`."""
    return tuple((a.x_mm, a.rotation_deg, a.width_mm) for a in mask.apertures)


def _spanning(span_mm: float, width_mm: float, position_mm: float, slant_deg: float) -> Aperture:
    length = span_mm / math.cos(math.radians(slant_deg))
    return slit(width_mm, length, position_mm, slant_deg)

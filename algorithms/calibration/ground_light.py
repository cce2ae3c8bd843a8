"""Light that the sunlit ground below a satellite sends up, direction by direction."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from algorithms.contract import Floats
from algorithms.row_arithmetic import normalise

EARTH_RADIUS_KM = 6371.0

#: Rings and spokes of lines of sight to the visible ground.
_RINGS, _SPOKES = 8, 24
#: Samples whose ground is lit together; memory only.
_BATCH = 256


def ground_light(
    sun: Floats, nadir: Floats, altitude_km: float
) -> Iterator[tuple[slice, Floats, Floats]]:
    """Yield light of a ground that sends all sunlight back, by Lambert's law, batch by batch.

    Parameters
    ----------
    sun, nadir : ndarray, shape (N, 3)
        Unit vectors of the sensor's frame.
    altitude_km : float
        Height of the orbit.

    Yields
    ------
    rows : slice
        Of a batch of B samples.
    directions : ndarray, shape (B, J, 3)
        Unit vectors towards the visible ground.
    light : ndarray, shape (B, J)
        Irradiance from there across the direction, in units of sunlight.
    """
    sight, solid_angle = _lines_of_sight(altitude_km)
    ground = ground_points(altitude_km)
    for start in range(0, len(sun), _BATCH):
        rows = slice(start, start + _BATCH)
        frame = _frames(sun[rows], nadir[rows])
        local_sun = np.einsum("nij,nj->ni", frame, sun[rows])
        light = np.maximum(local_sun @ ground.T, 0.0) * (solid_angle / math.pi)
        yield rows, np.einsum("nij,li->nlj", frame, sight), light


def ground_points(altitude_km: float) -> Floats:
    """Return the ground (J, 3) that the lines of sight meet, from Earth's centre; nadir is z.

    In units of the Earth's radius.
    """
    sight, _ = _lines_of_sight(altitude_km)
    reach = EARTH_RADIUS_KM / (EARTH_RADIUS_KM + altitude_km)
    # in units of the distance to the Earth's centre
    distance = sight[:, 2] - np.sqrt(np.maximum(sight[:, 2] ** 2 - 1.0 + reach**2, 0.0))
    return np.asarray((distance[:, None] * sight - [0.0, 0.0, 1.0]) / reach)


def _lines_of_sight(altitude_km: float) -> tuple[Floats, Floats]:
    """Directions (J, 3) about the nadir, which is z, over the visible ground; solid angles (J,)."""
    reach = EARTH_RADIUS_KM / (EARTH_RADIUS_KM + altitude_km)
    edge = math.sqrt(1.0 - reach**2)
    nodes, shares = np.polynomial.legendre.leggauss(_RINGS)
    cosine = np.repeat(edge + (1.0 - edge) * (nodes + 1.0) / 2.0, _SPOKES)
    turn = np.tile(2.0 * math.pi * (np.arange(_SPOKES) + 0.5) / _SPOKES, _RINGS)
    sine = np.sqrt(1.0 - cosine**2)
    sight = np.column_stack([sine * np.cos(turn), sine * np.sin(turn), cosine])
    return sight, np.repeat(shares * (1.0 - edge) / 2.0, _SPOKES) * (2.0 * math.pi / _SPOKES)


def _frames(sun: Floats, nadir: Floats) -> Floats:
    """(N, 3, 3) rotations whose z is the nadir and whose x is on the Sun's side of it."""
    across = sun - (sun * nadir).sum(axis=1, keepdims=True) * nadir
    other = np.eye(3)[np.abs(nadir).argmin(axis=1)]
    other = other - (other * nadir).sum(axis=1, keepdims=True) * nadir
    still = (across**2).sum(axis=1, keepdims=True) < 1e-12
    x = normalise(np.where(still, other, across))
    return np.stack([x, np.cross(nadir, x), nadir], axis=1)

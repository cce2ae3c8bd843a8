"""How the faces of maskless sensors are arranged: regular pyramids and spheres.

The cube is `benchmark.simulator.sensors.faces.CUBE`.
"""

from __future__ import annotations

import math

Normals = tuple[tuple[float, float, float], ...]


def pyramid(faces: int, tilt_deg: float, first_azimuth_deg: float = 0.0) -> Normals:
    """Outward normals of a regular pyramid's faces, in the order of their azimuth.

    Parameters
    ----------
    faces
        At least three.
    tilt_deg
        Of every normal from the boresight +z, in (0, 90): the complement of the elevation gamma
        of eq:msfpyra1 (Wang2019).
    first_azimuth_deg
        Of the first face, from +x towards +y; eq:msfpyra1 counts its azimuths from +y to +x.

    Raises
    ------
    ValueError
        When a parameter is outside its range.
    """
    if faces < 3:
        raise ValueError(f"a pyramid has at least 3 faces; got {faces}")
    if not 0 < tilt_deg < 90:
        raise ValueError(f"tilt_deg must be in (0, 90); got {tilt_deg}")
    up, out = math.cos(math.radians(tilt_deg)), math.sin(math.radians(tilt_deg))
    azimuths = [math.radians(first_azimuth_deg + 360.0 * face / faces) for face in range(faces)]
    return tuple((out * math.cos(a), out * math.sin(a), up) for a in azimuths)


def sphere(faces: int) -> Normals:
    """Outward normals of faces spread evenly over a sphere: a Fibonacci lattice from +z to -z."""
    return lattice(faces, -1.0)


def lattice(count: int, lowest_cosine: float) -> Normals:
    """Directions on a Fibonacci lattice over the cap around +z, equal areas each.

    `lowest_cosine` in [-1, 1) is that of the cap's half angle: -1 for the whole sphere, 0 for a
    hemisphere.

    Raises
    ------
    ValueError
        When a parameter is outside its range.
    """
    if count < 1:
        raise ValueError(f"count must be at least 1; got {count}")
    if not -1 <= lowest_cosine < 1:
        raise ValueError(f"lowest_cosine must be in [-1, 1); got {lowest_cosine}")
    turn = math.pi * (3.0 - math.sqrt(5.0))
    points = []
    for step in range(count):
        z = 1.0 - (1.0 - lowest_cosine) * (2.0 * step + 1.0) / (2.0 * count)
        radius = math.sqrt(1.0 - z * z)
        points.append((radius * math.cos(turn * step), radius * math.sin(turn * step), z))
    return tuple(points)

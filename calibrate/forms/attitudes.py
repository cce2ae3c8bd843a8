"""Directions of the light in the sensor's frame: by attitudes, and the Sun's place by date."""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats

#: Departure of a quaternion's length, and of a matrix from orthonormal rows, that rounding makes.
_LENGTH, _ORTHONORMAL = 0.02, 0.02
#: Share of rows that have to be such.
_MOST = 0.95


def are_quaternions(columns: Floats) -> bool:
    """Say whether four columns (N, 4) have the length of one in most rows."""
    length = np.linalg.norm(columns, axis=1)
    return bool(np.mean(np.abs(length - 1.0) < _LENGTH) > _MOST)


def are_matrices(columns: Floats) -> bool:
    """Say whether nine columns (N, 9), row by row, are rotations in most rows."""
    return bool(_right(columns).mean() > _MOST)


def rotated(columns: Floats, light: Floats, *, scalar_first: bool, to_sensor: bool) -> Floats:
    """Return the light's direction (N, 3) in the sensor's frame; NaN rows of what is no rotation.

    Columns are quaternions (N, 4) or matrices row by row (N, 9), the light (N, 3) is that in the
    outer frame. `to_sensor` says whether ``v' = R v`` (or ``q v q*``) gives the sensor's frame; its
    inverse does otherwise.
    """
    matrices = (
        columns.reshape(-1, 3, 3)
        if columns.shape[1] == 9
        else _matrices(np.roll(columns, -1, axis=1) if scalar_first else columns)
    )
    if columns.shape[1] == 9:
        matrices = np.where(_right(columns)[:, None, None], matrices, np.nan)
    turned = np.einsum("nij,nj->ni" if to_sensor else "nji,nj->ni", matrices, light)
    length = np.linalg.norm(turned, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(turned / np.where(length > 0, length, np.nan)[:, None])


def _right(columns: Floats) -> np.ndarray:
    """Return which matrices (N,) have orthonormal rows and keep hands."""
    matrices = columns.reshape(-1, 3, 3)
    off = np.einsum("nij,nkj->nik", matrices, matrices) - np.eye(3)
    with np.errstate(invalid="ignore"):
        return np.asarray((np.abs(off).max(axis=(1, 2)) < _ORTHONORMAL) & (np.linalg.det(
            np.nan_to_num(matrices)) > 0))  # fmt: skip


def _matrices(quaternions: Floats) -> Floats:
    """Rotation matrices (N, 3, 3) of quaternions (x, y, z, w); NaN where the length is not one."""
    length = np.linalg.norm(quaternions, axis=1)
    near = np.abs(length - 1.0) < 10.0 * _LENGTH
    x, y, z, w = (quaternions / np.where(near, length, np.nan)[:, None]).T
    return np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], axis=1),
            np.stack([2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)], axis=1),
            np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1),
        ],
        axis=1,
    )


#: Seconds of 1970 at J2000.0 (12 h terrestrial time of 1 January 2000), and of a century.
_J2000_S, _CENTURY_S = 946_728_000.0, 36_525 * 86_400.0
#: Terrestrial time minus UTC since 2017, seconds.
_TT_UTC_S = 69.184
#: Aberration of the Sun, degrees: light time and the Earth's motion together.
_ABERRATION_DEG = -0.005693
#: Precession in longitude since J2000, degrees a century.
_PRECESSION_DEG = (1.396971, 0.0003086)
_OBLIQUITY_DEG = 23.4392911
#: What planets and the Moon add to the longitude: amplitude, phase and rate, degrees and a century.
_TERMS = (
    (0.00134, 153.23, 22518.7541),  # Venus
    (0.00154, 216.57, 45037.5082),
    (0.00200, 312.69, 32964.3577),  # Jupiter
    (0.00179, 350.74 - 90.0, 445267.1142),  # Moon
    (0.00178, 231.19 - 90.0, 20.20),
)


def sun_by_date(seconds: Floats) -> Floats:
    """Return the Sun's apparent direction (N, 3) from Earth's centre in the frame of J2000.

    By seconds since 1970, UTC, and the Sun's mean elements with the largest perturbations (Meeus,
    Astronomical Formulae for Calculators, chapter 18). Light time and the aberration of the Earth's
    motion are included, a satellite's own motion (up to 0.0015 deg) and parallax (0.003 deg in a
    low orbit) are not.
    """
    t = (np.asarray(seconds, dtype=np.float64) + _TT_UTC_S - _J2000_S) / _CENTURY_S
    t1900 = t + 1.0
    mean = 279.69668 + 36000.76892 * t1900 + 0.0003025 * t1900**2
    anomaly = np.radians(
        358.47583 + 35999.04975 * t1900 - 0.000150 * t1900**2 - 0.0000033 * t1900**3
    )
    centre = (
        (1.919460 - 0.004789 * t1900 - 0.000014 * t1900**2) * np.sin(anomaly)
        + (0.020094 - 0.000100 * t1900) * np.sin(2.0 * anomaly)
        + 0.000293 * np.sin(3.0 * anomaly)
    )
    planets = sum(size * np.cos(np.radians(phase + rate * t1900)) for size, phase, rate in _TERMS)
    precession = _PRECESSION_DEG[0] * t + _PRECESSION_DEG[1] * t**2
    longitude = np.radians(mean + centre + planets + _ABERRATION_DEG - precession)
    tilt = np.radians(_OBLIQUITY_DEG)
    sine = np.sin(longitude)
    return np.column_stack([np.cos(longitude), sine * np.cos(tilt), sine * np.sin(tilt)])

"""Sun directions as unit vectors, as projected angles and as rotation angles, all in degrees.

Three pairs of angles are in use and agree only on the axes: projected angles
(``tan(alpha) = s_y/s_z``, ``tan(beta) = s_x/s_z``, eq:stdproj) and rotation angles, a turntable's,
with alpha inside (``s = (sin(beta) cos(alpha), sin(alpha), cos(beta) cos(alpha))``, eq:lsq) or with
beta inside (``s = (sin(beta), cos(beta) sin(alpha), cos(beta) cos(alpha))``).
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import Floats

Inner = Literal["alpha", "beta"]


def angles_from_sun(sun: ArrayLike) -> Floats:
    """Projected angles of Sun vectors.

    Parameters
    ----------
    sun : array_like, shape (N, 3)
        Vectors to the Sun in the sensor frame; their length does not matter.

    Returns
    -------
    ndarray, shape (N, 2)
        ``(alpha, beta)`` in degrees; a NaN row where the Sun is not in front (``s_z <= 0``).

    Raises
    ------
    ValueError
        If `sun` is not (N, 3).

    Examples
    --------
    >>> angles_from_sun([[0.0, 1.0, 1.0], [0.0, 0.0, -1.0]])
    array([[45.,  0.],
           [nan, nan]])
    """
    return np.degrees(np.arctan(tangents_from_sun(sun)))


def sun_from_angles(angles_deg: ArrayLike) -> Floats:
    """Sun unit vectors of projected angles; the inverse of `angles_from_sun`.

    Parameters
    ----------
    angles_deg : array_like, shape (N, 2)
        ``(alpha, beta)`` in degrees.

    Returns
    -------
    ndarray, shape (N, 3)
        Unit vectors; a NaN row where an angle is NaN or reaches 90 degrees.

    Raises
    ------
    ValueError
        If `angles_deg` is not (N, 2).

    Examples
    --------
    >>> sun_from_angles([[0.0, 45.0], [0.0, 90.0]]).round(3)
    array([[0.707, 0.   , 0.707],
           [  nan,   nan,   nan]])
    """
    angles = _rows(angles_deg, 2, "angles_deg")
    tangents = np.tan(np.radians(angles))
    tangents[~(np.abs(angles) < 90.0)] = np.nan
    return sun_from_tangents(tangents)


def tangents_from_sun(sun: ArrayLike) -> Floats:
    """Tangents of the projected angles of Sun vectors (eq:stdproj).

    Parameters
    ----------
    sun : array_like, shape (N, 3)
        Vectors to the Sun in the sensor frame; their length does not matter.

    Returns
    -------
    ndarray, shape (N, 2)
        ``(tan(alpha), tan(beta)) = (s_y / s_z, s_x / s_z)``; a NaN row where ``s_z <= 0``.

    Raises
    ------
    ValueError
        If `sun` is not (N, 3).

    Examples
    --------
    >>> tangents_from_sun([[0.5, 1.0, 2.0]])
    array([[0.5 , 0.25]])
    """
    vectors = _rows(sun, 3, "sun")
    tangents = np.full((len(vectors), 2), np.nan)
    front = vectors[:, 2] > 0
    tangents[front] = vectors[front][:, [1, 0]] / vectors[front][:, 2:]
    return tangents


def sun_from_tangents(tangents: ArrayLike) -> Floats:
    """Sun unit vectors of tangents; the inverse of `tangents_from_sun`.

    Parameters
    ----------
    tangents : array_like, shape (N, 2)
        ``(tan(alpha), tan(beta))``.

    Returns
    -------
    ndarray, shape (N, 3)
        Unit vectors; NaN rows stay NaN.

    Raises
    ------
    ValueError
        If `tangents` is not (N, 2).

    Examples
    --------
    >>> sun_from_tangents([[0.0, 0.75]])
    array([[0.6, 0. , 0.8]])
    """
    alpha, beta = _rows(tangents, 2, "tangents").T
    length = alpha * alpha
    length += beta * beta
    length += 1.0
    np.sqrt(length, out=length)
    length[~np.isfinite(length)] = np.nan
    sun = np.empty((len(length), 3))
    for component, column in zip((beta, alpha, 1.0), sun.T, strict=True):
        np.divide(component, length, out=column)
    return sun


def rotations_from_sun(sun: ArrayLike, inner: Inner = "alpha") -> Floats:
    """Rotation angles of Sun vectors: the axes of a two-axis turntable (eq:lsq).

    Parameters
    ----------
    sun : array_like, shape (N, 3)
        Vectors to the Sun in the sensor frame.
    inner : {"alpha", "beta"}
        The axis next to the sensor, which the other one carries: alpha, about x, as eq:lsq has
        it, or beta, about y.

    Returns
    -------
    ndarray, shape (N, 2)
        ``(alpha, beta)`` in degrees: ``alpha = asin(s_y)`` and ``beta = atan2(s_x, s_z)``, or with
        beta inside ``beta = asin(s_x)`` and ``alpha = atan2(s_y, s_z)``.

    Raises
    ------
    ValueError
        If `sun` is not (N, 3), or `inner` is neither axis.

    Examples
    --------
    >>> rotations_from_sun([[0.0, 1.0, 0.0], [1.0, 0.0, 1.0]])
    array([[90.,  0.],
           [ 0., 45.]])
    >>> rotations_from_sun([[0.48, 0.64, 0.6]]).round(2)
    array([[39.79, 38.66]])
    >>> rotations_from_sun([[0.48, 0.64, 0.6]], inner="beta").round(2)
    array([[46.85, 28.69]])
    """
    x, y, z = _rows(sun, 3, "sun").T
    if _require_axis(inner) == "alpha":
        rotations = np.column_stack([np.arctan2(y, np.hypot(x, z)), np.arctan2(x, z)])
    else:
        rotations = np.column_stack([np.arctan2(y, z), np.arctan2(x, np.hypot(y, z))])
    return np.asarray(np.degrees(rotations), dtype=np.float64)


def sun_from_rotations(rotations_deg: ArrayLike, inner: Inner = "alpha") -> Floats:
    """Sun unit vectors of rotation angles; the inverse of `rotations_from_sun`.

    Parameters
    ----------
    rotations_deg : array_like, shape (N, 2)
        ``(alpha, beta)`` in degrees, any.
    inner : {"alpha", "beta"}
        The axis next to the sensor.

    Returns
    -------
    ndarray, shape (N, 3)
        ``(sin(beta) cos(alpha), sin(alpha), cos(beta) cos(alpha))``, or with beta inside
        ``(sin(beta), cos(beta) sin(alpha), cos(beta) cos(alpha))``.

    Raises
    ------
    ValueError
        If `rotations_deg` is not (N, 2), or `inner` is neither axis.

    Examples
    --------
    >>> sun_from_rotations([[30.0, 0.0]]).round(3)
    array([[0.   , 0.5  , 0.866]])
    """
    alpha, beta = np.radians(_rows(rotations_deg, 2, "rotations_deg")).T
    if _require_axis(inner) == "alpha":
        x, y = np.sin(beta) * np.cos(alpha), np.sin(alpha)
    else:
        x, y = np.sin(beta), np.cos(beta) * np.sin(alpha)
    return np.column_stack([x, y, np.cos(beta) * np.cos(alpha)])


def separation_deg(first: ArrayLike, second: ArrayLike) -> Floats:
    """Angle between paired vectors, exact for the smallest and the largest angles alike.

    ``atan2(|a x b|, a . b)``: the arc cosine of the dot product loses every angle below about
    1e-6 degrees.

    Parameters
    ----------
    first, second : array_like, shape (N, 3)
        Vectors; their lengths do not matter.

    Returns
    -------
    ndarray, shape (N,)
        Degrees in [0, 180]; NaN where either vector has a NaN.

    Raises
    ------
    ValueError
        If an array is not (N, 3) or their lengths differ.

    Examples
    --------
    >>> separation_deg([[0.0, 0.0, 1.0]], [[0.0, 1e-9, 1.0]])
    array([5.72957795e-08])
    """
    a, b = _rows(first, 3, "first"), _rows(second, 3, "second")
    if len(a) != len(b):
        raise ValueError(f"first and second must pair up; got {len(a)} and {len(b)} rows")
    cross = np.linalg.norm(np.cross(a, b), axis=1)
    angle = np.degrees(np.arctan2(cross, np.einsum("ij,ij->i", a, b)))
    return np.asarray(angle, dtype=np.float64)


def _require_axis(inner: str) -> str:
    if inner not in get_args(Inner):
        raise ValueError(f"inner must be one of {', '.join(get_args(Inner))}; got {inner!r}")
    return inner


def _rows(values: ArrayLike, columns: int, name: str) -> Floats:
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != columns:
        raise ValueError(f"{name} must have shape (N, {columns}); got {array.shape}")
    return array

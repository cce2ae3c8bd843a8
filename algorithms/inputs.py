"""Checks at the door: what an extractor or model was given, as an array it can work on.

Every function raises ValueError saying what was expected and what came (UnusableDataError where
the form is right and the data are not enough), and never changes the caller's array.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.contract import (
    Floats,
    NotFittedError,
    UnusableDataError,
)

Frames = NDArray[Any]

UNIT_TOLERANCE = 1e-6
"""Largest departure from length one of a vector given as a unit vector."""

#: Numba compiles every kernel anew for each type, some seconds a piece at a first call. Two hold
#: what detectors give without loss; a third would pay for a copy it saves only after many frames.
_FRAME_DTYPES = np.dtype(np.uint16), np.dtype(np.float64)


def as_frames(observations: ArrayLike) -> Frames:
    """Frames (N, H, W) ready for a compiled kernel.

    Parameters
    ----------
    observations : array_like, shape (N, H, W)
        Real numbers. uint16 and float64 keep their type; uint8 and booleans become uint16, every
        other type float64 (exact for integers below 2**53).

    Returns
    -------
    ndarray, shape (N, H, W)
        Row-contiguous, aligned, in native byte order, read-only; a copy only where needed.

    Raises
    ------
    ValueError
        If the input is not three-dimensional, is empty, is masked or does not hold real numbers.

    Examples
    --------
    >>> as_frames([[[True, False], [False, False]]])
    array([[[1, 0],
            [0, 0]]], dtype=uint16)
    """
    array = _numbers(observations, "observations", 3, "(N, H, W)")
    dtype = array.dtype.newbyteorder("=")
    if array.dtype.kind == "b" or dtype == np.uint8:
        dtype = np.dtype(np.uint16)
    elif dtype not in _FRAME_DTYPES:
        dtype = np.dtype(np.float64)
    # The read-only flag is part of an array's type in Numba: one flag, one compilation.
    frames = np.require(array, dtype=dtype, requirements=["C_CONTIGUOUS", "ALIGNED"]).view()
    frames.flags.writeable = False
    return frames


def as_currents(observations: ArrayLike, columns: int, by: str) -> Floats:
    """Detector readings as float64.

    Parameters
    ----------
    observations : array_like, shape (N, columns)
        Real numbers.
    columns : int
        Elements of the detector.
    by : str
        Who reads them, for the message.

    Returns
    -------
    ndarray, shape (N, columns)
        A copy.

    Raises
    ------
    ValueError
        If the input is not (N, `columns`), is empty, is masked or does not hold real numbers;
        the message names `by`.

    Examples
    --------
    >>> as_currents([[1, 2, 3]], 4, "voltage-balance")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: voltage-balance reads observations of shape (N, 4), ...; got (1, 3)
    """
    array = _numbers(observations, f"observations of {by}", 2, f"(N, {columns})")
    if array.shape[1] != columns:
        raise ValueError(
            f"{by} reads observations of shape (N, {columns}), one column a detector element; "
            f"got {array.shape}"
        )
    return np.array(array, dtype=np.float64)


def as_features(features: ArrayLike, columns: int, by: str) -> Floats:
    """Features as float64, with every row that is not finite set to NaN.

    Parameters
    ----------
    features : array_like, shape (N, columns)
        Real numbers.
    columns : int
        Features of a sample.
    by : str
        Who reads them, for the message.

    Returns
    -------
    ndarray, shape (N, columns)
        A copy, of rows that are finite or NaN throughout.

    Raises
    ------
    ValueError
        If the input is not (N, `columns`), is empty, is masked or does not hold real numbers.

    Examples
    --------
    >>> as_features([[1, 2], [3, float("inf")]], 2, "spm")
    array([[ 1.,  2.],
           [nan, nan]])
    """
    found = np.array(as_feature_rows(features, columns, by), dtype=np.float64)
    if not np.isfinite(found).all():
        found[~np.isfinite(found).all(axis=1)] = np.nan
    return found


def as_feature_rows(features: ArrayLike, columns: int, by: str) -> NDArray[Any]:
    """Features as they are, with `as_features`' demands on their shape and type.

    Parameters
    ----------
    features, columns, by
        As `as_features` takes them.

    Returns
    -------
    ndarray, shape (N, columns)
        Not copied where they are an array already.

    Raises
    ------
    ValueError
        As `as_features`.

    Examples
    --------
    >>> as_feature_rows([[1, 2]], 2, "spm")
    array([[1, 2]])
    """
    array = _numbers(features, f"features of {by}", 2, f"(N, {columns})")
    if array.shape[1] != columns:
        raise ValueError(f"{by} reads features of shape (N, {columns}); got {array.shape}")
    return array


def as_calibration_rows(
    features: ArrayLike, sun: ArrayLike, columns: int, by: str, *, frontal: bool = False
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Paired features and Sun unit vectors, rows without features left out, and which are left.

    Parameters
    ----------
    features : array_like, shape (N, columns)
        Real numbers.
    sun : array_like, shape (N, 3)
        Unit vectors.
    columns : int
        Features of a sample.
    by : str
        Who reads them, for the message.
    frontal : bool
        Whether the Sun must be in front of the detector.

    Returns
    -------
    features : ndarray, shape (n, columns)
        Those that are finite.
    sun : ndarray, shape (n, 3)
        Of the same samples.
    usable : ndarray of bool, shape (N,)
        Which they are.

    Raises
    ------
    UnusableDataError
        If `frontal` and a row with features has its Sun at ``s_z <= 0``.
    ValueError
        If either shape is wrong, their lengths differ, or a Sun vector is not finite and of unit
        length within `UNIT_TOLERANCE`.

    Examples
    --------
    >>> _, _, usable = as_calibration_rows([[1, 2], [np.nan, 2]], [[0, 0, 1], [0, 1, 0]], 2, "spm")
    >>> usable
    array([ True, False])
    """
    found = as_features(features, columns, by)
    vectors = np.array(_numbers(sun, f"sun of {by}", 2, "(N, 3)"), dtype=np.float64)
    if vectors.shape != (len(found), 3):
        raise ValueError(
            f"{by} fits to sun of shape ({len(found)}, 3), one unit vector a feature row; "
            f"got {vectors.shape}"
        )
    lengths = np.linalg.norm(vectors, axis=1)
    wrong = ~(np.abs(lengths - 1.0) <= UNIT_TOLERANCE)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise ValueError(f"sun must hold unit vectors; row {row} has length {lengths[row]:.6g}")
    usable = np.asarray(~np.isnan(found).any(axis=1))
    found, vectors = found[usable], vectors[usable]
    behind = vectors[:, 2] <= 0
    if frontal and behind.any():
        raise UnusableDataError(
            f"{by} is a planar model: the Sun must be in front of the detector (s_z > 0); "
            f"{int(behind.sum())} calibration rows with features have s_z <= 0"
        )
    return found, vectors, usable


def require_samples(count: int, needed: int, by: str, why: str) -> None:
    """Refuse too few samples.

    Parameters
    ----------
    count : int
        Samples with features.
    needed : int
        Least number of them.
    by : str
        Who fits them, for the message.
    why : str
        What they are needed for, for the message.

    Raises
    ------
    UnusableDataError
        If `count` is below `needed`.

    Examples
    --------
    >>> require_samples(2, 3, "lsq", "five parameters, two angles a sample")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    algorithms.contract.UnusableDataError: lsq needs at least 3 samples with features (...); got 2
    """
    if count < needed:
        raise UnusableDataError(
            f"{by} needs at least {needed} samples with features ({why}); got {count}"
        )


def require_fitted(model: object, attribute: str) -> None:
    """Refuse to go on with a model that has not been fitted.

    Parameters
    ----------
    model : object
        A model.
    attribute : str
        What `fit` gives it.

    Raises
    ------
    NotFittedError
        If `model` does not carry `attribute`.

    Examples
    --------
    >>> require_fitted(object(), "table_deg_")
    Traceback (most recent call last):
    algorithms.contract.NotFittedError: this object is not fitted yet; call fit(features, sun) first
    """
    if not hasattr(model, attribute):
        raise NotFittedError(
            f"this {type(model).__name__} is not fitted yet; call fit(features, sun) first"
        )


def _numbers(values: ArrayLike, what: str, ndim: int, shape: str) -> NDArray[Any]:
    if isinstance(values, np.ma.MaskedArray):
        raise ValueError(  # noqa: TRY004 - the contract: wrong input is a ValueError
            f"{what} must be a plain array; got a masked one (mark missing values with NaN)"
        )
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ValueError(f"{what} must have shape {shape}; got a ragged sequence") from error
    if array.dtype.kind not in "buif":
        raise ValueError(f"{what} must hold real numbers; got dtype {array.dtype}")
    if array.ndim != ndim:
        raise ValueError(f"{what} must have shape {shape}; got {array.shape}")
    if array.size == 0:
        raise ValueError(f"{what} must not be empty; got shape {array.shape}")
    return array

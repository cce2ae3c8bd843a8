"""What is known of a sample beside its features: named columns, such as time or temperature."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

Context = Mapping[str, ArrayLike]

CONTEXT: dict[str, tuple[int, ...]] = {
    "time_s": (),
    "temperature_K": (),
    "illumination": (),
    "rate_deg_s": (3,),
    "eclipse": (),
    "albedo": (),
    "magnetic_field_nT": (3,),
    "nadir": (3,),
    "sun_inertial": (3,),
    "nadir_inertial": (3,),
    "magnetic_field_inertial_nT": (3,),
}
"""Columns by name, with the shape of a sample's value: a number, or a vector of the sensor's frame
(``_inertial``: of an inertial one). ``illumination`` is sunlight over its mean at one astronomical
unit; ``rate_deg_s`` is the body's mean rate since the sample before, as a gyroscope has it;
``eclipse`` and ``albedo`` are 0 or 1; ``nadir`` are unit vectors."""


def as_context(
    context: Context | None, wanted: tuple[str, ...], count: int, by: str
) -> dict[str, NDArray[np.float64]]:
    """Columns that a stage reads, checked, as float64.

    Parameters
    ----------
    context : mapping of str to array_like, optional
        Columns by name, of any names: those not wanted are not looked at.
    wanted : tuple of str
        Columns that are read, of `CONTEXT`.
    count : int
        Samples.
    by : str
        Who reads them, for the message.

    Returns
    -------
    dict of str to ndarray
        Copies, (count,) or (count, 3), of the columns wanted.

    Raises
    ------
    ValueError
        If a column is missing, has another shape, or does not hold real numbers.

    Examples
    --------
    >>> as_context({"temperature_K": [290, 300], "time_s": [0, 1]}, ("temperature_K",), 2, "drift")
    {'temperature_K': array([290., 300.])}
    >>> as_context({"temperature": [290]}, ("temperature_K",), 1, "drift")
    Traceback (most recent call last):
    ValueError: drift reads the context's temperature_K; got temperature
    """
    given = {} if context is None else context
    if not isinstance(given, Mapping):
        raise ValueError(  # noqa: TRY004 - the contract: wrong input is a ValueError
            f"context of {by} must map names of columns to values; got {type(given).__name__}"
        )
    if missing := [name for name in wanted if name not in given]:
        raise ValueError(
            f"{by} reads the context's {', '.join(missing)}; got {', '.join(given) or 'none'}"
        )
    columns = {}
    for name in wanted:
        array = np.asarray(given[name])
        shape = (count, *CONTEXT[name])
        if array.shape != shape or array.dtype.kind not in "buif":
            raise ValueError(
                f"context {name} of {by} must hold real numbers of shape {shape}; "
                f"got {array.dtype} {array.shape}"
            )
        columns[name] = np.array(array, dtype=np.float64)
    return columns


def complete(columns: Mapping[str, NDArray[np.float64]], count: int) -> NDArray[np.bool_]:
    """Whether each sample has a finite value in every column.

    Parameters
    ----------
    columns : mapping of str to ndarray
        As `as_context` gives them.
    count : int
        Samples.

    Returns
    -------
    ndarray of bool, shape (count,)
        True for all of them where there are no columns.

    Examples
    --------
    >>> complete({"temperature_K": np.array([290.0, np.nan])}, 2)
    array([ True, False])
    """
    known = np.ones(count, dtype=np.bool_)
    for column in columns.values():
        known &= np.isfinite(column).reshape(count, -1).all(axis=1)
    return known

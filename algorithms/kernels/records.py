"""Records of named numbers for compiled loops: one class names the fields and their types."""

from __future__ import annotations

from typing import Annotated, Any, get_type_hints

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

#: A field of two numbers, along x and along y.
Pair = Annotated[Floats, 2]
Records = NDArray[Any]
"""(N,) array of records: `records[k].field` in Python and in compiled loops."""


def record(fields: type) -> np.dtype[Any]:
    """Type of the records that have the annotated attributes of a class as their fields.

    Parameters
    ----------
    fields : type
        Class with annotations alone, each of them float, int, bool or `Pair`.

    Returns
    -------
    dtype
        Aligned record type: float64, int64, bool and two float64, in the order of the class.

    Examples
    --------
    >>> class Spot:
    ...     light: float
    ...     pixels: int
    >>> spots = np.zeros(2, dtype=record(Spot))
    >>> spots[1].light = 2.5
    >>> spots["light"]
    array([0. , 2.5])
    """
    types: dict[Any, Any] = {
        float: np.float64,
        int: np.int64,
        bool: np.bool_,
        Pair: (np.float64, 2),
    }
    hints = get_type_hints(fields, include_extras=True)
    layout: Any = {"names": [*hints], "formats": [types[hint] for hint in hints.values()]}
    return np.dtype((np.record, np.dtype(layout, align=True)))

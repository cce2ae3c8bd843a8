"""Refusals of wrong parameters: ValueError that names whose they are, what may be and what came."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, get_args


def require_positive(by: str, **parameters: float) -> None:
    """Refuse parameters that are not positive and finite.

    Parameters
    ----------
    by : str
        Whose parameters they are, for the message.
    **parameters : float
        By name.

    Raises
    ------
    ValueError
        Naming the first of them that is not.

    Examples
    --------
    >>> require_positive("spm", focal_length_mm=2.0, unit_mm=0.0)
    Traceback (most recent call last):
    ValueError: spm: unit_mm must be positive and finite; got 0.0
    """
    _require(
        by, parameters, lambda value: math.isfinite(value) and value > 0, "positive and finite"
    )


def require_within(by: str, interval: str, **parameters: float) -> None:
    """Refuse parameters outside an interval.

    Parameters
    ----------
    by : str
        Whose parameters they are, for the message.
    interval : str
        Its ends, such as ``"[0, 1)"``: a bracket belongs to it, a parenthesis does not.
    **parameters : float
        By name.

    Raises
    ------
    ValueError
        Naming the first of them that is not.

    Examples
    --------
    >>> require_within("mean-shift", "[0, 1)", similarity=1.0)
    Traceback (most recent call last):
    ValueError: mean-shift: similarity must be in [0, 1); got 1.0
    """
    low, high = (float(end) for end in interval[1:-1].split(","))

    def inside(value: float) -> bool:
        above = low <= value if interval[0] == "[" else low < value
        below = value <= high if interval[-1] == "]" else value < high
        return above and below

    _require(by, parameters, inside, f"in {interval}")


def require_at_least(by: str, least: float, **parameters: float) -> None:
    """Refuse parameters below a number.

    Parameters
    ----------
    by : str
        Whose parameters they are, for the message.
    least : float
        The smallest allowed.
    **parameters : float
        By name.

    Raises
    ------
    ValueError
        Naming the first of them that is below, or not a number.

    Examples
    --------
    >>> require_at_least("bscm", 1, loops=0)
    Traceback (most recent call last):
    ValueError: bscm: loops must be at least 1; got 0
    """
    _require(by, parameters, lambda value: value >= least, f"at least {least}")


def require_order(by: str, most: int, **parameters: int | None) -> None:
    """Refuse degrees and numbers of harmonics that are out of range.

    Parameters
    ----------
    by : str
        Whose parameters they are, for the message.
    most : int
        The largest allowed; the smallest is 1.
    **parameters : int or None
        By name; None lets the samples choose.

    Raises
    ------
    ValueError
        Naming the first of them that is out of range.

    Examples
    --------
    >>> require_order("polynomial", 7, degree=8)
    Traceback (most recent call last):
    ValueError: polynomial: degree must be from 1 to 7, or None; got 8
    """
    _require(
        by,
        parameters,
        lambda value: value is None or 1 <= value <= most,
        f"from 1 to {most}, or None",
    )


def require_choice(by: str, choices: object, **parameters: object) -> None:
    """Refuse parameters that are none of the words allowed.

    Parameters
    ----------
    by : str
        Whose parameters they are, for the message.
    choices : Literal
        The words.
    **parameters : object
        By name.

    Raises
    ------
    ValueError
        Naming the first of them that is not.

    Examples
    --------
    >>> from typing import Literal
    >>> require_choice("bcm", Literal["none", "median"], background="mean")
    Traceback (most recent call last):
    ValueError: bcm: background must be one of none, median; got 'mean'
    """
    allowed = get_args(choices)
    _require(by, parameters, lambda value: value in allowed, f"one of {', '.join(allowed)}")


def _require(
    by: str, parameters: Mapping[str, object], holds: Callable[[Any], bool], what: str
) -> None:
    """Raise ValueError for the first parameter that a condition does not hold of."""
    for name, value in parameters.items():
        if not holds(value):
            raise ValueError(f"{by}: {name} must be {what}; got {value!r}")

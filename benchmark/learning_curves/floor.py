"""Where a learning curve ends: its floor, and from how many poses on it is near.

The squared error of a calibration on K poses is modelled as ``f^2 + a K^-b``: what no pose takes
away (noise of the test readings, what extractor and model get wrong), and what
poses do. For a linear least squares fit of p parameters to readings of variance s^2 the excess is
``s^2 p / K``, b = 1; that of a table between whose poses is interpolated falls faster. The floor is
f and not the error with all poses: by the latter every curve would have reached its floor.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import nnls

from algorithms.contract import Floats

#: Near: an error of at most so many floors.
NEAR = 1.1
#: Exponents of the law that are tried: an excess does not fall slower than the variance of a mean.
EXPONENTS = tuple((np.arange(4, 13) / 4.0).tolist())
#: Sizes with an error, of every unit, below which no law is fitted.
FEWEST_SIZES = 5
#: Misfit, relative and root mean square over the errors, above which the law does not hold.
WORST_MISFIT = 0.1
#: Draws anew of the draws, and the share of them that the floor's range leaves out on either side.
_REPLICATES, _OUTSIDE = 100, 0.05

Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Floor:
    """Where the curves of the units of a sensor end.

    Of each unit (U,) the floor, and the range of nine in ten floors of draws drawn anew, so that
    the spread between draws is in it, and the spread between units is not. `exponent` is b of the
    law, `misfit` how far it misses the errors, relative. Where it is not fitted, the floor is the
    error with all poses, without a range.
    """

    error_deg: tuple[float, ...]
    low_deg: tuple[float, ...]
    high_deg: tuple[float, ...]
    exponent: float | None
    misfit: float | None
    is_fitted: bool


def floor_of(
    sizes: Sequence[int],
    errors_deg: ArrayLike,
    counted: ArrayLike,
    generator: np.random.Generator,
    *,
    lawful: bool = True,
) -> Floor | None:
    """Find the floor of each unit.

    A unit's curve is the median over draws of the squared error, at sizes where half of its draws
    count. Units have floors of their own, and poses help all alike: a and b are common.

    Numbers of poses (S,) ascend, the last is all of them; errors (U, D, S) by unit, draw and size
    are NaN where there is none, and `counted` says which of them count. `generator` is of the draws
    drawn anew; not `lawful` are poses that are not drawn at random.

    The error with all poses where fewer than `FEWEST_SIZES` sizes count, or the law misses by more
    than `WORST_MISFIT`; None where there is no error with all poses that counts.
    """
    errors = np.asarray(errors_deg, dtype=np.float64)
    usable = np.asarray(counted, dtype=np.bool_) & np.isfinite(errors)
    if errors.ndim != 3 or errors.shape != usable.shape or errors.shape[2] != len(sizes):
        raise ValueError(
            f"errors_deg and counted must have shape (U, D, {len(sizes)}); got {errors.shape} and "
            f"{usable.shape}"
        )
    if not usable[:, :, -1].all():
        return None
    whole = tuple(errors[:, 0, -1].tolist())
    plain = Floor(whole, whole, whole, None, None, is_fitted=False)
    if (
        not lawful
        or min(np.isfinite(_level(e, u)).sum() for e, u in zip(errors, usable, strict=True))
        < FEWEST_SIZES
    ):
        return plain
    floors, exponent, misfit = _fit(sizes, errors, usable)
    if misfit > WORST_MISFIT:
        return plain
    again = np.array([_again(sizes, errors, usable, generator) for _ in range(_REPLICATES)])
    low, high = np.quantile(again, [_OUTSIDE, 1.0 - _OUTSIDE], axis=0)
    # what is drawn anew of D spreads less than what it is drawn of, by the root of (D - 1) / D
    wider = math.sqrt(errors.shape[1] / max(errors.shape[1] - 1, 1))
    low, high = floors - wider * (floors - low), floors + wider * (high - floors)
    return Floor(
        tuple(floors.tolist()),
        tuple(np.clip(low, 0.0, floors).tolist()),
        tuple(np.maximum(high, floors).tolist()),
        exponent,
        misfit,
        is_fitted=True,
    )


def reached_from(sizes: Sequence[int], near: ArrayLike) -> int | None:
    """Return the size from which on every one is near; None where the last is not."""
    flags = np.asarray(near, dtype=np.bool_)
    if flags.shape != (len(sizes),) or not len(sizes):
        raise ValueError(f"near must have shape ({len(sizes)},), not empty; got {flags.shape}")
    if not flags[-1]:
        return None
    away = np.flatnonzero(~flags)
    return sizes[int(away[-1]) + 1] if len(away) else sizes[0]


def _again(
    sizes: Sequence[int], errors: Floats, usable: Flags, generator: np.random.Generator
) -> Floats:
    """Floors (U,) of as many draws of each unit, drawn anew with replacement."""
    units, draws, _ = errors.shape
    chosen = generator.integers(draws, size=(units, draws))
    drawn = np.stack([e[c] for e, c in zip(errors, chosen, strict=True)])
    kept = np.stack([u[c] for u, c in zip(usable, chosen, strict=True)])
    return _fit(sizes, drawn, kept)[0]


def _fit(sizes: Sequence[int], errors: Floats, usable: Flags) -> tuple[Floats, float, float]:
    """Floors (U,), exponent and misfit of the law that misses the curves least.

    Squares are weighed by their own inverse: what counts is the relative error.
    """
    levels = np.stack([_level(e, u) for e, u in zip(errors, usable, strict=True)])
    unit, place = np.nonzero(np.isfinite(levels))
    level = levels[unit, place]
    share = np.asarray(sizes, dtype=np.float64)[place] / sizes[-1]
    columns = np.zeros((len(level), len(levels) + 1))
    columns[np.arange(len(level)), unit] = 1.0 / level
    best: tuple[float, float, Floats] | None = None
    for exponent in EXPONENTS:
        columns[:, -1] = share**-exponent / level
        found, missed = nnls(columns, np.ones(len(level)))
        if best is None or missed < best[0]:
            best = float(missed), exponent, found
    assert best is not None  # noqa: S101 - there are exponents
    least, chosen, parts = best
    # of the squares; the errors' is half of it
    misfit = least / math.sqrt(len(level)) / 2.0
    # what all poses reach, no floor lies above
    return np.minimum(np.sqrt(parts[:-1]), errors[:, 0, -1]), chosen, misfit


def _level(errors: Floats, usable: Flags) -> Floats:
    """(S,) median squared error of one unit's draws (D, S); NaN where less than half count."""
    found = np.full(errors.shape[1], np.nan)
    for place in np.flatnonzero(2 * usable.sum(axis=0) >= len(errors)):
        found[place] = np.median(errors[usable[:, place], place] ** 2)
    return found

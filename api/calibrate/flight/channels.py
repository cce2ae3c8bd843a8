"""A fitted chain of many channels as polynomials, one an octant of the sky, for flight software."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.contract import Floats, Model
from api.calibrate.flight.table import NoTableError
from api.calibrate.selection import unbounded

#: Channels that products of two are made of, and that any code is written for.
_MOST_SQUARED, _MOST = 10, 16
#: Readings mixed of measured ones in an octant, to which its polynomial is fitted.
_MIXED = 3000
#: Samples that an octant needs.
_FEWEST = 12
#: Singular values below this share are left out: coefficients stay small.
_SMALLEST = 1e-3
#: Largest coefficient that the fixed point of 24 binary places holds.
_LARGEST = 100.0
#: How far readings may depart from what their direction explains, over what was seen.
_ROOM = 1.5
_SEED = 20_260_202


@dataclass(frozen=True)
class ChannelTable:
    """Directions as polynomials of signals over their length, one for each octant.

    Attributes
    ----------
    first : ndarray, shape (3, n)
        Of normalised signals to a rough direction, whose signs name the octant.
    squared : bool
        Whether products of two signals are among the terms.
    coefficients : ndarray, shape (8, terms, 3)
        Of each octant.
    used : ndarray of bool, shape (8,)
        Which were measured.
    expected : ndarray, shape (8, n, 4)
        Normalised signals of a direction: constant and slope.
    tolerance : ndarray, shape (8,)
        Farthest that they may be from that.
    weakest, strongest : float
        Length of signals that are answered.
    added_deg, largest_deg : float
        RMS and largest error that this adds to the chain's, on the samples.
    """

    first: Floats
    squared: bool
    coefficients: Floats
    used: NDArray[np.bool_]
    expected: Floats
    tolerance: Floats
    weakest: float
    strongest: float
    added_deg: float = 0.0
    largest_deg: float = 0.0

    @property
    def words(self) -> str:
        """Name what this is, for a report."""
        return f"{self.coefficients.shape[1]} terms in each of {int(self.used.sum())} octants"

    def predict(self, signals: Floats) -> Floats:
        """Return unit vectors (N, 3); NaN rows where nothing was measured."""
        length = np.linalg.norm(np.nan_to_num(signals), axis=1)
        unit = np.nan_to_num(signals) / np.maximum(length, 1e-300)[:, None]
        octant = octant_of(unit, self.first)
        terms = terms_of(unit, self.squared)
        sun = np.einsum("nt,ntk->nk", terms, self.coefficients[octant])
        sun /= np.maximum(np.linalg.norm(sun, axis=1), 1e-300)[:, None]
        away = np.linalg.norm(unit - _explained(self.expected[octant], sun), axis=1)
        known = self.used[octant] & np.isfinite(signals).all(axis=1)
        known &= (length >= self.weakest) & (length <= self.strongest)
        sun[~(known & (away <= self.tolerance[octant]))] = np.nan
        return np.asarray(sun)


def octant_of(unit: Floats, first: Floats) -> NDArray[np.int64]:
    """Return the octant (N,) of normalised signals (N, n), 0 to 7."""
    return np.asarray((unit @ first.T >= 0.0) @ np.array([1, 2, 4]))


def terms_of(unit: Floats, squared: bool) -> Floats:
    """Return one, the signals, and their products (N, terms)."""
    columns = [np.ones(len(unit)), *unit.T]
    if squared:
        pairs = combinations_with_replacement(range(unit.shape[1]), 2)
        columns += [unit[:, i] * unit[:, j] for i, j in pairs]
    return np.column_stack(columns)


def channel_table(
    model: Model, signals: Floats, context: Mapping[str, Floats], most_deg: float
) -> ChannelTable:
    """Fit polynomials to the answers of a fitted chain of channels.

    Parameters
    ----------
    model : Model
        Fitted; of three to sixteen signals and no context.
    signals : ndarray, shape (N, n)
        Of the calibration.
    context : mapping
        Must be empty: a table knows no temperature.
    most_deg : float
        RMS error that this may add: the chain's own.

    Raises
    ------
    NoTableError
        If the chain reads a context or too many channels, or the polynomials depart from its
        answers by more than `most_deg` RMS.
    """
    count = signals.shape[1]
    if tuple(model.about.context):
        raise NoTableError(f"code for flight knows no {', '.join(model.about.context)}")
    if count > _MOST:
        raise NoTableError(f"flight code is written for at most {_MOST} channels; got {count}")
    open_model = unbounded(model)
    length = np.linalg.norm(signals, axis=1)
    unit = signals / length[:, None]
    exact = open_model.predict(signals, context)
    known = np.isfinite(exact).all(axis=1)
    first = np.linalg.lstsq(unit[known], exact[known], rcond=1e-6)[0].T
    octant = octant_of(unit, first)
    squared = count <= _MOST_SQUARED
    size = terms_of(unit[:1], squared).shape[1]
    table = ChannelTable(
        first, squared, np.zeros((8, size, 3)), np.zeros(8, dtype=np.bool_),
        np.zeros((8, count, 4)), np.zeros(8), 0.5 * float(np.percentile(length, 1)),
        2.0 * float(length.max()),
    )  # fmt: skip
    rng = np.random.default_rng(_SEED)
    for number in range(8):
        inside = known & (octant == number)
        if inside.sum() < _FEWEST:
            continue
        made = _mixed(signals[inside], rng)
        sun = open_model.predict(made, {})
        usable = np.isfinite(sun).all(axis=1)
        if usable.sum() < _FEWEST:
            continue
        near = made[usable] / np.linalg.norm(made[usable], axis=1)[:, None]
        terms = terms_of(near, squared)
        table.coefficients[number] = np.linalg.lstsq(terms, sun[usable], rcond=_SMALLEST)[0]
        directions = np.column_stack([np.ones(int(inside.sum())), exact[inside]])
        slope = np.linalg.lstsq(directions, unit[inside], rcond=1e-6)[0].T
        table.expected[number] = slope
        left = unit[inside] - directions @ slope.T
        table.tolerance[number] = _ROOM * float(np.linalg.norm(left, axis=1).max()) + 1e-3
        table.used[number] = True
    judged = _judged(table, signals, exact)
    if not judged.added_deg <= most_deg:
        raise NoTableError(
            f"polynomials of the channels depart from the chain by {judged.added_deg:.3g} deg, "
            "more than it errs"
        )
    return judged


def _judged(table: ChannelTable, signals: Floats, exact: Floats) -> ChannelTable:
    off = separation_deg(table.predict(signals), exact)
    off = off[np.isfinite(off)]
    if not len(off) or np.abs(table.coefficients).max() > _LARGEST:
        raise NoTableError("no polynomial of the channels fits the chain's answers")
    added, largest = float(np.sqrt(np.mean(off**2))), float(off.max())
    return replace(table, added_deg=added, largest_deg=largest)


def _mixed(signals: Floats, rng: np.random.Generator) -> Floats:
    """Return readings between measured ones: each of three that are near each other."""
    from scipy.spatial import cKDTree  # noqa: PLC0415 - SciPy, at the first use

    unit = signals / np.linalg.norm(signals, axis=1)[:, None]
    near = np.asarray(cKDTree(unit).query(unit, k=min(9, len(unit)))[1])
    start = rng.integers(len(signals), size=_MIXED)
    other = near[start, rng.integers(near.shape[1], size=_MIXED)]
    third = near[start, rng.integers(near.shape[1], size=_MIXED)]
    weight = rng.dirichlet(np.ones(3), size=_MIXED)
    mixed = (
        weight[:, [0]] * signals[start]
        + weight[:, [1]] * signals[other]
        + weight[:, [2]] * signals[third]
    )
    return np.vstack([signals, mixed])


def _explained(expected: Floats, sun: Floats) -> Floats:
    """Return the normalised signals (N, n) that directions (N, 3) explain."""
    return np.asarray(expected[:, :, 0] + np.einsum("nik,nk->ni", expected[:, :, 1:], sun))

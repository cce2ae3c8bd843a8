"""Which methods of a board are distinguished: a paired test over units, and what it can tell.

Units are paired: every method is scored on the same ones, so that a unit that is hard for all of
them says nothing against any. What is tested is the logarithm of the ratio of two errors.

The test of a method A against the leader has the hypothesis that the geometric mean of A's errors
over the leader's is at most `EQUIVALENT`: differences that no engineer would pay for separate
nothing. Three things make it hold on few units and many methods.

- The leader is chosen from the same data, so it is the luckiest of its like. Holm's correction for
  the comparisons with one method given beforehand does not see that: among twenty equal methods it
  separates one on far more than 5 % of boards. Here every step of Holm's procedure counts all
  ordered pairs of the k methods not yet separated, k (k - 1), which covers any choice of a leader.
  Methods far behind are separated in the first steps and do not weigh on those that are near.
- The variance of ten log ratios is known badly, and the smallest p-values are those of variances
  that came out small. Variances are moderated (Smyth 2004): each is drawn towards what all methods
  of the board have in common, as far as they agree.
- Methods scored on fewer units than the leader are compared on the units in common, five at least.

Ranks are never averaged, and apart from Holm's count and the common variance an answer does not
depend on who else is on the board.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import digamma, polygamma, stdtr, stdtrit

from algorithms.contract import Floats

#: Ratio of two errors up to which methods are equivalent in practice.
EQUIVALENT = 1.03
#: Share of boards of equal methods on which any is separated, at most.
LEVEL = 0.05
#: Share of cases in which the smallest ratio that a board can tell apart is distinguished.
POWER = 0.9
#: Units in common that a comparison needs.
FEWEST_UNITS = 5
#: Smaller spreads of a log ratio are taken as this: stored errors are rounded.
_LEAST_SPREAD = 1e-3
_LEAST_ERROR_DEG = 1e-12
_MANY = 1e6  # degrees of freedom that are as good as infinite


def logarithms(errors_deg: Sequence[Sequence[float | None]]) -> Floats:
    """Return log errors (M, U) of M methods on up to U units; NaN where there is no error.

    Parameters
    ----------
    errors_deg
        Of each method by unit, the standard unit first; methods may have fewer units than others.
    """
    found = np.full((len(errors_deg), max(map(len, errors_deg), default=0)), np.nan)
    for place, errors in enumerate(errors_deg):
        for unit, error in enumerate(errors):
            if error is not None:
                found[place, unit] = math.log(max(error, _LEAST_ERROR_DEG))
    return found


def best_method(logs: Floats) -> int:
    """Return the place of the method with the least mean log error, of those with the most units.

    Parameters
    ----------
    logs
        Log errors (M, U) of `logarithms`; the first of equals is taken.
    """
    known = np.isfinite(logs).sum(axis=1)
    full = np.flatnonzero(known == known.max())
    return int(full[np.argmin(np.nanmean(logs[full], axis=1))])


def over(logs: Floats, leader: int) -> Floats:
    """Return the geometric mean (M,) of each method's errors over the leader's on common units.

    NaN where there are none.
    """
    mean, _, _ = _compare(logs, leader)
    return np.exp(mean)


def groups(logs: Floats, leader: int) -> list[int | None]:
    """Return the group of each method: 1 is not distinguished from the leader.

    Group 2 is what is not distinguished from the best of the others, and so on. None for methods
    with fewer than `FEWEST_UNITS` units in common with the leader: by what rule they are behind,
    the caller says.

    Parameters
    ----------
    logs
        Log errors (M, U) of `logarithms`.
    leader
        Place of the best method.
    """
    found: list[int | None] = [None] * len(logs)
    _, _, common = _compare(logs, leader)
    left = np.flatnonzero(common >= FEWEST_UNITS)
    group = 0
    while len(left):
        group += 1
        some = logs[left]
        first = int(np.flatnonzero(left == leader)[0]) if group == 1 else best_method(some)
        apart = separate(some, first)
        for place in left[~apart]:
            found[place] = group
        left = left[apart]
    return found


def separate(logs: Floats, leader: int) -> NDArray[np.bool_]:
    """Say which methods (M,) are distinguished from the leader.

    Those with fewer than `FEWEST_UNITS` units in common with it are not.

    Parameters
    ----------
    logs
        Log errors (M, U) of `logarithms`.
    leader
        Place of the best method.
    """
    mean, spread, common = _compare(logs, leader)
    tested = np.flatnonzero((common >= FEWEST_UNITS) & (np.arange(len(logs)) != leader))
    apart = np.zeros(len(logs), np.bool_)
    if not len(tested):
        return apart
    n = common[tested]
    sd, freedom = _moderated(spread[tested], n - 1)
    t = (mean[tested] - math.log(EQUIVALENT)) / (sd / np.sqrt(n))
    p = stdtr(freedom, -t)
    for step, place in enumerate(np.argsort(p, kind="stable")):
        if p[place] > _level(1 + len(tested) - step):
            break
        apart[tested[place]] = True
    return apart


def smallest_ratio(logs: Floats, leader: int) -> float | None:
    """Return the smallest ratio to the leader that is distinguished in `POWER` of cases.

    It is that of a method whose log ratio to the leader spreads between units as the median one of
    the board does, scored on all units of the leader, and tested last: beside the first group.

    Parameters
    ----------
    logs
        Log errors (M, U) of `logarithms`.
    leader
        Place of the best method.

    Returns
    -------
    float or None
        None where nothing can be compared with the leader.
    """
    _, spread, common = _compare(logs, leader)
    tested = (common >= FEWEST_UNITS) & (np.arange(len(logs)) != leader)
    if not tested.any():
        return None
    apart = separate(logs, leader)
    sd, freedom = _moderated(spread[tested], common[tested] - 1)
    n, df = int(common[leader]), float(np.median(freedom))
    beside = 1 + max(1, int((tested & ~apart).sum()))
    needed = stdtrit(df, 1 - _level(beside)) + stdtrit(df, POWER)
    return EQUIVALENT * math.exp(float(needed) * float(np.median(sd)) / math.sqrt(n))


def _level(methods: int) -> float:
    """Level of one test while so many methods, the leader among them, are not separated."""
    return LEVEL / (methods * (methods - 1))


def _compare(logs: Floats, leader: int) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Mean and standard deviation (M,) of the log ratios to a method, and the units in common."""
    ratio = logs - logs[leader]
    known = np.isfinite(ratio)
    n = known.sum(axis=1)
    values = np.where(known, ratio, 0.0)
    mean = np.where(n > 0, values.sum(axis=1) / np.maximum(n, 1), np.nan)
    squares = np.where(known, (values - mean[:, None]) ** 2, 0.0).sum(axis=1)
    return mean, np.sqrt(squares / np.maximum(n - 1, 1)), n


def _moderated(spread: Floats, freedom: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """Draw standard deviations (M,) towards their common one; returns them and their freedom.

    Smyth, Stat. Appl. Genet. Mol. Biol. 3 (2004) 3, section 6.2: the variances are taken as draws
    about a common one, scattered as by `prior` degrees of freedom, both estimated from their
    logarithms.
    """
    variance = np.maximum(spread, _LEAST_SPREAD) ** 2
    half = freedom / 2.0
    logs = np.log(variance) - digamma(half) + np.log(half)
    scatter = 0.0 if len(logs) == 1 else float(np.var(logs, ddof=1))
    excess = scatter - float(np.mean(polygamma(1, half)))
    if len(logs) == 1:
        return np.sqrt(variance), freedom.astype(np.float64)
    prior = 2.0 * _trigamma_inverse(excess) if excess > 0 else _MANY
    common = math.exp(float(np.mean(logs)) + float(digamma(prior / 2)) - math.log(prior / 2))
    total = prior + freedom
    return np.sqrt((prior * common + freedom * variance) / total), np.minimum(total, _MANY)


def _trigamma_inverse(value: float) -> float:
    """Solve trigamma(x) = value by Newton's steps on its reciprocal, which is nearly straight."""
    if value > 1e7:
        return 1.0 / math.sqrt(value)
    if value < 1e-6:
        return 1.0 / value
    x = 0.5 + 1.0 / value
    for _ in range(50):
        now = float(polygamma(1, x))
        step = now * (1.0 - now / value) / float(polygamma(2, x))
        x += step
        if abs(step) < 1e-8 * x:
            break
    return x

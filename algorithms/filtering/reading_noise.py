"""How noisy readings are: over how many steps their errors last, and what is white of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.filtering.shared_results import compute_once

if TYPE_CHECKING:
    from algorithms.filtering.sun_space import SunSpace

#: Longest correlation of residuals that is looked for, in steps.
_LAGS = 200
#: Least share of the residuals' variance that is tried for the readings' own, and how many are.
_QUIETEST, _SHARES = 1e-3, 13
#: Of the readings that any share follows, how many one must: a series may begin a row later.
_FOLLOWED = 0.99


class FittedFilter(Protocol):
    """A filter that has learnt how its sensor reads a Sun."""

    noise_: Floats
    starts_: Floats

    def space(self, years: float = 0.0, noise: Floats | None = None) -> SunSpace:
        """Return its state space, with this noise of readings."""
        ...

    def considered_errors(self) -> tuple[int, ...]:
        """Which errors of the state are considered."""
        ...


def correlated_steps(residuals: Floats) -> Floats:
    """Count steps (m,) over which residuals (n, m) are correlated, at least 1.

    ``1 + 2 sum rho_k`` up to where the correlation has fallen to a twentieth: a mean over many
    samples has this many times the variance that it would have of white ones.
    """
    count, number = residuals.shape
    steps = np.ones(number)
    for m in range(number):
        r = residuals[:, m] - residuals[:, m].mean()
        power = float((r**2).sum())
        for lag in range(1, min(_LAGS, count // 4)):
            rho = float((r[lag:] * r[:-lag]).sum()) / power if power > 0 else 0.0
            if rho < 0.05:
                break
            steps[m] += 2.0 * rho
    return steps


def estimate_noise(
    model: FittedFilter, features: Floats, known: Floats, apart_s: Floats, least: Floats
) -> Floats:
    """Lower the noise of a calibration's residuals to what the readings themselves leave of it.

    Residuals have the noise of the calibration's reference, too; readings that follow each other
    are compared by the gyroscope alone. The share of the residuals' variance that makes the
    readings likeliest: tried along a geometric series, with a parabola through the best three. No
    share is taken with which some readings cannot be followed that can with another.

    Parameters
    ----------
    model : FittedFilter
        With everything learnt but its noise, of which it has the residuals'.
    features, known : ndarray, shapes (n, m) and (n, 7)
        In the order of time.
    apart_s : ndarray, shape (n,)
        Time since the sample before; infinite where a series begins.
    least : ndarray, shape (m,)
        Below which no variance falls.

    Returns
    -------
    ndarray, shape (m,)
        Variances, none above the model's.
    """
    # all that the answer depends on: filters that differ in their rule of update alone share it
    given = model.space(noise=model.noise_), model.starts_, model.considered_errors()
    return compute_once(
        (_likeliest, *given, features, known, apart_s, least),
        lambda: _likeliest(model, features, known, apart_s, least),
    )


def _likeliest(
    model: FittedFilter, features: Floats, known: Floats, apart_s: Floats, least: Floats
) -> Floats:
    """Return what `estimate_noise` does, worked out."""
    shares = np.geomspace(_QUIETEST, 1.0, _SHARES)
    noises = np.maximum(shares[:, None] * model.noise_, least)
    mean_likelihoods, followed = _foretold(model, noises, features, known, apart_s)
    likely = np.where(followed >= _FOLLOWED * followed.max(), mean_likelihoods, -np.inf)
    best = min(max(int(np.argmax(likely)), 1), _SHARES - 2)
    before, here, after = likely[best - 1 : best + 2]
    bend = before - 2.0 * here + after
    shift = 0.5 * (before - after) / bend if -np.inf < bend < 0 else 0.0
    step = np.log(shares[1] / shares[0])
    share = min(float(shares[best] * np.exp(np.clip(shift, -1.0, 1.0) * step)), 1.0)
    return np.asarray(np.maximum(share * model.noise_, least))


def _foretold(
    model: FittedFilter, noises: Floats, features: Floats, known: Floats, apart_s: Floats
) -> tuple[Floats, NDArray[np.int64]]:
    """Give the mean log-likelihood of readings with each noise (B, m), and of how many (B,).

    One belief has a run for each noise; it is NaN until one is begun, as are its likelihoods.
    """
    from algorithms.filtering.filters import ExtendedKalman, initial_state  # noqa: PLC0415 - Numba

    count, considered = len(noises), model.considered_errors()
    by = ExtendedKalman(considered)
    spaces = [model.space(noise=noise) for noise in noises]
    tried, n = spaces[0].states_towards(model.starts_), spaces[0].errors
    belief = initial_state(spaces[0], np.full((count, tried.shape[1]), np.nan), np.zeros((n, n)))
    begun = np.zeros(count, dtype=np.bool_)
    totals, rows = np.zeros(count), np.zeros(count, dtype=np.int64)
    for row, (read, step_s) in enumerate(zip(features, apart_s.tolist(), strict=True)):
        begun &= math.isfinite(step_s)
        due = np.flatnonzero(~begun)
        if len(due) < count:
            belief = by.predict(spaces[0], belief, known[row], step_s)
            belief = by.update(spaces[0], belief, read[None], known[row])
            heard = begun & np.isfinite(belief.log_likelihood)
            totals[heard] += belief.log_likelihood[heard]
            rows += heard
        for run in due:
            first = spaces[run].start_belief(by, tried, read, known[row], considered)
            begun[run] = first is not None
            belief.states[run] = np.nan
            if first is not None:
                belief.states[run], belief.covariance[run] = first.states[0], first.covariance[0]
                belief.noise[run] = first.noise[0]
    return totals / np.maximum(rows, 1), rows

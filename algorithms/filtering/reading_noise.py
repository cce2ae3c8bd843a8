"""How noisy readings are: over how many steps their errors last, and what is white of them."""

from __future__ import annotations

import hashlib
import pickle
from typing import TYPE_CHECKING, Protocol

import numpy as np

from algorithms.contract import Floats

if TYPE_CHECKING:
    from algorithms.filtering.filters import Belief
    from algorithms.filtering.sun_space import SunSpace

#: Longest correlation of residuals that is looked for, in steps.
_LAGS = 200
#: Least share of the residuals' variance that is tried for the readings' own, and how many are.
_QUIETEST, _SHARES = 1e-3, 13
#: Of the readings that any share follows, how many one must: a series may begin a row later.
_FOLLOWED = 0.99
#: Answers kept of `heard`, by a digest of what they depend on, and the latest so many.
_heard: dict[bytes, Floats] = {}
_KEPT = 16


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
    key = hashlib.sha256(pickle.dumps((*given, features, known, apart_s, least))).digest()
    if key not in _heard:
        while len(_heard) >= _KEPT:
            _heard.pop(next(iter(_heard)), None)
        _heard[key] = _likeliest(model, features, known, apart_s, least)
    return _heard[key].copy()


def _likeliest(
    model: FittedFilter, features: Floats, known: Floats, apart_s: Floats, least: Floats
) -> Floats:
    """Return what `heard` does, worked out."""
    from algorithms.filtering.filters import ExtendedKalman  # noqa: PLC0415 - Numba

    by = ExtendedKalman(model.considered_errors())
    shares = np.geomspace(_QUIETEST, 1.0, _SHARES)
    mean_likelihoods, followed = [], []
    for share in shares:
        space = model.space(noise=np.maximum(share * model.noise_, least))
        tried = space.states_towards(model.starts_)
        belief: Belief | None = None
        total, rows = 0.0, 0
        for row, read in enumerate(features):
            if belief is None or not np.isfinite(apart_s[row]):
                belief = space.start_belief(by, tried, read, known[row], model.considered_errors())
                continue
            belief = by.predict(space, belief, known[row], float(apart_s[row]))
            belief = by.update(space, belief, read[None], known[row])
            if np.isfinite(belief.log_likelihood[0]):
                total += float(belief.log_likelihood[0])
                rows += 1
        mean_likelihoods.append(total / max(rows, 1))
        followed.append(rows)
    likely = np.where(np.array(followed) >= _FOLLOWED * max(followed), mean_likelihoods, -np.inf)
    best = min(max(int(np.argmax(likely)), 1), _SHARES - 2)
    before, here, after = likely[best - 1 : best + 2]
    bend = before - 2.0 * here + after
    shift = 0.5 * (before - after) / bend if -np.inf < bend < 0 else 0.0
    step = np.log(shares[1] / shares[0])
    share = min(float(shares[best] * np.exp(np.clip(shift, -1.0, 1.0) * step)), 1.0)
    return np.asarray(np.maximum(share * model.noise_, least))

"""How noisy readings are: over how many steps their errors last, and what is white of them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from algorithms.contract import Floats

if TYPE_CHECKING:
    from algorithms.filtering.filters import Belief
    from algorithms.filtering.sequence import SunFilter

#: Longest correlation of residuals that is looked for, in steps.
_LAGS = 200
#: Rounds at most towards the noise that readings themselves tell, and a step that is none.
_ROUNDS, _SETTLED = 12, 0.03


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


def heard(
    model: SunFilter, features: Floats, known: Floats, apart_s: Floats, least: Floats
) -> Floats:
    """Lower the noise of a calibration's residuals to what the readings themselves leave of it.

    Residuals have the noise of the calibration's reference, too; readings that follow each other
    are compared by the gyroscope alone. Of a filter that has the right noise R, squares of what
    updates leave have the mean ``R - H P H'`` (Mohamed and Schwarz).

    Parameters
    ----------
    model : SunFilter
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
    from algorithms.filtering.filters import ExtendedKalman  # noqa: PLC0415 - Numba

    by, most, noise = ExtendedKalman(model.considered()), model.noise_, model.noise_
    for _ in range(_ROUNDS):
        space = model.space(noise=noise)
        belief: Belief | None = None
        total = np.zeros((2, len(noise)))
        for row, read in enumerate(features):
            if belief is None or not np.isfinite(apart_s[row]):
                belief = space.started(by, model.starts_, read, known[row], model.considered())
                continue
            belief = by.predict(space, belief, known[row], float(apart_s[row]))
            belief = by.update(space, belief, read[None], known[row])
            slopes = space.sensitivity(belief.states, known[row])[0]
            spread = np.diagonal(slopes @ belief.covariance[0] @ slopes.T)
            left = (read - space.measured(belief.states, known[row])[0]) ** 2
            if np.isfinite(left).all() and np.isfinite(spread).all():
                total += np.stack([left, noise - spread])
        if not (total > 0).all():
            break
        # squared: where the gyroscope is noisier than readings, steps are short
        before, noise = noise, np.clip(noise * (total[0] / total[1]) ** 2, least, most)
        if (np.abs(noise - before) <= _SETTLED * before).all():
            break
    return noise

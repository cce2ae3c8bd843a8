"""What readings of faces are worth where the light's strength changes from pose to pose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

#: Noise of a face over the largest signal below which there is nothing to weigh: rounding.
_LEAST = 1e-9
#: Rounds between the faces' noise and the light's spread; neither moves after some.
_ROUNDS = 25
_AT_REST = 1e-3
#: Variances of the light's strength that are tried, over those with which one sample tells it.
_SPREADS = np.concatenate([[0.0], 10.0 ** np.arange(-3.0, 6.01, 0.125)])


@dataclass(frozen=True)
class ResidualWeights:
    """Weights of residuals that share, sample by sample, an unknown strength of the light.

    A lamp flickers and drifts, the Sun is nearer in January: sample i of K faces reads
    ``(1 + d_i) m_ik + e_ik``, the strength ``d_i`` of standard deviation tau common to all its
    faces, ``e_ik`` of deviation sigma_k. The residuals' covariance ``S + tau^2 m_i m_i'`` is undone
    by its root; both sizes are those of greatest likelihood.

    Attributes
    ----------
    used : ndarray of bool, shape (n, K)
        Readings that count.
    noise : ndarray, shape (K,)
        Each face's sigma.
    modelled : ndarray, shape (n, K)
        Signals over their faces' noise, 0 where not used.
    spread : float
        tau.

    References
    ----------
    Ours, for model:assem: least squares with one random effect a sample.
    """

    used: NDArray[np.bool_]
    noise: Floats
    modelled: Floats
    spread: float

    @classmethod
    def even(cls, used: NDArray[np.bool_]) -> Self:
        """Return the weighing of equal noise in steady light."""
        return cls(used, np.ones(used.shape[1]), np.zeros(used.shape), 0.0)

    @classmethod
    def of(cls, modelled: Floats, off: Floats, used: NDArray[np.bool_], numbers: int) -> Self:
        """Return the likeliest weighing of residuals `off` (n, K) of a fit of so many `numbers`."""
        off, modelled = np.where(used, off, 0.0), np.where(used, modelled, 0.0)
        count = used.sum(axis=0)
        share = max(1.0 - numbers / float(count.sum()), 0.1)
        noise = np.maximum(np.sqrt((off**2).sum(axis=0) / count / share), _LEAST)
        spread = 0.0
        for _ in range(_ROUNDS):
            m, r = modelled / noise, off / noise
            power, along = (m**2).sum(axis=1), (m * r).sum(axis=1)
            tried = _SPREADS / power.mean()
            information = (
                tried[:, None] * power
            )  # (spreads, n): how well a sample tells its strength
            left = (r**2).sum() - (tried[:, None] * along**2 / (1.0 + information)).sum(axis=1)
            turned = np.log1p(information).sum(axis=1)
            total = float(count.sum())
            best = int(np.argmin(total * np.log(np.maximum(left, 1e-300)) + turned))
            ratio = float(tried[best])
            # given the strength's, the noise expected of each face
            level = ratio * along / (1.0 + ratio * power)
            shrinkage = ratio / (1.0 + ratio * power)
            size = float(left[best]) / total
            rest = (r - level[:, None] * m) ** 2 + size * shrinkage[:, None] * m**2
            spread = float(np.sqrt(ratio * size))
            before, noise = (
                noise,
                np.maximum(noise * np.sqrt(rest.sum(axis=0) / count / share), _LEAST),
            )
            if np.abs(noise - before).max() <= _AT_REST * noise.min():
                break
        return cls(used, noise, modelled / noise, spread)

    def weigh(self, off: Floats) -> Floats:
        """Residuals (n, K), or derivatives (n, K, P), as independent ones of one size."""
        scale = self.noise / self.noise.min()
        shape = (1, -1) + (1,) * (off.ndim - 2)
        found = off / scale.reshape(shape)
        if self.spread == 0.0:
            return np.asarray(found)
        power = (self.modelled**2).sum(axis=1)
        share = np.zeros_like(power)
        lit = power > 0
        share[lit] = (1.0 - 1.0 / np.sqrt(1.0 + self.spread**2 * power[lit])) / power[lit]
        kept = np.where(self.used.reshape(*self.used.shape, *shape[2:]), found, 0.0)
        along = np.einsum("nk,nk...->n...", self.modelled * share[:, None], kept)
        return np.asarray(found - np.einsum("nk,n...->nk...", self.modelled, along))

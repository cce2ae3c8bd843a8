"""Several models side by side, each weighed by how well it foretells the readings (MMAE)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from algorithms.contract import Floats
from algorithms.filtering.filters import Belief, ExtendedKalman, initial_state
from algorithms.filtering.noise_kernel import mix
from algorithms.filtering.state_space import StateSpace


@dataclass(frozen=True)
class MultipleModels:
    """MMAE: extended Kalman filters that differ in the noise they expect, and their mixture.

    Each hypothesis' probability is multiplied by the likelihood of every reading (Magill); none
    falls below `least`, so that one that becomes true later is found.

    Parameters
    ----------
    noise_scales : tuple of float
        Standard deviation of readings, over the space's own, of each hypothesis; positive.
    least : float
        Smallest probability.
    considered : tuple of int
        As `algorithms.filtering.filters.ExtendedKalman`.

    Examples
    --------
    >>> from algorithms.filtering.state_space import LinearStateSpace
    >>> one = np.eye(1)
    >>> space = LinearStateSpace(one, one, one, one)
    >>> bank = MultipleModels((1.0, 10.0))
    >>> belief = bank.begin(space, np.zeros((1, 1)), one)
    >>> belief = bank.update(space, belief, np.array([[30.0]]), np.zeros(0))
    >>> belief.weights.round(3)
    array([0., 1.])
    """

    noise_scales: tuple[float, ...] = (0.25, 1.0, 4.0)
    least: float = 1e-6
    considered: tuple[int, ...] = ()

    def begin(self, space: StateSpace, states: Floats, covariance: Floats) -> Belief:
        """Belief of all hypotheses, equally probable, those of a run beside each other."""
        number = len(self.noise_scales)
        n = space.errors
        every = np.broadcast_to(covariance, (len(states), n, n))
        belief = initial_state(
            space, np.repeat(states, number, axis=0), np.repeat(every, number, axis=0)
        )
        scales = np.tile(np.square(self.noise_scales), len(states))
        weights = np.full(len(scales), 1.0 / number)
        return replace(belief, noise=belief.noise * scales[:, None, None], weights=weights)

    def predict(self, space: StateSpace, belief: Belief, known: Floats, step_s: float) -> Belief:
        """Belief one step on."""
        return ExtendedKalman().predict(space, belief, known, step_s)

    def update(self, space: StateSpace, belief: Belief, read: Floats, known: Floats) -> Belief:
        """Belief with readings (B, m), one row a run."""
        number = len(self.noise_scales)
        after = ExtendedKalman(self.considered).update(
            space, belief, np.repeat(read, number, axis=0), known
        )
        # readings whose errors are correlated tell as much as fewer would
        steps = space.correlate()
        log_likelihood = after.log_likelihood.reshape(-1, number) / (steps.sum() / len(steps))
        best = log_likelihood.max(axis=1, keepdims=True)
        likelihood = np.where(np.isfinite(best), np.exp(log_likelihood - best), 1.0)
        weights = after.weights.reshape(-1, number) * likelihood
        weights = np.maximum(weights / weights.sum(axis=1, keepdims=True), self.least)
        weights /= weights.sum(axis=1, keepdims=True)
        squared, likelihoods = after.squared_innovation, after.log_likelihood
        return Belief(
            after.states, after.covariance, after.noise, squared, likelihoods, weights.ravel()
        )

    def estimate(self, space: StateSpace, belief: Belief) -> tuple[Floats, Floats]:
        """Mean of the hypotheses, and its covariance: theirs and what they are apart."""
        number, n = len(self.noise_scales), space.errors
        weights = belief.weights.reshape(-1, number)
        runs = np.arange(len(weights))
        likely = belief.states.reshape(len(weights), number, -1)[runs, weights.argmax(axis=1)]
        apart = space.errors_between(belief.states, np.repeat(likely, number, axis=0))
        apart = apart.reshape(-1, number, n)
        mean, covariance = mix(weights, apart, belief.covariance.reshape(-1, number, n, n))
        return space.add_errors(likely, mean), covariance

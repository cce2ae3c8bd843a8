"""Kalman filters on a `StateSpace`: extended, unscented, cubature, adaptive, robust, considering.

A filter holds settings only. What it knows is a `Belief`, which each step turns into another; the
batch axis B are Monte-Carlo runs, or the hypotheses of `algorithms.filtering.hypotheses`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np

from algorithms.contract import Floats
from algorithms.filtering import algebra_kernel as algebra
from algorithms.filtering.noise_kernel import adapt, raise_noise
from algorithms.filtering.state_space import StateSpace


@dataclass(frozen=True)
class Belief:
    """What a filter knows after a step.

    Attributes
    ----------
    states : ndarray, shape (B, S)
        Best estimates.
    covariance : ndarray, shape (B, n, n)
        Of their errors.
    noise : ndarray, shape (B, m, m)
        Covariance of readings as the filter takes it; of how many tell as much as one, the state
        space knows.
    squared_innovation : ndarray, shape (B,)
        Of the last update, in units of its own covariance; NaN where nothing was read. Chi-square
        of m degrees of freedom where the state space is the system's.
    log_likelihood : ndarray, shape (B,)
        Of the last reading.
    weights : ndarray, shape (B,)
        Probability of each hypothesis among those of its run; 1 where there is one.
    """

    states: Floats
    covariance: Floats
    noise: Floats
    squared_innovation: Floats
    log_likelihood: Floats
    weights: Floats

    def with_estimate(self, states: Floats, covariance: Floats) -> Belief:
        """Return the belief with other estimates."""
        squared, likelihood = self.squared_innovation, self.log_likelihood
        return Belief(states, covariance, self.noise, squared, likelihood, self.weights)


def initial_state(space: StateSpace, states: Floats, covariance: Floats) -> Belief:
    """Belief before anything is read; covariance (B, n, n) or (n, n)."""
    count = len(states)
    n, m = space.errors, space.readings
    nothing = np.full(count, np.nan)
    return Belief(
        states,
        np.array(np.broadcast_to(covariance, (count, n, n)), order="C"),
        np.array(np.broadcast_to(space.measurement_noise(), (count, m, m)), order="C"),
        nothing,
        nothing,
        np.ones(count),
    )


class Filter(Protocol):
    """A way from belief to belief."""

    def begin(self, space: StateSpace, states: Floats, covariance: Floats) -> Belief:
        """Belief before anything is read, of states (B, S); covariance (B, n, n) or (n, n)."""
        ...

    def estimate(self, space: StateSpace, belief: Belief) -> tuple[Floats, Floats]:
        """Best states (B, S) and covariances (B, n, n), one a run."""
        ...

    def predict(self, space: StateSpace, belief: Belief, known: Floats, step_s: float) -> Belief:
        """Belief one step on, nothing read."""
        ...

    def update(self, space: StateSpace, belief: Belief, read: Floats, known: Floats) -> Belief:
        """Belief once readings (B, m) are in; a run with a NaN among them stays as it was."""
        ...


class _OneBelief:
    """A rule whose belief is one state a run."""

    def begin(self, space: StateSpace, states: Floats, covariance: Floats) -> Belief:
        """Belief before anything is read."""
        return initial_state(space, states, covariance)

    def estimate(self, space: StateSpace, belief: Belief) -> tuple[Floats, Floats]:
        """States and covariances of the belief."""
        del space
        return belief.states, belief.covariance


@dataclass(frozen=True)
class ExtendedKalman(_OneBelief):
    """EKF: dynamics and readings linearised at the estimate, covariance in Joseph's form.

    Parameters
    ----------
    considered : tuple of int
        Errors that are considered, not estimated (Schmidt): their covariance enters gain and
        update of all others, and no reading moves them.

    Examples
    --------
    >>> from algorithms.filtering.state_space import LinearStateSpace
    >>> one = np.eye(1)
    >>> space = LinearStateSpace(one, 0 * one, one, one)
    >>> belief = initial_state(space, np.zeros((1, 1)), one)
    >>> belief = ExtendedKalman().update(space, belief, np.array([[2.0]]), np.zeros(0))
    >>> belief.states, belief.covariance
    (array([[1.]]), array([[[0.5]]]))
    """

    considered: tuple[int, ...] = ()

    def predict(self, space: StateSpace, belief: Belief, known: Floats, step_s: float) -> Belief:
        """Belief one step on."""
        states, transition = space.advance(belief.states, known, step_s)
        covariance = algebra.predict(belief.covariance, transition, space.process_noise(step_s))
        return belief.with_estimate(states, covariance)

    def update(self, space: StateSpace, belief: Belief, read: Floats, known: Floats) -> Belief:
        """Belief with readings (B, m)."""
        foretold, sensitivity = space.observe(belief.states, known)
        innovation = read - foretold
        step, covariance, squared, likelihood = algebra.update(
            belief.covariance,
            sensitivity,
            self.weigh(belief, sensitivity, innovation),
            space.correlate(),
            innovation,
            _estimate(space.errors, self.considered),
        )
        states = space.add_errors(belief.states, step)
        after = Belief(states, covariance, belief.noise, squared, likelihood, belief.weights)
        return self.adapt(space, after, read, known, sensitivity)

    def weigh(self, belief: Belief, sensitivity: Floats, innovation: Floats) -> Floats:
        """(B, m, m) covariance of these readings: that of the belief."""
        del sensitivity, innovation
        return belief.noise

    def adapt(
        self, space: StateSpace, after: Belief, read: Floats, known: Floats, sensitivity: Floats
    ) -> Belief:
        """Belief with what the update tells of the noise: nothing here."""
        del space, read, known, sensitivity
        return after


@dataclass(frozen=True)
class AdaptiveKalman(ExtendedKalman):
    """AKF: the covariance of readings follows what they leave (Mohamed and Schwarz).

    After each update ``R <- R + (e e' + H P H' - R) / window``, e the residual and P the
    covariance after the update: of a filter that has the right R, both together have it as their
    mean.

    Parameters
    ----------
    considered : tuple of int
        As `ExtendedKalman`.
    window : float
        Number of readings over which the noise is averaged, above 1.
    least : float
        Share of the space's own variance below which none falls.
    most : float
        Multiple of it above which none rises: a reading that is taken for noise altogether would
        never again tell that the estimate is off.

    Examples
    --------
    >>> from algorithms.filtering.state_space import LinearStateSpace
    >>> one = np.eye(1)
    >>> space = LinearStateSpace(one, 0 * one, one, one)
    >>> belief = initial_state(space, np.zeros((1, 1)), one)
    >>> AdaptiveKalman().update(space, belief, np.array([[2.0]]), np.zeros(0)).noise
    array([[[1.01]]])
    """

    window: float = 50.0
    least: float = 1e-4
    most: float = 16.0

    def adapt(
        self, space: StateSpace, after: Belief, read: Floats, known: Floats, sensitivity: Floats
    ) -> Belief:
        """Belief with its noise moved towards that of the residuals."""
        own = np.diagonal(space.measurement_noise())
        noise = adapt(
            after.noise,
            after.covariance,
            sensitivity,
            read - space.predict_readings(after.states, known),
            after.squared_innovation,
            self.window,
            self.least * own,
            self.most * own,
        )
        squared, likelihood = after.squared_innovation, after.log_likelihood
        return Belief(after.states, after.covariance, noise, squared, likelihood, after.weights)


@dataclass(frozen=True)
class RobustKalman(ExtendedKalman):
    """RKF: a reading beyond some standard deviations counts less, so that its pull is bounded.

    Huber's weights on each innovation: beyond `limit` standard deviations, its variance is
    raised until the gain falls with the innovation's size and their product stays.

    Parameters
    ----------
    considered : tuple of int
        As `ExtendedKalman`.
    limit : float
        Number of standard deviations up to which a reading has full weight, positive.

    Examples
    --------
    >>> from algorithms.filtering.state_space import LinearStateSpace
    >>> one = np.eye(1)
    >>> space = LinearStateSpace(one, 0 * one, one, one)
    >>> belief = initial_state(space, np.zeros((1, 1)), one)
    >>> far = np.array([[20.0]])  # without the limit, half of it would be believed
    >>> RobustKalman().update(space, belief, far, np.zeros(0)).states.round(2)
    array([[1.41]])
    """

    limit: float = 2.0

    def weigh(self, belief: Belief, sensitivity: Floats, innovation: Floats) -> Floats:
        """Give the readings' covariance, raised where they are far off."""
        found: Floats = raise_noise(
            belief.noise, belief.covariance, sensitivity, innovation, self.limit
        )
        return found


@dataclass(frozen=True)
class SigmaPointKalman(_OneBelief):
    """UKF and CKF: covariances by points on both sides of the estimate, without derivatives.

    The n errors have 2 n points at ``sqrt(n + kappa)`` standard deviations, and the estimate
    itself: the cubature rule of third degree for kappa 0, where the middle has no weight.

    Parameters
    ----------
    kappa : float
        From 0 up.
    beta : float
        Weight added to the middle's in covariances; 2 suits a normal distribution.
    considered : tuple of int
        As `ExtendedKalman`.

    Examples
    --------
    >>> cubature = SigmaPointKalman(kappa=0.0, beta=0.0)
    >>> cubature.weights(2)
    (array([0.  , 0.25, 0.25, 0.25, 0.25]), array([0.  , 0.25, 0.25, 0.25, 0.25]))
    """

    kappa: float = 1.0
    beta: float = 2.0
    considered: tuple[int, ...] = ()

    def weights(self, n: int) -> tuple[Floats, Floats]:
        """(2 n + 1,) of means and of covariances, the middle first."""
        return _weights(self.kappa, self.beta, n)

    def predict(self, space: StateSpace, belief: Belief, known: Floats, step_s: float) -> Belief:
        """Belief one step on: the points' mean and spread, and the process noise."""
        means, spreads = self.weights(space.errors)
        points, _ = self._points(space, belief)
        count, number, size = points.shape
        after = space.propagate(points.reshape(-1, size), known, step_s)
        middle = after[::number].copy()
        off = space.errors_between(after, np.repeat(middle, number, axis=0))
        mean, _ = algebra.centre(off.reshape(count, number, -1), means)
        states = space.add_errors(middle, mean)
        # of the mean, in its own axes
        off = space.errors_between(after, np.repeat(states, number, axis=0)).reshape(
            count, number, -1
        )
        covariance = algebra.cross(off, off, spreads)
        covariance += space.process_noise(step_s)
        return belief.with_estimate(states, covariance)

    def update(self, space: StateSpace, belief: Belief, read: Floats, known: Floats) -> Belief:
        """Belief with readings (B, m), by the points' readings."""
        means, spreads = self.weights(space.errors)
        points, errors = self._points(space, belief)
        count, number, size = points.shape
        seen = space.predict_readings(points.reshape(-1, size), known).reshape(count, number, -1)
        mean, off = algebra.centre(seen, means)
        step, covariance, squared, likelihood = algebra.update_by_points(
            belief.covariance,
            algebra.cross(errors, off, spreads),
            algebra.cross(off, off, spreads),
            belief.noise,
            space.correlate(),
            read - mean,
            _estimate(space.errors, self.considered),
        )
        states = space.add_errors(belief.states, step)
        return Belief(states, covariance, belief.noise, squared, likelihood, belief.weights)

    def _points(self, space: StateSpace, belief: Belief) -> tuple[Floats, Floats]:
        """States (B, 2 n + 1, S) of the points, the estimate first, and their errors."""
        n, count = space.errors, len(belief.states)
        errors = algebra.sigma_errors(belief.covariance, math.sqrt(n + self.kappa))
        number = 2 * n + 1
        states = space.add_errors(np.repeat(belief.states, number, axis=0), errors.reshape(-1, n))
        return states.reshape(count, number, -1), errors


@lru_cache(maxsize=64)
def _estimate(n: int, considered: tuple[int, ...]) -> Floats:
    counts = np.ones(n)
    counts[list(considered)] = 0.0
    return counts


@lru_cache(maxsize=64)
def _weights(kappa: float, beta: float, n: int) -> tuple[Floats, Floats]:
    means = np.full(2 * n + 1, 0.5 / (n + kappa))
    means[0] = kappa / (n + kappa)
    spreads = means.copy()
    spreads[0] += beta
    return means, spreads


#: Cubature Kalman filter.
CUBATURE = SigmaPointKalman(kappa=0.0, beta=0.0)

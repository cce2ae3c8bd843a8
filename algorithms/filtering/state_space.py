"""State-space models for filters: `StateSpace`, and the simplest one, `LinearStateSpace`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from algorithms.contract import Floats


class StateSpace(Protocol):
    """``x' = f(x, u, dt) + w``, ``z = h(x, u) + v``: dynamics, readings, and the noise of both.

    States (B, S) may live on a curved space, as a direction does; their errors (B, n) are flat:
    `add_errors` adds them to states and `errors_between` takes the difference of two. ``u`` (U,) is
    what is known from moment to moment: rates, temperatures. B counts runs or hypotheses.
    """

    @property
    def errors(self) -> int:
        """Numbers n that an error has."""
        ...

    @property
    def readings(self) -> int:
        """Numbers m that are read."""
        ...

    def propagate(self, states: Floats, known: Floats, step_s: float) -> Floats:
        """States (B, S) one step on, without noise: f."""
        ...

    def advance(self, states: Floats, known: Floats, step_s: float) -> tuple[Floats, Floats]:
        """Propagate states as `propagate` does, and give f's Jacobian F (B, n, n), of errors."""
        ...

    def process_noise(self, step_s: float) -> Floats:
        """(n, n) covariance Q of what a step adds."""
        ...

    def predict_readings(self, states: Floats, known: Floats) -> Floats:
        """(B, m) readings without noise: h."""
        ...

    def observe(self, states: Floats, known: Floats) -> tuple[Floats, Floats]:
        """Give readings as `predict_readings` does, and h's Jacobian H (B, m, n), of errors."""
        ...

    def measurement_noise(self) -> Floats:
        """(m, m) covariance R of readings."""
        ...

    def correlate(self) -> Floats:
        """(m,) steps over which errors of readings are correlated, 1 of white ones."""
        ...

    def add_errors(self, states: Floats, errors: Floats) -> Floats:
        """States (B, S) with errors (B, n) added."""
        ...

    def errors_between(self, states: Floats, origins: Floats) -> Floats:
        """Errors (B, n) that take origins (B, S) to states."""
        ...


@dataclass(frozen=True)
class LinearStateSpace:
    """``x' = F x + w``, ``z = H x + v``, the same at every step; what is known does not enter.

    Parameters
    ----------
    dynamics : ndarray, shape (n, n)
        F, of one step however long.
    process : ndarray, shape (n, n)
        Q.
    observation : ndarray, shape (m, n)
        H.
    noise : ndarray, shape (m, m)
        R.

    Examples
    --------
    >>> space = LinearStateSpace(np.eye(1), np.eye(1), np.eye(1), np.eye(1))
    >>> space.predict_readings(np.array([[3.0]]), np.zeros(0))
    array([[3.]])
    """

    dynamics: Floats
    process: Floats
    observation: Floats
    noise: Floats

    @property
    def errors(self) -> int:
        """As many as states."""
        return len(self.dynamics)

    @property
    def readings(self) -> int:
        """Rows of H."""
        return len(self.observation)

    def propagate(self, states: Floats, known: Floats, step_s: float) -> Floats:
        """``F x``."""
        del known, step_s
        return np.asarray(states @ self.dynamics.T)

    def advance(self, states: Floats, known: Floats, step_s: float) -> tuple[Floats, Floats]:
        """``F x``, and F."""
        each = np.broadcast_to(self.dynamics, (len(states), *self.dynamics.shape)).copy()
        return self.propagate(states, known, step_s), each

    def process_noise(self, step_s: float) -> Floats:
        """Q."""
        del step_s
        return self.process

    def predict_readings(self, states: Floats, known: Floats) -> Floats:
        """``H x``."""
        del known
        return np.asarray(states @ self.observation.T)

    def observe(self, states: Floats, known: Floats) -> tuple[Floats, Floats]:
        """``H x``, and H."""
        each = np.broadcast_to(self.observation, (len(states), *self.observation.shape)).copy()
        return self.predict_readings(states, known), each

    def measurement_noise(self) -> Floats:
        """R."""
        return self.noise

    def correlate(self) -> Floats:
        """White."""
        return np.ones(len(self.noise))

    def add_errors(self, states: Floats, errors: Floats) -> Floats:
        """Their sum."""
        return states + errors

    def errors_between(self, states: Floats, origins: Floats) -> Floats:
        """Their difference."""
        return states - origins

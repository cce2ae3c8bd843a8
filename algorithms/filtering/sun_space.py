"""`SunSpace`: the Sun seen from a turning body, its gyroscope's bias, and a sensor that drifts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from algorithms.contract import Floats
from algorithms.filtering import algebra_kernel as algebra
from algorithms.filtering import sun_kernel as motion
from algorithms.filtering.drift import MOTION, Drift, Gyroscope
from algorithms.filtering.filters import Belief, Filter
from algorithms.filtering.readings import Readings

_DIRECTION = slice(6, 9)
#: Of the direction, rad, before the first reading; and steps towards what explains it best.
_FIRST_RAD, _STEPS = 0.5, 6
#: Standard deviations of a chi-square beyond which a reading is not explained.
_FAR = 5.0


class SunSpace:
    """State space of a Sun sensor on a body whose turning a gyroscope tells.

    ``s' = exp(-[(w - b) dt]) s``, bias and parameters wander, readings are those learnt. States
    are (B, 12 + p), errors (B, 5 + p): see `algorithms.filtering.sun_kernel`. Behind the sensor's
    parameters stands a turn of the head, where there is one: ``z = h(exp([d]) s) + v``.

    Parameters
    ----------
    readings : Readings
        FittedFilter.
    noise : ndarray, shape (m, m)
        Covariance of readings.
    gyroscope : Gyroscope
        Its data sheet.
    drifts : sequence of Drift
        Numbers of the sensor that are in the state.
    steps : ndarray, shape (m,), optional
        Over which errors of readings are correlated; white by default.
    turn : float
        1-sigma, rad, of the head's turn about each axis; 0 where there is none.
    """

    def __init__(
        self,
        readings: Readings,
        noise: Floats,
        gyroscope: Gyroscope,
        drifts: Sequence[Drift],
        *,
        steps: Floats | None = None,
        turn: float = 0.0,
    ) -> None:
        self._readings, self._noise = readings, noise
        self._gyroscope = gyroscope
        self._chosen = np.array([drift.place for drift in drifts], dtype=np.float64)
        turns = [turn] * 3 if turn else []
        self._steps = np.ones(len(noise)) if steps is None else np.asarray(steps)
        self._turn = MOTION + len(drifts) + 7 if turn else 0
        self.errors = MOTION + len(drifts) + len(turns)
        first = [_FIRST_RAD] * 2 + [gyroscope.bias] * 3 + [drift.deviation for drift in drifts]
        self._first = np.diag(np.square([*first, *turns]))
        walks = [0.0] * 2 + [gyroscope.bias_walk] * 3 + [drift.walk for drift in drifts]
        self._walks = np.square([*walks, *np.zeros(len(turns))])
        self._step: tuple[float, Floats] | None = None

    @property
    def readings(self) -> int:
        """Numbers read at a time."""
        return self._readings.count

    def propagate(self, states: Floats, known: Floats, step_s: float) -> Floats:
        """States after the body turned."""
        found: Floats = motion.propagate(states, known, step_s)
        return found

    def advance(self, states: Floats, known: Floats, step_s: float) -> tuple[Floats, Floats]:
        """States after the body turned, and the Jacobian."""
        found: tuple[Floats, Floats] = motion.advance(states, known, step_s)
        return found

    def process_noise(self, step_s: float) -> Floats:
        """Angle random walk, and what the bias' own walk adds to it; walks of all the rest."""
        if self._step is None or self._step[0] != step_s:  # steps are nearly always alike
            noise = np.diag(self._walks * step_s)
            walk = self._gyroscope
            noise[0, 0] = noise[1, 1] = (
                walk.angle_walk**2 * step_s + walk.bias_walk**2 * step_s**3 / 3.0
            )
            self._step = step_s, noise
        return self._step[1]

    def predict_readings(self, states: Floats, known: Floats) -> Floats:
        """Give readings without noise."""
        return self.observe(states, known)[0]

    def observe(self, states: Floats, known: Floats) -> tuple[Floats, Floats]:
        """Give readings without noise, and the Jacobian."""
        return self._readings.at(states, self._chosen, known, self._turn)

    def measurement_noise(self) -> Floats:
        """Covariance of readings."""
        return self._noise

    def correlate(self) -> Floats:
        """Give the steps over which errors of readings are correlated."""
        return self._steps

    def add_errors(self, states: Floats, errors: Floats) -> Floats:
        """States with errors added."""
        found: Floats = motion.add_errors(states, errors)
        return found

    def errors_between(self, states: Floats, origins: Floats) -> Floats:
        """Errors that take origins to states."""
        found: Floats = motion.errors_between(states, origins)
        return found

    def states_towards(self, sun: Floats) -> Floats:
        """States (B, S) of directions (B, 3), without bias and drift."""
        states = np.zeros((len(sun), self.errors + 7))
        least = np.eye(3)[np.abs(sun).argmin(axis=1)]
        first = np.cross(least, sun)
        first /= np.sqrt((first**2).sum(axis=1, keepdims=True))
        states[:, 0:3], states[:, 3:6], states[:, 6:9] = first, np.cross(sun, first), sun
        return states

    def start_belief(
        self,
        by: Filter,
        tried: Floats,
        read: Floats,
        known: Floats,
        considered: tuple[int, ...] = (),
    ) -> Belief | None:
        """Belief after a first reading (m,), from the best of states (G, S); None without one.

        A reading that no direction explains begins nothing: squares of what is left are chi-square,
        in units of the noise and of what is considered.

        Gauss-Newton steps of the update, all from the same prior (iterated Kalman update).
        """
        scale = np.sqrt(np.diagonal(self._noise))
        off = (read - self.predict_readings(tried, known)) / scale
        cost = (off**2).sum(axis=1)
        if not np.isfinite(cost).any():
            return None
        first = tried[[int(np.nanargmin(cost))]]
        state, step = first, np.zeros((1, self.errors))
        noise, white = np.diag(np.diagonal(self._noise) * self._steps)[None], np.ones(len(read))
        estimated = np.ones(self.errors)
        estimated[list(considered)] = 0.0
        prior = self._first[None].copy()
        covariance = prior
        for _ in range(_STEPS):
            values, slopes = self.observe(state, known)
            innovation = read - values + (slopes @ step[0])
            if not np.isfinite(innovation).all():
                return None
            step, covariance, _, _ = algebra.update(
                prior, slopes, noise, white, innovation, estimated
            )
            state = self.add_errors(first, step)
        left, slopes = self.observe(state, known)
        unsure = slopes[0][:, list(considered)] ** 2 @ np.diagonal(prior[0])[list(considered)]
        left = (read - left[0]) ** 2 / (np.diagonal(noise[0]) + unsure)
        if not left.sum() <= len(left) + _FAR * np.sqrt(2.0 * len(left)):
            return None
        return by.begin(self, state, covariance)

    @staticmethod
    def direction(states: Floats) -> Floats:
        """(B, 3) unit vectors to the Sun."""
        return states[:, _DIRECTION]

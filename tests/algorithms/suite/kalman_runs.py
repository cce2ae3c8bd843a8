"""Sensors on a turning body, known to the last digit, and runs of them drawn from their noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from algorithms.filtering.drift import EARTH, GAINS, LEVEL, Drift, Gyroscope
from algorithms.filtering.readings import FaceReadings, SpotReadings
from algorithms.filtering.state_space import LinearStateSpace
from algorithms.filtering.sun_space import SunSpace

Floats = NDArray[np.float64]

CUBE = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1.0)])
GYROSCOPE = Gyroscope(angle_walk=1e-4, bias=3e-5, bias_walk=2e-8)
STEP_S = 10.0


def cube() -> FaceReadings:
    """Six cosines of 100 units under perpendicular light, no Earth."""
    design = np.zeros((6, 16))
    for k, normal in enumerate(CUBE):
        first = np.roll(normal, 1)
        design[k, 0:3], design[k, 3:6], design[k, 6:9] = normal, first, np.cross(normal, first)
        design[k, 9:15] = (0.1, 100.0, -4.0, 2.0, 0.01, 98.0)
    return FaceReadings(design, np.zeros(12), 300.0)


def pinhole() -> SpotReadings:
    """A hole 100 px in front of its detector."""
    powers = np.array([(0, 0), (1, 0), (0, 1)], dtype=np.float64)
    design = np.array([(50.0, 40.0), (100.0, 0.0), (0.0, 100.0)])
    return SpotReadings(powers, design, np.zeros((3, 2)), 300.0)


@dataclass(frozen=True)
class Runs:
    """What B runs went through: states (T, B, S), readings (T, B, m), what is known (T, 7)."""

    space: SunSpace
    states: Floats
    readings: Floats
    known: Floats
    first: Floats


def rates(steps: int) -> Floats:
    """(T, 3) rad/s of a body that nods about its x and y axes by some 25 degrees."""
    turn = 0.07 * np.arange(steps)
    return 0.003 * np.column_stack([np.cos(turn), np.sin(1.3 * turn), 0.3 * np.ones(steps)])


def drawn(
    space: SunSpace, *, runs: int = 100, steps: int = 120, first: Floats, seed: int = 1
) -> Runs:
    """Return runs drawn from a state space's own noise: truth and filter are of one model."""
    rng = np.random.default_rng(seed)
    known = np.zeros((steps, 7))
    known[:, :3], known[:, 3] = rates(steps), 1.0
    ahead = np.array([[0.1, 0.1, 0.98**0.5]])
    middle = np.repeat(space.states_towards(ahead), runs, axis=0)
    states = space.add_errors(middle, draws(rng, first, runs))
    history, read = [], []
    for step in range(steps):
        if step:
            # the gyroscope's noise moves the truth: the rate is one for all runs
            states = space.propagate(states, known[step], STEP_S)
            states = space.add_errors(states, draws(rng, space.process_noise(STEP_S), runs))
        history.append(states)
        noise = draws(rng, space.measurement_noise(), runs)
        read.append(space.predict_readings(states, known[step]) + noise)
    return Runs(space, np.array(history), np.array(read), known, middle)


def draws(rng: np.random.Generator, covariance: Floats, count: int) -> Floats:
    """(count, n) normal numbers of a covariance that may have nothing in some places."""
    values, vectors = np.linalg.eigh(covariance)
    scale = np.sqrt(np.maximum(values, 0.0))
    return np.ascontiguousarray((rng.standard_normal((count, len(values))) * scale) @ vectors.T)


def spaces() -> dict[str, SunSpace]:
    """State spaces of faces and of a spot, with what may drift."""
    level = Drift(LEVEL, 0.05, 1e-4)
    gains = [Drift(GAINS + k, 0.01, 0.0) for k in range(6)]
    return {
        "faces": SunSpace(cube(), 0.25 * np.eye(6), GYROSCOPE, (level,)),
        "spot": SunSpace(pinhole(), 0.01 * np.eye(2), GYROSCOPE, ()),
        "gains": SunSpace(cube(), 0.25 * np.eye(6), GYROSCOPE, (level, *gains)),
        "earth": SunSpace(cube(), 0.25 * np.eye(6), GYROSCOPE, (level, Drift(EARTH, 0.3, 0.0))),
        "head": SunSpace(
            pinhole(), 0.01 * np.eye(2), GYROSCOPE, [Drift(p, 0.01, 1e-5) for p in range(5)]
        ),
        "turned": SunSpace(pinhole(), 0.01 * np.eye(2), GYROSCOPE, (), turn=float(np.radians(0.5))),
    }


def first_covariance(space: SunSpace) -> Floats:
    """Covariance at the start: 3 degrees a tangent axis, and what may drift."""
    covariance = space._first.copy()
    covariance[0, 0] = covariance[1, 1] = np.radians(3.0) ** 2
    return covariance


SPACES = spaces()


def turned_exactly(vectors: Floats, turn: Floats) -> Floats:
    """Vectors (N, 3) turned by a rotation vector, by SciPy."""
    return np.asarray(Rotation.from_rotvec(turn).apply(vectors))


NOTHING = np.zeros(0)
#: A cart on a rail: place, speed, and a bias of the second of two gauges of its place.
CART = LinearStateSpace(
    dynamics=np.array([[1.0, 0.5, 0.0], [0.0, 0.95, 0.0], [0.0, 0.0, 0.9]]),
    process=np.array([[0.02, 0.01, 0.0], [0.01, 0.05, 0.0], [0.0, 0.0, 0.03]]),
    observation=np.array([[1.0, 0.0, 0.0], [1.0, 0.2, 1.0]]),
    noise=np.array([[0.4, 0.1], [0.1, 0.9]]),
)


def history(runs: int, steps: int, seed: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """States (T, B, 3) and readings (T, B, 2)."""
    rng = np.random.default_rng(seed)
    states = rng.multivariate_normal(np.zeros(3), np.eye(3), runs)
    seen, read = [], []
    for _ in range(steps):
        states = states @ CART.dynamics.T
        states = states + rng.multivariate_normal(np.zeros(3), CART.process, runs)
        noise = rng.multivariate_normal(np.zeros(2), CART.noise, runs)
        seen.append(states)
        read.append(states @ CART.observation.T + noise)
    return np.array(seen), np.array(read)

"""On a linear system with normal noise every filter is Kalman's, and ends at Riccati's solution."""

from __future__ import annotations

import numpy as np
import pytest
from kalman_runs import CART, NOTHING, history
from scipy.linalg import solve_discrete_are

from algorithms.filtering.filters import (
    CUBATURE,
    AdaptiveKalman,
    ExtendedKalman,
    RobustKalman,
    SigmaPointKalman,
)
from algorithms.filtering.hypotheses import MultipleModels
from algorithms.filtering.state_space import LinearStateSpace

KALMANS = {
    "extended": ExtendedKalman(),
    "unscented": SigmaPointKalman(),
    "cubature": CUBATURE,
    "robust, never limited": RobustKalman(limit=1e9),
    "adaptive, never adapting": AdaptiveKalman(window=1e18),
    "one model": MultipleModels((1.0,)),
}


def textbook(read: np.ndarray) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Means and covariances of one run (T, 2) as printed everywhere, with an inverse."""
    f, q, h, r = CART.dynamics, CART.process, CART.observation, CART.noise
    x, p = np.zeros(3), np.eye(3)
    means, covariances = [], []
    for z in read:
        x, p = f @ x, f @ p @ f.T + q
        k = p @ h.T @ np.linalg.inv(h @ p @ h.T + r)
        x, p = x + k @ (z - h @ x), (np.eye(3) - k @ h) @ p
        means.append(x)
        covariances.append(p)
    return means, covariances


@pytest.mark.parametrize("name", KALMANS)
def test_every_filter_is_kalmans(name: str) -> None:
    kalman = KALMANS[name]
    _, read = history(runs=3, steps=40)
    belief = kalman.begin(CART, np.zeros((3, 3)), np.eye(3))
    truth = [textbook(read[:, run]) for run in range(3)]
    for step in range(40):
        belief = kalman.predict(CART, belief, NOTHING, 1.0)
        belief = kalman.update(CART, belief, read[step], NOTHING)
        states, covariances = kalman.estimate(CART, belief)
        for run in range(3):
            np.testing.assert_allclose(states[run], truth[run][0][step], atol=1e-10)
            np.testing.assert_allclose(covariances[run], truth[run][1][step], atol=1e-10)


@pytest.mark.parametrize("name", ["extended", "unscented", "cubature"])
def test_covariance_ends_at_riccatis_solution(name: str) -> None:
    kalman = KALMANS[name]
    belief = kalman.begin(CART, np.zeros((1, 3)), 5.0 * np.eye(3))
    for _ in range(200):
        before = kalman.predict(CART, belief, NOTHING, 1.0)
        belief = kalman.update(CART, before, np.zeros((1, 2)), NOTHING)
    settled = solve_discrete_are(CART.dynamics.T, CART.observation.T, CART.process, CART.noise)
    np.testing.assert_allclose(before.covariance[0], settled, atol=1e-10)


def test_a_reading_that_is_missing_changes_nothing_and_the_other_runs_go_on() -> None:
    _, read = history(runs=2, steps=1)
    read[0, 1] = np.nan
    for kalman in KALMANS.values():
        belief = kalman.begin(CART, np.zeros((2, 3)), np.eye(3))
        after = kalman.update(CART, belief, read[0], NOTHING)
        states, covariances = kalman.estimate(CART, after)
        assert (states[1] == 0).all()
        assert (covariances[1] == np.eye(3)).all()
        assert (states[0] != 0).any()
        assert np.isnan(after.squared_innovation[1])


def test_what_is_considered_is_not_moved_and_costs_its_share() -> None:
    """Schmidt's filter of one number read beside a bias: ``P = (R + B) P0 / (P0 + R + B)``."""
    space = LinearStateSpace(np.eye(2), 0 * np.eye(2), np.array([[1.0, 1.0]]), np.array([[0.5]]))
    schmidt = ExtendedKalman(considered=(1,))
    belief = schmidt.begin(space, np.zeros((1, 2)), np.diag([4.0, 0.3]))
    belief = schmidt.update(space, belief, np.array([[2.0]]), NOTHING)
    assert belief.states[0, 1] == 0
    assert belief.covariance[0, 1, 1] == pytest.approx(0.3, abs=1e-15)
    assert belief.states[0, 0] == pytest.approx(2.0 * 4.0 / 4.8, abs=1e-14)
    assert belief.covariance[0, 0, 0] == pytest.approx(4.0 * 0.8 / 4.8, abs=1e-14)
    assert belief.covariance[0, 0, 1] == pytest.approx(-4.0 / 4.8 * 0.3, abs=1e-14)
    assert belief.squared_innovation[0] == pytest.approx(4.0 / 4.8, abs=1e-14)

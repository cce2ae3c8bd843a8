"""Adaptive, robust, multiple-model and considering filters do what each is for."""

from __future__ import annotations

import numpy as np
import pytest
from kalman_runs import CART, NOTHING, history

from algorithms.filtering.filters import AdaptiveKalman, ExtendedKalman, RobustKalman
from algorithms.filtering.hypotheses import MultipleModels
from algorithms.filtering.state_space import LinearStateSpace


def through(kalman, space, read):
    belief = kalman.begin(space, np.zeros((read.shape[1], space.errors)), np.eye(space.errors))
    for z in read:
        belief = kalman.predict(space, belief, NOTHING, 1.0)
        belief = kalman.update(space, belief, z, NOTHING)
    return belief


@pytest.mark.parametrize("reported", [0.1, pytest.param(1.0, marks=pytest.mark.slow), 10.0])
def test_the_adaptive_filter_finds_the_noise_whatever_it_was_told(reported: float) -> None:
    _, read = history(runs=60, steps=1500)
    space = LinearStateSpace(CART.dynamics, CART.process, CART.observation, reported * CART.noise)
    found = through(AdaptiveKalman(window=100.0), space, read).noise.mean(axis=0)
    # 60 runs of some 100 readings: a variance is known to sqrt(2 / 6000) = 2 %
    np.testing.assert_allclose(found, CART.noise, rtol=0.12, atol=0.03)


@pytest.mark.parametrize("true", [0.5, 2.0, 8.0])
def test_of_several_models_the_right_one_becomes_probable(true: float) -> None:
    rng = np.random.default_rng(8)
    states, _ = history(runs=20, steps=60)
    noise = true * rng.multivariate_normal(np.zeros(2), CART.noise, (60, 20))
    read = states @ CART.observation.T + noise
    bank = MultipleModels((0.5, 2.0, 8.0), least=1e-9)
    weights = through(bank, CART, read).weights.reshape(20, 3)
    assert weights.sum(axis=1) == pytest.approx(1.0, abs=1e-12)
    assert weights[:, bank.noise_scales.index(true)].min() > 0.95


def test_several_models_follow_noise_that_changes() -> None:
    _, read = history(runs=10, steps=120)
    rng = np.random.default_rng(8)
    read[60:] += 8.0 * rng.multivariate_normal(np.zeros(2), CART.noise, (60, 10))
    bank = MultipleModels((1.0, 8.0))
    early, late = through(bank, CART, read[:60]), through(bank, CART, read)
    assert early.weights.reshape(10, 2)[:, 0].min() > 0.9
    assert late.weights.reshape(10, 2)[:, 1].min() > 0.9


def test_an_outlier_moves_the_robust_filter_by_so_much_and_the_extended_one_without_bound() -> None:
    _, read = history(runs=1, steps=30)
    calm, moved = {}, {}
    for name, kalman in {"extended": ExtendedKalman(), "robust": RobustKalman()}.items():
        calm[name] = through(kalman, CART, read).states[0]
        for size in (1e2, 1e4, 1e6):
            wild = read.copy()
            wild[-1, 0, 0] += size
            off = through(kalman, CART, wild).states[0] - calm[name]
            moved[name, size] = float(np.abs(off).max())
    assert moved["extended", 1e6] > 1e3 * moved["extended", 1e2] * 0.99
    assert moved["robust", 1e6] < 1.5 * moved["robust", 1e2]
    deviation = np.sqrt(through(ExtendedKalman(), CART, read).covariance[0].diagonal().max())
    assert moved["robust", 1e6] < 3.0 * deviation


def test_without_outliers_the_robust_filter_loses_next_to_nothing() -> None:
    states, read = history(runs=200, steps=40)
    error = {
        name: np.mean((through(kalman, CART, read).states - states[-1]) ** 2)
        for name, kalman in {"extended": ExtendedKalman(), "robust": RobustKalman()}.items()
    }
    assert error["robust"] < 1.1 * error["extended"]


def test_a_considered_bias_gives_the_spread_that_runs_have_and_an_ignored_one_does_not() -> None:
    """4000 runs of a gauge whose bias nobody estimates: the covariance is that of the errors."""
    rng = np.random.default_rng(5)
    runs, steps = 4000, 25
    known = LinearStateSpace(np.eye(1), 0.01 * np.eye(1), np.eye(1), np.eye(1))
    whole = LinearStateSpace(
        np.eye(2), np.diag([0.01, 0.0]), np.array([[1.0, 1.0]]), np.array([[1.0]])
    )
    place = rng.standard_normal((runs, 1))
    bias = 0.7 * rng.standard_normal((runs, 1))
    read, truth = [], place
    for _ in range(steps):
        truth = truth + 0.1 * rng.standard_normal((runs, 1))
        read.append(truth + bias + rng.standard_normal((runs, 1)))
    schmidt, ignoring = ExtendedKalman(considered=(1,)), ExtendedKalman()
    belief = schmidt.begin(whole, np.zeros((runs, 2)), np.diag([1.0, 0.49]))
    naive = ignoring.begin(known, np.zeros((runs, 1)), np.eye(1))
    for z in read:
        belief = schmidt.update(whole, schmidt.predict(whole, belief, NOTHING, 1.0), z, NOTHING)
        naive = ignoring.update(known, ignoring.predict(known, naive, NOTHING, 1.0), z, NOTHING)
    spread = float(np.mean((belief.states[:, 0] - truth[:, 0]) ** 2))
    naive_spread = float(np.mean((naive.states[:, 0] - truth[:, 0]) ** 2))
    # a variance of 4000 runs is known to sqrt(2 / 4000) = 2.2 %
    assert belief.covariance[0, 0, 0] == pytest.approx(spread, rel=0.07)
    assert belief.covariance[0, 0, 0] > 2.0 * naive.covariance[0, 0, 0]
    assert naive_spread > 2.0 * naive.covariance[0, 0, 0]
    assert spread < naive_spread
    assert np.array_equal(belief.states[:, 1], np.zeros(runs))

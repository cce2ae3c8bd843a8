"""The Sun in a turning body: exact turns, derivatives, and filters that know their own errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from kalman_runs import (
    GYROSCOPE,
    SPACES,
    STEP_S,
    drawn,
    first_covariance,
    pinhole,
    turned_exactly,
)
from scipy.stats import chi2

from algorithms.filtering.filters import (
    CUBATURE,
    AdaptiveKalman,
    ExtendedKalman,
    SigmaPointKalman,
)
from algorithms.filtering.hypotheses import MultipleModels
from algorithms.filtering.sun_space import SunSpace

NAMES = ("faces", "spot", "gains", "earth", "head")
KNOWN = np.array([0.01, -0.02, 0.015, 0.6, 0.0, -0.8, 12.0])


def some_states(space, count=7):
    rng = np.random.default_rng(4)
    sun = rng.normal((0.2, -0.1, 1.0), 0.3, (count, 3))
    states = space.states_towards(sun / np.linalg.norm(sun, axis=1, keepdims=True))
    size = np.r_[0.3, 0.3, 1e-3 * np.ones(3), 0.02 * np.ones(space.errors - 5)]
    return space.add_errors(states, size * rng.standard_normal((count, space.errors)))


@pytest.mark.parametrize("name", NAMES)
def test_a_body_that_turns_sees_the_sun_turn_back(name: str) -> None:
    states = some_states(SPACES[name])
    after = SPACES[name].propagate(states, KNOWN, STEP_S)
    for before, found in zip(states, after, strict=True):
        turn = -(KNOWN[:3] - before[9:12]) * STEP_S
        expected = turned_exactly(before[:9].reshape(3, 3), turn)
        np.testing.assert_allclose(found[:9].reshape(3, 3), expected, atol=1e-14)
        np.testing.assert_array_equal(found[9:], before[9:])


@pytest.mark.parametrize("name", NAMES)
def test_derivatives_are_those_of_differences(name: str) -> None:
    space = SPACES[name]
    states = some_states(space)
    n, step = space.errors, 1e-6
    after, transition = space.advance(states, KNOWN, STEP_S)
    seen, sensitivity = space.observe(states, KNOWN)
    np.testing.assert_array_equal(after, space.propagate(states, KNOWN, STEP_S))
    np.testing.assert_array_equal(seen, space.predict_readings(states, KNOWN))
    for column in range(n):
        error = np.zeros((len(states), n))
        error[:, column] = step
        up, down = space.add_errors(states, error), space.add_errors(states, -error)
        change = space.errors_between(space.propagate(up, KNOWN, STEP_S), after)
        change -= space.errors_between(space.propagate(down, KNOWN, STEP_S), after)
        np.testing.assert_allclose(transition[:, :, column], change / (2 * step), atol=2e-6)
        read = space.predict_readings(up, KNOWN) - space.predict_readings(down, KNOWN)
        np.testing.assert_allclose(sensitivity[:, :, column], read / (2 * step), atol=2e-5)


FILTERS = {"extended": ExtendedKalman(), "unscented": SigmaPointKalman(), "cubature": CUBATURE}


@pytest.mark.parametrize(
    ("name", "by"),
    [
        ("faces", "extended"),
        ("spot", "extended"),
        ("head", "extended"),
        ("head", "unscented"),
        ("head", "cubature"),
    ],
)
def test_errors_and_innovations_are_as_large_as_the_filter_says(name: str, by: str) -> None:
    """100 runs: squares in units of the filter's own covariance within their 95 % bounds."""
    space, kalman = SPACES[name], FILTERS[by]
    first = first_covariance(space)
    runs = drawn(space, first=first, seed=11)
    belief = kalman.begin(space, runs.first, first)
    errors, innovations = [], []
    for step in range(len(runs.known)):
        if step:
            belief = kalman.predict(space, belief, runs.known[step], STEP_S)
        belief = kalman.update(space, belief, runs.readings[step], runs.known[step])
        off = space.errors_between(runs.states[step], belief.states)
        inverse = np.linalg.inv(belief.covariance)
        errors.append(np.einsum("bi,bij,bj->b", off, inverse, off))
        innovations.append(belief.squared_innovation)
    count = len(runs.first)
    # of 120 independent sums 95 % +- 2 % are within; errors are correlated over some ten steps
    for squares, freedom, least in (
        (innovations, space.readings, 0.89),
        (errors, space.errors, 0.80),
    ):
        low, high = chi2.ppf((0.025, 0.975), count * freedom)
        sums = np.sum(squares, axis=1)
        inside = np.mean((sums > low) & (sums < high))
        assert inside > least, f"{inside:.2f} of the steps within the bounds"
    # innovations are white: all of them together have bounds of their own
    low, high = chi2.ppf((0.025, 0.975), count * space.readings * (len(innovations) - 20))
    assert low < np.sum(innovations[20:]) < high


def test_a_filter_that_ignores_gains_is_too_sure_and_one_that_considers_them_is_not() -> None:
    """Faces whose gains are 1 % off: 200 runs, the direction's errors beside each filter's own."""
    whole, plain = SPACES["gains"], SPACES["faces"]
    first = first_covariance(whole)
    runs = drawn(whole, runs=200, steps=80, first=first, seed=12)
    schmidt = ExtendedKalman(considered=tuple(range(6, 12)))
    considering = schmidt.begin(whole, runs.first, first)
    ignoring = ExtendedKalman().begin(
        plain, np.ascontiguousarray(runs.first[:, :13]), first[:6, :6]
    )
    spread, said = {}, {}
    for step, known in enumerate(runs.known):
        if step:
            considering = schmidt.predict(whole, considering, known, STEP_S)
            ignoring = ExtendedKalman().predict(plain, ignoring, known, STEP_S)
        considering = schmidt.update(whole, considering, runs.readings[step], known)
        ignoring = ExtendedKalman().update(plain, ignoring, runs.readings[step], known)
    for name, belief in {"considering": considering, "ignoring": ignoring}.items():
        off = plain.errors_between(
            np.ascontiguousarray(runs.states[-1][:, :13]), belief.states[:, :13].copy()
        )
        spread[name] = float(np.mean(off[:, :2] ** 2))
        said[name] = float(np.mean(belief.covariance[:, [0, 1], [0, 1]]))
    assert said["considering"] == pytest.approx(spread["considering"], rel=0.25)
    assert said["considering"] > said["ignoring"]
    assert spread["ignoring"] > 1.5 * said["ignoring"]
    assert (considering.states[:, 13:] == 0).all()


def squared_errors(space, by, runs, first) -> tuple[np.ndarray, np.ndarray]:
    """(T, B) of the direction, in the filter's own units; and of innovations, a reading."""
    size = space.errors + 7
    start = np.ascontiguousarray(runs.first[:, :size])
    belief = by.begin(space, start, first[: space.errors, : space.errors])
    found, innovations = [], []
    for step, known in enumerate(runs.known):
        if step:
            belief = by.predict(space, belief, known, STEP_S)
        belief = by.update(space, belief, runs.readings[step], known)
        off = space.errors_between(
            np.ascontiguousarray(runs.states[step][:, :size]), belief.states
        )[:, :2]
        inverse = np.linalg.inv(belief.covariance[:, :2, :2])
        found.append(np.einsum("bi,bij,bj->b", off, inverse, off))
        innovations.append(belief.squared_innovation / space.readings)
    return np.array(found), np.array(innovations)


@pytest.mark.parametrize(
    "by",
    [
        ExtendedKalman((5, 6, 7)),
        SigmaPointKalman(considered=(5, 6, 7)),
        AdaptiveKalman((5, 6, 7)),
        MultipleModels(considered=(5, 6, 7)),
    ],
    ids=lambda by: type(by).__name__,
)
def test_a_reference_that_was_turned_is_considered(by) -> None:
    """Heads turned by half a degree, 400 runs: who ignores it is too sure.

    A turn lasts: the runs' mean is one draw for all steps, of 0.05 standard deviation.
    """
    space, first = SPACES["turned"], first_covariance(SPACES["turned"])
    runs = drawn(space, first=first, seed=14, runs=400, steps=50)
    if isinstance(by, MultipleModels):
        estimates = mixed_errors(space, by, runs, first)
        ignored = mixed_errors(SPACES["spot"], MultipleModels(), runs, first[:5, :5])
    else:
        estimates = squared_errors(space, by, runs, first)[0]
        plain = replace(by, considered=())
        ignored = squared_errors(SPACES["spot"], plain, runs, first)[0]
    said = estimates[5:].mean(axis=1) / 2.0
    assert 0.85 < said.min() <= said.max() < 1.15, f"{said.min():.2f} to {said.max():.2f}"
    assert ignored[-1].mean() > 10.0 * estimates[-1].mean()


def mixed_errors(space, by, runs, first) -> np.ndarray:
    """(T, B) of the mixture's direction, in units of its covariance."""
    size = space.errors + 7
    belief = by.begin(space, np.ascontiguousarray(runs.first[:, :size]), first)
    found = []
    for step, known in enumerate(runs.known):
        if step:
            belief = by.predict(space, belief, known, STEP_S)
        belief = by.update(space, belief, runs.readings[step], known)
        states, covariance = by.estimate(space, belief)
        off = space.errors_between(np.ascontiguousarray(runs.states[step][:, :size]), states)[:, :2]
        inverse = np.linalg.inv(covariance[:, :2, :2])
        found.append(np.einsum("bi,bij,bj->b", off, inverse, off))
    return np.array(found)


def test_readings_that_err_alike_for_some_steps_tell_as_much_as_fewer() -> None:
    """An autoregression of 0.8 lasts for nine steps: 100 runs, with and without knowing it."""
    space, first = SPACES["spot"], first_covariance(SPACES["spot"])
    with_steps = SunSpace(pinhole(), 0.01 * np.eye(2), GYROSCOPE, (), steps=np.full(2, 9.0))
    runs = drawn(space, first=first, seed=15, steps=200)
    clean = np.array(
        [
            space.predict_readings(at, known)
            for at, known in zip(runs.states, runs.known, strict=True)
        ]
    )
    white = runs.readings - clean
    for step in range(1, len(white)):
        white[step] = 0.8 * white[step - 1] + 0.6 * white[step]
    lasting = replace(runs, readings=clean + white)
    knowing, innovations = squared_errors(with_steps, ExtendedKalman(), lasting, first)
    ignoring, _ = squared_errors(space, ExtendedKalman(), lasting, first)
    assert 0.7 < knowing[40:].mean() / 2.0 < 1.3
    # the estimate so far has the error of the reading, too: innovations are somewhat less
    assert 0.4 < innovations[40:].mean() < 1.1
    assert ignoring[40:].mean() / 2.0 > 2.0


def test_gains_that_drift_are_found_by_the_filter_that_has_them_in_its_state() -> None:
    space = SPACES["gains"]
    first = first_covariance(space)
    runs = drawn(space, runs=50, steps=200, first=first, seed=13)
    kalman = ExtendedKalman()
    belief = kalman.begin(space, runs.first, first)
    for step, known in enumerate(runs.known):
        if step:
            belief = kalman.predict(space, belief, known, STEP_S)
        belief = kalman.update(space, belief, runs.readings[step], known)
    # of the faces that the Sun lights; a common change of all is the light's strength
    lit = runs.readings.mean(axis=(0, 1)) > 5.0
    true, found = runs.states[-1][:, 13:][:, lit], belief.states[:, 13:][:, lit]
    off = (found - true) - (found - true).mean(axis=1, keepdims=True)
    before = true - true.mean(axis=1, keepdims=True)
    assert lit.sum() >= 3
    assert np.sqrt(np.mean(off**2)) < 0.5 * np.sqrt(np.mean(before**2))

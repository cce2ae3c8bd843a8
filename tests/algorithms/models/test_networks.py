"""Networks: their functions and derivatives, their training, and what it gives on every machine."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest
from scipy.optimize import least_squares as scipy_least_squares

from algorithms.angles import separation_deg, sun_from_angles
from algorithms.contract import UnusableDataError
from algorithms.models.neural_network.axis_networks import AxisNetworks
from algorithms.models.neural_network.cholesky_kernel import solve
from algorithms.models.neural_network.deep_signals import DeepSignals
from algorithms.models.neural_network.deep_surface import DeepSurface
from algorithms.models.neural_network.direction_errors import (
    Correction,
    errors_of,
    least_squares,
)
from algorithms.models.neural_network.network_kernel import (
    LINEAR,
    LOG_SIGMOID,
    TANH,
    network_derivatives,
    train,
)
from algorithms.models.neural_network.portable_kernel import angles_deg
from algorithms.models.neural_network.training import Network, Training, hold_out, train_network

DEEP = ((3, 3, 5, 4, 2), (LOG_SIGMOID, TANH, TANH, LINEAR))


def network(widths, kinds, seed=0, scale=1.0):
    weights = scale * Training(widths, kinds, restarts=1, seed=seed).start(0)
    return Network(weights, np.array(widths), np.array(kinds))


def derivatives(net, inputs):
    out = np.empty((len(inputs), int(net.widths[-1]), len(net.weights)))
    network_derivatives(inputs, net.weights, net.widths, net.kinds, out)
    return out


def plainly(net, inputs):
    """The same network by NumPy's own functions and matrix products."""
    respond = {
        LINEAR: lambda x: x,
        LOG_SIGMOID: lambda x: 1.0 / (1.0 + np.exp(-x)),
        TANH: np.tanh,
    }
    at, values = 0, inputs
    for before, after, kind in zip(net.widths[:-1], net.widths[1:], net.kinds, strict=True):
        part = net.weights[at : at + after * (before + 1)].reshape(after, before + 1)
        values = respond[int(kind)](values @ part[:, :before].T + part[:, before])
        at += part.size
    return values


def noisy_curve(count, noise, seed=3):
    """Samples of a sine with noise, a third of them held out."""
    rng = np.random.default_rng(seed)
    inputs = rng.uniform(-1.0, 1.0, (count, 1))
    clean = np.sin(3.0 * inputs)
    return (
        inputs,
        clean,
        clean + noise * rng.standard_normal(clean.shape),
        np.arange(count) % 3 == 0,
    )


@pytest.mark.parametrize("scale", [1.0, 30.0])
def test_a_network_is_its_layers_one_after_another(scale):
    net = network(*DEEP, scale=scale)
    inputs = np.random.default_rng(1).uniform(-1.0, 1.0, (150, 3))
    np.testing.assert_allclose(net.values(inputs), plainly(net, inputs), rtol=0, atol=1e-12 * scale)


def test_sums_far_off_saturate_and_nan_stays_nan():
    steep = Network(np.array([1.0, 0.0]), np.array([1, 1]), np.array([LOG_SIGMOID]))
    found = steep.values(np.array([[1e300], [-1e300], [np.nan], [0.0]]))[:, 0]
    np.testing.assert_allclose(found, [1.0, 0.0, np.nan, 0.5], atol=1e-13)


def test_derivatives_are_those_of_finite_differences():
    net = network(*DEEP, seed=4)
    inputs = np.random.default_rng(2).uniform(-1.0, 1.0, (70, 3))
    found = derivatives(net, inputs)
    for place in range(len(net.weights)):
        moved = []
        for step in (1e-5, -1e-5):
            weights = net.weights.copy()
            weights[place] += step
            moved.append(plainly(Network(weights, net.widths, net.kinds), inputs))
        difference = (moved[0] - moved[1]) / 2e-5
        np.testing.assert_allclose(found[:, :, place], difference, atol=1e-8)


def test_a_linear_network_is_least_squares():
    rng = np.random.default_rng(5)
    inputs = rng.uniform(-1.0, 1.0, (90, 3))
    wanted = inputs @ rng.uniform(-1, 1, (3, 2)) + rng.normal(0.3, 0.1, (90, 2))
    held = np.arange(90) < 30
    found = train_network(
        inputs, wanted, held, Training((3, 2), (LINEAR,), 1, 0, patience=10**6), "t"
    )
    design = np.column_stack([inputs, np.ones(90)])[~held]
    best = np.linalg.lstsq(design, wanted[~held], rcond=None)[0]
    # kept is the step that was best on what was held out, hardly another one than the last
    np.testing.assert_allclose(found.network.weights.reshape(2, 4).T, best, atol=2e-3)
    off = np.sqrt(((design @ best - wanted[~held]) ** 2).sum(axis=1).mean())
    assert found.fitted == pytest.approx(off, rel=1e-3)
    last = Training((3, 2), (LINEAR,), 1, 0).start(0)
    part = np.ascontiguousarray(inputs[~held]), np.ascontiguousarray(wanted[~held])
    train(*part, *part, last, found.network.widths, found.network.kinds, 50, 50, 0.0)
    np.testing.assert_allclose(last.reshape(2, 4).T, best, atol=1e-9)


def test_scipy_finds_no_lower_error_around_where_training_ends():
    inputs, _, wanted, _ = noisy_curve(60, 0.05)
    widths, kinds = np.array([1, 3, 1]), np.array([LOG_SIGMOID, LINEAR])
    ours = Training((1, 3, 1), (LOG_SIGMOID, LINEAR), 1, 2).start(0)
    before = ours.copy()
    train(inputs, wanted, inputs, wanted, ours, widths, kinds, 1000, 1000, 0.0)

    def off(weights):
        return (Network(weights, widths, kinds).values(inputs) - wanted).ravel()

    theirs = scipy_least_squares(
        off,
        ours + 0.02 * np.sin(np.arange(10)),
        jac=lambda weights: derivatives(Network(weights, widths, kinds), inputs)[:, 0],
        method="lm",
        max_nfev=2000,
    )
    assert (off(ours) ** 2).sum() == pytest.approx(2.0 * theirs.cost, rel=1e-6)
    assert (off(ours) ** 2).sum() < 0.02 * (off(before) ** 2).sum()


def test_a_network_that_could_have_made_the_samples_finds_them():
    truth = network((2, 3, 1), (LOG_SIGMOID, LINEAR), seed=8, scale=2.0)
    inputs = np.random.default_rng(6).uniform(-1.0, 1.0, (200, 2))
    wanted = truth.values(inputs)
    held = np.arange(200) % 5 == 0
    found = train_network(
        inputs, wanted, held, Training((2, 3, 1), truth.kinds, 5, 0, 1000, 200), "t"
    )
    assert found.held < 1e-4 * wanted.std()


def test_stopping_early_keeps_noise_out():
    """Few noisy samples and many units: what was kept beats what training ends with."""
    inputs, clean, wanted, held = noisy_curve(75, 0.3)
    widths, kinds = (1, 12, 1), (LOG_SIGMOID, LINEAR)
    plan = Training(widths, kinds, restarts=3, seed=0)
    kept = train_network(inputs, wanted, held, plan, "t")
    last = plan.start(0)
    part = np.ascontiguousarray(inputs[~held]), np.ascontiguousarray(wanted[~held])
    train(*part, *part, last, np.array(widths), np.array(kinds), 2000, 2000, 0.0)
    ended = Network(last, np.array(widths), np.array(kinds))

    def error(net):
        return np.sqrt(np.mean((net.values(inputs) - clean)[held] ** 2))

    assert error(kept.network) < 0.7 * error(ended)
    assert kept.fitted > np.sqrt(np.mean((ended.values(inputs) - wanted)[~held] ** 2))


def test_samples_held_out_move_no_weight():
    """They say when to stop, nothing else: with no patience to lose, any will do."""
    inputs, _, wanted, held = noisy_curve(60, 0.1)
    one = Training((1, 4, 1), (LOG_SIGMOID, LINEAR), 1, 0, steps=0)
    first = train_network(inputs, wanted, held, one, "t")
    assert np.isfinite(first.held)
    found = [first.network.weights]
    moved = wanted.copy()
    moved[held] *= 1.0 + 1e-9
    found.append(train_network(inputs, moved, held, one, "t").network.weights)
    np.testing.assert_array_equal(*found)


def test_cholesky_solves_what_numpy_solves():
    rng = np.random.default_rng(7)
    half = rng.standard_normal((20, 12))
    matrix, wanted = half.T @ half, rng.standard_normal(12)
    factor, found = np.empty((12, 12)), np.empty(12)
    assert solve(np.triu(matrix), 0.5, wanted, factor, found)
    np.testing.assert_allclose((matrix + 0.5 * np.eye(12)) @ found, wanted, atol=1e-12)
    assert not solve(-matrix, 0.0, wanted, factor, found)


def test_least_squares_is_numpys_where_every_column_counts():
    rng = np.random.default_rng(9)
    design, wanted = rng.standard_normal((50, 4)), rng.standard_normal((50, 2))
    best = np.linalg.lstsq(design, wanted, rcond=None)[0]
    np.testing.assert_allclose(least_squares(design, wanted, "t"), best, atol=1e-8)
    dark = np.column_stack([design, np.zeros(50)])
    np.testing.assert_allclose(least_squares(dark, wanted, "t")[4], 0.0)


def test_angles_are_those_of_the_c_library():
    tangents = np.tan(np.radians(np.linspace(-89.9, 89.9, 2001)))
    found = np.empty_like(tangents)
    angles_deg(tangents, found)
    wanted = [math.degrees(math.atan(tangent)) for tangent in tangents]
    np.testing.assert_allclose(found, wanted, rtol=4e-16, atol=3e-14)


@pytest.mark.parametrize("frontal", [True, False])
def test_the_errors_of_a_direction_undo_it(frontal):
    rng = np.random.default_rng(10)
    sun, base = (rng.uniform((-1, -1, 0.2), (1, 1, 1), (40, 3)) for _ in range(2))
    sun /= np.linalg.norm(sun, axis=1, keepdims=True)
    base = sun + 0.2 * base
    base /= np.linalg.norm(base, axis=1, keepdims=True)
    errors = errors_of(base, sun, frontal=frontal)
    assert errors.shape == (40, 2 if frontal else 3)
    # a network that hands its inputs on
    count = errors.shape[1]
    weights = np.column_stack([np.eye(count), np.zeros(count)]).ravel()
    handed = Network(weights, np.array([count, count]), np.array([LINEAR]))
    found = Correction(handed, 2.0, 0.0, 0).correct(base, errors / 2.0)
    np.testing.assert_allclose(found, sun, atol=1e-14)


def turntable(reach=60, step=6):
    angles = np.arange(-reach, reach + 1, step)
    return sun_from_angles(np.stack(np.meshgrid(angles, angles), -1).reshape(-1, 2))


def quadrants(sun):
    """Balances of a quadrant photodiode whose response bends towards the field's edge."""
    return np.tanh(0.9 * sun[:, :2] / sun[:, 2:]) @ np.array([[1.0, 0.03], [-0.03, 1.0]])


@pytest.mark.parametrize("model", [AxisNetworks(), DeepSurface()])
def test_networks_learn_a_bent_response_between_the_poses(model):
    sun = turntable()
    model.fit(quadrants(sun), sun)
    angles = np.random.default_rng(12).uniform(-57.0, 57.0, (300, 2))
    between = sun_from_angles(angles)
    assert separation_deg(model.predict(quadrants(between)), between).max() < 0.5


def test_deep_networks_learn_light_that_comes_with_the_sun():
    """A second light that stands fixed to the Sun: no face's response is a cosine any more."""
    normals = np.array([(0.5, 0.5, 0.7), (-0.5, 0.5, 0.7), (-0.5, -0.5, 0.7), (0.5, -0.5, 0.7)])
    sun = turntable(48, 6)

    def signals(sun):
        other = np.column_stack([-sun[:, 1], sun[:, 0], 0.1 * sun[:, 2]])
        return (sun @ normals.T).clip(0.0) + 0.2 * (other @ normals.T).clip(0.0)

    model = DeepSignals(signals=4).fit(signals(sun), sun)
    between = sun_from_angles(np.random.default_rng(13).uniform(-45.0, 45.0, (200, 2)))
    inputs = (signals(between) - model.middle_) / model.half_range_
    before = separation_deg(model._base(inputs), between)
    after = separation_deg(model.predict(signals(between)), between)
    assert np.sqrt(np.mean(after**2)) < 0.2 * np.sqrt(np.mean(before**2))


def test_nothing_is_learnt_where_there_is_nothing_to_correct():
    sun = turntable(40, 5)
    model = DeepSurface().fit(sun[:, :2] / sun[:, 2:], sun)
    assert not model.correction_.network.weights.any()
    assert model.correction_.steps == 0
    between = sun_from_angles(np.random.default_rng(16).uniform(-39.0, 39.0, (50, 2)))
    found = model.predict(between[:, :2] / between[:, 2:])
    assert separation_deg(found, between).max() < 2e-5  # the grid of training data


def test_seeds_give_other_networks_and_one_seed_the_same():
    sun = turntable(40, 5)
    features = quadrants(sun) + 0.002 * np.random.default_rng(14).standard_normal((len(sun), 2))
    fits = [AxisNetworks(seed=seed).fit(features, sun) for seed in (0, 0, 1)]
    weights = [np.concatenate([net.weights for net in fit.networks_]) for fit in fits]
    np.testing.assert_array_equal(weights[0], weights[1])
    assert not np.allclose(weights[0], weights[2])
    answers = [fit.predict(features) for fit in fits]
    assert 0 < np.nanmax(separation_deg(answers[0], answers[2])) < 0.5


def test_poses_held_out_are_a_fifth_and_none_of_the_rim():
    sun = turntable(40, 5)
    held = hold_out(sun)
    assert 0.1 < held.mean() < 0.2
    edge = np.abs(sun[:, :2] / sun[:, 2:]).max(axis=1) > np.tan(np.radians(39.0))
    assert not held[edge].any()


def test_fewer_poses_than_weights_are_refused():
    sun = turntable(40, 20)
    with pytest.raises(UnusableDataError, match="49 weights"):
        AxisNetworks().fit(quadrants(sun), sun)
    with pytest.raises(UnusableDataError, match="hold some out"):
        train_network(
            np.zeros((9, 1)), np.zeros((9, 1)), np.zeros(9, bool), Training((1, 1), (0,), 1, 0), "t"
        )


_WEIGHTS = """
import json, sys
import numpy as np
from algorithms.models.neural_network.axis_networks import AxisNetworks
from algorithms.models.neural_network.deep_signals import DeepSignals
from algorithms.models.neural_network.deep_surface import DeepSurface
data = np.load(sys.argv[1])
found = []
for model, features in (
    (AxisNetworks(restarts=2), data["spots"]),
    (DeepSurface(restarts=2), data["spots"]),
    (DeepSignals(signals=4, restarts=2), data["signals"]),
):
    model.fit(features, data["sun"])
    networks = getattr(model, "networks_", None) or (model.correction_.network,)
    found += [value.hex() for net in networks for value in net.weights.tolist()]
print(json.dumps(found))
"""


@pytest.mark.slow
def test_weights_are_the_same_with_the_kernels_of_other_processors(tmp_path):
    """Other BLAS, other NumPy loops, machine code for a processor without wide registers."""
    sun = turntable(48, 6)
    rng = np.random.default_rng(15)
    normals = np.array([(0.5, 0.5, 0.7), (-0.5, 0.5, 0.7), (-0.5, -0.5, 0.7), (0.5, -0.5, 0.7)])
    np.savez(
        tmp_path / "poses.npz",
        sun=sun,
        spots=quadrants(sun) + 1e-3 * rng.standard_normal((len(sun), 2)),
        signals=((sun @ normals.T).clip(0.0)) ** 1.2 + 1e-3 * rng.standard_normal((len(sun), 4)),
    )
    old = {
        "OPENBLAS_CORETYPE": "Prescott",
        "NPY_DISABLE_CPU_FEATURES": _beyond_baseline(),
        "NUMBA_CPU_NAME": "generic",
        "NUMBA_CPU_FEATURES": "",
        "NUMBA_CACHE_DIR": str(tmp_path / "cache"),
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4",
    }
    found = []
    for changed in ({}, old):
        run = subprocess.run(
            [sys.executable, "-c", _WEIGHTS, str(tmp_path / "poses.npz")],
            env={**os.environ, **changed},
            capture_output=True,
            text=True,
            check=True,
        )
        found.append(json.loads(run.stdout))
    assert len(found[0]) > 300
    assert found[0] == found[1]


def _beyond_baseline():
    """What NumPy can be made to do without on this processor."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    return " ".join(name for name in __cpu_dispatch__ if __cpu_features__.get(name))

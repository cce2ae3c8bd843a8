"""A training step's bits against sums written out one after another: no library decides them."""

import numpy as np
import pytest

from algorithms.models.neural_network.cholesky_kernel import solve
from algorithms.models.neural_network.network_kernel import (
    LINEAR,
    LOG_SIGMOID,
    TANH,
    network_derivatives,
    network_values,
    train,
)


def summed(rows, others):
    """Mean products of columns (R, P) with others (R, Q), four rows at a time, in NumPy's order."""
    total = np.zeros((rows.shape[1], others.shape[1]))
    padding = -len(rows) % 4
    rows = np.vstack([rows, np.zeros((padding, rows.shape[1]))])
    others = np.vstack([others, np.zeros((padding, others.shape[1]))])
    for first in range(0, len(rows), 4):
        a, b, c, d = (np.outer(rows[first + k], others[first + k]) for k in range(4))
        total += a + b + c + d
    return total


@pytest.mark.compiles
@pytest.mark.parametrize(
    ("widths", "kinds"),
    [
        ((2, 3, 1), (LOG_SIGMOID, LINEAR)),  # 13 weights
        ((1, 5, 1), (TANH, LINEAR)),  # 16, a multiple of eight
        ((2, 2, 4, 4, 2), (LOG_SIGMOID, TANH, TANH, LINEAR)),  # 48
        ((3, 4, 3), (TANH, LINEAR)),  # 31
    ],
)
@pytest.mark.parametrize("samples", [17, 64, 131])
def test_a_step_has_the_bits_of_sums_in_the_stated_order(widths, kinds, samples):
    rng = np.random.default_rng(samples)
    widths, kinds = np.array(widths), np.array(kinds)
    count = int(((widths[:-1] + 1) * widths[1:]).sum())
    start = rng.normal(0.0, 0.5, count)
    inputs = rng.uniform(-1.0, 1.0, (samples, widths[0]))
    wanted = rng.uniform(-1.0, 1.0, (samples, widths[-1]))
    rows = np.empty((samples, widths[-1], count))
    network_derivatives(inputs, start, widths, kinds, rows)
    answers = np.empty(wanted.shape)
    network_values(inputs, start, widths, kinds, answers)
    rows, errors = rows.reshape(-1, count), (answers - wanted).reshape(-1, 1)
    normal, gradient = summed(rows, rows) / samples, summed(rows, errors)[:, 0] / samples

    found = start.copy()
    held, _, taken = train(inputs, wanted, inputs, wanted, found, widths, kinds, 1, 9, 0.0)
    assert taken == 1
    mean = 0.0
    for p in range(count):
        mean += normal[p, p]
    mean /= count
    step, tried = np.empty(count), []
    for power in range(12):
        damping = 1e-2
        for _ in range(power):
            damping *= 10.0
        assert solve(normal, damping * mean, gradient, np.empty((count, count)), step)
        tried.append(start - step)
    assert any(np.array_equal(found, one) for one in tried)
    assert held < np.mean(np.sum((answers - wanted) ** 2, axis=1))

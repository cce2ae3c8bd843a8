"""A step of Levenberg-Marquardt against NumPy's matrices, over whole blocks of samples and not."""

import numpy as np
import pytest

from algorithms.models.neural_network.network_kernel import (
    LINEAR,
    TANH,
    network_derivatives,
    network_values,
    train,
)


@pytest.mark.parametrize("samples", [19, 64, 141])
@pytest.mark.parametrize("outputs", [1, 2, 3])
def test_a_step_is_that_of_the_damped_normal_equations(samples, outputs):
    rng = np.random.default_rng(samples)
    widths, kinds = np.array([3, 4, outputs]), np.array([TANH, LINEAR])
    start = rng.normal(0.0, 0.5, 4 * 4 + 5 * outputs)
    inputs = rng.uniform(-1.0, 1.0, (samples, 3))
    wanted = np.sin(inputs @ rng.normal(0.0, 1.0, (3, outputs)))

    def errors(weights):
        answers = np.empty((samples, outputs))
        network_values(inputs, weights, widths, kinds, answers)
        return (answers - wanted).ravel()

    rows = np.empty((samples, outputs, len(start)))
    network_derivatives(inputs, start, widths, kinds, rows)
    rows = rows.reshape(-1, len(start))
    normal, gradient = rows.T @ rows, rows.T @ errors(start)
    # the first of rising dampings that lowers the error
    for damping in 10.0 ** np.arange(-2, 11) * np.trace(normal) / len(start):
        best = start - np.linalg.solve(normal + damping * np.eye(len(start)), gradient)
        if np.sum(errors(best) ** 2) < np.sum(errors(start) ** 2):
            break

    found = start.copy()
    held, fitted, taken = train(inputs, wanted, inputs, wanted, found, widths, kinds, 1, 9, 0.0)
    assert taken == 1
    np.testing.assert_allclose(found, best, rtol=1e-9, atol=1e-10)
    np.testing.assert_allclose(fitted, np.sum(errors(found) ** 2) / samples, rtol=1e-12)
    assert held == fitted

"""What networks are trained on: rounded to a grid, and free of the signals' unit."""

import numpy as np

from algorithms.angles import sun_from_angles
from algorithms.models.neural_network.deep_signals import DeepSignals
from algorithms.models.neural_network.training import on_grid


def test_training_data_lie_on_the_grid_of_their_range():
    ramp = np.array([[0.0], [1.3 * 2.0**-22], [1.0]])
    found, _ = on_grid(ramp, np.eye(3))
    np.testing.assert_array_equal(found[:, 0], [0.0, 2.0**-22, 1.0])


def test_the_unit_of_signals_does_not_matter():
    axis = np.arange(-40.0, 41.0, 8.0)
    sun = sun_from_angles(np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2))
    signals = np.column_stack([np.tanh(sun[:, :2] / sun[:, 2:]), sun[:, 2] ** 2])

    def answers(unit):
        model = DeepSignals(signals=3, hidden=2, restarts=1).fit(unit * signals, sun)
        return model.predict(unit * signals)

    assert np.isfinite(answers(1.0)).all()
    np.testing.assert_array_equal(answers(4096.0), answers(1.0))

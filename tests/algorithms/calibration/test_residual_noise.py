"""Errors of fitted parameters where poses and features are noisy each in its way."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.calibration.residual_noise import parameter_covariance

RNG = np.random.default_rng(5)
POSES = 300
DERIVATIVES = RNG.normal(size=(POSES, 2, 4)) * (1.0, 10.0, 0.1, 1.0)
PLACE = np.linspace(0.0, 1.0, POSES)[:, None, None]
#: As behind a pinhole: the farther from the boresight, the less a feature moves an angle.
MOVED = np.eye(2) * (1.0 - 0.8 * PLACE) + 0.1 * RNG.normal(size=(POSES, 2, 2))


@pytest.mark.parametrize(("pose", "feature"), [(1.0, 0.0), (0.0, 1.0), (0.6, 1.0)])
def test_covariance_is_that_of_fits_to_drawn_noise(pose, feature):
    """2000 linear fits scatter as the mean of the covariances they state."""
    flat = DERIVATIVES.reshape(-1, 4)
    solve = np.linalg.pinv(flat)
    found, stated = [], []
    for seed in range(2000):
        rng = np.random.default_rng(seed)
        noise = pose * rng.normal(size=(POSES, 2))
        noise += feature * np.einsum("nij,nj->ni", MOVED, rng.normal(size=(POSES, 2)))
        vector = solve @ noise.ravel()
        found.append(vector)
        if seed < 40:
            off = noise - DERIVATIVES @ vector
            stated.append(np.diag(parameter_covariance(DERIVATIVES, off, MOVED)))
    np.testing.assert_allclose(np.mean(stated, axis=0), np.var(found, axis=0), rtol=0.1)


def test_a_perfect_fit_has_no_errors():
    assert not parameter_covariance(DERIVATIVES, np.zeros((POSES, 2)), MOVED).any()

"""Directions that two sides explain alike get no answer, and all others the one they had."""

import numpy as np

from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from algorithms.models.physics_informed.sure_faces import SureFaces

CUBE = tuple(tuple(row) for row in np.vstack([np.eye(3), -np.eye(3)]).tolist())
#: Cosine of incidence up to which a face stays dark.
DEAD = 0.03


def signals(sun, noise, seed):
    """Light of faces that answer grazing light with nothing."""
    lit = np.maximum(sun @ np.array(CUBE).T - DEAD, 0.0) / (1.0 - DEAD)
    return lit + np.random.default_rng(seed).normal(0.0, noise, lit.shape)


def sphere(count, seed):
    sun = np.random.default_rng(seed).normal(size=(count, 3))
    return sun / np.linalg.norm(sun, axis=1, keepdims=True)


def fitted(kind):
    sun = sphere(600, 1)
    return kind(CUBE).fit(signals(sun, 1e-3, 2), sun)


def test_a_sun_in_the_plane_of_dark_faces_gets_no_answer():
    aside = np.array([[0.02, 0.6, 0.0], [-0.02, 0.6, 0.0], [0.6, 0.02, 0.0]])
    aside[:, 2] = np.sqrt(1.0 - (aside**2).sum(axis=1))
    read = signals(aside, 0.0, 3)
    assert np.isfinite(fitted(AssembledFaces).predict(read)).any()
    assert np.isnan(fitted(SureFaces).predict(read)).all()


def test_every_other_direction_keeps_its_answer():
    sun = sphere(500, 4)
    sun = sun[np.abs(sun).min(axis=1) > 0.1]
    read = signals(sun, 1e-3, 5)
    sure = fitted(SureFaces).predict(read)
    assert np.isfinite(sure).all()
    np.testing.assert_array_equal(sure, fitted(AssembledFaces).predict(read))

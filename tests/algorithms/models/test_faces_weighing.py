"""Faces in light that changes from pose to pose, and against an independent fit."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from algorithms.models.physics_informed.faces_fit import FacesFit
from algorithms.models.physics_informed.faces_weighing import ResidualWeights
from benchmark import datasets

PYRAMID = np.array(
    [(np.sin(0.5) * np.cos(t), np.sin(0.5) * np.sin(t), np.cos(0.5)) for t in range(6)]
)
RESPONSE = np.array([-0.015, 0.752, 0.632, -0.369])


def spread(count, half_deg=50.0, seed=0):
    rng = np.random.default_rng(seed)
    z, turn = rng.uniform(np.cos(np.radians(half_deg)), 1, count), rng.uniform(0, 2 * np.pi, count)
    wide = np.sqrt(1 - z**2)
    return np.column_stack([wide * np.cos(turn), wide * np.sin(turn), z])


def read(sun, rng, flicker, noise=1e-3):
    c = sun @ PYRAMID.T
    value = np.maximum(((RESPONSE[3] * c + RESPONSE[2]) * c + RESPONSE[1]) * c + RESPONSE[0], 0.0)
    strength = 1.0 + flicker * rng.standard_normal((len(sun), 1))
    return value * strength + noise * rng.standard_normal(c.shape)


def own_fit(nominal, signals, sun, test):
    """Directions by gains, normals, a cubic response and a lamp's slopes: SciPy, not ours."""
    count, top = len(nominal), signals.max()
    lit = sun @ nominal.T > 0.05

    def modelled(p, directions):
        vectors = p[: 3 * count].reshape(count, 3)
        gains = np.linalg.norm(vectors, axis=1)
        c = directions @ (vectors / gains[:, None]).T
        b = p[3 * count : 3 * count + 3]
        cubic = b[0] + (1 - b.sum()) * c + b[1] * c**2 + b[2] * c**3
        return gains * np.where(c > 0, np.maximum(cubic, 0), 0)

    def off(p):
        lamp = 1 + sun @ p[-3:]
        return (modelled(p, sun) * lamp[:, None] - signals / top)[lit]

    start = nominal * (signals / top).max(axis=0)[:, None]
    p = least_squares(off, np.concatenate([start.ravel(), np.zeros(6)])).x
    found = np.empty((len(test), 3))
    for row, reading in enumerate(test / top):

        def beside(vector, reading=reading):  # its length is the light's strength
            length = np.linalg.norm(vector)
            return length * modelled(p, (vector / length)[None])[0] - reading

        first = (p[: 3 * count].reshape(count, 3) * reading[:, None]).sum(axis=0)
        found[row] = least_squares(beside, first / np.linalg.norm(first), method="lm").x
    return found / np.linalg.norm(found, axis=1, keepdims=True)


@pytest.mark.slow
@pytest.mark.parametrize("unit", [0, 2])
@pytest.mark.parametrize(
    "name",
    ["pd-maskless-cube", "pva-maskless-panels", "pd-maskless-pyramid", "pva-maskless-sphere"],
)
def test_no_standard_data_set_is_read_better_by_an_independent_fit(name, unit):
    """Of what both answer and the readings settle: its error, within two per cent."""
    preset = datasets.get(name).for_unit(unit)
    calibration = preset.generate("nominal", "calibration")
    asked = preset.generate("nominal", "test", 400)
    nominal = np.array(preset.geometry.face_normals)
    model = AssembledFaces.for_sensor(preset.geometry, FeatureKind.SIGNALS)
    error = separation_deg(
        model.fit(calibration.observations, calibration.sun).predict(asked.observations), asked.sun
    )
    other = separation_deg(
        own_fit(nominal, calibration.observations, calibration.sun, asked.observations), asked.sun
    )
    both = preset.bound("nominal", n=400).observable & np.isfinite(error)
    assert both.mean() > 0.9
    assert np.sqrt(np.mean(error[both] ** 2)) <= 1.02 * np.sqrt(np.mean(other[both] ** 2))
    assert np.median(error[both]) <= 1.03 * np.median(other[both])


def test_weighed_residuals_are_independent_ones():
    """Their products are those of the inverse covariance, as NumPy inverts it."""
    rng = np.random.default_rng(3)
    noise, modelled, tau = np.array([1.0, 2.0, 1.5, 3.0]), rng.uniform(0.1, 1, (5, 4)), 0.7
    used = np.ones((5, 4), dtype=bool)
    used[0, 1:] = False  # one face alone
    weighing = ResidualWeights(used, noise, np.where(used, modelled, 0) / noise, tau)
    off = rng.normal(size=(5, 4))
    found = weighing.weigh(off)
    for row in range(5):
        kept = used[row]
        m = modelled[row, kept]
        covariance = np.diag(noise[kept] ** 2) + tau**2 * np.outer(m, m)
        expected = off[row, kept] @ np.linalg.solve(covariance, off[row, kept])
        assert (found[row, kept] ** 2).sum() == pytest.approx(expected, rel=1e-12)
    stacked = np.stack([off, 2.0 * off], axis=2)
    np.testing.assert_allclose(weighing.weigh(stacked)[..., 1], 2.0 * found, rtol=1e-12)


@pytest.mark.slow
def test_flickering_light_costs_a_calibration_nothing_to_speak_of():
    """Its strength is common to the faces of a sample: normals come out as in steady light."""
    sun, wrong = spread(300), {}
    for flicker in (0.0, 0.02):
        off = []
        for seed in range(5):
            signals = read(sun, np.random.default_rng(seed), flicker)
            fit = FacesFit(PYRAMID, signals, sun, "test").solve(each=False)
            off.append(separation_deg(fit.normals, PYRAMID))
            np.testing.assert_allclose(fit.noise, 1e-3, rtol=0.25)
        wrong[flicker] = np.sqrt(np.mean(np.square(off)))
    assert wrong[0.02] < 1.5 * wrong[0.0]


@pytest.mark.slow
def test_intervals_hold_the_tilts_in_flickering_light():
    """93 to 97 % of 95 % intervals over 200 seeds."""
    sun = spread(60)
    held = []
    for seed in range(200):
        signals = read(sun, np.random.default_rng(seed), 0.01)
        found = FacesFit(PYRAMID, signals, sun, "test").solve(each=False).parameters
        held += [
            abs(one.value) < 1.96 * one.deviation for one in found if one.name.startswith("tilt")
        ]
    assert 0.93 <= np.mean(held) <= 0.97

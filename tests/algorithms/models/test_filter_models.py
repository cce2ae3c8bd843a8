"""What filters learn from a calibration, what they refuse, and how each differs from the plain."""

from __future__ import annotations

from dataclasses import replace

import flights
import numpy as np
import pytest

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind, UnsuitableDesignError
from algorithms.discovery import discover_models
from algorithms.filtering.reading_noise import correlated_steps
from algorithms.filtering.readings import FaceReadings, SpotReadings, earth_columns
from algorithms.models.filters import (
    AssemblyDriftFilter,
    ConsiderKalmanFilter,
    ExtendedKalmanFilter,
    RobustKalmanFilter,
)

CUBE = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1.0)])
FILTERS = [m for m in discover_models().values() if getattr(m, "sequential", False)]


def sphere(count: int, seed: int) -> np.ndarray:
    vectors = np.random.default_rng(seed).standard_normal((count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def known_of(nadir: np.ndarray, kelvin: np.ndarray) -> np.ndarray:
    return np.column_stack([np.zeros((len(nadir), 3)), nadir, kelvin])


def read(readings, sun: np.ndarray, known: np.ndarray) -> np.ndarray:
    states = np.zeros((1, 12))
    rows = []
    for vector, row in zip(sun, known, strict=True):
        states[0, 6:9] = vector
        warm = np.r_[row[:6], row[6] - readings.middle_k]
        rows.append(readings.at(states, np.zeros(0), warm)[0][0])
    return np.array(rows)


def test_faces_are_learnt_with_their_tilts_gains_warmth_and_the_earth() -> None:
    """A sensor within what readings can say is found to rounding, up to squares of its tilts."""
    rng = np.random.default_rng(7)
    sun, nadir = sphere(1500, 1), sphere(1500, 2)
    kelvin = 290.0 + 20.0 * rng.standard_normal(1500)
    tilted = CUBE + 0.02 * rng.standard_normal((6, 3))
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    gain = 100.0 * (1.0 + 0.1 * rng.standard_normal(6))
    cosine = np.maximum(sun @ tilted.T, 0.0)
    direct = 0.9 * cosine + 0.2 * cosine**2 - 0.1 * cosine**3
    direct += 1e-3 * cosine * (kelvin - kelvin.mean())[:, None]
    earth = np.r_[0.0, 0.01, 0.02, 0.05, 0.04, 0.02, -0.01, 0.03, 0.01, 0.01, 0.02, -0.01]
    shone = np.column_stack([earth_columns(sun, nadir, normal) @ earth for normal in tilted])
    signals = 0.3 + gain * (direct + shone)
    known = known_of(nadir, kelvin)
    learnt = FaceReadings.from_calibration(CUBE, signals, sun, known, "faces")
    found = read(learnt, sun, known)
    assert np.sqrt(np.mean((found - signals) ** 2)) < 0.003 * gain.mean()
    off_deg = np.degrees(np.linalg.norm(learnt.design[:, :3] - tilted, axis=1))
    before_deg = np.degrees(np.linalg.norm(CUBE - tilted, axis=1))
    assert off_deg.max() < 0.1 * before_deg.max()
    np.testing.assert_allclose(learnt.design[:, 14], gain, rtol=0.02)


def test_spots_are_learnt_with_as_high_an_order_as_they_need() -> None:
    sun = flights.path(FeatureKind.SPOT)
    beta, alpha = sun[:, 0] / sun[:, 2], sun[:, 1] / sun[:, 2]
    kelvin = 290.0 + 10.0 * np.cos(np.arange(len(sun)))
    known = known_of(-sun, kelvin)
    straight = np.column_stack([50.0 + 200.0 * beta, 60.0 + 200.0 * alpha])
    straight += 0.01 * np.random.default_rng(2).standard_normal(straight.shape)
    bent = straight * 1.0
    bent[:, 0] += 30.0 * beta**3 + 0.02 * (kelvin - kelvin.mean())
    for spots, order in ((straight, 1), (bent, 3)):
        learnt = SpotReadings.from_calibration(spots, sun, known, "spots")
        assert order <= learnt.settings()["order"] <= 5
        assert np.abs(read(learnt, sun, known) - spots).max() < 0.05
    assert learnt.warm[0, 0] == pytest.approx(0.02, abs=5e-4)


def test_correlated_residuals_count_as_fewer() -> None:
    """Of an autoregression the sum of correlations is ``(1 + r) / (1 - r)``."""
    rng = np.random.default_rng(4)
    noise = rng.standard_normal((20_000, 2))
    for step in range(1, len(noise)):
        noise[step, 1] += 0.8 * noise[step - 1, 1]
    steps = correlated_steps(noise)
    assert steps[0] == pytest.approx(1.0, abs=0.05)
    assert steps[1] == pytest.approx(9.0, rel=0.15)


def test_signals_without_faces_are_refused(geometry) -> None:
    for cls in FILTERS:
        with pytest.raises(UnsuitableDesignError, match="face_normals"):
            cls.for_sensor(replace(geometry, face_normals=None), FeatureKind.SIGNALS)
        assert cls.for_sensor(replace(geometry, face_normals=None), FeatureKind.SPOT).columns() == 2


def test_an_answer_that_is_too_uncertain_is_not_given(geometry) -> None:
    flight = flights.flight(FeatureKind.SPOT, geometry)
    model = ExtendedKalmanFilter().fit(**flight)
    deviation = model.deviation_deg(flight["features"], flight["context"])
    strict = ExtendedKalmanFilter(worst_deg=float(np.nanmedian(deviation)))
    found = strict.fit(**flight).predict(flight["features"], flight["context"])
    answered = np.isfinite(found[:, 0])
    assert np.array_equal(answered[1:], deviation[1:] <= strict.worst_deg)
    assert 0.4 < answered.mean() < 0.6


@pytest.mark.parametrize("kind", [FeatureKind.SIGNALS, FeatureKind.SPOT])
def test_wild_readings_pull_the_robust_filter_less(geometry, kind) -> None:
    flight = flights.flight(kind, geometry)
    wild = flight["features"].copy()
    wild[60:200:20, 0] += 0.2 * np.abs(wild).max()
    worst = {}
    for cls in (ExtendedKalmanFilter, RobustKalmanFilter):
        model = cls.for_sensor(geometry, kind).fit(**flight)
        error = separation_deg(model.predict(wild, flight["context"]), flight["sun"])
        worst[cls] = float(np.nanmax(error))
    assert worst[RobustKalmanFilter] < 0.5 * worst[ExtendedKalmanFilter]


def test_what_is_considered_stays_and_makes_the_filter_less_sure(geometry) -> None:
    flight = flights.flight(FeatureKind.SIGNALS, geometry)
    plain = ExtendedKalmanFilter.for_sensor(geometry, FeatureKind.SIGNALS).fit(**flight)
    schmidt = ConsiderKalmanFilter.for_sensor(geometry, FeatureKind.SIGNALS).fit(**flight)
    track = schmidt.track(flight["features"], flight["context"])
    assert (track.drift[1:, 1:] == 0).all()  # behind the light's strength
    np.testing.assert_allclose(track.drift_deviation[1:, 2:], schmidt.gain_deviation, rtol=1e-9)
    sure = plain.deviation_deg(flight["features"], flight["context"])
    assert (track.deviation_deg[20:] > sure[20:]).all()


def test_gains_that_changed_since_the_calibration_are_found_face_by_face(geometry) -> None:
    flight = flights.flight(FeatureKind.SIGNALS, geometry)
    model = AssemblyDriftFilter.for_sensor(geometry, FeatureKind.SIGNALS).fit(**flight)
    changes = np.array([0.02, -0.015, 0.01, -0.02, 0.015, -0.01])  # a common one is the light's
    track = model.track((1.0 + changes) * flight["features"], flight["context"])
    found = track.drift[-1, 1:7]  # behind the light's strength
    np.testing.assert_allclose(found - found.mean(), changes, atol=2e-3)


def test_a_row_alone_is_followed_where_a_track_is_asked_for_and_not_begun_for_an_answer(
    geometry,
) -> None:
    flight = flights.flight(FeatureKind.SPOT, geometry)
    model = ExtendedKalmanFilter().fit(**flight)
    context = {name: column[10:20] for name, column in flight["context"].items()}
    apart = {**context, "time_s": 1e4 * np.arange(10.0)}
    features = flight["features"][10:20]
    assert model.track(features, apart).is_read.all()
    assert np.isnan(model.predict(features, apart)).all()
    track, found = model.track(features, context), model.predict(features, context)
    assert track.is_read.sum() > 2
    answered = np.isfinite(found[:, 0])
    assert answered.sum() == track.is_read.sum() - 1
    np.testing.assert_array_equal(found[answered], track.sun[answered])

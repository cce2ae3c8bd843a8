"""Filters on the flights: silent in eclipse, better than single samples, and after the drift."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind
from algorithms.discovery import discover_models
from algorithms.models.filters import AssemblyDriftFilter, ExtendedKalmanFilter
from algorithms.models.physics_informed.assembled_faces import AssembledFaces
from algorithms.pipeline import extract_features
from benchmark import datasets
from benchmark.metrics.score import repeatability_deg
from benchmark.plan.combinations import cells
from benchmark.plan.parts import installed_parts
from benchmark.simulator.flight.gyro import Gyro, rotation_vectors_deg
from benchmark.simulator.flight.orbit import DAY_S, YEAR_DAYS

FILTERS = {n: m for n, m in discover_models().items() if getattr(m, "sequential", False)}
#: One model of the Sun's motion, and one that learns what drifts.
FEW = {"extended-kalman"}
CUBE = datasets.get("pd-orbit")


@pytest.fixture(scope="module")
def flown():
    """Calibration and test of the photodiodes, by condition."""
    return {
        name: (CUBE.generate(name, "calibration"), CUBE.generate(name, "test"))
        for name in ("nominal", "no-albedo")
    }


@pytest.fixture(scope="module")
def single(flown):
    """Errors of a model that reads each sample alone, by condition."""
    errors = {}
    for name, (calibration, test) in flown.items():
        still = AssembledFaces(CUBE.geometry.face_normals)
        still.fit(calibration.observations, calibration.sun)
        errors[name] = separation_deg(still.predict(test.observations), test.sun)
    return errors


def rms(error: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean(error**2)))


def test_the_gyroscope_tells_how_the_body_turned() -> None:
    flight = replace(CUBE.flight, gyro=Gyro(0.0, 0.0, 0.0))
    preset = replace(CUBE, directions=flight)
    for split in ("calibration", "test"):
        leg, rate = flight.leg(split), preset.context("nominal", split)["rate_deg_s"]
        turn = Rotation.from_rotvec(-np.radians(rate) * flight.test.step_s)
        follows = np.flatnonzero(np.diff(leg.since_s) == flight.test.step_s) + 1
        carried = turn[follows].apply(leg.sun_body[follows - 1])
        np.testing.assert_allclose(carried, leg.sun_body[follows], atol=1e-12)


def test_rotation_vectors_are_scipys() -> None:
    turns = Rotation.random(40, random_state=3)
    small = Rotation.from_rotvec(np.random.default_rng(1).normal(0, 0.5, (40, 3)))
    found = rotation_vectors_deg((small.inv() * turns).as_matrix(), turns.as_matrix())
    np.testing.assert_allclose(np.radians(found), small.as_rotvec(), atol=1e-13)
    np.testing.assert_array_equal(rotation_vectors_deg(np.eye(3)[None], np.eye(3)[None]), 0.0)


def test_the_gyroscopes_noise_is_that_of_its_data_sheet() -> None:
    still = np.broadcast_to(np.eye(3), (20_000, 3, 3))
    time_s = 10.0 * np.arange(20_000)
    drawn = np.random.default_rng(9)
    white = Gyro(0.6, 0.0, 0.0).read(still, still, time_s, 10.0, drawn)
    hour = white[: 360 * 50].reshape(50, 360, 3).sum(axis=1) * 10.0
    assert hour.std() == pytest.approx(0.6, rel=0.15)  # of 150 hours
    bias = [
        Gyro(0.0, 7.0, 0.0).read(still[:1], still[:1], time_s[:1], 10.0, drawn) for _ in "a" * 400
    ]
    assert 3600.0 * np.std(bias) == pytest.approx(7.0, rel=0.1)
    walk = 3600.0 * Gyro(0.0, 0.0, 2.0).read(still, still, time_s, 10.0, drawn)
    assert np.diff(walk[::360], axis=0).std() == pytest.approx(2.0, rel=0.25)
    with pytest.raises(ValueError, match="bias_deg_h"):
        Gyro(bias_deg_h=-1.0)


def test_every_filter_is_planned_on_every_flight_and_nowhere_else() -> None:
    flights = [d for d in datasets.names() if "rate_deg_s" in datasets.get(d).context_columns]
    assert {"pd-orbit", "ccd-orbit"} <= set(flights)
    planned = {(c.dataset, c.model) for c in cells(models=list(FILTERS))}
    assert planned == {(d, m) for d in flights for m in FILTERS}
    assert {FILTERS[n].about.taxonomy for n in ("assembly-drift", "consider-kalman")} == {
        "ACM",
        "ECM/Noise",
    }


@pytest.mark.parametrize(
    "name", [n if n in FEW else pytest.param(n, marks=pytest.mark.slow) for n in FILTERS]
)
def test_in_eclipse_no_sun_is_invented_and_in_sunlight_single_samples_are_beaten(
    flown, single, name
) -> None:
    for condition, (calibration, test) in flown.items():
        model = FILTERS[name].for_sensor(CUBE.geometry, FeatureKind.SIGNALS)
        model.fit(calibration.observations, calibration.sun, calibration.context)
        found = model.predict(test.observations, test.context)
        eclipse = test.context["eclipse"]
        assert np.isnan(found[eclipse]).all()
        assert np.isfinite(found[~eclipse]).all(axis=1).mean() > 0.99
        error = separation_deg(found, test.sun)
        # without the Earth's light a single sample is nearly as good as its noise lets it be
        share = 0.5 if condition == "nominal" else 1.0
        assert rms(error[~eclipse]) < share * rms(single[condition][~eclipse]), condition


def test_dead_reckoning_through_eclipse_is_as_good_as_it_says(flown) -> None:
    calibration, test = flown["no-albedo"]
    model = ExtendedKalmanFilter(face_normals=CUBE.geometry.face_normals)
    model.fit(calibration.observations, calibration.sun, calibration.context)
    track = model.track(test.observations, test.context)
    eclipse = np.asarray(test.context["eclipse"]) & np.isfinite(track.sun[:, 0])
    error = separation_deg(track.sun, test.sun)
    assert not track.is_read[eclipse].any()
    inside = np.flatnonzero(eclipse[1:] & eclipse[:-1]) + 1
    assert (track.deviation_deg[inside] > track.deviation_deg[inside - 1]).all()
    assert rms(error[eclipse]) < 3.0 * rms(np.sqrt(2.0) * track.deviation_deg[eclipse])
    assert track.deviation_deg[eclipse].max() < 0.5


def test_gains_that_drift_are_followed(flown) -> None:
    """A quarter of a year on the static calibration is 4 % off, the filter half a per cent."""
    calibration, test = flown["no-albedo"]
    model = AssemblyDriftFilter(face_normals=CUBE.geometry.face_normals)
    model.fit(calibration.observations, calibration.sun, calibration.context)
    track = model.track(test.observations, test.context)
    pattern, sensor = CUBE.fixed_pattern("no-albedo"), CUBE.condition("no-albedo").sensor

    def response(split: str) -> np.ndarray:
        leg = CUBE.flight.leg(split)
        temperature = sensor.thermal.temperature(leg.orbit, leg.sun, leg.since_s)
        age = leg.time_s / (DAY_S * YEAR_DAYS)
        factors = sensor.drift.factors(
            temperature, age, pattern["gain_per_k"], pattern["loss_per_year"]
        )
        return factors * leg.sunlight

    # what warmth changes is part of the calibration
    warmth = test.context["temperature_K"] - model.readings_.middle_k
    foreseen = 1 + model.readings_.design[:, 13] / model.readings_.design[:, 14] * warmth[:, None]
    true = response("test") / response("calibration").mean(axis=0) / foreseen
    found = (1 + track.drift[:, :1]) * (1 + track.drift[:, 1:7])
    settled = ~np.asarray(test.context["eclipse"]) & (np.arange(len(true)) > 400)
    static, followed = rms(true[settled] - 1.0), rms(found[settled] - true[settled])
    assert static > 0.04
    assert followed < 0.1 * static


def test_the_split_repeat_is_no_sequence(flown) -> None:
    """Poses minutes apart, pass after pass: no answers, and so no repeatability."""
    calibration, _ = flown["nominal"]
    model = ExtendedKalmanFilter(face_normals=CUBE.geometry.face_normals)
    model.fit(calibration.observations, calibration.sun, calibration.context)
    again = CUBE.generate("nominal", "repeat")
    found = model.predict(again.observations, again.context)
    assert np.isnan(found).all()
    assert np.isnan(repeatability_deg(found.reshape(8, 25, 3)))


@pytest.mark.slow
def test_a_drifting_assembly_behind_a_spot_is_no_worse_filtered_than_still() -> None:
    preset = datasets.get("ccd-orbit")
    calibration, test = (preset.generate("nominal", split) for split in ("calibration", "test"))
    extractor = installed_parts().extractor("bctm").for_sensor(preset.geometry)
    known, seen = (
        extract_features(extractor, part.observations, part.origin_px)
        for part in (calibration, test)
    )
    eclipse = np.asarray(test.context["eclipse"])
    static = installed_parts().model("homography").for_sensor(preset.geometry, extractor.about.kind)
    static.fit(known, calibration.sun)
    single = separation_deg(static.predict(seen), test.sun)
    model = ExtendedKalmanFilter().fit(known, calibration.sun, calibration.context)
    found = model.predict(seen, test.context)
    assert np.isnan(found[eclipse]).all()
    both = np.isfinite(single) & np.isfinite(found[:, 0])
    assert rms(separation_deg(found, test.sun)[both]) < 1.05 * rms(single[both])

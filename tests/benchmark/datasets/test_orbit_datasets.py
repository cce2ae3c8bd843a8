"""The time series: order, context, eclipse, drift, digests, and how eclipse is scored."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets import Samples
from benchmark.datasets.conditions.flight import FlightPreset
from benchmark.metrics.bounds import cramer_rao
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.sensors.faces import FaceSensor

NAMES = (
    *("pd-orbit", "pd-albedo-orbit", "ccd-orbit", "qpd-orbit", "ccd-multi-slit-orbit"),
    "pva-orbit",
)
#: The flights of the quick run: they take least, and one way to fly is common to all.
QUICK = ("pd-albedo-orbit", "qpd-orbit")
each = pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in QUICK else pytest.mark.slow) for n in NAMES]
)
PRESETS = {name: datasets.get(name) for name in NAMES}


class Made(dict[tuple[str, str], Samples]):
    """Splits by data set and name, generated when they are first asked for."""

    def __missing__(self, key: tuple[str, str]) -> Samples:
        name, split = key
        self[key] = PRESETS[name].generate("nominal", split)
        return self[key]


@pytest.fixture(scope="module")
def made() -> Made:
    return Made()


def flight_of(name: str) -> FlightPreset:
    preset = PRESETS[name]
    assert isinstance(preset, FlightPreset)
    return preset


@each
def test_context_has_the_columns_the_card_names(made, name: str) -> None:
    card = PRESETS[name].card()
    for split in ("calibration", "test"):
        samples = made[name, split]
        assert samples.context is not None
        assert set(samples.context) == set(card["context"]) == set(PRESETS[name].context_columns)
        for column, values in samples.context.items():
            assert len(values) == len(samples.sun), column
            assert values.shape[1:] == ((3,) if "(N, 3)" in card["context"][column] else ())
            assert np.isfinite(values).all()
        for column in ("nadir", "sun_inertial", "nadir_inertial"):
            assert np.linalg.norm(samples.context[column], axis=1) == pytest.approx(1, abs=1e-14)
    assert "posterior" in card["bound"]["note"]


@each
def test_samples_are_in_order_and_continuous(made, name: str) -> None:
    span = flight_of(name).flight.test
    test, calibration = made[name, "test"], made[name, "calibration"]
    assert np.diff(test.context["time_s"]) == pytest.approx(span.step_s, abs=1e-6)
    steps = np.diff(calibration.context["time_s"])
    assert (steps >= span.step_s).all()
    trained = flight_of(name).flight.calibration
    orbits = trained.samples * trained.step_s / flight_of(name).flight.orbit.period_s
    assert (steps > 1000).sum() == round(orbits)  # the eclipses
    assert test.context["time_s"][0] > calibration.context["time_s"][-1]
    turn = np.degrees(np.linalg.norm(np.cross(test.sun[1:], test.sun[:-1]), axis=1))
    attitude = flight_of(name).flight.attitude
    fastest = (attitude.precession_deg_s + attitude.spin_deg_s) * span.step_s
    assert 0 < turn.max() <= fastest
    # beside the cycle's own change six standard deviations of the thermometer's noise, one digit
    step = np.abs(np.diff(test.context["temperature_K"])).max()
    assert step < 0.03 * span.step_s + 6 * 2**0.5 * 0.2 + 0.25
    for column in ("nadir_inertial", "magnetic_field_inertial_nT"):
        step = np.linalg.norm(np.diff(test.context[column], axis=0), axis=1)
        assert step.max() < 3 * np.median(step)


@pytest.mark.slow
@each
def test_eclipse_is_dark_and_only_the_test_split_has_it(made, name: str) -> None:
    samples = made[name, "test"]
    eclipse = samples.context["eclipse"]
    card = PRESETS[name].card()["splits"]["test"]
    assert eclipse.mean() == pytest.approx(card["eclipse_fraction"], abs=0.01)
    assert not made[name, "calibration"].context["eclipse"].any()
    brightest = samples.observations.reshape(len(eclipse), -1).max(axis=1).astype(float)
    assert brightest[eclipse].max() < 0.1 * brightest[~eclipse].min()
    for condition in PRESETS[name].conditions:
        scene = PRESETS[name].scene(condition, "test")
        assert (scene.irradiance[eclipse] == 0).all()
        assert (scene.stray[eclipse] == 0).all()
        assert (scene.irradiance[~eclipse] > 0.95).all()


@each
def test_the_direction_is_not_observable_in_eclipse(made, name: str) -> None:
    eclipse = made[name, "test"].context["eclipse"]
    preset = PRESETS[name]
    whole = preset.scene("nominal", "test")
    edge = int(np.argmax(~eclipse))  # the flight's test begins in the dark
    part = slice(edge - 20, edge + 20)
    setup = preset.condition("nominal")
    bound = cramer_rao(
        setup.sensor,
        whole.part(part.start, part.stop),
        preset.fixed_pattern("nominal"),
        setup.irradiance,
    )
    assert not bound.observable[eclipse[part]].any()
    assert np.isinf(bound.angle_deg[eclipse[part]]).all()
    assert bound.observable[~eclipse[part]].mean() > 0.8


@pytest.mark.parametrize("name", ["pd-orbit", pytest.param("ccd-orbit", marks=pytest.mark.slow)])
def test_other_instruments_agree_with_the_truth(made, name: str) -> None:
    """Nadir and field in both frames, with the true Sun, are one rotation apart."""
    perfect = PRESETS[name].generate("ideal-calibration", "test")
    context, sun = perfect.context, perfect.sun
    inner = np.sum(context["nadir_inertial"] * context["sun_inertial"], axis=1)
    apart = np.sum(context["nadir"] * sun, axis=1) - inner
    assert apart.std() == pytest.approx(np.radians(0.5) * np.mean(1 - inner**2) ** 0.5, rel=0.1)
    strength = np.linalg.norm(context["magnetic_field_inertial_nT"], axis=1)
    along = np.sum(context["magnetic_field_nT"] * sun, axis=1)
    model = np.sum(context["magnetic_field_inertial_nT"] * context["sun_inertial"], axis=1)
    assert (along - model).std() == pytest.approx(200.0, rel=0.1)
    assert abs((along - model).mean()) < 4 * 200 / len(sun) ** 0.5
    assert 18_000 < strength.min() < strength.max() < 60_000


def test_windows_wait_where_the_sun_was_last_seen() -> None:
    scene = PRESETS["ccd-orbit"].scene("nominal", "test")
    eclipse = scene.irradiance == 0
    origin = scene.origin_px
    assert origin is not None
    inside = eclipse[1:] & eclipse[:-1]
    assert (origin[1:][inside] == origin[:-1][inside]).all()
    entering = eclipse[1:] & ~eclipse[:-1]
    assert entering.sum() >= 3
    assert (origin[1:][entering] == origin[:-1][entering]).all()
    assert (origin[1:][~eclipse[1:]] != origin[:-1][~eclipse[1:]]).any(axis=1).mean() > 0.9


def test_drift_moves_the_spot_by_more_than_the_bound(made) -> None:
    """Between coldest and warmest sunlit sample the head moves by tens of bounds."""
    preset = PRESETS["ccd-orbit"]
    nominal, stable = preset.condition("nominal").sensor, preset.condition("stable").sensor
    scene = preset.scene("nominal", "test")
    moved = nominal.project(scene).rims_mm[0] - stable.project(scene).rims_mm[0]
    shift = moved.mean(axis=1)
    assert np.ptp(shift[:, 0]) > 1e-3
    assert np.ptp(shift[:, 0]) < 0.013  # a pixel
    age = scene.age_years
    assert age.min() == pytest.approx(90 / 365.2422, abs=1e-3)


def test_albedo_vanishes_in_eclipse_by_geometry(made) -> None:
    preset = PRESETS["pd-orbit"]
    context = made["pd-orbit", "test"].context
    eclipse, scene = context["eclipse"], preset.scene("nominal", "test")
    assert scene.albedo is not None
    assert (scene.albedo[eclipse] == 0).all()
    assert np.array_equal(context["albedo"], ~eclipse)
    assert not preset.generate("no-albedo", "test", 5).context["albedo"].any()
    assert (scene.albedo[~eclipse].max(axis=1) > 0.02).mean() > 0.5
    # not switched off: from within the cylinder no sunlit ground is above the horizon
    leg = flight_of("pd-orbit").flight.leg("test")
    sensor = preset.condition("nominal").sensor
    assert isinstance(sensor, FaceSensor)
    dark = sensor.earthlight(
        Earth(), leg.sun_body[eclipse], leg.nadir_body[eclipse], preset.fixed_pattern("nominal")
    )
    assert np.abs(dark).max() < 1e-12

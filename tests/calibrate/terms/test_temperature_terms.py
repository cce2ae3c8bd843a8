"""Terms of temperature: known drifts are found as they are, and none where there is none."""

from __future__ import annotations

from pathlib import Path

import bench
import numpy as np
import pytest

from algorithms.calibration.saving import stage_document, stage_of
from algorithms.contract import Floats, UnusableDataError
from calibrate.readings import readings_of
from calibrate.roles import guess
from calibrate.selection import applicable, compare, geometry_of
from calibrate.table import read_table
from calibrate.terms.temperature import TERMS, TemperatureGains, TemperatureTerms

SHARED = Path(__file__).parents[4] / "shared"
RNG = np.random.default_rng(41)
SUN = bench.sun_of(RNG.uniform(-45.0, 45.0, (300, 2)))
BALL = bench.sphere(600, 42)
CELSIUS = RNG.uniform(-20.0, 60.0, 300)
OF_BALL = RNG.uniform(-20.0, 60.0, 600)
LEVELS = np.array([1.0, 0.5, 1.2, 0.8, 0.3, 0.0])


def camera(celsius: Floats) -> Floats:
    """Spots that grow by 0.03 %/K about (500, 520)."""
    middle = np.array([500.0, 520.0])
    still = bench.spots(SUN, 3)
    return np.asarray(middle + (still - middle) * (1.0 + 3e-4 * (celsius - 20.0))[:, None])


@pytest.mark.parametrize("zero", [0.0, 273.15])
def test_a_scale_about_a_centre_is_found_in_celsius_as_in_kelvin(zero: float) -> None:
    warm = {"temperature_K": CELSIUS + zero}
    stage = TemperatureTerms().fit(camera(CELSIUS), SUN, warm)
    assert stage.slope_ == pytest.approx(-3e-4 * np.eye(2), abs=3e-6)
    assert -stage.shift_ / stage.slope_[0, 0] == pytest.approx([500.0, 520.0], abs=2.0)
    still = camera(np.full(300, CELSIUS.mean()))
    off = stage.transform(camera(CELSIUS), warm) - still
    assert np.sqrt(np.mean(off**2)) < 2.0 * bench.NOISE


def test_a_shift_alone_has_no_scale() -> None:
    moved = bench.spots(SUN, 3) + CELSIUS[:, None] * [0.02, -0.01]
    stage = TemperatureTerms().fit(moved, SUN, {"temperature_K": CELSIUS})
    assert not stage.slope_.any()
    assert stage.shift_ == pytest.approx([-0.02, 0.01], abs=5e-4)


@pytest.mark.parametrize("seed", range(3))
def test_a_sensor_that_temperature_leaves_alone_gets_no_term(seed: int) -> None:
    with pytest.raises(UnusableDataError, match="do not go with the temperature"):
        TemperatureTerms().fit(bench.spots(SUN, seed), SUN, {"temperature_K": CELSIUS})


def test_a_temperature_that_goes_with_the_direction_tells_nothing() -> None:
    by_angle = {"temperature_K": 300.0 + 40.0 * SUN[:, 0]}
    with pytest.raises(UnusableDataError, match="poses at other temperatures"):
        TemperatureTerms().fit(camera(CELSIUS), SUN, by_angle)


def test_gains_of_channels_are_found_each() -> None:
    drift = 5e-4 * LEVELS
    warm = bench.faces(BALL, 5) * (1.0 + drift * (OF_BALL - OF_BALL.mean())[:, None])
    stage = TemperatureGains(6).fit(warm, BALL, {"temperature_K": OF_BALL})
    assert np.diag(stage.slope_) == pytest.approx(-drift, abs=6e-5)
    assert not stage.shift_.any()


def test_dark_levels_of_channels_are_found_each() -> None:
    drift = 4e-4 * LEVELS
    warm = bench.faces(BALL, 5) + drift * (OF_BALL - OF_BALL.mean())[:, None]
    stage = TemperatureGains(6).fit(warm, BALL, {"temperature_K": OF_BALL})
    assert stage.shift_ == pytest.approx(-drift, abs=5e-5)
    assert not stage.slope_.any()


@pytest.mark.parametrize("name", list(TERMS))
def test_a_stage_is_linear_in_temperature_and_survives_its_document(name: str) -> None:
    planar = name == "temperature-terms"
    stage = TemperatureTerms() if planar else TemperatureGains(6)
    sun, celsius = (SUN, CELSIUS) if planar else (BALL, OF_BALL)
    readings = camera(CELSIUS) if planar else bench.faces(BALL, 5) * (1 + 1e-3 * celsius)[:, None]
    stage.fit(readings, sun, {"temperature_K": celsius})
    loaded = stage_of(stage_document(stage), TERMS)
    at = [
        loaded.transform(readings, {"temperature_K": np.full(len(sun), t)})  # type: ignore[union-attr]
        for t in (stage.reference_k_, stage.reference_k_ + 1.0, stage.reference_k_ + 30.0)
    ]
    assert at[0] == pytest.approx(readings)
    assert (at[2] - at[0]) == pytest.approx(30.0 * (at[1] - at[0]), abs=1e-7)
    assert np.array_equal(at[2], stage.transform(readings, {
        "temperature_K": np.full(len(sun), stage.reference_k_ + 30.0)
    }))  # fmt: skip


@pytest.mark.skipif(not SHARED.is_dir(), reason="needs ../shared")
def test_the_shared_file_of_warm_spots_is_explained_by_a_term() -> None:
    table = read_table(SHARED / "cases" / "spot-temperature-C.csv")
    settings = guess(table)
    readings = readings_of(table, settings)
    geometry = geometry_of(readings, settings)
    known = applicable(readings, geometry)
    term, plain = "temperature-terms + homography", "homography"
    found = compare(readings, geometry, {name: known[name] for name in (term, plain)})
    rms = {one.name: one.rms_deg for one in found}
    assert rms[term] < 0.009
    assert rms[plain] > 0.1
